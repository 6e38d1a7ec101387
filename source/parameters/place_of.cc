#include "place_of.h"

#include "parameter_file.h"

namespace nsfd
{
  namespace
  {
    bool begins_with(const std::string &text, const std::size_t at,
                     const std::string &word)
    {
      if (word.empty() || text.compare(at, word.size(), word) != 0)
        return false;
      const std::size_t end = at + word.size();
      return end == text.size() || text[end] == ':' || text[end] == '/' ||
             text[end] == ' ';
    }
  } // namespace

  SourceLocation place_of(const std::string &file, const std::string &message)
  {
    ParameterFile parsed;
    InputErrors known_before;
    const SourceLocation whole{file, 0, 0, 0, ""};
    if (!parsed.read_file(file, known_before))
      return whole;
    // names may begin with names: the longest is meant
    const ParameterSection *section = nullptr;
    for (const ParameterSection *candidate : parsed.sections())
      if (begins_with(message, 0, candidate->name()) &&
          (section == nullptr ||
           section->name().size() < candidate->name().size()))
        section = candidate;
    if (section == nullptr)
      return whole;
    const std::size_t slash = section->name().size();
    const ParameterEntry *entry = nullptr;
    if (slash < message.size() && message[slash] == '/')
      for (const ParameterEntry &candidate : section->entries())
        if (begins_with(message, slash + 1, candidate.name) &&
            (entry == nullptr || entry->name.size() < candidate.name.size()))
          entry = &candidate;
    if (entry == nullptr)
      return section->location();
    return entry->value.empty() ? entry->name_location
                                : entry->value.location();
  }
} // namespace nsfd
