#include "local_problem.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nsfd::local
{
  namespace
  {
    /**
     * The local problem of a law that adds openings, at a given mean traction m
     * of the step: with the openings o and e at its start and its end
     *
     *   R_N = m (<e_N>_+ - <o_N>_+) / (e_N - o_N),
     *   R_T = m r (o_T + e_T) / (|o_T| + |e_T|),
     *
     * the discrete gradient of m d, set-valued where o = e = 0. Rules of the
     * end of the step have o = 0: they lose energy where the point closes.
     */
    template <int dim>
    class AddedOpenings
    {
    public:
      AddedOpenings(const PointDamage<dim> &damage, LocalProblem<dim> &local)
          : damage_(damage), local_(local), problem_(local.problem),
            i_(local.i), wh_(problem_.weight[i_] * problem_.time_step),
            slope_(velocity_slope<dim>(problem_)), exact_(is_exact(problem_))
      {
        const bool at_jump = problem_.rule == CohesionRule::end_velocity;
        double square = 0.;
        for (unsigned int c = 0; c < dim; ++c) {
          const double old =
              problem_.from_closed ? 0. : problem_.jump_old[i_ * dim + c];
          base_[c] = at_jump ? old : problem_.jump_free[i_ * dim + c];
          start_[c] = exact_ ? old : 0.;
          if (c > 0)
            square += start_[c] * start_[c];
        }
        slip_start_ = std::sqrt(square);
        // round-off of a slip of 0 has no direction
        if (slip_start_ <= round_off * std::max(damage.history().opening,
                                                damage.final_opening())) {
          slip_start_ = 0.;
          std::fill(start_.begin() + 1, start_.end(), 0.);
        }
      }

      /** Where the step ends if its mean traction is that of @p end. */
      double opening_for(const Reach &end)
      {
        const double m = damage_.mean_traction(end);
        auto &solution = local_.solution;
        const double R_N = solve_normal_part(m);
        solution.frozen = {};
        solution.frozen.secant = {R_N, 0.};
        // closed surfaces are pressed together by what holds them
        const double pressing = solution.impulse[0] + wh_ * m;
        if (problem_.contact[i_] && local_.interaction().friction > 0. &&
            pressing > 0.)
          solution.frozen.threshold = threshold_for(
              problem_, i_, damage_.beta(damage_.history_after(end)), pressing);
        solve_tangential_part(m * damage_.slip_weight());
        solution.reach = end_reach<dim>(problem_, i_, solution.velocity);
        return solution.reach.opening;
      }

    private:
      static constexpr double round_off = 1e-15; ///< of the last opening
      const PointDamage<dim> &damage_;
      LocalProblem<dim> &local_;
      const OneStepProblem<dim> &problem_;
      const std::size_t i_;
      const double wh_, slope_;
      const bool exact_;
      std::array<double, dim> base_{}, start_{};
      double slip_start_ = 0.;

      static bool is_exact(const OneStepProblem<dim> &problem)
      {
        return problem.rule == CohesionRule::exact;
      }

      double end_at(const double U, const unsigned int c = 0) const
      {
        return added_end(base_[c], slope_ * U);
      }

      /** U_N of R_N without contact, against the majorant. */
      double free_normal(const double m) const
      {
        const double A = local_.majorant_normal * wh_, U_loc = local_.local[0];
        const double o = start_[0], e_loc = end_at(U_loc);
        const double k = A * m * slope_;
        const auto velocity = [&](const double e) {
          return (e - base_[0]) / slope_;
        };
        if (o >= 0. && e_loc - k >= 0.)
          return U_loc - A * m;
        if (o == 0.)
          return e_loc > 0. ? velocity(0.) : U_loc;
        if (o > 0.) {
          // (e - e_loc)(o - e) + k o = 0 with e < 0
          const double p = e_loc + o, q = e_loc * o - k * o;
          const double root = std::sqrt((e_loc - o) * (e_loc - o) + 4. * k * o);
          return velocity(p > 0. ? 2. * q / (p + root) : (p - root) / 2.);
        }
        if (e_loc <= 0.)
          return U_loc;
        // (e - e_loc)(e - o) + k e = 0 with e > 0
        const double p = e_loc + o - k, q = e_loc * o;
        const double root = std::sqrt(p * p - 4. * q);
        return velocity(p > 0. ? (p + root) / 2. : -2. * q / (root - p));
      }

      /** The normal part; the secant of its traction, for preconditioners. */
      double solve_normal_part(const double m)
      {
        auto &solution = local_.solution;
        const double U_loc = local_.local[0], A = local_.majorant_normal;
        double U = free_normal(m);
        solution.contact_impulse = 0.;
        solution.status = PointStatus::open;
        if (problem_.contact[i_] && U < problem_.target[i_]) {
          U = problem_.target[i_];
          solution.status = PointStatus::stick;
        }
        solution.velocity[0] = U;
        solution.impulse[0] = (U - U_loc) / A;
        const double e = end_at(U), o = start_[0];
        const double R = added_normal_traction(m, o, e);
        if (o == 0. && e == 0.)
          solution.status = PointStatus::stick; // held by both, or by cohesion
        if (solution.status == PointStatus::stick)
          solution.contact_impulse = positive(solution.impulse[0] + wh_ * R);
        else if (e > 0. && o >= 0.)
          solution.impulse[0] = -wh_ * m;
        const double size = positive(e) + positive(o);
        return size > 0. ? 2. * m / size : 0.;
      }

      std::array<double, dim> slip_at(const std::array<double, dim> &U) const
      {
        std::array<double, dim> e{};
        for (unsigned int c = 1; c < dim; ++c)
          e[c] = end_at(U[c], c);
        return e;
      }

      double slip_size(const std::array<double, dim> &U) const
      {
        double square = 0.;
        for (const double e : slip_at(U))
          square += e * e;
        return std::sqrt(square);
      }

      /** With the spring of the secant @p b; the slip at the end. */
      double solve_spring(const double b)
      {
        auto &solution = local_.solution;
        const bool closed = solution.status != PointStatus::open;
        solution.frozen.secant.tangential = b;
        solve_tangential<dim>(problem_, i_, solution.frozen, local_.local,
                              local_.majorant_tangential, solution);
        if (!closed)
          solution.status = PointStatus::open;
        return slip_size(solution.velocity);
      }

      double secant_of(const double size, const double slip) const
      {
        return exact_ ? 2. * size / (slip_start_ + slip) : size / slip;
      }

      /** e_T = 0 is held by less than the traction @p size and friction. */
      bool holds(const double size)
      {
        auto &solution = local_.solution;
        const double A = local_.majorant_tangential;
        std::array<double, dim> U{}, P{}, way{};
        double sliding = 0.;
        for (unsigned int c = 1; c < dim; ++c) {
          U[c] = -base_[c] / slope_;
          P[c] = (U[c] - local_.local[c]) / A;
          way[c] = U[c] + problem_.sliding_offset[i_ * dim + c];
          sliding += way[c] * way[c];
        }
        sliding = std::sqrt(sliding);
        double bound = wh_ * size, square = 0.;
        const double s = solution.frozen.threshold;
        if (sliding == 0.)
          bound += s;
        for (unsigned int c = 1; c < dim; ++c)
          square += springs::square(P[c] +
                                    (sliding > 0. ? s * way[c] / sliding : 0.));
        if (!(square <= bound * bound))
          return false;
        for (unsigned int c = 1; c < dim; ++c) {
          solution.velocity[c] = U[c];
          solution.impulse[c] = P[c];
        }
        solution.frozen.secant.tangential =
            secant_of(size, 1e-12 * std::max(damage_.history().opening,
                                             damage_.final_opening()));
        return true;
      }

      /** In the plane: the traction @p size to one side, @p sign. */
      bool solve_one_side(const double size, const double sign)
      {
        auto &solution = local_.solution;
        const double A = local_.majorant_tangential,
                     s = solution.frozen.threshold, R = sign * size,
                     offset = problem_.sliding_offset[i_ * dim + 1];
        const double z = local_.local[1] - A * wh_ * R + offset;
        const double U =
            std::copysign(positive(std::abs(z) - A * s), z) - offset;
        const double e = end_at(U, 1);
        if (sign * e < 0.)
          return false;
        solution.velocity[1] = U;
        solution.impulse[1] = s == 0. ? -wh_ * R : (U - local_.local[1]) / A;
        if (solution.status == PointStatus::stick && U + offset != 0.)
          solution.status = PointStatus::slide;
        solution.frozen.secant.tangential =
            secant_of(size, std::max(std::abs(e), 1e-300));
        return true;
      }

      void solve_tangential_part(const double size)
      {
        if (size == 0.) {
          solve_spring(0.);
          return;
        }
        if (slip_start_ == 0. && holds(size))
          return;
        if (dim == 2) {
          const double first = std::copysign(1., start_[1]);
          if (solve_one_side(size, first) ||
              (slip_start_ == 0. && solve_one_side(size, -first)))
            return;
        }
        // next to a slip of 0 the traction keeps its size, and the secant grows
        const double farthest = solve_spring(0.);
        double low = slip_start_ > 0. ? 0. : 1e-12 * farthest,
               high = farthest + slip_start_;
        const auto excess = [&](const double slip) {
          return solve_spring(secant_of(size, slip)) - slip;
        };
        const double f_low = excess(low);
        if (f_low <= 0.)
          return;
        double f_high = excess(high);
        for (unsigned int k = 0; k < 60 && f_high > 0.; ++k)
          f_high = excess(high *= 2.);
        if (f_high < 0.)
          excess(bracketed_root(excess, low, high, f_low, f_high));
      }
    };
  } // namespace

  template <int dim>
  void solve_added(const PointDamage<dim> &damage, const Reach &start,
                   LocalProblem<dim> &local)
  {
    const double history = damage.history().opening;
    AddedOpenings<dim> point(damage, local);
    const double held = point.opening_for(damage.history());
    if (!(held > history))
      return;
    const auto excess = [&](const double opening) {
      return point.opening_for({opening, 0.}) - opening;
    };
    const double root =
        adjacent_root(excess, history, held, start.opening, damage.kinks());
    excess(root);
    local.solution.reach = {root, 0.};
  }

#define INSTANTIATE(dim)                                                       \
  template void solve_added<dim>(const PointDamage<dim> &, const Reach &,      \
                                 LocalProblem<dim> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd::local
