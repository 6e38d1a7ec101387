#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace nsfd::abaqus
{
  /** Without blanks at its ends. */
  std::string trimmed(const std::string &text);
  std::string upper(std::string text);
  /** Without the quotes that blanks in names need. */
  std::string unquoted(const std::string &text);
  /** What stands between the commas of a line. */
  std::vector<std::string> fields(const std::string &line);

  std::optional<long> integer(const std::string &text);
  /** Exponents may be written with e or d; an empty text is 0. */
  std::optional<double> real(std::string text);

  /** `*ELEMENT, TYPE=CPE4, ELSET=plate`, over several lines if need be. */
  class Keyword
  {
  public:
    /** Take a line that begins or goes on; true if the keyword is whole. */
    bool take(const std::string &line);
    /** The next line belongs to it. */
    bool goes_on() const { return goes_on_; }

    /** With its star, in upper case, one blank between words. */
    const std::string &name() const { return name_; }
    bool is(const char *name) const { return name_ == name; }
    bool has(const std::string &parameter) const
    {
      return parameters_.count(parameter) != 0;
    }
    /** A parameter as it is written; empty if it is not there. */
    std::string get(const std::string &parameter) const;

  private:
    std::string name_;
    std::map<std::string, std::string> parameters_; ///< in upper case
    bool goes_on_ = false;
  };
} // namespace nsfd::abaqus
