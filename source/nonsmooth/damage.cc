#include "damage.h"
#include "springs.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    using springs::square;

    /** Squares of the opening and of the slip of a jump. */
    template <int dim>
    std::array<double, 2> squares(const double *u)
    {
      std::array<double, 2> result{u[0] > 0. ? u[0] * u[0] : 0., 0.};
      for (unsigned int c = 1; c < dim; ++c)
        result[1] += u[c] * u[c];
      return result;
    }
  } // namespace

  template <int dim>
  PointDamage<dim>::PointDamage(const OneStepProblem<dim> &problem,
                                const std::size_t point)
      : problem_(problem),
        interaction_(problem.interactions[problem.interaction[point]]),
        law_(*interaction_.law), mixed_(law_.mixed()), point_(point),
        a_(problem.strength_factor[point]), l_(problem.opening_factor[point]),
        history_{problem.opening_max[point],
                 mixed_ ? problem.slip_max[point] : 0.},
        old_(&problem.jump_old[point * dim])
  {
  }

  template <int dim>
  Reach PointDamage<dim>::reach(const double *u) const
  {
    return reach_of<dim>(interaction_, u);
  }

  template <int dim>
  Reach PointDamage<dim>::history_after(const Reach &end) const
  {
    if (!grows(end))
      return history_;
    if (law_.rate_dependent())
      return {law_.delayed_opening(l_ * history_.opening, l_ * end.opening,
                                   problem_.time_step) /
                  l_,
              0.};
    return {std::max(history_.opening, end.opening),
            std::max(history_.slip, end.slip)};
  }

  /** I(to) - I(from). */
  template <int dim>
  double PointDamage<dim>::released(const double from, const double to) const
  {
    return a_ / l_ * law_.energy_increment(l_ * from, l_ * to);
  }

  /** The secants that unload from a history. */
  template <int dim>
  Secant PointDamage<dim>::secants_at(const Reach &history) const
  {
    if (mixed_) {
      const double x = l_ * history.opening, y = l_ * history.slip;
      return {a_ * l_ * mixed_->normal_secant(x, y),
              a_ * l_ * mixed_->tangential_secant(x, y)};
    }
    return isotropic(secant_at(history.opening));
  }

  template <int dim>
  Secant PointDamage<dim>::secant(const Reach &end) const
  {
    if (plateau())
      return isotropic(plateau_secant(end.opening));
    if (!grows(end))
      return secants_at(history_);
    if (problem_.rule != CohesionRule::exact)
      return secants_at(history_after(end));
    return mixed_ ? mixed_secant(end) : isotropic(scalar_secant(end.opening));
  }

  /**
   * Where damage grows: the squares of opening and slip go straight from the
   * start of the step to its end, unloaded up to the history. Then the square
   * of d_m goes straight to its new value, at the pace of d^2.
   */
  template <int dim>
  typename PointDamage<dim>::Growth
  PointDamage<dim>::growth(const double opening) const
  {
    const double d_m = history_.opening, d = reach(old_).opening;
    // d <= d_m but for round-off, which must not reach a small difference
    const bool unloads = d < d_m * (1. - 2e-15);
    Growth result;
    result.opening = unloads ? d_m : std::max(d, d_m);
    if (law_.rate_dependent()) {
      result.from = d_m;
      result.to = history_after({opening, 0.}).opening;
      result.opening = std::max(d, d_m);
    } else {
      result.from = result.opening;
      result.to = std::max(opening, result.opening);
    }
    return result;
  }

  /**
   * The mean secant along that way. With one scalar that follows the opening
   * at once it is the change of the area under the envelope over the change
   * of d^2/2.
   */
  template <int dim>
  double PointDamage<dim>::scalar_secant(const double opening) const
  {
    const double d_m = history_.opening, d = reach(old_).opening;
    const Growth grown = growth(opening);
    // mean traction times the way: the way must not suffer from the scaling
    const double s0 = l_ * grown.from, s1 = l_ * grown.to;
    if (!(s1 > s0))
      return secant_at(grown.to);
    const double mean = a_ * law_.energy_increment(s0, s1) / (s1 - s0);
    const double growing = 2. * mean / (grown.from + grown.to);
    if (d >= grown.opening)
      return growing;
    const double unloaded = secant_at(d_m) * (d_m - d) * (d_m + d);
    return (unloaded +
            growing * (opening - grown.opening) * (opening + grown.opening)) /
           ((opening - d) * (opening + d));
  }

  /** The same where W = T(d_m) d below d_m. */
  template <int dim>
  double PointDamage<dim>::plateau_secant(const double opening) const
  {
    const double d_m = history_.opening, d_top = std::max(d_m, opening);
    const double d = reach(old_).opening;
    // set-valued at 0: any traction up to the plateau
    const double least = 1e-12 * std::max(d_top, d);
    if (problem_.rule != CohesionRule::exact)
      return a_ * law_.traction(l_ * d_top) / std::max(opening, least);
    const double plateau = a_ * law_.traction(l_ * d_m);
    if (opening <= d_m || opening == d)
      return 2. * plateau / std::max(d + opening, least);
    const double start = std::max(d, d_m);
    return 2. * (plateau * (start - d) + released(start, opening)) /
           ((opening - d) * (opening + d));
  }

  template <int dim>
  double PointDamage<dim>::strength() const
  {
    return a_ *
           (plateau() ? law_.traction(l_ * history_.opening) : law_.strength());
  }

  template <int dim>
  double PointDamage<dim>::beta(const Reach &history) const
  {
    return mixed_ ? mixed_->beta(l_ * history.opening, l_ * history.slip)
                  : law_.beta(l_ * history.opening);
  }

  template <int dim>
  double PointDamage<dim>::stored(const Reach &history, const double *u) const
  {
    if (plateau())
      return a_ * law_.traction(l_ * history.opening) * reach(u).opening;
    if (history.opening == 0. && law_.extrinsic())
      return 0.;
    const Secant b = secants_at(history);
    const auto [normal, tangential] = squares<dim>(u);
    return (b.normal * normal + b.tangential * tangential) / 2.;
  }

  template <int dim>
  typename PointDamage<dim>::Dissipation
  PointDamage<dim>::dissipation(const double *u) const
  {
    const Reach end = reach(u);
    if (!grows(end))
      return {};
    const Reach after = history_after(end);
    if (mixed_)
      return {mixed_dissipation(reach(old_), end), 0.};
    const auto half_stored = [&](const double d) {
      if (d == 0. && law_.extrinsic())
        return 0.;
      return plateau() ? a_ * law_.traction(l_ * d) * d
                       : secant_at(d) * square(d) / 2.;
    };
    // what the envelope leaves of the work between the two histories
    const double d_m = history_.opening, d_top = after.opening;
    const double damage = std::max(
        0., released(d_m, d_top) - (half_stored(d_top) - half_stored(d_m)));
    if (plateau() || (law_.has_potential() && !law_.rate_dependent()))
      return {damage, 0.};
    const double loss = lost_energy(u, damage);
    if (!law_.rate_dependent())
      return {loss, 0.};
    return {std::min(damage, loss), std::max(0., loss - damage)};
  }

  /**
   * The integral of -e^2/2 db along the way of growth(), with the stored
   * energy b e^2/2; @p damage is that of -d_m^2/2 db.
   */
  template <int dim>
  double PointDamage<dim>::lost_energy(const double *u,
                                       const double damage) const
  {
    const auto norm = [&](const double *v) {
      const auto [normal, tangential] = squares<dim>(v);
      return normal + interaction_.stiffness_ratio * tangential;
    };
    const double d0 = square(reach(old_).opening),
                 d1 = square(reach(u).opening);
    const Growth grown = growth(reach(u).opening);
    const double e0 = norm(old_), e1 = norm(u);
    const double share = [&] {
      const double first = square(grown.opening);
      return first > d0 ? (first - d0) / (d1 - d0) : 0.;
    }();
    const double e_start = e0 + std::min(share, 1.) * (e1 - e0);
    const double loss = secant_at(grown.from) - secant_at(grown.to);
    const double from = square(grown.from), to = square(grown.to);
    if (!(loss > 0.) || !(to > from))
      return 0.;
    const double way =
        std::clamp((2. * damage / loss - from) / (to - from), 0., 1.);
    return loss * (e_start + way * (e1 - e_start)) / 2.;
  }

  /**
   * For one order of the two openings, the normal quotient is that of
   *
   *   W_N(x; y) = int T_N(x, y) dx above x_m, K_N(x_m, y) x^2 / 2 below,
   *
   * at the slip history y before or after the step; the mean of both orders.
   */
  template <int dim>
  Secant PointDamage<dim>::mixed_secant(const Reach &end) const
  {
    const Reach start = reach(old_), after = history_after(end);
    // W(to) - W(from) over the change of the square, times 2
    const auto quotient = [&](const double from, const double to,
                              const double largest, const auto &energy,
                              const auto &secant) {
      const double bottom = std::min(from, largest);
      const double top = std::max(largest, bottom);
      if (to <= top)
        return secant(top);
      const double elastic = secant(top) * (top - bottom) * (top + bottom);
      return (elastic + 2. * energy(top, to)) / ((to - bottom) * (to + bottom));
    };
    const double x_m = history_.opening, y_m = history_.slip;
    const auto normal = [&](const double y) {
      return quotient(
          start.opening, end.opening, x_m,
          [&](const double from, const double to) {
            return a_ / l_ * mixed_->normal_energy(l_ * from, l_ * to, l_ * y);
          },
          [&](const double x) {
            return a_ * l_ * mixed_->normal_secant(l_ * x, l_ * y);
          });
    };
    const auto tangential = [&](const double x) {
      return quotient(
          start.slip, end.slip, y_m,
          [&](const double from, const double to) {
            return a_ / l_ *
                   mixed_->tangential_energy(l_ * from, l_ * to, l_ * x);
          },
          [&](const double y) {
            return a_ * l_ * mixed_->tangential_secant(l_ * x, l_ * y);
          });
    };
    return {(normal(y_m) + normal(after.slip)) / 2.,
            (tangential(x_m) + tangential(after.opening)) / 2.};
  }

  /** Along the same two ways; each part is a loss of secant or of area. */
  template <int dim>
  double PointDamage<dim>::mixed_dissipation(const Reach &start,
                                             const Reach &end) const
  {
    const Reach after = history_after(end);
    const double x_m = history_.opening, y_m = history_.slip;
    const auto K_N = [&](const double x, const double y) {
      return a_ * l_ * mixed_->normal_secant(l_ * x, l_ * y);
    };
    const auto K_T = [&](const double x, const double y) {
      return a_ * l_ * mixed_->tangential_secant(l_ * x, l_ * y);
    };
    // the opening grows at the slip history y while the slip is s
    const auto opens = [&](const double y, const double s) {
      if (after.opening <= x_m)
        return 0.;
      const double area =
          a_ / l_ * mixed_->normal_energy(l_ * x_m, l_ * after.opening, l_ * y);
      return std::max(0.,
                      area - (K_N(after.opening, y) * square(after.opening) -
                              K_N(x_m, y) * square(x_m)) /
                                 2.) +
             (K_T(x_m, y) - K_T(after.opening, y)) * square(s) / 2.;
    };
    const auto slips = [&](const double x, const double u) {
      if (after.slip <= y_m)
        return 0.;
      const double area =
          a_ / l_ *
          mixed_->tangential_energy(l_ * y_m, l_ * after.slip, l_ * x);
      return std::max(0., area - (K_T(x, after.slip) * square(after.slip) -
                                  K_T(x, y_m) * square(y_m)) /
                                     2.) +
             (K_N(x, y_m) - K_N(x, after.slip)) * square(u) / 2.;
    };
    return (opens(y_m, start.slip) + slips(after.opening, end.opening) +
            slips(x_m, start.opening) + opens(after.slip, end.slip)) /
           2.;
  }

  template class PointDamage<2>;
  template class PointDamage<3>;
} // namespace nsfd
