#include "former_words.h"

#include "input_errors.h"

#include <algorithm>
#include <cctype>

namespace nsfd
{
  namespace
  {
    using Place = FormerWord::Place;

    const FormerWord *find_word(const Place place, const std::string &section,
                                const std::string &entry,
                                const std::string &former)
    {
      for (const FormerWord &word : former_words())
        if (word.place == place && word.section == section &&
            (place == Place::entry || word.entry == entry) &&
            word.former == former)
          return &word;
      return nullptr;
    }
  } // namespace

  std::size_t begin_of_last_word(const std::string &value)
  {
    std::size_t begin = value.size();
    while (begin > 0 &&
           std::isalpha(static_cast<unsigned char>(value[begin - 1])))
      --begin;
    return begin;
  }

  const std::vector<FormerWord> &former_words()
  {
    static const std::vector<FormerWord> words = {
        {Place::entry, "Time", "maximum bisections", "maximum halvings",
         "maximum bisections"},
        {Place::value, "Time", "scheme", "leapfrog", "explicit"},
        {Place::unit, "Time", "step", "crossings", "courant", true},
        {Place::unit, "Time", "step", "crossing", "courant", true},
        {Place::unit, "Time", "dynamic step", "crossings", "courant", true},
        {Place::unit, "Time", "dynamic step", "crossing", "courant", true},
        {Place::value, "Solver", "method", "chain", "cascade"},
        {Place::value, "Solver", "method", "contacts alone",
         "frictional contact"},
        {Place::value, "Solver", "path", "element-wise", "local"},
        {Place::value, "Solver", "path", "global", "assembled"},
    };
    return words;
  }

  std::vector<const FormerWord *> renew_words(const std::string &section_kind,
                                              std::string &name,
                                              std::string &value)
  {
    std::vector<const FormerWord *> replaced;
    if (const FormerWord *word =
            find_word(Place::entry, section_kind, "", name)) {
      replaced.push_back(word);
      name = word->now;
    }
    if (const FormerWord *word =
            find_word(Place::value, section_kind, name, value)) {
      replaced.push_back(word);
      value = word->now;
    }
    const std::size_t unit = begin_of_last_word(value);
    if (const FormerWord *word =
            find_word(Place::unit, section_kind, name, value.substr(unit))) {
      replaced.push_back(word);
      value = value.substr(0, unit) + word->now;
    }
    return replaced;
  }

  std::string current_unit(const std::string &unit)
  {
    for (const FormerWord &word : former_words())
      if (word.place == Place::unit && word.former == unit)
        return word.now;
    return unit;
  }

  std::string did_you_mean_today(const std::string &word,
                                 const std::vector<std::string> &candidates,
                                 const Place place,
                                 const std::string &section_kind,
                                 const std::string &entry,
                                 const std::string &otherwise)
  {
    std::vector<std::string> all = candidates;
    for (const FormerWord &known : former_words())
      if (known.place == place && known.section == section_kind &&
          (place == Place::entry || known.entry == entry) &&
          std::find(candidates.begin(), candidates.end(), known.now) !=
              candidates.end())
        all.push_back(known.former);
    std::string meant = nearest_name(word, all);
    if (const FormerWord *known = find_word(place, section_kind, entry, meant))
      meant = known->now;
    return meant.empty() ? otherwise : "did you mean `" + meant + "`?";
  }
} // namespace nsfd
