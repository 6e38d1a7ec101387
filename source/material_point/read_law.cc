#include "read_law.h"

#include "drive_point.h"
#include "input/read_sections.h"
#include "read_bar.h"
#include "read_law_path.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

namespace nsfd
{
  namespace
  {
    const std::vector<std::string> known_kinds = {"Interface", "Path", "Bar",
                                                  "Output", "Constants"};

    void check_section_name(const ParameterSection &section,
                            InputErrors &errors)
    {
      const std::string kind = section.kind();
      const bool is_known = std::find(known_kinds.begin(), known_kinds.end(),
                                      kind) != known_kinds.end();
      if (!is_known)
        errors.error(
            section.location(),
            fmt::format("one point has no section `{}`", section.name()),
            did_you_mean(kind, known_kinds,
                         "known are Interface: ..., Path, Bar, Output and "
                         "Constants; run a whole scene without `law`"));
      else if (kind == "Interface" && section.block_name().empty())
        errors.error(section.location(), "section `Interface` needs a name",
                     "write for example: subsection Interface: first");
      else if (kind != "Interface" && section.name() != kind)
        errors.error(section.location(),
                     fmt::format("section `{}` takes no name", kind),
                     "write: subsection " + kind);
    }

    /** Entries that --set gives without a section are those of the law. */
    std::string with_section(const std::string &assignment,
                             const ParameterFile &file, InputErrors &errors)
    {
      const std::size_t equals = assignment.find('=');
      if (assignment.substr(0, equals).find('/') != std::string::npos)
        return assignment;
      std::vector<std::string> blocks;
      for (const ParameterSection *section : file.sections())
        if (section->kind() == "Interface")
          blocks.push_back(section->name());
      if (blocks.size() == 1)
        return blocks.front() + "/" + assignment;
      errors.error({"--set", 0, 0, static_cast<unsigned int>(assignment.size()),
                    assignment},
                   fmt::format("`{}` belongs to no section", assignment),
                   blocks.empty()
                       ? ""
                       : fmt::format("write for example: --set '{}/{}'",
                                     blocks.front(), assignment));
      return "";
    }

    LawCurveInput read_block(SectionReader &reader)
    {
      LawCurveInput curve;
      curve.name = reader.block_name();
      const auto value = reader.raw("law", "", "a cohesive law", "tvergaard");
      const auto &registry = CohesiveLawRegistry::instance();
      curve.law_name = value ? collapse_blanks(value->text()) : "";
      if (!registry.knows(curve.law_name)) {
        reader.accept_everything();
        if (value)
          reader.error(
              "law",
              fmt::format("law = {} is not a cohesive law", curve.law_name),
              advice_on_name(curve.law_name, registry.names(),
                             fmt::format("known are: {}",
                                         fmt::join(registry.names(), ", "))));
        return curve;
      }
      const auto law = read_cohesive_law(reader, curve.law_name);
      const double friction = read_friction(reader);
      const double exponent =
          read_friction_exponent(reader, law ? law->friction_exponent() : 1.);
      const bool plateau = read_plateau(reader, law.get(), curve.law_name);
      reader.refuse({"where", "restitution", "broken", "intact faces",
                     "strength scatter", "seed"},
                    "`nsfd law` drives one point, there are no faces");
      if (law)
        curve.interaction = interaction_of(law, friction, exponent);
      curve.interaction.plateau = plateau;
      return curve;
    }

    /** A path, or the bar that pulls the points. */
    void read_way(ParameterFile &file, LawInput &input, InputErrors &errors)
    {
      if (!file.has_section("Bar")) {
        SectionReader path(file.open("Path"), errors);
        return read_law_path(path, input);
      }
      if (const ParameterSection *path = file.find("Path"))
        errors.error(path->location(), "a point has a path or a bar, not both",
                     "remove section `Path`: the bar pulls the point open");
      SectionReader bar(file.open("Bar"), errors);
      read_bar(bar, input);
    }

    std::unique_ptr<LawInput>
    read_parsed(ParameterFile &file, const std::string &output_name,
                const std::vector<std::string> &overrides, InputErrors &errors)
    {
      for (const std::string &assignment : overrides) {
        const std::string whole = with_section(assignment, file, errors);
        if (!whole.empty())
          file.override_entry(whole, known_kinds, errors);
      }
      for (const ParameterSection *section : file.sections())
        check_section_name(*section, errors);

      auto input = std::make_unique<LawInput>();
      input->title = output_name;
      read_constants(file, errors);
      if (!read_plug_ins(file, errors, "nsfd law", file.location().source))
        return nullptr;
      for (ParameterSection *block : file.open_blocks("Interface")) {
        SectionReader reader(*block, errors);
        input->curves.push_back(read_block(reader));
      }
      if (input->curves.empty())
        errors.error(file.location(), "no Interface block names a law",
                     "add for example: subsection Interface: first, with `set "
                     "law = tvergaard`");
      read_way(file, *input, errors);
      SectionReader output(file.open("Output"), errors);
      input->directory =
          output.word("directory", "output/" + output_name,
                      "for the curve, its pictures and this file");
      file.report_stray(errors);
      if (errors.has_errors())
        return nullptr;
      input->echo = file.print();
      return input;
    }

    // ------------------------------------------------------- a law by its name

    using Entries = std::vector<std::string>;

