#include "run_info.h"

#include "nsfd/base/version.h"
#include "nsfd/simulation.h"

#include <deal.II/fe/fe.h>

#include <unistd.h>

#include <ctime>

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
    info.command_line = options.command_line;
    info.file = input.file;
    info.date = today();
    info.host = host_name();
    for (const auto &[name, number] : library_versions())
      info.libraries[name] = number;
    info.ranks = n_ranks;

    auto &parts = info.parts;
    parts.emplace_back("mesh", input.mesh.type);
    parts.emplace_back("element", model.discretization->element().get_name());
    for (const auto &material : input.materials)
      parts.emplace_back("material " + material.name,
                         material.rigid ? "rigid" : "linear elastic");
    for (const auto &block : input.interfaces) {
      parts.emplace_back("interface " + block.name, block.law_name);
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
      parts.emplace_back("obstacle", obstacle.name);
    if (model.discretization->has_loads())
      parts.emplace_back("loads", "body forces and tractions");
    parts.emplace_back("dynamics", model.path);
    parts.emplace_back("solver", model.method);
    if (input.verification)
      parts.emplace_back("verification", "exact values");
    return info;
  }

  template RunInfo run_info(const SceneInput &, const RunOptions &,
                            const Model<2> &, unsigned int);
  template RunInfo run_info(const SceneInput &, const RunOptions &,
                            const Model<3> &, unsigned int);
} // namespace nsfd
