#include "nsfd/cohesive_laws/law_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    double square(const double x) { return x * x; }

    /** A difference of squares of openings, m^2, has its digits: the first of
        a wave that arrives are so small that it is 0, and quotients with it are
        no numbers. The secant is constant there. */
    bool is_known(const double difference)
    {
      using limits = std::numeric_limits<double>;
      return std::abs(difference) >= limits::min() / limits::epsilon();
    }
  } // namespace

  Reach LawPoint::history_after(const Reach &history, const Reach &end,
                                const double time) const
  {
    if (!grows(history, end))
      return history;
    if (law_.rate_dependent())
      return {
          law_.delayed_opening(l_ * history.opening, l_ * end.opening, time) /
              l_,
          0.};
    return {std::max(history.opening, end.opening),
            std::max(history.slip, end.slip)};
  }

  Secant LawPoint::secant(const Reach &history) const
  {
    if (mixed_) {
      const double x = l_ * history.opening, y = l_ * history.slip;
      return {a_ * l_ * mixed_->normal_secant(x, y),
              a_ * l_ * mixed_->tangential_secant(x, y)};
    }
    const double b = secant_at(history.opening);
    return {b, b * stiffness_ratio_};
  }

  double LawPoint::beta(const Reach &history) const
  {
    return mixed_ ? mixed_->beta(l_ * history.opening, l_ * history.slip)
                  : law_.beta(l_ * history.opening);
  }

  double LawPoint::stored(const LawState &state) const
  {
    if (plateau_)
      return traction(state.history.opening) * reach(state.jump).opening;
    if (state.history.opening == 0. && law_.extrinsic())
      return 0.;
    const Secant b = secant(state.history);
    return (b.normal * square(state.jump.opening) +
            b.tangential * state.jump.slip_square) /
           2.;
  }

  Secant LawPoint::mean_secant(const Reached &from, const Reached &to) const
  {
    if (!plateau_) {
      if (!grows(from.largest, to.now))
        return secant(from.largest);
      if (mixed_)
        return mixed_secant(from, to);
    }
    double b;
    if (plateau_) {
      // set-valued at 0: any traction up to the plateau
      const double d = from.now.opening, opening = to.now.opening,
                   d_top = std::max({from.largest.opening, d, opening});
      b = 2. * mean_traction(from, opening) /
          std::max(d + opening, 1e-12 * d_top);
    } else
      b = scalar_secant(from, to);
    return {b, b * stiffness_ratio_};
  }

  /** I(to) - I(from). */
  double LawPoint::released(const double from, const double to) const
  {
    return a_ / l_ * law_.energy_increment(l_ * from, l_ * to);
  }

  /**
   * Where damage grows: the squares of opening and slip go straight from the
   * start of the step to its end, unloaded up to the history. Then the square
   * of d_m goes straight to its new value, at the pace of d^2.
   */
  LawPoint::Growth LawPoint::growth(const Reached &start,
                                    const Reached &end) const
  {
    const double d_m = start.largest.opening, d = start.now.opening;
    // d <= d_m but for round-off, which must not reach a small difference
    const bool unloads = d < d_m * (1. - 2e-15);
    Growth result;
    result.opening = unloads ? d_m : std::max(d, d_m);
    if (law_.rate_dependent()) {
      result.from = d_m;
      result.to = end.largest.opening;
      result.opening = std::max(d, d_m);
    } else {
      result.from = result.opening;
      result.to = std::max(end.now.opening, result.opening);
    }
    return result;
  }

  /**
   * The mean secant along that way. With one scalar that follows the opening
   * at once it is the change of the area under the envelope over the change
   * of d^2/2.
   */
  double LawPoint::scalar_secant(const Reached &start, const Reached &end) const
  {
    const double d_m = start.largest.opening, d = start.now.opening,
                 opening = end.now.opening;
    const Growth grown = growth(start, end);
    // mean traction times the way: the way must not suffer from the scaling
    const double s0 = l_ * grown.from, s1 = l_ * grown.to;
    if (!(s1 > s0))
      return secant_at(grown.to);
    const double mean = a_ * law_.energy_increment(s0, s1) / (s1 - s0);
    const double growing = 2. * mean / (grown.from + grown.to);
    if (d >= grown.opening)
      return growing;
    const double way = (opening - d) * (opening + d);
    if (!is_known(way))
      return growing;
    const double unloaded = secant_at(d_m) * (d_m - d) * (d_m + d);
    return (unloaded +
            growing * (opening - grown.opening) * (opening + grown.opening)) /
           way;
  }

  double LawPoint::mean_traction(const Reached &from,
                                 const double opening) const
  {
    const double d_m = from.largest.opening, d = from.now.opening;
    const double start = std::max(d, d_m), s0 = l_ * start, s1 = l_ * opening;
    if (!(s1 > s0))
      return traction(d_m);
    const double growing = a_ * law_.energy_increment(s0, s1) / (s1 - s0);
    if (d >= start)
      return growing;
    return (traction(d_m) * (start - d) + growing * (opening - start)) /
           (opening - d);
  }

  Dissipation LawPoint::dissipated(const LawState &from,
                                   const LawState &to) const
  {
    const Reach end = reach(to.jump);
    if (!grows(from.history, end))
      return {};
    if (mixed_)
      return {mixed_dissipation({reach(from.jump), from.history},
                                {end, to.history}),
              0.};
    const auto half_stored = [&](const double d) {
      if (d == 0. && law_.extrinsic())
        return 0.;
      return plateau_ ? traction(d) * d : secant_at(d) * square(d) / 2.;
    };
    // what the envelope leaves of the work between the two histories
    const double d_m = from.history.opening, d_top = to.history.opening;
    const double damage = std::max(
        0., released(d_m, d_top) - (half_stored(d_top) - half_stored(d_m)));
    const bool potential = has_potential(stiffness_ratio_, shear_weight_);
    if (plateau_ || (potential && !law_.rate_dependent()))
      return {damage, 0.};
    const double loss = lost_energy(from, to, damage);
    if (!law_.rate_dependent())
      return {loss, 0.};
    return {std::min(damage, loss), std::max(0., loss - damage)};
  }

  /**
   * The integral of -e^2/2 db along the way of growth(), with the stored
   * energy b e^2/2; @p damage is that of -d_m^2/2 db.
   */
  double LawPoint::lost_energy(const LawState &from, const LawState &to,
                               const double damage) const
  {
    const auto norm = [&](const JumpSize &u) {
      return square(u.opening) + stiffness_ratio_ * u.slip_square;
    };
    const Reached start{reach(from.jump), from.history},
        end{reach(to.jump), to.history};
    const double d0 = square(start.now.opening), d1 = square(end.now.opening);
    const Growth grown = growth(start, end);
    const double e0 = norm(from.jump), e1 = norm(to.jump);
    const double share = [&] {
      const double first = square(grown.opening);
      return first > d0 ? (first - d0) / (d1 - d0) : 0.;
    }();
    const double e_start = e0 + std::min(share, 1.) * (e1 - e0);
    const double loss = secant_at(grown.from) - secant_at(grown.to);
    const double first = square(grown.from), last = square(grown.to);
    if (!(loss > 0.) || !(last > first))
      return 0.;
    const double way =
        std::clamp((2. * damage / loss - first) / (last - first), 0., 1.);
    return loss * (e_start + way * (e1 - e_start)) / 2.;
  }

  /**
   * For one order of the two openings, the normal quotient is that of
   *
   *   W_N(x; y) = int T_N(x, y) dx above x_m, K_N(x_m, y) x^2 / 2 below,
   *
   * at the slip history y before or after the step; the mean of both orders.
   */
  Secant LawPoint::mixed_secant(const Reached &from, const Reached &to) const
  {
    const Reach &start = from.now, &end = to.now, &after = to.largest;
    // W(to) - W(from) over the change of the square, times 2
    const auto quotient = [&](const double before, const double now,
                              const double largest, const auto &energy,
                              const auto &secant) {
      const double bottom = std::min(before, largest);
      const double top = std::max(largest, bottom);
      if (now <= top)
        return secant(top);
      const double way = (now - bottom) * (now + bottom);
      if (!is_known(way))
        return secant(now);
      const double elastic = secant(top) * (top - bottom) * (top + bottom);
      return (elastic + 2. * energy(top, now)) / way;
    };
    const double x_m = from.largest.opening, y_m = from.largest.slip;
    const auto normal = [&](const double y) {
      return quotient(
          start.opening, end.opening, x_m,
          [&](const double x0, const double x1) {
            return a_ / l_ * mixed_->normal_energy(l_ * x0, l_ * x1, l_ * y);
          },
          [&](const double x) {
            return a_ * l_ * mixed_->normal_secant(l_ * x, l_ * y);
          });
    };
    const auto tangential = [&](const double x) {
      return quotient(
          start.slip, end.slip, y_m,
          [&](const double y0, const double y1) {
            return a_ / l_ *
                   mixed_->tangential_energy(l_ * y0, l_ * y1, l_ * x);
          },
          [&](const double y) {
            return a_ * l_ * mixed_->tangential_secant(l_ * x, l_ * y);
          });
    };
    return {(normal(y_m) + normal(after.slip)) / 2.,
            (tangential(x_m) + tangential(after.opening)) / 2.};
  }

  /** Along the same two ways; each part is a loss of secant or of area. */
  double LawPoint::mixed_dissipation(const Reached &from,
                                     const Reached &to) const
  {
    const Reach &start = from.now, &end = to.now, &after = to.largest;
    const double x_m = from.largest.opening, y_m = from.largest.slip;
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
} // namespace nsfd