    /** "strength = 3 MPa; toughness = 4 J/m^2" in parts. */
    Entries entries_of(const std::string &example)
    {
      Entries entries;
      std::istringstream parts(example);
      for (std::string part; std::getline(parts, part, ';');)
        entries.push_back(collapse_blanks(part));
      return entries;
    }

    /**
     * The example of the law, and what may be left of it next to entries that
     * the user gives: entries may be tied to each other.
     */
    std::vector<Entries> candidates(const std::string &law,
                                    const bool has_overrides)
    {
      const auto &examples =
          CohesiveLawRegistry::instance().entries().at(law).examples;
      const Entries all =
          examples.empty() ? Entries() : entries_of(examples.front());
      std::vector<Entries> result = {all};
      if (!has_overrides)
        return result;
      for (std::size_t i = all.size(); i-- > 0;) {
        Entries fewer = all;
        fewer.erase(fewer.begin() + i);
        result.push_back(fewer);
      }
      if (all.size() > 1)
        result.push_back({});
      return result;
    }

    std::string text_of(const std::string &law, const Entries &entries)
    {
      std::string text = fmt::format("# law_{0} - {0}, driven along a path.\n"
                                     "subsection Interface: {0}\n"
                                     "  set law = {0}\n",
                                     law);
      for (const std::string &entry : entries)
        text += "  set " + entry + "\n";
      return text + "end\n";
    }

    /** "strength = 3 MPa; ..." as they were used, without defaults. */
    std::string used_entries(const Entries &entries,
                             const std::vector<std::string> &overrides)
    {
      const auto name_of = [](const std::string &entry) {
        return collapse_blanks(entry.substr(0, entry.find('=')));
      };
      std::vector<std::string> used;
      for (const std::string &entry : entries)
        if (std::none_of(overrides.begin(), overrides.end(),
                         [&](const std::string &other) {
                           return name_of(other) == name_of(entry);
                         }))
          used.push_back(entry + " (example)");
      for (const std::string &entry : overrides)
        if (name_of(entry).find('/') == std::string::npos)
          used.push_back(name_of(entry) + " = " +
                         collapse_blanks(entry.substr(entry.find('=') + 1)));
      return fmt::format("{}", fmt::join(used, "; "));
    }

    std::unique_ptr<LawInput>
    read_name(const std::string &law, const std::vector<std::string> &overrides,
              InputErrors &errors)
    {
      const bool has_overrides = std::any_of(
          overrides.begin(), overrides.end(), [](const std::string &text) {
            return text.substr(0, text.find('=')).find('/') ==
                   std::string::npos;
          });
      // the first one without an error, else the one with the fewest
      std::unique_ptr<LawInput> best;
      InputErrors best_errors;
      for (const Entries &entries : candidates(law, has_overrides)) {
        InputErrors mine;
        ParameterFile file;
        file.read_text(text_of(law, entries), "example of " + law, mine);
        auto input = read_parsed(file, "law_" + law, overrides, mine);
        const bool is_first = best_errors.diagnostics().empty();
        if (input || is_first || mine.n_errors() < best_errors.n_errors())
          best_errors = mine;
        if (!input)
          continue;
        input->entries = used_entries(entries, overrides);
        best = std::move(input);
        break;
      }
      for (const Diagnostic &d : best_errors.diagnostics())
        errors.add(d);
      return best;
    }
  } // namespace

  std::unique_ptr<LawInput> read_law(const std::string &what,
                                     const std::vector<std::string> &overrides,
                                     InputErrors &errors)
  {
    const auto &registry = CohesiveLawRegistry::instance();
    if (registry.knows(what))
      return read_name(what, overrides, errors);
    const std::filesystem::path path(what);
    std::error_code ignored;
    if (path.extension() != ".prm" && !std::filesystem::exists(path, ignored)) {
      errors.error(
          {what, 0, 0, 0, ""}, "is neither a cohesive law nor a parameter file",
          advice_on_name(
              what, registry.names(),
              fmt::format("laws are: {}", fmt::join(registry.names(), ", "))));
      return nullptr;
    }
    ParameterFile file;
    if (!file.read_file(what, errors))
      return nullptr;
    return read_parsed(file, path.stem().string(), overrides, errors);
  }

  std::vector<std::unique_ptr<LawInput>>
  read_examples(const std::string &what,
                const std::vector<std::string> &overrides, InputErrors &errors)
  {
    const auto &registry = CohesiveLawRegistry::instance();
    std::vector<std::unique_ptr<LawInput>> inputs;
    if (!registry.knows(what) || !overrides.empty())
      inputs.push_back(read_law(what, overrides, errors));
    else
      for (const std::string &example : registry.entries().at(what).examples) {
        ParameterFile file;
        file.read_text(text_of(what, entries_of(example)), "example of " + what,
                       errors);
        inputs.push_back(read_parsed(file, "law_" + what, {}, errors));
        if (inputs.back())
          inputs.back()->entries = example;
      }
    return inputs;
  }

  std::unique_ptr<LawInput>
  read_law_text(const std::string &text, const std::string &name,
                const std::vector<std::string> &overrides, InputErrors &errors)
  {
    ParameterFile file;
    file.read_text(text, name, errors);
    return read_parsed(file, std::filesystem::path(name).stem().string(),
                       overrides, errors);
  }
} // namespace nsfd
