#include "augmented_lagrangian.h"
#include "held_supports.h"

#include <deal.II/base/tensor.h>

#include "delassus/node_values.h"
#include "nonsmooth/point_tangent.h"
#include "nonsmooth/row_work.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /// over A: a law that gives way by less is rigid to machine precision
    constexpr double own_compliance = 1e-11;
    /// what a step of Newton's method leaves where it is near its solution
    constexpr double fast = 0.1;
    /// of the error, what a point has whose vertex is solved by itself
    constexpr double of_elimination = 1e-2;
    /// of the tolerance, of impulses that may stay without any iteration: what
    /// they lack is the same in every step of bodies at rest, and adds up
    constexpr double untouched = 1e-4;
    /// what difference quotients leave of their digits
    constexpr double left_to_differences = 1e-5;
    /// of the momenta, as imbalance() measures it
    constexpr double digits_of_momenta = 1e-14;
    /// each one leaves little of the one before, until round-off is left
    constexpr unsigned int most_row_steps = 6;
  } // namespace

  /**
   * T and the right-hand side without the springs, where they are slack: P + dP
   * = S + J (dU - A dP). What sticks has 1 + J A = 0; it gives way by a small
   * share of A.
   */
  template <int dim>
  void AugmentedLagrangian<dim>::remove_springs(const Work &work)
  {
    for (const std::size_t i : work.problem.acting) {
      if (work.holds(i))
        continue;
      double *T = &tangents_[i * dim * dim], *r = &right_side_[i * dim];
      const bool differences =
          has_difference_quotients(work.problem, i, solutions_[i]);
      double left = differences ? left_to_differences : rigid_;
      // Points that are more than motions: what each of them carries is known
      // from its own compliance alone, as small as that may be.
      bool gives_way = work.from_rest && !differences;
      for (unsigned int c = 0; c < dim; ++c)
        gives_way =
            gives_way &&
            1. - T[c * dim + c] * compliance_[i * dim + c] > own_compliance;
      if (gives_way)
        left = 0.;
      dealii::Tensor<2, dim> block, own;
      dealii::Tensor<1, dim> right;
      for (unsigned int c = 0; c < dim; ++c) {
        right[c] = r[c];
        for (unsigned int d = 0; d < dim; ++d) {
          block[c][d] = (1. - left) * T[c * dim + d];
          own[c][d] =
              (c == d ? 1. : 0.) - block[c][d] * compliance_[i * dim + d];
        }
      }
      const auto inverse = invert(own);
      block = inverse * block;
      right = inverse * right;
      for (unsigned int c = 0; c < dim; ++c) {
        r[c] = right[c];
        for (unsigned int d = 0; d < dim; ++d)
          T[c * dim + d] = block[c][d];
      }
    }
  }

  /** What a point carries and how it moves is lost in the error of a step. */
  template <int dim>
  bool AugmentedLagrangian<dim>::rests(const Work &work,
                                       const std::size_t i) const
  {
    double moves = 0., carries = 0.;
    for (std::size_t k = i * dim; k < (i + 1) * dim; ++k) {
      const double R = work.evaluation.majorant(i, unsigned(k - i * dim));
      moves += velocity_[k] * velocity_[k] / R;
      carries +=
          R * std::max(impulse_[k] * impulse_[k], defect_[k] * defect_[k]);
    }
    const double little = 0.1 * work.tolerance * scale_;
    return std::max(moves, carries) <= little * little;
  }

  /** Points at rest that carry nothing are open or closed by the last digits:
      they stay as they are in the factor. */
  template <int dim>
  void AugmentedLagrangian<dim>::keep_tangents_at_rest(const Work &work)
  {
    const Vector &factored = work.motion.factored();
    if (work.from_rest || factored.size() != tangents_.size())
      return;
    for (const std::size_t i : work.problem.acting)
      if (rests(work, i)) {
        std::copy_n(factored.begin() + long(i * dim * dim), dim * dim,
                    tangents_.begin() + long(i * dim * dim));
        std::copy_n(defect_.begin() + long(i * dim), dim,
                    right_side_.begin() + long(i * dim));
      }
  }

  /** Newton's step for the natural map, in full. Collective. */
  template <int dim>
  bool AugmentedLagrangian<dim>::take_step(const Work &work,
                                           const double tolerance,
                                           const double share)
  {
    ++work.report.newton;
    copy_of_points<dim>(work.problem.acting, right_side_, defect_);
    const bool symmetric = differentiate(work);
    remove_springs(work);
    if (work.from_rest)
      hold_supports(work.problem, work.evaluation, velocity_, tangents_,
                    right_side_);
    if (symmetric)
      symmetrise(work, false);
    keep_tangents_at_rest(work);
    if (!work.motion.solve(tangents_, symmetric, right_side_,
                           {tolerance, share, defect_}, dP_, dU_))
      return false;
    for (const std::size_t i : work.problem.acting)
      for (std::size_t k = i * dim; k < (i + 1) * dim; ++k)
        impulse_[k] += dP_[k];
    work.motion.move(1., impulse_, velocity_);
    return true;
  }

  /**
   * Newton steps that leave no more than @p most of the rows with a prescribed
   * velocity, with momenta to round-off: polish() would move such rows again,
   * by that round-off over the mass of the bodies.
   */
  template <int dim>
  void AugmentedLagrangian<dim>::hold_rows(const Work &work, const double most)
  {
    if (!std::isfinite(most)) // nobody asks
      return;
    const auto left = [&] {
      return row_work(work.problem, work.delassus.communicator(), velocity_,
                      impulse_)
          .energy;
    };
    Iterate best = iterate(work);
    double least = left();
    const double balanced =
        std::max(2. * work.motion.imbalance(), digits_of_momenta);
    bool moved = false;
    for (unsigned int round = 0; round < most_row_steps && least > most;
         ++round) {
      soften(work, 1.);
      answer(work, velocity_);
      set_right_side(work);
      // the difference of impulses has lost what is left of the velocities to
      // the last bit of impulses
      for (const std::size_t i : work.problem.acting)
        for (unsigned int c = 0; c < dim; ++c)
          if (const std::size_t k = i * dim + c;
              work.problem.kind[i] == PointKind::prescribed &&
              (work.problem.mask[i] & (1u << c)))
            right_side_[k] = (work.problem.given_velocity[k] - velocity_[k]) /
                             compliance_[k];
      moved = true;
      if (!take_step(work, lost, 0.))
        break;
      judge_velocities(work);
      // what the first step leaves of the momenta, beside rows that were far
      // off, is made good by the next one
      if (!(work.evaluation.error <= work.tolerance) ||
          !work.motion.balances(enough(work)))
        break;
      if (work.motion.imbalance() > balanced)
        continue;
      const double now = left();
      if (!(now < 0.5 * least))
        break;
      least = now;
      best = iterate(work);
    }
    if (!moved)
      return;
    return_to(work, best);
    judge_velocities(work);
  }

  /**
   * The vertices of what @p error, |P - S|_R over |P|_R, consists of, by
   * themselves, if that leaves less; what is left. Collective.
   */
  template <int dim>
  double AugmentedLagrangian<dim>::eliminate(const Work &work,
                                             const double error)
  {
    auto *const vertices = dynamic_cast<VertexMotion<dim> *>(&work.motion);
    if (!vertices)
      return error;
    std::vector<std::size_t> points;
    for (const std::size_t i : work.problem.acting) {
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        const double defect = impulse_[i * dim + c] - solutions_[i].impulse[c];
        square += work.evaluation.majorant(i, c) * defect * defect;
      }
      if (std::sqrt(square) > of_elimination * error * scale_)
        points.push_back(i);
    }
    const Iterate before = iterate(work);
    Vector w = before.motion;
    if (!elimination_.solve(work.problem, *vertices,
                            work.delassus.communicator(), points, velocity_, w,
                            impulse_))
      return error;
    work.motion.set_motion(w, impulse_, velocity_);
    const auto judge = [&] {
      soften(work, 1.);
      answer(work, velocity_);
      return errors(work).defect;
    };
    const double left = judge();
    if (left < error)
      return left;
    return_to(work, before);
    return judge();
  }

  /**
   * Full steps of Newton's method for the natural map, from which the method of
   * multipliers takes over where more than @p most_idle of them lead nowhere:
   * true if they have solved the problem.
   */
  template <int dim>
  bool AugmentedLagrangian<dim>::jump(const Work &work,
                                      const unsigned int most_idle)
  {
    constexpr double none = std::numeric_limits<double>::infinity();
    // where points change sides at their peaks, a full step loses what is there
    constexpr double near = 1e-6, away = 1e3;
    Iterate best = iterate(work);
    double least = none;
    std::array<double, 2> before{least, least};
    unsigned int idle = 0;
    bool polished = work.motion.balances(lost);
    for (;;) {
      soften(work, 1.);
      answer(work, velocity_);
      double defect = errors(work).defect;
      if (!work.from_rest && work.report.newton > 0 &&
          defect > work.tolerance && defect > fast * before[0])
        defect = eliminate(work, defect);
      if (!work.from_rest && work.report.newton == 0 &&
          defect <= untouched * work.tolerance && !polished) {
        polish(work); // the impulses are right
        polished = true;
        continue;
      }
      // a step from rest balances from its first iteration on, if that is exact
      const bool exact = work.from_rest && !may_be_rough(work);
      const bool balances =
          exact ? work.report.newton > 0 : work.motion.balances(enough(work));
      const double error = balances || exact
                               ? defect
                               : std::max(defect, work.motion.imbalance());
      if (balances &&
          error <= (work.report.newton == 0 ? untouched : 1.) * work.tolerance)
        return true;
      idle = error < 0.5 * least ? 0 : idle + 1;
      if (error < least && (balances || !exact)) {
        least = error;
        best = iterate(work);
      }
      const bool comes_back = std::abs(error - before[1]) < 1e-2 * error;
      before = {error, before[0]};
      const bool leads_away =
          work.from_rest && least < near && error > away * least;
      if (idle > most_idle || comes_back || leads_away ||
          !std::isfinite(error) || work.report.newton >= work.most)
        break;
      set_right_side(work);
      // as far as a step of Newton's method is right; the next one makes good
      // what is left
      if (!take_step(work, enough(work),
                     exact ? 0. : std::min(1e-2, 0.1 * defect)))
        break;
    }
    if (least == none)
      return false;
    return_to(work, best);
    return false;
  }

  /** The natural map at the present velocities and impulses. */
  template <int dim>
  void AugmentedLagrangian<dim>::judge_velocities(const Work &work)
  {
    for (const std::size_t i : work.problem.acting)
      work.evaluation.solutions[i].reach = solutions_[i].reach;
    work.evaluation.velocity = velocity_;
    work.evaluation.update_laws(impulse_);
  }

#define INSTANTIATE(dim)                                                       \
  template void AugmentedLagrangian<dim>::remove_springs(const Work &);        \
  template bool AugmentedLagrangian<dim>::take_step(const Work &, double,      \
                                                    double);                   \
  template void AugmentedLagrangian<dim>::judge_velocities(const Work &);      \
  template bool AugmentedLagrangian<dim>::jump(const Work &, unsigned int);    \
  template void AugmentedLagrangian<dim>::hold_rows(const Work &, double)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
