#include "study_input.h"

#include "nsfd/parameters/section_reader.h"
#include "parameters/parameter_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace nsfd
{
  namespace
  {
    constexpr unsigned int any_count = std::numeric_limits<unsigned int>::max();

    bool starts_with(const std::string &text, const std::string &start)
    {
      return text.compare(0, start.size(), start) == 0;
    }

    /** One block `Vary: name`: every entry is a parameter. */
    void read_block(const ParameterSection &block, InputErrors &errors,
                    std::vector<Variation> &variations)
    {
      Variation variation;
      variation.name = block.block_name();
      if (variation.name.empty())
        return errors.error(block.location(), "section `Vary` needs a name",
                            "write for example: subsection Vary: mesh");
      bool good = true;
      for (const ParameterEntry &entry : block.entries()) {
        std::string problem;
        auto values = expand_values(entry.value.text(), problem);
        if (!problem.empty()) {
          errors.error(entry.value.location(), problem);
          good = false;
        } else
          variation.parameters.push_back(
              {entry.name, std::move(values), entry.value.location().source});
      }
      if (!good)
        return;
      const std::string problem = problem_of(variation);
      if (!problem.empty())
        return errors.error(block.location(), problem,
                            "write for example: set Mesh/cells = [8, 1], "
                            "[16, 1]");
      variations.push_back(std::move(variation));
    }

    /** A doubled parameter would be set twice in every case. */
    void check_distinct(const std::vector<Variation> &variations,
                        const SourceLocation &location, InputErrors &errors)
    {
      std::vector<std::string> paths;
      double n = 1.;
      for (const Variation &variation : variations) {
        n *= double(variation.size());
        for (const auto &parameter : variation.parameters)
          paths.push_back(parameter.path);
      }
      std::sort(paths.begin(), paths.end());
      const auto twice = std::adjacent_find(paths.begin(), paths.end());
      if (twice != paths.end())
        errors.error(location, fmt::format("`{}` varies twice", *twice),
                     "name every parameter once");
      for (const std::string &path : paths)
        if (path == "Output/directory" ||
            (starts_with(path, "Study/") && path != "Study/ranks"))
          errors.error(location, fmt::format("`{}` cannot vary", path),
                       "each case has a folder of its own");
      if (n > 10000.)
        errors.error(location, fmt::format("there are {:.0f} combinations", n),
                     "at most 10000 are possible");
    }

    std::vector<std::string> words(const std::string &text)
    {
      std::vector<std::string> result;
      std::size_t begin = 0;
      while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string word =
            collapse_blanks(text.substr(begin, end - begin));
        if (!word.empty())
          result.push_back(word);
        begin = end + 1;
      }
      return result;
    }

    /** Number of the variation that has this name or parameter; -1 if none. */
    int find_variation(const std::vector<Variation> &variations,
                       const std::string &name)
    {
      for (std::size_t v = 0; v < variations.size(); ++v) {
        if (variations[v].name == name)
          return int(v);
        for (const auto &parameter : variations[v].parameters)
          if (parameter.path == name || short_name(parameter.path) == name)
            return int(v);
      }
      return -1;
    }

    /** A variation that an entry names; -1 for @p none. */
    int read_variation(SectionReader &reader, const std::string &entry,
                       const std::string &none,
                       const std::vector<Variation> &variations,
                       const std::string &text)
    {
      const std::string name = reader.word(entry, none, text);
      if (name == none || name == "none")
        return -1;
      const int v = find_variation(variations, name);
      std::vector<std::string> names;
      for (const Variation &variation : variations)
        names.push_back(variation.name);
      if (v < 0)
        reader.error(entry, fmt::format("nothing called `{}` varies", name),
                     did_you_mean(name, names));
      return v;
    }

    /** Mesh, else step, else the last one that takes several values. */
    int natural_abscissa(const std::vector<Variation> &variations)
    {
      for (const char *path : {"Mesh/cells", "Mesh/refinements", "Time/step"}) {
        const int v = find_variation(variations, path);
        if (v >= 0 && !variations[std::size_t(v)].is_constant())
          return v;
      }
      return -1;
    }

    int natural_comparison(const std::vector<Variation> &variations)
    {
      const int v = find_variation(variations, "Discretization/degree");
      return v >= 0 && !variations[std::size_t(v)].is_constant() ? v : -1;
    }

    /** "displacement_L2: degree + 1, energy: 1" */
    void read_expected(SectionReader &reader, StudyInput &study)
    {
      const std::string entry = "expected orders";
      const std::string text =
          reader.word(entry, "none",
                      "ERROR: formula, ...; formulas may name degree, cells, "
                      "what varies");
      if (text == "none")
        return;
      for (const std::string &part : words(text)) {
        const std::size_t colon = part.find(':');
        if (colon == std::string::npos) {
          reader.error(entry, fmt::format("`{}` has no `:`", part),
                       "write for example: displacement_L2: degree + 1");
          continue;
        }
        study.expected_orders[collapse_blanks(part.substr(0, colon))] =
            collapse_blanks(part.substr(colon + 1));
      }
    }

    void read_targets(SectionReader &reader, StudyInput &study)
    {
      study.targets = reader.number_list(
          "target errors", units::none, Range::positive(),
          "at which costs are compared; default 0.1, 0.01, 0.001");
      if (study.targets.empty())
        study.targets = {0.1, 0.01, 0.001};
    }

    /** "xi: modulus_ratio, bound_79; time: energy" */
    void read_diagrams(SectionReader &reader, StudyInput &study)
    {
      const std::string entry = "diagrams";
      const std::string text = reader.word(
          entry, "none", "quantities over one of them: X: Y, Z; ...");
      if (text == "none")
        return;
      std::size_t begin = 0;
      while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(';', begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        begin = end + 1;
        const std::size_t colon = part.find(':');
        if (colon == std::string::npos) {
          reader.error(entry, fmt::format("`{}` has no `:`", part),
                       "write for example: xi: modulus_ratio, bound_79");
          continue;
        }
        study.diagrams.push_back({collapse_blanks(part.substr(0, colon)),
                                  words(part.substr(colon + 1))});
      }
    }

    void read_observed(SectionReader &reader, StudyInput &study)
    {
      const std::string text = reader.word(
          "observe", "none",
          "beside errors: numbers of summary.json, columns as in max work");
      if (text == "none")
        return;
      std::string problem;
      study.observed = parse_observed(text, problem);
      if (!problem.empty())
        reader.error("observe", problem,
                     "write for example: fragments, max reaction_top_y, final "
                     "tip/length");
    }

    void read_section(ParameterSection &section, InputErrors &errors,
                      StudyInput &study)
    {
      SectionReader reader(section, errors);
      read_observed(reader, study);
      study.repeats = reader.integer(
          "repeats", study.observed.empty() ? "5" : "1", 1, any_count,
          "of each case; short ones are repeated more often");
      study.ranks = reader.integer("ranks", "1", 1, any_count,
                                   "of each case; may vary as Study/ranks");
      study.jobs = reader.integer(
          "jobs", study.observed.empty() ? "1" : "0", 0, 256,
          "cases at a time, 0: one per core, the default if quantities are "
          "observed; run times are reliable with 1 only");
      study.outputs =
          reader.boolean("outputs", false, "fields and reports of every case");
      study.limit_checks = reader.boolean(
          "limit checks", study.observed.empty(),
          "the best cases again, with tolerance/100 and with half the step");
      const std::string errors_text = reader.word(
          "errors", "all", "which ones to show; costs are those of the first");
      if (errors_text != "all")
        study.errors = words(errors_text);
      study.abscissa =
          read_variation(reader, "abscissa", "auto", study.variations,
                         "what varies where orders are taken; auto: mesh or "
                         "step; or none");
      if (reader.word("abscissa", "auto", "") == "auto")
        study.abscissa = natural_abscissa(study.variations);
      study.average =
          read_variation(reader, "average over", "none", study.variations,
                         "what varies only to average errors over it");
      study.compare =
          read_variation(reader, "compare", "auto", study.variations,
                         "what varies where costs are compared; auto: the "
                         "degree; or none: every series");
      if (reader.word("compare", "auto", "") == "auto")
        study.compare = natural_comparison(study.variations);
      study.size =
          reader.word("size", "auto",
                      "formula: errors are a power of it; auto: 1/cells, "
                      "2^-refinements, the step");
      read_expected(reader, study);
      study.order_tolerance = reader.number(
          "order tolerance", "0.15", units::none, Range::non_negative(),
          "by which an order may miss the expected one");
      read_targets(reader, study);
      read_diagrams(reader, study);
    }

    /** Where the results go, before any scene is read. */
    std::string directory_of(ParameterFile &parsed, const std::string &file,
                             const std::vector<std::string> &set)
    {
      std::string directory = "auto";
      if (const ParameterSection *output = parsed.find("Output"))
        if (const ParameterEntry *entry = output->find("directory"))
          directory = entry->value.text();
      for (const std::string &assignment : set) {
        const std::size_t equals = assignment.find('=');
        if (collapse_blanks(assignment.substr(0, equals)) == "Output/directory")
          directory = collapse_blanks(assignment.substr(equals + 1));
      }
      return directory == "auto"
                 ? "output/" + std::filesystem::path(file).stem().string()
                 : directory;
    }

    /** "# name - sentence", more lines up to an empty one. */
    void read_opening(const ParameterFile &file, StudyInput &study)
    {
      std::string text;
      for (const std::string &line : file.opening_comment()) {
        const std::size_t begin = line.find_first_not_of("# \t");
        if (begin == std::string::npos)
          break;
        text += (text.empty() ? "" : " ") + line.substr(begin);
      }
      const std::size_t dash = text.find(" - ");
      const bool has_title = dash != std::string::npos && dash < 80;
      study.title = has_title ? text.substr(0, dash) : study.file;
      study.description = has_title ? text.substr(dash + 3) : text;
    }
  } // namespace

  bool is_study(const std::string &file, const std::vector<std::string> &set)
  {
    for (const std::string &assignment : set)
      if (starts_with(assignment, "Study/"))
        return true;
    ParameterFile parsed;
    InputErrors ignored;
    if (!parsed.read_file(file, ignored))
      return false;
    for (const ParameterSection *section : parsed.sections())
      if (section->kind() == "Study" || section->kind() == "Vary")
        return true;
    return false;
  }

  std::unique_ptr<StudyInput> read_study(const std::string &file,
                                         const std::vector<std::string> &set,
                                         const std::vector<std::string> &vary,
                                         InputErrors &errors)
  {
    ParameterFile parsed;
    if (!parsed.read_file(file, errors))
      return nullptr;
    auto study = std::make_unique<StudyInput>();
    study->file = file;
    read_opening(parsed, *study);
    for (const std::string &assignment : set)
      if (starts_with(assignment, "Study/"))
        parsed.override_entry(assignment, {"Study"}, errors);

    for (const ParameterSection *block : parsed.sections())
      if (block->kind() == "Vary")
        read_block(*block, errors, study->variations);
    for (const std::string &text : vary) {
      std::string problem;
      const auto variation = parse_variation(text, problem);
      if (!variation)
        errors.error({"--vary", 0, 0, unsigned(text.size()), text}, problem,
                     "write for example: --vary 'Time/theta=0.5, 1'");
      else
        study->variations.push_back(*variation);
    }
    if (study->variations.empty() && !errors.has_errors())
      errors.error(parsed.location(), "nothing varies in this study",
                   "add --vary 'Section/name=a, b', or a section `Vary: name` "
                   "with lines `set Section/name = a, b`");
    check_distinct(study->variations, parsed.location(), errors);
    ParameterSection &section = parsed.open("Study");
    read_section(section, errors, *study);
    section.report_stray(errors);
    study->directory = directory_of(parsed, file, set);
    if (errors.has_errors())
      return nullptr;
    study->echo = section.print();
    for (const Variation &variation : study->variations) {
      study->echo += fmt::format("\nsubsection Vary: {}\n", variation.name);
      for (const auto &parameter : variation.parameters) {
        std::string values;
        for (const std::string &value : parameter.values)
          values += (values.empty() ? "[" : ", [") + value + "]";
        study->echo += fmt::format("  set {} = {}\n", parameter.path, values);
      }
      study->echo += "end\n";
    }
    return study;
  }
} // namespace nsfd
