#include "bisected_mesh.h"
#include "model.h"

#include "discretization/body_frequency.h"
#include "discretization/cells.h"
#include "time_integration/stable_step.h"

#include <deal.II/grid/tria.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

// How long the steps of a model are.

namespace nsfd
{
  namespace
  {
    /** Of joined cells, of this rank. */
    template <int dim>
    double limit_of_cells(const SceneInput &input,
                          const Discretization<dim> &discretization)
    {
      const auto &cells = discretization.cells();
      if (!input.has_viscous_bodies())
        return longest_step(highest_frequency(cells), input.front_viscosity());
      const auto steps = longest_steps(cells, input.front_viscosity());
      return steps.empty() ? std::numeric_limits<double>::infinity()
                           : *std::min_element(steps.begin(), steps.end());
    }
    /**
     * By how much the impact of bodies that fly towards each other, or to an
     * obstacle, compresses them at most: their speed over that of waves, as of
     * one that is stopped by a rigid wall. Collective.
     */
    template <int dim>
    double compression_of_impact(const SceneInput &input,
                                 const Discretization<dim> &discretization,
                                 const Communicator &communicator)
    {
      constexpr double none = std::numeric_limits<double>::infinity();
      if (!input.large_motion ||
          (input.contacts.empty() && input.obstacles.empty()))
        return 0.;
      std::array<double, dim> low, high;
      low.fill(none);
      high.fill(-none);
      const auto look = [&](const unsigned int c, const double v) {
        low[c] = std::min(low[c], v);
        high[c] = std::max(high[c], v);
      };
      const auto &cells = discretization.cells();
      double waves = none;
      for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
        const auto x = cells.centre(b);
        const auto &material = input.materials[cells.body_class(b).material];
        for (unsigned int c = 0; c < dim; ++c)
          look(c, material.initial_velocity[c].at(x, 0.));
        for (const auto &elasticity : cells.class_shape(b).elasticity)
          waves = std::min(waves, elasticity.pressure_wave_speed());
      }
      for (const auto &obstacle : input.obstacles)
        for (unsigned int c = 0; c < dim; ++c) {
          const auto &v = obstacle.velocity[c];
          look(c, v ? v->at(dealii::Point<dim>(), 0.) : 0.);
        }
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        const double range =
            communicator.max(high[c]) - communicator.min(low[c]);
        square += range * range;
      }
      waves = communicator.min(waves);
      return std::isfinite(waves) ? std::sqrt(square) / waves : 0.;
    }
  } // namespace

  template <int dim>
  void Model<dim>::build_control(const SceneInput &input,
                                 const Communicator &communicator,
                                 std::vector<std::string> &problems)
  {
    if (input.time.step_kind != StepKind::time &&
        discretization->crossing_time() == 0.) {
      problems.push_back("Time/step: all bodies are rigid, no wave "
                         "crosses a cell; write the step as a time");
      return;
    }
    if (input.time.scheme.at_nodes)
      explicit_limit = communicator.min(limit_of_cells(input, *discretization));
    if constexpr (dim == 2)
      // on several ranks the whole mesh says it: see SpreadBisection
      if (input.mesh_changes() && input.adaptivity->bisects &&
          communicator.size() == 1)
        explicit_limit = longest_bisected_step(input, *this);
    compression = compression_of_impact(input, *discretization, communicator);
    const bool quasi_static = input.statics && input.statics->steps;
    // more are a slip of the pen, and are counted in 32 bits
    constexpr double most_steps = 1e9;
    const auto demand_fewer = [&](const char *entry, const double duration,
                                  const double step) {
      if (duration / step <= most_steps)
        return true;
      problems.push_back(fmt::format(
          "Time/{}: {:.4g} s in steps of {:.4g} s are {:.2g} steps, more than "
          "{:g}: write a shorter time or longer steps",
          entry, duration, step, duration / step, most_steps));
      return false;
    };
    const double until = input.statics ? input.statics->until : 0.;
    if (quasi_static && !demand_fewer("step", until, input.statics->step))
      return;
    if (input.may_move() &&
        !demand_fewer("end", input.time.end - until, dynamic_step(input)))
      return;
    control =
        quasi_static ? load_control(input, 0.) : dynamic_control(input, 0.);
  }

  template <int dim>
  double Model<dim>::stable_limit(const SceneInput &input,
                                  const Communicator &communicator) const
  {
    return input.time.scheme.at_nodes
               ? explicit_limit
               : communicator.min(stable_step(discretization->bodies()));
  }

  template <int dim>
  void Model<dim>::check_stability(const SceneInput &input,
                                   const Communicator &communicator,
                                   std::vector<std::string> &problems)
  {
    const double limit = stable_limit(input, communicator);
    if (dynamic_step(input) > limit)
      problems.push_back(fmt::format(
          "Time/step is {:.4g} s, and the explicit scheme is stable up to "
          "{:.4g} s: write at most `{:.3f} courant`",
          dynamic_step(input), limit,
          0.999 * limit / discretization->crossing_time()));
  }

  template <int dim>
  double Model<dim>::dynamic_step(const SceneInput &input) const
  {
    // of the longest that is stable; cells that become lower by some share
    // bound it by about as much, and to change the length later costs energy
    // (beyond a tenth of the speed of waves by more than that: what forces that
    // are not linear make of the energies grows with both)
    const double strong = std::max(0., compression - 0.1);
    const double share = 0.9 * std::max(0.35, 1. - compression - 3. * strong);
    const bool is_automatic = input.time.step_kind == StepKind::automatic;
    if (input.time.scheme.at_nodes && is_automatic)
      return share * explicit_limit;
    const double step =
        input.time.step * (input.time.step_kind == StepKind::time
                               ? 1.
                               : discretization->crossing_time());
    return is_automatic && explicit_limit > 0. && step > explicit_limit
               ? share * explicit_limit
               : step;
  }

  template <int dim>
  void Model<dim>::keep_longest_step()
  {
    double step = control->base_step();
    while (step > explicit_limit)
      step /= 2.;
    delassus->set_terms({delassus->terms().viscous_theta, step});
  }

  template <int dim>
  std::unique_ptr<StepControl>
  Model<dim>::dynamic_control(const SceneInput &input, const double start) const
  {
    return std::make_unique<StepControl>(input.time.end, dynamic_step(input),
                                         input.time.maximum_bisections, start);
  }

  template <int dim>
  std::unique_ptr<StepControl>
  Model<dim>::load_control(const SceneInput &input, const double start) const
  {
    return std::make_unique<StepControl>(input.statics->until,
                                         input.statics->step,
                                         input.time.maximum_bisections, start);
  }

  template void Model<2>::build_control(const SceneInput &,
                                        const Communicator &,
                                        std::vector<std::string> &);
  template void Model<3>::build_control(const SceneInput &,
                                        const Communicator &,
                                        std::vector<std::string> &);
  template double Model<2>::stable_limit(const SceneInput &,
                                         const Communicator &) const;
  template double Model<3>::stable_limit(const SceneInput &,
                                         const Communicator &) const;
  template void Model<2>::check_stability(const SceneInput &,
                                          const Communicator &,
                                          std::vector<std::string> &);
  template void Model<3>::check_stability(const SceneInput &,
                                          const Communicator &,
                                          std::vector<std::string> &);
  template double Model<2>::dynamic_step(const SceneInput &) const;
  template double Model<3>::dynamic_step(const SceneInput &) const;
  template void Model<2>::keep_longest_step();
  template void Model<3>::keep_longest_step();
  template std::unique_ptr<StepControl>
  Model<2>::dynamic_control(const SceneInput &, double) const;
  template std::unique_ptr<StepControl>
  Model<3>::dynamic_control(const SceneInput &, double) const;
  template std::unique_ptr<StepControl>
  Model<2>::load_control(const SceneInput &, double) const;
  template std::unique_ptr<StepControl>
  Model<3>::load_control(const SceneInput &, double) const;
} // namespace nsfd
