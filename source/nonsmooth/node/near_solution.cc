#include "near_solution.h"

#include "nonsmooth/local_problem.h"

namespace nsfd
{
  using namespace local;

  namespace
  {
    /** With two damage scalars, of which one may stay. */
    template <int dim>
    bool solve_near_mixed(const PointDamage<dim> &damage, const Reach &near,
                          LocalProblem<dim> &here, LocalSolution<dim> &solution)
    {
      const Reach &low = damage.history();
      const auto grows = [&](const Reach &end) {
        return end.opening > (1. + 1e-9) * low.opening ||
               end.slip > (1. + 1e-9) * low.slip;
      };
      Reach end;
      if (!grows(near) ||
          !follow_mixed_damage<dim>(damage, {infinity, infinity}, near, here,
                                    end) ||
          !grows(end))
        return false;
      solution = here.solution;
      if (end.opening > low.opening)
        solution.reach.opening = end.opening;
      if (end.slip > low.slip)
        solution.reach.slip = end.slip;
      solution.damages = solution.coupled = true;
      return true;
    }
  } // namespace

  template <int dim>
  bool solve_near(const OneStepProblem<dim> &problem, const std::size_t i,
                  const std::array<double, dim> &local, const double R,
                  const Reach &end, LocalSolution<dim> &solution)
  {
    const PointKind kind = problem.kind[i];
    if (kind != PointKind::cohesive && kind != PointKind::rigid)
      return false;
    const Interaction &interaction =
        problem.interactions[problem.interaction[i]];
    LocalProblem<dim> here{problem, i, local, R, R};
    // a law that adds openings has no secants
    if (interaction.plateau || here.lifts() || interaction.law->adds_openings())
      return false;
    const double low = problem.opening_max[i];
    double x = end.opening;
    if (kind == PointKind::cohesive && !interaction.law->mixed() &&
        !(x > (1. + 1e-9) * low))
      return false;
    const PointDamage<dim> damage(problem, i);
    if (interaction.law->mixed())
      return solve_near_mixed<dim>(damage, end, here, solution);
    if (damage.drops())
      return false;
    const double wh = problem.weight[i] * problem.time_step;
    if (kind == PointKind::rigid) {
      double pull[dim];
      for (unsigned int c = 0; c < dim; ++c)
        pull[c] = -local[c] / R;
      pull[0] = -pull[0];
      const double size = damage.effective_traction(pull[0], pull + 1),
                   strength = wh * damage.strength();
      if (size <= (1. + 1e-9) * strength)
        return false;
      if (!(x > 0.)) // what the strength leaves of the way
        x = problem.time_step * problem.theta * R * (size - strength);
    }
    // U = (U_loc - ...) / (1 + R kappa s): with this factor the distance from
    // an end to that of its secant is nearly linear in the end, and has a
    // slope also where x is small beside R kappa s x
    const double give = R * wh * tangential_spring<dim>(problem, 1.).slope;
    // Against a nearly rigid law every end is a little short of itself: only
    // with a slope is a small distance one to the root. And after a short way
    // the impulse hangs on the last digits of the end: left to the search.
    double last_x = 0., last = 0., slope = 0.;
    std::array<double, dim> last_P{};
    const auto is_steep = [&] {
      double change = 0., size = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        change += std::abs(here.solution.impulse[c] - last_P[c]);
        size += std::abs(last_P[c]);
      }
      return !(change * x <= 100. * size * std::abs(x - last_x));
    };
    for (unsigned int k = 0; k < 6; ++k) {
      here.solve_end(damage, {x, 0.});
      const double short_by = here.solution.reach.opening - x;
      const double distance =
          short_by * (1. + give * here.solution.frozen.secant.tangential);
      if (k > 0 && std::abs(x - last_x) > 1e-9 * x) {
        slope = (distance - last) / (x - last_x);
        if (is_steep())
          return false;
      }
      if (k > 0 && !(slope < -0.2))
        return false;
      if (k > 0 && std::abs(short_by) <= 2e-15 * x) {
        solution = here.solution;
        solution.reach = {x, 0.};
        solution.damages = solution.coupled = true;
        return true;
      }
      last_x = x;
      last = distance;
      last_P = here.solution.impulse;
      if (k > 0)
        x -= distance / slope;
      else
        x = std::abs(distance) > 1e-7 * x ? x + distance : x * (1. + 1e-7);
      if (!(x > (1. + 1e-9) * low))
        return false;
    }
    return false;
  }

  template bool solve_near<2>(const OneStepProblem<2> &, std::size_t,
                              const std::array<double, 2> &, double,
                              const Reach &, LocalSolution<2> &);
  template bool solve_near<3>(const OneStepProblem<3> &, std::size_t,
                              const std::array<double, 3> &, double,
                              const Reach &, LocalSolution<3> &);
} // namespace nsfd
