#pragma once

#include <string>
#include <vector>

namespace nsfd
{
  /** A stretch of one line of the input, which a message underlines. */
  struct SourceLocation {
    std::string source;      ///< file as it was named, or "--set"
    unsigned int line = 0;   ///< from 1; 0: the whole source, or a --set
    unsigned int column = 0; ///< from 0, in bytes of `text`
    unsigned int length = 0; ///< in bytes; 0 underlines nothing
    std::string text;        ///< the line
  };

  /** One error, warning or note. */
  struct Diagnostic {
    enum class Kind { error, warning, note };
    SourceLocation location;
    std::string message; ///< names parameter and value
    std::string advice;  ///< what to write instead, may be empty
    Kind kind = Kind::error;

    bool is_error() const { return kind == Kind::error; }
  };

  /**
   * Collects what is wrong with the input, so that a user sees all of it at
   * once. Nothing here throws; a run may start only if has_errors() is false.
   *
   *     midplane.prm:23: error: Young modulus = -3 GPa must be positive
   *       23 |   set Young modulus = -3 GPa
   *          |                       ^~~~~~
   *       write for example: 135 GPa
   */
  class InputErrors
  {
  public:
    void error(const SourceLocation &location, const std::string &message,
               const std::string &advice = "");
    void warning(const SourceLocation &location, const std::string &message,
                 const std::string &advice = "");

    /** Something to know, once however often it is said. */
    void note(const SourceLocation &location, const std::string &message);

    /** As it stands, from another collection. */
    void add(const Diagnostic &diagnostic);

    /** Take back an error that turned out to follow from another one. */
    void withdraw(const SourceLocation &location, const std::string &message);

    bool has_errors() const { return n_errors() > 0; }
    unsigned int n_errors() const;

    /** In the order in which they were found. */
    const std::vector<Diagnostic> &diagnostics() const { return diagnostics_; }

    /**
     * Errors, warnings and notes in the order of the lines, as text for a
     * terminal, with a closing line if there are errors. Empty if there is
     * nothing. At most @p n_shown of them are printed.
     */
    std::string report(unsigned int n_shown = 40) const;

  private:
    std::vector<Diagnostic> diagnostics_;
  };

  /**
   * The candidate that is spelt most like @p word (upper and lower case are
   * the same here, a swap of neighbours counts once, a missing or extra whole
   * word is forgiven); empty if none is near.
   */
  std::string nearest_name(const std::string &word,
                           const std::vector<std::string> &candidates);

  /** "did you mean `strength`?", or @p otherwise if nothing is near. */
  std::string did_you_mean(const std::string &word,
                           const std::vector<std::string> &candidates,
                           const std::string &otherwise = "");
} // namespace nsfd
