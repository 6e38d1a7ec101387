#include "path_laws.h"

#include "static_bonds.h"

#include "core/bracketed_root.h"
#include "nonsmooth/damage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nsfd
{
  namespace
  {
    /** Of the peak or the end of a law: where a point has come to it. */
    constexpr double at_event = 1e-9;
    /** Of its strength: a joined point that opens. */
    constexpr double at_strength = 1e-6;
    /** Of G/R_max: a point that has been opened and closes again. */
    constexpr double closed_again = 1e-6;
    /** The same of the spring that an open point starts with, at least: stiffer
        ones are hard to solve. */
    constexpr double least_opening = 1e-3;
  } // namespace

  template <int dim>
  std::size_t PathLaws<dim>::start()
  {
    laws_.hold();
    last_ = now_ = Sample();
    for (std::size_t i = 0; i < problem_.n_owned; ++i)
      if (iterate_.at.kind[i] == PointKind::rigid && laws_.law(i).law)
        return i;
    return End::none;
  }

  /** It has its law, which is held. */
  template <int dim>
  bool PathLaws<dim>::takes_part(const std::size_t i) const
  {
    return iterate_.at.kind[i] == PointKind::cohesive && laws_.law(i).law;
  }

  template <int dim>
  bool PathLaws<dim>::is_closed(const std::size_t i) const
  {
    return bonds_ && iterate_.activated[i] != LoadStepIterate<dim>::opened &&
           bonds_->is_closed(iterate_.at, i);
  }

  template <int dim>
  void PathLaws<dim>::observe(const double s)
  {
    std::swap(last_, now_);
    now_.load_time = s;
    now_.force = iterate_.force;
    now_.jump.assign(problem_.n_points * dim, 0.);
    for (std::size_t i = 0; i < problem_.n_points; ++i)
      if (takes_part(i))
        for (unsigned int c = 0; c < dim; ++c)
          now_.jump[i * dim + c] =
              problem_.jump_free[i * dim + c] +
              iterate_.h * iterate_.solutions[i].velocity[c];
  }

  template <int dim>
  auto PathLaws<dim>::on_line(std::vector<double> Sample::*const member,
                              const std::size_t i, const double s) const
      -> Vector
  {
    const double x = (s - now_.load_time) / (now_.load_time - last_.load_time);
    Vector result;
    for (unsigned int c = 0; c < dim; ++c) {
      const double here = (now_.*member)[i * dim + c];
      result[c] = here + x * (here - (last_.*member)[i * dim + c]);
    }
    return result;
  }

  template <int dim>
  double PathLaws<dim>::dissipation_of(const std::size_t i,
                                       const double s) const
  {
    if (!takes_part(i) || is_closed(i))
      return 0.;
    const Interaction &interaction = laws_.law(i);
    const LawPoint law = law_at(interaction, problem_.strength_factor[i],
                                problem_.opening_factor[i]);
    const LawState start{JumpSize::of<dim>(&iterate_.old->jump[i * dim]),
                         laws_.history(i)};
    const Vector u = on_line(&Sample::jump, i, s);
    const JumpSize jump = JumpSize::of<dim>(u.data());
    if (!grows(start.history, law.reach(jump)))
      return 0.;
    return problem_.weight[i] *
           law.dissipated(start, law.moved(start, jump)).total();
  }

  /**
   * What a point would carry if all joined points of its face carried the same
   * traction: their sum alone is that of the nodes.
   */
  template <int dim>
  auto PathLaws<dim>::mean_of_face(const std::size_t i,
                                   const std::vector<double> &force) const
      -> Vector
  {
    const auto &face = points_.faces[points_.face_of[i]];
    Vector sum{};
    double weight = 0.;
    for (std::size_t k = face.first; k < face.first + face.count; ++k) {
      if (!takes_part(k) || !is_closed(k))
        continue;
      weight += problem_.weight[k];
      for (unsigned int c = 0; c < dim; ++c)
        sum[c] += force[k * dim + c];
    }
    for (double &one : sum)
      one *= problem_.weight[i] / weight;
    return sum;
  }

  /** Of its strength, of a joined point. */
  template <int dim>
  double PathLaws<dim>::share(const std::size_t i, const double s) const
  {
    const double x = (s - now_.load_time) / (now_.load_time - last_.load_time);
    const Vector here = mean_of_face(i, now_.force),
                 there = mean_of_face(i, last_.force);
    Vector r;
    for (unsigned int c = 0; c < dim; ++c)
      r[c] = here[c] + x * (here[c] - there[c]);
    return share_of(i, r);
  }

  template <int dim>
  double PathLaws<dim>::share_of(const std::size_t i, const Vector &r) const
  {
    return effective_traction<dim>(problem_, i, -r[0], r.data() + 1) /
           (problem_.weight[i] * point_strength<dim>(problem_, i));
  }

  /** Above 0 once the point has come to the next kink of its law. */
  template <int dim>
  double PathLaws<dim>::event(const std::size_t i, const double s) const
  {
    constexpr double none = -std::numeric_limits<double>::infinity();
    if (!takes_part(i))
      return none;
    if (is_closed(i))
      return share(i, s) - 1.;
    const Interaction &interaction = laws_.law(i);
    const CohesiveLaw &law = *interaction.law;
    const double l = problem_.opening_factor[i];
    const Reach last = laws_.history(i);
    const Vector u = on_line(&Sample::jump, i, s);
    const Reach reach = reach_of<dim>(interaction, u.data());
    if (const MixedLaw *const mixed = law.mixed()) {
      const auto size = [&](const Reach &one) {
        return std::hypot(l * one.opening / law.peak_opening(),
                          l * one.slip / mixed->peak_slip());
      };
      return size(last) < 1. - at_event ? size(reach) - 1. : none;
    }
    const double before = l * last.opening, now = l * reach.opening;
    if (before < law.peak_opening() * (1. - at_event))
      return now / law.peak_opening() - 1.;
    const double end = law.final_opening();
    return std::isfinite(end) && before < end * (1. - at_event)
               ? now / end - (1. + at_event)
               : none;
  }

  /** Below 0 as long as the step goes on at @p s; collective. */
  template <int dim>
  double PathLaws<dim>::excess(const PathControl &control, const double s,
                               std::size_t *const point) const
  {
    double result =
        control.alone ? -1. : (s - control.start) / control.longest - 1.;
    std::size_t worst = End::none;
    std::vector<double> dissipated(problem_.n_owned);
    for (std::size_t i = 0; i < problem_.n_points; ++i) {
      const double one =
          control.alone && takes_part(i) && is_closed(i) ? -1. : event(i, s);
      if (one > result) {
        result = one;
        worst = i;
      }
      if (i < problem_.n_owned)
        dissipated[i] = dissipation_of(i, s);
    }
    const double sum = communicator_.sum(dissipated);
    const double dissipation = sum / control.dissipation - 1.;
    if (point)
      *point = dissipation > result ? End::none : worst;
    return std::max(communicator_.max(result), dissipation);
  }

  /**
   * From the longest step downward: loads open the points of the springs, and
   * the first crossing is that of the branch that they open on.
   */
  template <int dim>
  auto PathLaws<dim>::end(const PathControl &control) const -> End
  {
    constexpr unsigned int most = 60, finer = 60, far = 10;
    const auto f = [&](const double s) { return excess(control, s, nullptr); };
    End result;
    double high = control.start + control.longest, f_high = f(high);
    double step = control.longest;
    for (unsigned int k = 0; control.alone && k < far && f_high < 0.; ++k) {
      high += step;
      f_high = f(high);
      step *= 2.;
    }
    result.load_time = high;
    if (f_high <= 4. * std::numeric_limits<double>::epsilon() *
                      (1. + std::abs(high) / control.longest)) {
      result.at_longest = !control.alone;
      result.found = result.at_longest || f_high >= 0.;
      return result;
    }
    double higher = high;
    step = control.longest / 16.;
    for (unsigned int k = 0; k < most; ++k, step *= 2.) {
      double low = high - step, f_low = f(low);
      if (f_low > f_high) { // beyond the least: sections of a bracket
        double from = low, to = higher;
        for (unsigned int n = 0; n < finer && f_low >= 0.; ++n) {
          const double third = (to - from) / 3.;
          const double f_1 = f(from + third), f_2 = f(to - third);
          low = f_1 < f_2 ? from + third : to - third;
          f_low = std::min(f_1, f_2);
          (f_1 < f_2 ? to : from) = f_1 < f_2 ? to - third : from + third;
        }
        result.load_time = low;
        if (f_low >= 0.)
          return result;
        high = higher;
        f_high = f(high);
      }
      if (f_low < 0.) {
        result.load_time =
            high - bracketed_root([&](const double x) { return f(high - x); },
                                  0., high - low, f_high, f_low);
        result.found = true;
        excess(control, result.load_time, &result.point);
        return result;
      }
      higher = high;
      high = low;
      f_high = f_low;
    }
    return result;
  }

  template <int dim>
  std::vector<double> PathLaws<dim>::damage() const
  {
    std::vector<double> damage(2 * problem_.n_points, 0.);
    for (std::size_t i = 0; i < problem_.n_points; ++i)
      if (takes_part(i)) {
        const double scale = laws_.opening_scale(i);
        damage[2 * i] = laws_.held(i).opening / scale;
        damage[2 * i + 1] = laws_.held(i).slip / scale;
      }
    return damage;
  }

  template <int dim>
  void PathLaws<dim>::set_damage(const std::vector<double> &damage)
  {
    for (std::size_t i = 0; i < problem_.n_points; ++i)
      if (takes_part(i) && !is_closed(i)) {
        const double scale = laws_.opening_scale(i);
        const Reach last = laws_.history(i);
        laws_.held(i) = {std::max(last.opening, damage[2 * i] * scale),
                         std::max(last.slip, damage[2 * i + 1] * scale)};
      }
  }

  template <int dim>
  double PathLaws<dim>::follow(const double s, std::vector<double> &damage)
  {
    double largest = 0.;
    damage.assign(2 * problem_.n_points, 0.);
    for (std::size_t i = 0; i < problem_.n_points; ++i) {
      if (!takes_part(i))
        continue;
      const double scale = laws_.opening_scale(i);
      const Reach last = laws_.history(i), held = laws_.held(i);
      Reach reach = last;
      if (!is_closed(i)) {
        const Vector u = on_line(&Sample::jump, i, s);
        const Reach now = reach_of<dim>(laws_.law(i), u.data());
        reach = {std::max(last.opening, now.opening),
                 std::max(last.slip, now.slip)};
        const double size = std::hypot(reach.opening, reach.slip);
        if (size > 0.)
          largest = std::max(largest, std::hypot(reach.opening - held.opening,
                                                 reach.slip - held.slip) /
                                          size);
        if (laws_.law(i).law->extrinsic() &&
            iterate_.activated[i] == LoadStepIterate<dim>::opened &&
            size < held.opening && size < closed_again * scale) {
          iterate_.activated[i] = iterate_.starts_joined(i)
                                      ? LoadStepIterate<dim>::lets_go
                                      : char(0);
          laws_.held(i) = reach = last;
        }
      }
      damage[2 * i] = reach.opening / scale;
      damage[2 * i + 1] = reach.slip / scale;
    }
    return communicator_.max(largest);
  }

  template <int dim>
  bool PathLaws<dim>::open(const double s)
  {
    std::vector<std::size_t> points; // all of a face at once
    for (std::size_t i = 0; i < problem_.n_points; ++i)
      if (takes_part(i) && is_closed(i) && share(i, s) >= 1. - at_strength)
        points.push_back(i);
    for (const std::size_t i : points)
      iterate_.activated[i] = LoadStepIterate<dim>::opened;
    return communicator_.any(!points.empty());
  }

  template <int dim>
  void PathLaws<dim>::guess(const double s, const double dissipation)
  {
    std::vector<std::size_t> points;
    unsigned int owned = 0;
    for (std::size_t i = 0; i < problem_.n_points; ++i) {
      if (!takes_part(i) || is_closed(i) || laws_.law(i).law->mixed())
        continue;
      const double last = laws_.history(i).opening;
      const Vector u = on_line(&Sample::jump, i, s);
      const CohesiveLaw &law = *laws_.law(i).law;
      const double l = problem_.opening_factor[i];
      if (l * last >= law.final_opening() || l * last < law.peak_opening() ||
          (iterate_.activated[i] != LoadStepIterate<dim>::opened &&
           reach_of<dim>(laws_.law(i), u.data()).opening <
               last * (1. - at_strength)))
        continue;
      points.push_back(i);
      owned += i < problem_.n_owned;
    }
    const double all = double(communicator_.sum_integer(owned));
    for (const std::size_t i : points) {
      // a triangle above the secant
      const double strength =
          problem_.strength_factor[i] * laws_.law(i).law->strength();
      const double scale = laws_.opening_scale(i);
      const bool opens = iterate_.activated[i] == LoadStepIterate<dim>::opened;
      laws_.held(i).opening =
          laws_.history(i).opening +
          std::clamp(2. * dissipation / (all * problem_.weight[i] * strength),
                     opens ? least_opening * scale : 0., scale / 2.);
    }
  }

  template <int dim>
  auto PathLaws<dim>::dissipated(const double s) const -> Dissipated
  {
    std::vector<double> terms(2 * problem_.n_owned);
    for (std::size_t i = 0; i < problem_.n_owned; ++i) {
      terms[i] = dissipation_of(i, s);
      terms[problem_.n_owned + i] = terms[i] * terms[i];
    }
    const auto sums = communicator_.sums(terms.data(), 2, problem_.n_owned);
    return {sums[0], sums[1] > 0. ? sums[0] * sums[0] / sums[1] : 0.};
  }

  template <int dim>
  double PathLaws<dim>::toughness_of_point() const
  {
    std::vector<double> terms(2 * problem_.n_owned, 0.);
    for (std::size_t i = 0; i < problem_.n_owned; ++i) {
      if (!laws_.may_damage(i))
        continue;
      // G/R_max of the point times its R_max
      terms[i] = problem_.weight[i] * laws_.opening_scale(i) *
                 problem_.strength_factor[i] * laws_.law(i).law->strength();
      terms[problem_.n_owned + i] = 1.;
    }
    const auto sums = communicator_.sums(terms.data(), 2, problem_.n_owned);
    return sums[1] > 0. ? sums[0] / sums[1] : 0.;
  }

  template <int dim>
  void PathLaws<dim>::conclude()
  {
    std::vector<char> part(problem_.n_points), closed(problem_.n_points);
    for (std::size_t i = 0; i < problem_.n_points; ++i) {
      part[i] = takes_part(i);
      closed[i] = part[i] && is_closed(i);
    }
    laws_.release();
    for (std::size_t i = 0; i < problem_.n_points; ++i) {
      if (!part[i])
        continue;
      auto &solution = iterate_.solutions[i];
      const Reach last = laws_.history(i);
      solution.damages = false;
      solution.reach = last;
      solution.frozen = FrozenPoint();
      if (closed[i]) {
        solution.frozen.secant = Secant::rigid();
        continue;
      }
      const PointDamage<dim> damage(problem_, i);
      double u[dim];
      for (unsigned int c = 0; c < dim; ++c)
        u[c] =
            problem_.jump_free[i * dim + c] + iterate_.h * solution.velocity[c];
      solution.reach = damage.reach(u);
      solution.frozen.secant = damage.secant(solution.reach);
      solution.damages = grows(last, solution.reach);
    }
  }

  template class PathLaws<2>;
  template class PathLaws<3>;
} // namespace nsfd
