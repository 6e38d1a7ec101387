#include "local_problem.h"

#include <array>

namespace nsfd::local
{
  namespace
  {
    /**
     * Where a law jumps, friction sets in at once, and the root of the local
     * problem can be the jump itself: with a secant and a threshold between
     * those of its two sides the step ends at just this opening.
     */
    template <int dim>
    void solve_between(LocalProblem<dim> &local, const FrozenPoint before,
                       const FrozenPoint after, const double opening)
    {
      const auto mix = [](const double share, const double a, const double b) {
        return a + share * (b - a);
      };
      const auto excess = [&](const double share) {
        const Secant &b = before.secant, &a = after.secant;
        local.solve({{mix(share, b.normal, a.normal),
                      mix(share, b.tangential, a.tangential)},
                     mix(share, before.threshold, after.threshold),
                     mix(share, before.lift, after.lift)});
        return local.solution.reach.opening - opening;
      };
      const double f_before = excess(0.), f_after = excess(1.);
      excess(bracketed_root(excess, 0., 1., f_before, f_after));
    }
  } // namespace

  template <int dim>
  bool stays_broken(const PointDamage<dim> &damage, const Reach &start,
                    LocalProblem<dim> &local)
  {
    const double end = damage.kinks().back();
    if (!(start.opening > end) || damage.history().opening >= end ||
        !damage.drops())
      return false;
    const auto excess = [&](const double opening) {
      local.solve_end(damage, {opening, 0.});
      return local.solution.reach.opening - opening;
    };
    double low = start.opening, high = low, f_low = excess(low), f_high = f_low;
    for (unsigned int k = 0; k < 60 && f_high > 0.; ++k)
      f_high = excess(high = end + 2. * (high - end));
    for (unsigned int k = 0; k < 60 && !(f_low > 0.); ++k)
      f_low = excess(low = end + 0.5 * (low - end));
    if (!(f_low > 0. && f_high <= 0.))
      return false;
    const double root = bracketed_root(excess, low, high, f_low, f_high);
    excess(root);
    local.solution.reach = {root, 0.};
    local.solution.damages = true;
    return true;
  }

  template <int dim>
  void solve_damage(const PointDamage<dim> &damage, const double low,
                    const double high, const double start,
                    LocalProblem<dim> &local)
  {
    const auto excess = [&](const double opening) {
      const Reach end{opening, 0.};
      local.solve_end(damage, end);
      return local.solution.reach.opening - opening;
    };
    const double root = adjacent_root(excess, low, high, start, damage.kinks());
    if (std::abs(excess(root)) > 1e-9 * root && !damage.plateau()) {
      excess(root * (1. - 1e-15));
      const FrozenPoint before = local.solution.frozen;
      excess(root * (1. + 1e-15));
      solve_between<dim>(local, before, local.solution.frozen, root);
    }
    local.solution.reach = {root, 0.};
  }

  template <int dim>
  bool follow_mixed_damage(const PointDamage<dim> &damage, const Reach &high,
                           const Reach &start, LocalProblem<dim> &local,
                           Reach &end)
  {
    using Pair = std::array<double, 2>;
    const Pair low{{damage.history().opening, damage.history().slip}};
    Pair x{{std::clamp(start.opening, low[0], high.opening),
            std::clamp(start.slip, low[1], high.slip)}};
    std::array<Pair, 2> H{{{{1., 0.}}, {{0., 1.}}}}; // step over distance
    Pair step{}, last{};
    const auto product = [&](const Pair &v) {
      return Pair{
          {H[0][0] * v[0] + H[0][1] * v[1], H[1][0] * v[0] + H[1][1] * v[1]}};
    };
    const auto size = [](const Pair &v) {
      return std::abs(v[0]) + std::abs(v[1]);
    };
    for (unsigned int k = 0; k < 12; ++k) {
      local.solve_end(damage, {x[0], x[1]});
      const Reach &reach = local.solution.reach;
      const Pair to{
          {std::max(low[0], reach.opening), std::max(low[1], reach.slip)}};
      const Pair distance{{to[0] - x[0], to[1] - x[1]}};
      const bool nearer = k == 0 || size(distance) < 0.5 * size(last);
      if (size(distance) <= (nearer ? 1e-14 : 1e-12) * size(to)) {
        end = {to[0], to[1]};
        return true;
      }
      if (!nearer)
        return false;
      if (k > 0) {
        const Pair change =
            product({{distance[0] - last[0], distance[1] - last[1]}});
        const double along = step[0] * change[0] + step[1] * change[1];
        if (!(along < 0.))
          return false;
        const Pair row{{step[0] * H[0][0] + step[1] * H[1][0],
                        step[0] * H[0][1] + step[1] * H[1][1]}};
        for (unsigned int r = 0; r < 2; ++r)
          for (unsigned int c = 0; c < 2; ++c)
            H[r][c] -= (step[r] + change[r]) * row[c] / along;
      }
      const Pair way = product(distance);
      for (unsigned int c = 0; c < 2; ++c) {
        const double next = std::max(low[c], x[c] + way[c]);
        step[c] = next - x[c];
        x[c] = next;
      }
      last = distance;
    }
    return false;
  }

  template <int dim>
  void solve_mixed_damage(const PointDamage<dim> &damage, const Reach &high,
                          const Reach &start, LocalProblem<dim> &local)
  {
    const Reach &low = damage.history();
    const auto finish = [&](const Reach &root) {
      // where nothing grows, the point is where its springs are
      Reach &end = local.solution.reach;
      if (root.opening > low.opening)
        end.opening = root.opening;
      if (root.slip > low.slip)
        end.slip = root.slip;
    };
    Reach end;
    if (follow_mixed_damage<dim>(damage, high, start, local, end)) {
      finish(end);
      return;
    }
    const auto reach = [&](const Reach &at) -> const Reach & {
      local.solve_end(damage, at);
      return local.solution.reach;
    };
    double opening = low.opening;
    const auto slip_excess = [&](const double slip) {
      const auto excess = [&](const double x) {
        return reach({x, slip}).opening - x;
      };
      opening =
          high.opening > low.opening
              ? adjacent_root(excess, low.opening, high.opening, start.opening)
              : low.opening;
      return reach({opening, slip}).slip - slip;
    };
    const double slip =
        high.slip > low.slip
            ? adjacent_root(slip_excess, low.slip, high.slip, start.slip)
            : low.slip;
    slip_excess(slip);
    finish({opening, slip});
  }

#define INSTANTIATE(dim)                                                       \
  template bool stays_broken<dim>(const PointDamage<dim> &, const Reach &,     \
                                  LocalProblem<dim> &);                        \
  template void solve_damage<dim>(const PointDamage<dim> &, double, double,    \
                                  double, LocalProblem<dim> &);                \
  template bool follow_mixed_damage<dim>(const PointDamage<dim> &,             \
                                         const Reach &, const Reach &,         \
                                         LocalProblem<dim> &, Reach &);        \
  template void solve_mixed_damage<dim>(const PointDamage<dim> &,              \
                                        const Reach &, const Reach &,          \
                                        LocalProblem<dim> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd::local
