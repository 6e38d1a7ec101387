#include "augmented_lagrangian.h"

#include "core/cost.h"
#include "linear_algebra/positive_part.h"
#include "nonsmooth/point_tangent.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /// of R, by which what sticks gives way where U is that of the nodes and
    /// not a difference of large numbers: what is rigid is so beside laws that
    /// have just begun to open
    constexpr double of_nodes = 1e-11;
    /// over A: a law that gives way by less is rigid to machine precision
    constexpr double own_compliance = 1e-11;
    /// what difference quotients leave of their digits
    constexpr double left_to_differences = 1e-5;
  } // namespace

  /** T of all points; false if it is not symmetric. Collective. */
  template <int dim>
  bool AugmentedLagrangian<dim>::differentiate(const Work &work)
  {
    const Charge charge(Cost::laws);
    const auto &problem = work.problem;
    bool symmetric = true;
    for (const std::size_t i : work.problem.acting) {
      const auto &solution = solutions_[i];
      const double A_N = compliance_[i * dim], A_T = compliance_[i * dim + 1];
      double *T = &tangents_[i * dim * dim];
      std::fill_n(T, dim * dim, 0.);
      std::array<double, dim> local;
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t k = i * dim + c;
        local[c] = velocity_[k] - compliance_[k] * rest_[k];
      }
      symmetric &= point_tangent<dim>(problem, i, solution, local, A_N, A_T, T);
    }
    return !work.delassus.communicator().any(!symmetric);
  }

  /** The symmetric part of T, without its negative eigenvalues on request. */
  template <int dim>
  void AugmentedLagrangian<dim>::symmetrise(const Work &work, const bool convex)
  {
    for (const std::size_t i : work.problem.acting) {
      double *T = &tangents_[i * dim * dim];
      if (convex && solutions_[i].coupled)
        take_positive_part<dim>(T);
      else
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < c; ++d)
            T[c * dim + d] = T[d * dim + c] =
                (T[c * dim + d] + T[d * dim + c]) / 2.;
    }
  }

  /**
   * T and the right-hand side without the springs, where they are slack: P + dP
   * = S + J (dU - A dP). What sticks has 1 + J A = 0; it gives way by a small
   * share of A.
   */
  template <int dim>
  void AugmentedLagrangian<dim>::remove_springs(const Work &work)
  {
    for (const std::size_t i : work.problem.acting) {
      double *T = &tangents_[i * dim * dim], *r = &right_side_[i * dim];
      const bool differences =
          has_difference_quotients(work.problem, i, solutions_[i]);
      double left = differences  ? left_to_differences
                    : from_rest_ ? of_nodes
                                 : last_share;
      // Points that are more than motions: what each of them carries is known
      // from its own compliance alone, as small as that may be.
      bool gives_way = from_rest_ && !differences;
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
    if (from_rest_ || factored.size() != tangents_.size())
      return;
    for (const std::size_t i : work.problem.acting)
      if (rests(work, i)) {
        std::copy_n(factored.begin() + long(i * dim * dim), dim * dim,
                    tangents_.begin() + long(i * dim * dim));
        std::copy_n(defect_.begin() + long(i * dim), dim,
                    right_side_.begin() + long(i * dim));
      }
  }

#define INSTANTIATE(dim)                                                       \
  template bool AugmentedLagrangian<dim>::differentiate(const Work &);         \
  template void AugmentedLagrangian<dim>::symmetrise(const Work &, bool);      \
  template void AugmentedLagrangian<dim>::remove_springs(const Work &);        \
  template void AugmentedLagrangian<dim>::keep_tangents_at_rest(const Work &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
