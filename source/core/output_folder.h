#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace nsfd
{
  /**
   * A file that cannot be written: a fact of the machine, such as a full disk,
   * and no fault of the program.
   */
  class OutputError : public std::runtime_error
  {
  public:
    /** If all ranks throw it @p together, with one text, none must wait. */
    explicit OutputError(const std::string &text, const bool together = false)
        : std::runtime_error(text), together_(together)
    {
    }

    bool is_on_all_ranks() const { return together_; }

  private:
    bool together_;
  };

  /**
   * The folder that this process writes to, on the first rank of a run: locked
   * against others, with a list of its files in `run.json`. Everything that
   * writes a file says so before, see note(); outside the folder, or where
   * there is none, nothing is charged.
   */
  class OutputFolder
  {
  public:
    enum class Claim {
      anew,    ///< it must be empty, or not be there
      replace, ///< the files that its run.json lists go, all others stay
      go_on    ///< all files stay, the list goes on
    };

    /** Of this process. */
    static OutputFolder &instance();

    /**
     * False with a message on standard error, and nothing changed, if it holds
     * files and may not be replaced, if another process writes to it, or if it
     * is no folder or may not be written to.
     */
    bool claim(const std::string &directory, Claim how);

    /**
     * What run.json says besides the list, the text of a JSON object; it is
     * written now. @throws OutputError
     */
    void describe(const std::string &json);

    /**
     * @p path is about to be written. A link of this name goes, it is not
     * followed. @throws OutputError if a folder has this name, or a part of the
     * path in the folder is a link
     */
    void note(const std::string &path);

    /** The list of exactly what is there. @throws OutputError */
    void finish();

  private:
    OutputFolder() = default;
    bool lock(const std::string &directory);
    bool may_replace(const std::string &directory);
    void write_list();

    std::recursive_mutex mutex_;
    std::string directory_; ///< empty: none
    std::string head_;
    std::set<std::string> files_;
    bool changed_ = false;
    std::chrono::steady_clock::time_point listed_;
    std::chrono::steady_clock::duration cost_{}; ///< of the last list
  };

  /**
   * The process that has locked @p directory, in words for a message; nothing
   * if no one writes to it, or if it cannot be locked.
   */
  std::optional<std::string> writer_of(const std::string &directory);

  /**
   * Make an output directory ours, see OutputFolder::claim: it must be empty
   * unless @p force replaces the run in it.
   */
  bool claim_directory(const std::string &directory, bool force);

  /**
   * Replaces the file at @p path in one go: readers see the old or the new
   * text, never a part of it. Links are replaced, not followed.
   * @throws OutputError with the reason
   */
  void write_file_atomically(const std::string &path, const std::string &text);
  /** The same of @p parts, one after the other: large ones are not copied. */
  void write_file_atomically(const std::string &path,
                             const std::vector<std::string_view> &parts);
} // namespace nsfd
