#include "read_sections.h"

#include "nsfd/nonsmooth/solver.h"
#include "nsfd/scene/verification_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    constexpr unsigned int any_count = std::numeric_limits<unsigned int>::max();

    /** Splits "0.6 crossings" into "0.6" and "crossings". */
    std::pair<SourceText, std::string> split_last_word(const SourceText &value)
    {
      const std::string &text = value.text();
      std::size_t begin = text.size();
      while (begin > 0 &&
             std::isalpha(static_cast<unsigned char>(text[begin - 1])))
        --begin;
      return {value.part(0, begin), text.substr(begin)};
    }

    void read_step(SectionReader &reader, TimeInput &time)
    {
      const auto value =
          reader.raw("step", "0.5 crossings",
                     "a time, crossings of a cell L/c_p, or auto");
      if (!value || value->text() == "auto") {
        time.step_kind = StepKind::automatic;
        return;
      }
      const auto [number, word] = split_last_word(*value);
      const bool is_misspelt =
          !find_unit(word) && nearest_name(word, {"crossings"}) == "crossings";
      if (word == "crossings" || word == "crossing") {
        time.step_kind = StepKind::crossings;
        time.step = reader.number_in(number, "step", "0.5 crossings",
                                     units::none, Range::positive());
      } else if (is_misspelt)
        reader.error(
            "step",
            fmt::format("step = {}: `{}` is not a unit", value->text(), word),
            "did you mean `crossings`?");
      else if (nearest_name(value->text(), {"auto"}) == "auto")
        reader.error("step",
                     fmt::format("step = {} is not a step", value->text()),
                     "did you mean `auto`?");
      else {
        time.step_kind = StepKind::time;
        time.step = reader.number_in(*value, "step", "0.5 crossings",
                                     units::time, Range::positive());
      }
    }

    void check_step(SectionReader &reader, const SceneInput &scene)
    {
      const bool all_rigid =
          !scene.materials.empty() &&
          std::all_of(scene.materials.begin(), scene.materials.end(),
                      [](const MaterialInput &m) { return m.rigid; });
      if (all_rigid && scene.time.step_kind != StepKind::time)
        reader.error("step",
                     "the step must be a time: all materials are rigid, and no "
                     "wave crosses a cell",
                     "write for example: set step = 1 us");
    }

    void read_theta(SectionReader &reader, const SceneInput &scene,
                    TimeInput &time)
    {
      const unsigned int n_before = reader.errors().n_errors();
      time.theta = reader.number("theta", "0.5", units::none, Range::any(),
                                 "1/2 conserves energy, 1 damps");
      if (reader.errors().n_errors() > n_before)
        return;
      if (time.theta < 0.5)
        reader.error("theta",
                     fmt::format("theta = {:g} must be at least 0.5: below it "
                                 "every step grows, as forward Euler does",
                                 time.theta),
                     "write for example: 0.5");
      if (time.theta > 1.)
        reader.error("theta",
                     fmt::format("theta = {:g} must be at most 1", time.theta),
                     "write for example: 0.5");

      double restitution = 0.;
      for (const InterfaceInput &interface : scene.interfaces)
        restitution = std::max(restitution, interface.restitution);
      for (const ObstacleInput &obstacle : scene.obstacles)
        restitution = std::max(restitution, obstacle.restitution);
      const double bound = 1. / (1. + restitution);
      if (time.theta > bound && time.theta <= 1.)
        reader.warning("theta",
                       fmt::format("theta = {:g} is above 1/(1 + e) = {:g} for "
                                   "restitution e = {:g}: impacts can create "
                                   "energy",
                                   time.theta, bound, restitution),
                       fmt::format("write at most {:g}", bound));
    }

    template <typename T>
    T read_named(SectionReader &reader, const std::string &name,
                 const std::vector<std::pair<std::string, T>> &values,
                 const std::string &text)
    {
      std::vector<std::string> names;
      for (const auto &value : values)
        names.push_back(value.first);
      const std::string chosen =
          reader.choice(name, names.front(), names, text);
      for (const auto &value : values)
        if (value.first == chosen)
          return value.second;
      return values.front().second;
    }
  } // namespace

  std::vector<NamedText> known_solvers()
  {
    std::vector<NamedText> solvers = {
        {"auto", "dual newton; what it cannot solve goes to the others"}};
    for (const auto &[name, entry] : SolverRegistry<2>::instance().entries())
      solvers.push_back({name, entry.text});
    return solvers;
  }

  void read_time(ParameterFile &file, InputErrors &errors, SceneInput &scene)
  {
    SectionReader reader(file.open("Time"), errors);
    TimeInput &time = scene.time;
    time.end = reader.number("end", "", units::time, Range::positive(), "s");
    read_step(reader, time);
    check_step(reader, scene);
    reader.choice("scheme", "moreau-jean", {"moreau-jean"}, "moreau-jean");
    read_theta(reader, scene, time);
    time.forecast_gamma1 = reader.number(
        "forecast gamma1", "0.5", units::none, Range::closed(0., 1.),
        "weight of the old velocity in the forecast of the gap");
    time.forecast_gamma2 =
        reader.number("forecast gamma2", "0", units::none,
                      Range::closed(0., 1.), "weight of the new velocity");
    if (time.forecast_gamma2 != 0.)
      reader.error("forecast gamma2",
                   "an implicit forecast of the gap is not there yet",
                   "write: forecast gamma2 = 0");
    time.cohesion_rule =
        read_named<CohesionRule>(reader, "cohesion rule",
                                 {{"exact", CohesionRule::exact},
                                  {"end point", CohesionRule::end_point},
                                  {"end velocity", CohesionRule::end_velocity}},
                                 "exact, end point or end velocity");
    time.contact_target =
        read_named<ContactTarget>(reader, "contact target",
                                  {{"energy safe", ContactTarget::energy_safe},
                                   {"velocity", ContactTarget::velocity},
                                   {"position", ContactTarget::position}},
                                  "energy safe, velocity or position");
    time.sliding = read_named<Sliding>(
        reader, "sliding",
        {{"velocity", Sliding::velocity}, {"increment", Sliding::increment}},
        "what friction opposes: velocity or increment");
    time.maximum_halvings = reader.integer("maximum halvings", "10", 0, 60,
                                           "of a step that cannot be solved");
  }

  void read_solver(ParameterFile &file, InputErrors &errors, SceneInput &scene)
  {
    SectionReader reader(file.open("Solver"), errors);
    SolverInput &solver = scene.solver;
    std::vector<std::string> methods;
    for (const NamedText &known : known_solvers())
      methods.push_back(known.name);
    solver.method = reader.choice("method", "auto", methods,
                                  fmt::format("{}", fmt::join(methods, ", ")));
    solver.path =
        reader.choice("path", "auto", {"auto", "element-wise", "global"},
                      "auto, element-wise or global");
    solver.linear_solver =
        reader.choice("linear solver", "auto", {"auto", "direct", "cg"},
                      "of the global path: auto, direct or cg");
    solver.tolerance =
        reader.number("tolerance", "1e-8", units::none, {0., 0.1, true, false},
                      "relative error of a step");
    solver.maximum_iterations =
        reader.integer("maximum iterations", "200", 1, any_count, "per step");
  }

  void read_output(ParameterFile &file, InputErrors &errors, SceneInput &scene)
  {
    SectionReader reader(file.open("Output"), errors);
    OutputInput &output = scene.output;
    output.directory =
        reader.word("directory", "auto", "auto: output/NAME of NAME.prm");
    if (output.directory == "auto")
      output.directory =
          "output/" + std::filesystem::path(scene.file).stem().string();
    output.fields =
        reader.boolean("fields", true, "write fields.pvd and interfaces.pvd");
    reader.choice("format", "vtu", {"vtu"}, "of the fields: vtu");
    output.fields_every =
        reader.number("fields every", "0", units::time, Range::non_negative(),
                      "s; 0: at the start and the end");
    output.fields_every_steps =
        reader.integer("fields every steps", "0", 0, any_count, "0: not used");
    output.report = reader.boolean("report", true, "write report.html");
    if (reader.integer("checkpoint every steps", "0", 0, any_count,
                       "0: never") != 0)
      reader.error("checkpoint every steps",
                   "checkpoint every steps must be 0: checkpoints are not "
                   "there yet",
                   "write 0");
  }

  void read_verification(ParameterFile &file, InputErrors &errors,
                         SceneInput &scene)
  {
    if (!file.has_section("Verification"))
      return;
    SectionReader reader(file.open("Verification"), errors);
    const auto value = reader.raw("case", "", "what the run is compared with");
    const auto &registry = VerificationRegistry::instance();
    const std::string name = value ? collapse_blanks(value->text()) : "";
    if (!registry.knows(name)) {
      reader.accept_everything();
      if (value)
        reader.error("case",
                     fmt::format("case = {} is not a verification case", name),
                     did_you_mean(name, registry.names(),
                                  "`nsfd --list` prints all names"));
      return;
    }
    const unsigned int n_before = errors.n_errors();
    try {
      scene.verification = registry.create(name, reader);
    } catch (const std::exception &exception) {
      if (errors.n_errors() == n_before)
        reader.error("case",
                     fmt::format("case = {}: {}", name, exception.what()));
    }
  }
} // namespace nsfd
