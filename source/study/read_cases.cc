#include "study_input.h"

#include "study_numbers.h"

#include "input/read_scene.h"
#include "nsfd/verification/verification_case.h"
#include "parameters/parameter_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <tuple>

namespace nsfd
{
  namespace
  {
    /** Into @p errors what is not there yet: most cases share their mistakes.
     */
    class DistinctErrors
    {
    public:
      explicit DistinctErrors(InputErrors &errors) : errors_(errors)
      {
        for (const Diagnostic &one : errors.diagnostics())
          seen_.insert(key(one));
      }

      void add(const InputErrors &more)
      {
        for (const Diagnostic &one : more.diagnostics())
          if (seen_.insert(key(one)).second)
            errors_.add(one);
      }

    private:
      using Key =
          std::tuple<std::string, unsigned int, std::string, std::string>;
      static Key key(const Diagnostic &one)
      {
        return {one.location.source, one.location.line, one.location.text,
                one.message};
      }
      InputErrors &errors_;
      std::set<Key> seen_;
    };

    /** "Time/step" of "Time/step = 1 us". */
    std::string path_of(const std::string &assignment)
    {
      return collapse_blanks(assignment.substr(0, assignment.find('=')));
    }

    bool is_for_scenes(const std::string &path)
    {
      return path.compare(0, 6, "Study/") != 0 && path != "Output/directory";
    }

    /** That gives the values of @p path; empty: the command line. */
    std::string file_of(const StudyInput &study, const std::string &path)
    {
      for (const Variation &variation : study.variations)
        for (const auto &parameter : variation.parameters)
          if (parameter.path == path)
            return parameter.file;
      return "";
    }

    /** Assignments for the scene of a case; @p more replace others. */
    std::vector<Assignment> assignments(const StudyInput &study,
                                        const Combination &combination,
                                        const std::string &name,
                                        const std::vector<std::string> &set,
                                        const std::vector<std::string> &more)
    {
      std::vector<Assignment> all;
      for (const std::string &assignment : set)
        if (is_for_scenes(path_of(assignment)))
          all.push_back({assignment});
      for (const auto &[path, value] : combination.parameters)
        if (is_for_scenes(path))
          all.push_back({path + "=" + value, file_of(study, path)});
      const auto find = [&all](const std::string &path) {
        return std::find_if(all.begin(), all.end(),
                            [&path](const Assignment &assignment) {
                              return path_of(assignment.text) == path;
                            });
      };
      for (const std::string &assignment : more) {
        const auto found = find(path_of(assignment));
        if (found != all.end())
          all.erase(found);
        all.push_back({assignment});
      }
      if (!study.outputs)
        for (const char *output : {"Output/fields", "Output/report"})
          if (find(output) == all.end())
            all.push_back({std::string(output) + "=false"});
      all.push_back({"Output/directory=" + study.directory + "/" + name});
      return all;
    }

    unsigned int ranks_of(const StudyInput &study,
                          const Combination &combination, InputErrors &errors)
    {
      for (const auto &[path, value] : combination.parameters)
        if (path == "Study/ranks") {
          const auto number = number_of_value(value);
          if (number && *number >= 1. && *number <= 1e6 &&
              *number == std::floor(*number))
            return unsigned(*number);
          errors.error(
              {study.file, 0, 0, 0, value},
              fmt::format("Study/ranks: `{}` is no number of ranks", value),
              "write for example: set Study/ranks = 1, 2, 4");
        }
      return study.ranks;
    }

    void fill_numbers(const SceneInput &scene, const Combination &combination,
                      std::map<std::string, double> &numbers)
    {
      numbers["dimension"] = scene.dimension;
      numbers["degree"] = scene.discretization.degree;
      numbers["refinements"] = scene.mesh.refinements;
      numbers["theta"] = scene.time.theta;
      if (!scene.mesh.cells.empty())
        numbers["cells"] = scene.mesh.cells[0];
      if (scene.time.step_kind != StepKind::automatic)
        numbers["step"] = scene.time.step;
      for (const auto &[path, value] : combination.parameters)
        if (const auto number = number_of_value(value))
          numbers.emplace(formula_name(short_name(path)), *number);
    }

    StudyCase read_case(const StudyInput &study, const Combination &combination,
                        const std::string &name,
                        const std::vector<std::string> &set,
                        const std::vector<std::string> &more,
                        InputErrors &errors)
    {
      StudyCase one;
      one.combination = combination;
      one.combination.name = name;
      one.ranks = ranks_of(study, combination, errors);
      const auto scene = read_case_scene(
          study.file, assignments(study, combination, name, set, more), errors);
      if (!scene)
        return one;
      try {
        if (scene->verification)
          scene->verification->initialise(*scene);
      } catch (const std::runtime_error &error) {
        errors.error({study.file, 0, 0, 0, ""},
                     fmt::format("case {}: {}", name, error.what()));
      }
      one.scene = scene->echo;
      one.tolerance = scene->solver.tolerance;
      if (!scene->statics && scene->time.step_kind == StepKind::time)
        one.half_step = fmt::format("{:.17g} s", 0.5 * scene->time.step);
      if (!scene->statics && scene->time.step_kind == StepKind::courant)
        one.half_step = fmt::format("{:.17g} courant", 0.5 * scene->time.step);
      fill_numbers(*scene, combination, one.numbers);
      return one;
    }
  } // namespace

  std::vector<StudyCase> read_cases(const StudyInput &study,
                                    const std::vector<std::string> &set,
                                    InputErrors &errors)
  {
    std::vector<StudyCase> cases;
    DistinctErrors distinct(errors);
    for (const Combination &combination : combine(study.variations)) {
      InputErrors of_case;
      cases.push_back(
          read_case(study, combination, combination.name, set, {}, of_case));
      distinct.add(of_case);
    }
    if (errors.has_errors())
      return cases;
    std::string problem;
    for (const StudyCase &one : cases) {
      for (const auto &[error, formula] : study.expected_orders)
        if (!evaluate(formula, one.numbers, problem))
          errors.error({study.file, 0, 0, 0, ""},
                       "expected orders: " + error + ": " + problem);
      if (study.size != "auto" && !evaluate(study.size, one.numbers, problem))
        errors.error({study.file, 0, 0, 0, ""}, "size: " + problem);
      if (errors.has_errors())
        break;
    }
    return cases;
  }

  StudyCase derived_case(const StudyInput &study, const StudyCase &original,
                         const std::string &name,
                         const std::vector<std::string> &set,
                         const std::vector<std::string> &more,
                         InputErrors &errors)
  {
    return read_case(study, original.combination, name, set, more, errors);
  }
} // namespace nsfd
