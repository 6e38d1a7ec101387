#include "read_sections.h"

#include "nonsmooth/solver.h"
#include "nsfd/verification/verification_case.h"

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    constexpr unsigned int any_count = std::numeric_limits<unsigned int>::max();

    void read_case(ParameterFile &file, InputErrors &errors, SceneInput &scene)
    {
      if (!file.has_section("Verification"))
        return;
      SectionReader reader(file.open("Verification"), errors);
      const auto value =
          reader.raw("case", "", "what the run is compared with");
      const auto &registry = VerificationRegistry::instance();
      const std::string name = value ? collapse_blanks(value->text()) : "";
      if (!registry.knows(name)) {
        reader.accept_everything();
        if (value)
          reader.error(
              "case", fmt::format("case = {} is not a verification case", name),
              advice_on_name(name, registry.names(),
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
  } // namespace

  std::vector<NamedText> known_solvers()
  {
    std::vector<NamedText> solvers = {
        {"auto", "dual newton, then the others where it fails"}};
    for (const auto &[name, entry] : SolverRegistry<2>::instance().entries())
      if (name != "auto") // of stored problems
        solvers.push_back({name, entry.text});
    return solvers;
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
        reader.choice("path", "auto", {"auto", "local", "assembled"},
                      "of the linear algebra: auto, local (blocks of single "
                      "bodies) or assembled (one sparse matrix)");
    if (solver.path == "local" && scene.has_bonded_faces())
      reader.error("path",
                   "path = local contradicts bonded faces, which couple "
                   "the bodies",
                   "write auto, or take rigid faces");
    if (solver.path == "assembled" && scene.large_motion)
      reader.error(
          "path",
          "path = assembled has one matrix for all steps, and bodies of "
          "motion = large turn",
          "write auto or local");
    else if (solver.path == "assembled" && scene.has_history())
      reader.error("path",
                   fmt::format("path = assembled has one matrix for all steps, "
                               "and bodies of {} get softer",
                               history_dependent_model(scene)),
                   "write auto or local");
    if (solver.method == "gauss seidel" && scene.has_bonded_faces())
      reader.error("method",
                   "method = gauss seidel works body by body, and bonded faces "
                   "couple the bodies",
                   "write auto, or take rigid faces");
    solver.linear_solver =
        reader.choice("linear solver", "auto", {"auto", "direct", "cg"},
                      "of the assembled path: auto, direct or cg");
    solver.tolerance =
        reader.number("tolerance", "1e-8", units::none, {0., 0.1, true, false},
                      "relative error of a step");
    solver.maximum_iterations =
        reader.integer("maximum iterations", "200", 1, any_count, "per step");
    scene.solver.save_problems = reader.choice(
        "save problems", "none", {"none", "hard", "all"},
        "for `nsfd solve`: none, hard (rejected or handed over), all");
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
    const std::string format =
        reader.choice("format", "vtu", {"vtu", "hdf5", "vtkhdf"},
                      "of the fields: vtu, hdf5 (with XDMF), or vtkhdf (a file "
                      "for all times)");
    output.format = format == "vtkhdf" ? FieldFormat::vtkhdf
                    : format == "hdf5" ? FieldFormat::hdf5
                                       : FieldFormat::vtu;
    output.fields_every =
        reader.number("fields every", "0", units::time, Range::non_negative(),
                      "s; 0: at the start and the end");
    output.fields_every_steps =
        reader.integer("fields every steps", "0", 0, any_count, "0: not used");
    output.report = reader.boolean("report", true, "write report.html");
    output.checkpoint_steps = reader.integer(
        "checkpoint every steps", "0", 0, any_count,
        "for --resume; 0: not by steps, only when the run is stopped");
    output.checkpoint_seconds =
        reader.number("checkpoint every", "0", units::time,
                      Range::non_negative(), "s of wall time; 0: not used");
  }

  void read_verification(ParameterFile &file, InputErrors &errors,
                         SceneInput &scene)
  {
    read_case(file, errors, scene);
    for (const BoundaryInput &boundary : scene.boundaries)
      if (boundary.exact_motion &&
          (!scene.verification || !scene.verification->has_motion()))
        errors.error(file.location(),
                     fmt::format("`Boundary: {}`: motion = exact needs a "
                                 "verification case that moves boundaries",
                                 boundary.name),
                     "write for example, in section Verification: set case = "
                     "manufactured");
    if (!scene.verification || errors.has_errors())
      return;
    try {
      scene.verification->provide(scene);
    } catch (const std::exception &exception) {
      errors.error(file.location(), exception.what());
    }
  }
} // namespace nsfd
