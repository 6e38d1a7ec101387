#include "path_report.h"

#include "records/engineering.h"

#include <fmt/format.h>

#include <iostream>

namespace nsfd
{
  namespace
  {
    std::string scheme_text(const SceneInput &input)
    {
      const TimeInput &time = input.time;
      if (!input.scheme_choice.empty())
        return input.scheme_choice;
      const bool loads = input.statics && input.statics->steps;
      const std::string kind =
          loads                  ? "equilibria from one load to the next"
          : time.scheme.at_nodes ? "explicit steps of joined cells, no system "
                                   "is solved"
          : time.scheme.explicit_forces
              ? "the forces of the bodies are explicit, contacts are solved"
          : time.scheme.smooth ? "smooth motion, the error of a step is bounded"
                               : "implicit steps";
      return fmt::format("{}, of section Time: {}{}", time.scheme_name, kind,
                         loads           ? ""
                         : input.statics ? ", after an equilibrium"
                                         : "");
    }

    /** In the order in which Model decides. */
    template <int dim>
    std::string path_text(const SceneInput &input, const Model<dim> &model)
    {
      const double crossing = model.discretization->crossing_time();
      const auto why = [&]() -> std::string {
        if (input.iterates())
          return input.large_motion
                     ? "blocks of single bodies, which turn"
                     : "blocks of single bodies, whose materials keep a "
                       "history";
        if (input.time.scheme.at_nodes)
          return "single nodes with their points, each by itself";
        if (input.has_bonded_faces())
          return "one system of all bodies, because faces are joined";
        if (input.solver.path != "auto")
          return "as section Solver says";
        if (!(crossing > 0.))
          return "blocks of single bodies, all of them rigid";
        const double ratio = model.dynamic_step(input) / crossing;
        return model.path == "local"
                   ? fmt::format("blocks of single bodies, because a step is "
                                 "{:.3g} times the time that waves take across "
                                 "a cell, at most 5",
                                 ratio)
                   : fmt::format("one system of all bodies, because a step is "
                                 "{:.3g} times the time that waves take across "
                                 "a cell, more than 5",
                                 ratio);
      };
      return fmt::format("{}, {}", model.path, why());
    }

    /** Explicit steps that are shorter than they need be. */
    template <int dim>
    std::string longer_steps(const SceneInput &input, const Model<dim> &model)
    {
      const double step = model.dynamic_step(input);
      if (!input.time.scheme.at_nodes || !(model.explicit_limit > 2. * step))
        return "";
      return fmt::format("`set step = auto`, stable up to {}: {:.2g} times "
                         "fewer steps, and each is as accurate",
                         engineering(model.explicit_limit, "s"),
                         0.9 * model.explicit_limit / step);
    }
  } // namespace

  template <int dim>
  void print_path(const SceneInput &input, const Model<dim> &model,
                  const Communicator &communicator)
  {
    if (!communicator.is_root())
      return;
    const auto line = [](const char *name, const std::string &text) {
      std::cout << fmt::format("  {:<10} {}\n", name, text);
    };
    line("scheme", scheme_text(input));
    const std::string longer = longer_steps(input, model);
    if (!longer.empty())
      line("", "change: " + longer);
    line("path", path_text(input, model));
    line("solver", model.method);
  }

  template void print_path<2>(const SceneInput &, const Model<2> &,
                              const Communicator &);
  template void print_path<3>(const SceneInput &, const Model<3> &,
                              const Communicator &);
} // namespace nsfd
