#include "run_info.h"

#include "core/version.h"
#include "discretization/cells.h"
#include "discretization/loads.h"
#include "group_report.h"
#include "motion_report.h"
#include "simulation.h"

#include <deal.II/fe/fe.h>

#include <fmt/format.h>

#include <unistd.h>

#include <ctime>
#include <iostream>

namespace nsfd
{
  namespace
  {
    std::string today()
    {
      const std::time_t now = std::time(nullptr);
      char text[32];
      std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ",
                    std::gmtime(&now));
      return text;
    }

    std::string host_name()
    {
      char host[256] = "";
      gethostname(host, sizeof(host) - 1);
      return host;
    }
  } // namespace

  template <int dim>
  RunInfo run_info(const SceneInput &input, const RunOptions &options,
                   const Model<dim> &model, const unsigned int n_ranks)
  {
    RunInfo info;
    const Version program = version();
    info.version = program.number;
    info.git_hash = program.git_hash;
    info.build_type = program.build_type;
    info.interface = program.interface;
    info.plug_ins = loaded_plug_ins();
    info.command_line = options.command_line;
    info.file = input.file;
    info.date = today();
    info.host = host_name();
    for (const auto &[name, number] : library_versions())
      info.libraries[name] = number;
    info.ranks = n_ranks;

    auto &parts = info.parts;
    parts.emplace_back("mesh", input.mesh.type);
    parts.emplace_back("element",
                       model.discretization->cells().element->get_name());
    for (const auto &material : input.materials)
      parts.emplace_back("material " + material.name, material.model_name);
    for (const auto &[keyword, sentence] : motion_report(input))
      parts.emplace_back(keyword, sentence);
    for (const auto &block : input.interfaces) {
      const bool joined =
          block.law_name == "rigid" || block.law_name == "bonded";
      parts.emplace_back((block.obstacle < 0 ? "interface " : "cohesion on ") +
                             block.name,
                         joined ? "joined" : block.law_name);
      if (block.strength_scatter.is_random() ||
          block.toughness_scatter.is_random())
        info.seeds.push_back(block.seed);
    }
    for (const auto &block : input.interfaces)
      if (block.crack_pressure)
        parts.emplace_back("crack pressure", block.name);
    for (const unsigned int b : model.discretization->driven_boundaries())
      parts.emplace_back("motion", input.boundaries[b].name);
    for (const auto &obstacle : input.obstacles)
      parts.emplace_back("obstacle",
                         input.large_motion
                             ? obstacle.name + ": " +
                                   describe_obstacle(obstacle, input.dimension)
                             : obstacle.name);
    if (model.discretization->loads().any())
      parts.emplace_back("loads", "body forces and tractions");
    if (!input.scheme_choice.empty())
      parts.emplace_back("scheme", input.scheme_choice);
    parts.emplace_back("linear algebra", model.path);
    parts.emplace_back("solver", model.method);
    if (input.statics)
      parts.emplace_back("equilibria", input.statics->steps
                                           ? "quasi-static steps"
                                           : "at the start");
    if (input.verification)
      parts.emplace_back("verification", "exact values");
    for (const PlugIn &one : info.plug_ins)
      if (one.used)
        parts.emplace_back("plug-in", one.file);
    return info;
  }

  template <int dim>
  void count_points(const SceneInput &input,
                    const Discretization<dim> &discretization,
                    const Communicator &communicator,
                    std::map<std::string, double> &c)
  {
    unsigned long long cohesive = 0, frictional = 0;
    for (std::size_t i = 0; i < discretization.points().n_owned; ++i) {
      const auto &origin = discretization.origins()[i];
      if (origin.kind == PointOrigin::Kind::interface) {
        const auto &block = input.interfaces[origin.block];
        cohesive += bool(block.law);
        frictional += block.friction > 0.;
      } else if (origin.kind == PointOrigin::Kind::obstacle)
        frictional += input.obstacles[origin.block].friction > 0.;
    }
    c["cohesive_points"] = double(communicator.sum_integer(cohesive));
    c["friction_points"] = double(communicator.sum_integer(frictional));
  }

  void print_opening(const SceneInput &input, const RunInfo &info,
                     const Summary &summary, const double step,
                     const double crossing)
  {
    std::cout << fmt::format(
        "nsfd {}  {}  {} cells, {} unknowns, {} interface points, step {:.4g}",
        info.version, input.file, summary.cells, summary.dofs,
        summary.interface_points, step);
    if (crossing > 0.)
      std::cout << fmt::format(" (Courant number {:.3g})", step / crossing);
    std::cout << "\n";
    for (const auto &[kind, name] : info.parts)
      std::cout << fmt::format("  {:<24} {}\n", kind, name);
    for (const auto &[keyword, sentence] : short_group_report(input))
      std::cout << fmt::format("  {:<24} {}\n", keyword, sentence);
    std::cout << std::flush; // a reader may wait for it
  }

  template RunInfo run_info(const SceneInput &, const RunOptions &,
                            const Model<2> &, unsigned int);
  template RunInfo run_info(const SceneInput &, const RunOptions &,
                            const Model<3> &, unsigned int);
  template void count_points(const SceneInput &, const Discretization<2> &,
                             const Communicator &,
                             std::map<std::string, double> &);
  template void count_points(const SceneInput &, const Discretization<3> &,
                             const Communicator &,
                             std::map<std::string, double> &);
} // namespace nsfd
