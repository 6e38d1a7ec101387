#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace nsfd
{
  /** A word of parameter files that has another name today. */
  struct FormerWord {
    enum class Place {
      entry, ///< name of an entry
      value, ///< the whole value of an entry
      unit   ///< the last word of its value
    };
    Place place;
    std::string section;     ///< its kind: "Time", "Interface"
    std::string entry;       ///< today's name; of Place::entry the same as now
    std::string former, now; ///< the two words
    bool stays = false;      ///< both are in use: no note
  };

  /** All of them. Files that have them go on working. */
  const std::vector<FormerWord> &former_words();

  /**
   * Writes the name and the value of an entry in today's words.
   * @return those that were replaced
   */
  std::vector<const FormerWord *> renew_words(const std::string &section_kind,
                                              std::string &name,
                                              std::string &value);

  /** Where the last word of a value begins, letters only: "0.6 courant". */
  std::size_t begin_of_last_word(const std::string &value);

  /** Today's word for a unit, @p unit itself if it is none of them. */
  std::string current_unit(const std::string &unit);

  /**
   * As did_you_mean(), where a misspelt former word of the same place means the
   * candidate that it is called today.
   */
  std::string did_you_mean_today(const std::string &word,
                                 const std::vector<std::string> &candidates,
                                 FormerWord::Place place,
                                 const std::string &section_kind,
                                 const std::string &entry,
                                 const std::string &otherwise = "");
} // namespace nsfd
