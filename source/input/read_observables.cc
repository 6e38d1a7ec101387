#include "read_sections.h"

#include "nsfd/postprocess/observable.h"

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /** Letters, digits, and what stands between words. */
    bool names_a_file(const std::string &name)
    {
      return std::all_of(name.begin(), name.end(), [](const char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == ' ' ||
               c == '_' || c == '-';
      });
    }

    std::string lower_case(std::string text)
    {
      for (char &c : text)
        c = char(std::tolower(static_cast<unsigned char>(c)));
      return text;
    }

    ObservableInput read_observable(SectionReader &reader,
                                    const SceneInput &scene)
    {
      ObservableInput block;
      block.name = reader.block_name();
      const auto &registry = ObservableRegistry::instance();
      block.type =
          read_registered_name(reader, "type", "crack", registry.names());
      block.every = reader.integer("every steps", "1", 1, 1000000000,
                                   "steps from row to row");
      if (registry.knows(block.type))
        block.observable = registry.create(block.type, reader, scene);
      else
        reader.accept_everything();
      return block;
    }
  } // namespace

  void read_observables(ParameterFile &file, InputErrors &errors,
                        SceneInput &scene)
  {
    for (ParameterSection *block : file.open_blocks("Observable")) {
      SectionReader reader(*block, errors);
      scene.observables.push_back(read_observable(reader, scene));
      const std::string &name = scene.observables.back().name;
      if (!names_a_file(name))
        errors.error(block->location(),
                     fmt::format("`{}` cannot be the name of a file: its rows "
                                 "are in observables/NAME.csv",
                                 name),
                     "write letters, digits, blanks, - and _");
      for (std::size_t k = 0; k + 1 < scene.observables.size(); ++k) {
        const std::string &other = scene.observables[k].name;
        if (lower_case(other) == lower_case(name) ||
            lower_case(other) + "_profile" == lower_case(name) ||
            lower_case(other) == lower_case(name) + "_profile")
          errors.error(block->location(),
                       fmt::format("`Observable: {}` and `Observable: {}` "
                                   "write to the same file",
                                   other, name),
                       "give one of them another name");
      }
    }
  }
} // namespace nsfd
