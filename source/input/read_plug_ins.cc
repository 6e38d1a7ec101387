#include "read_sections.h"

#include "nsfd/core/plug_in.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace nsfd
{
  namespace
  {
    bool is_loaded(const std::string &name)
    {
      const auto &all = loaded_plug_ins();
      return std::any_of(all.begin(), all.end(), [&name](const PlugIn &one) {
        return one.name == name;
      });
    }

    /** Where a plug-in is likely to have been built, next to @p file. */
    std::string likely_path(const std::string &name, const std::string &file)
    {
      const std::filesystem::path folder =
          std::filesystem::path(file).parent_path();
      std::error_code error;
      for (const auto &path :
           {folder / (name + ".so"), folder / "build" / (name + ".so")})
        if (std::filesystem::exists(path, error))
          return path.string();
      return "PATH/" + name + ".so";
    }
  } // namespace

  bool read_plug_ins(ParameterFile &file, InputErrors &errors,
                     const std::string &command, const std::string &name)
  {
    SectionReader reader(file.top(), errors);
    const std::string entry = "plug-ins",
                      text = "plug-ins that this file needs; they are loaded "
                             "by --plug-in FILE or from NSFD_PLUG_INS";
    if (!reader.optional(entry, text))
      return true;
    const auto value = reader.raw(entry, "", text, "my_law");
    const unsigned int n_before = errors.n_errors();
    for (const SourceText &word :
         value ? value->split(',') : std::vector<SourceText>()) {
      const std::string needed = collapse_blanks(word.text());
      if (is_loaded(needed))
        plug_ins::note_use(needed);
      else
        errors.error(
            word.location(),
            fmt::format("the plug-in `{}` is not loaded", needed),
            fmt::format("a file loads none itself; type: {} {} --plug-in {}",
                        command, name, likely_path(needed, name)));
    }
    return errors.n_errors() == n_before;
  }

  std::string advice_on_name(const std::string &word,
                             const std::vector<std::string> &known,
                             const std::string &otherwise)
  {
    const std::string nearest = did_you_mean(word, known);
    return nearest.empty()
               ? otherwise + "; a name of a plug-in needs --plug-in FILE"
               : nearest + " A name of a plug-in needs --plug-in FILE";
  }

  std::string read_registered_name(SectionReader &reader,
                                   const std::string &entry,
                                   const std::string &default_text,
                                   const std::vector<std::string> &known)
  {
    const std::string list = fmt::format("{}", fmt::join(known, ", "));
    const auto value = reader.raw(entry, default_text, list);
    if (!value)
      return default_text;
    const std::string word = collapse_blanks(value->text());
    if (std::find(known.begin(), known.end(), word) != known.end())
      return word;
    reader.error(entry,
                 fmt::format("{} = {} is not one of: {}", entry, word, list),
                 advice_on_name(word, known, "`nsfd --list` prints all names"));
    return default_text;
  }
} // namespace nsfd
