#include "joined_bodies.h"

#include "core/cost.h"
#include "linear_algebra/factor_limits.h"
#include "linear_algebra/positive_part.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  double stiffness_over_mass(const Bodies &bodies, const StepShares &shares,
                             const Communicator &communicator)
  {
    double ratio = 0.;
    for (const BodyClass &body : bodies.classes)
      for (unsigned int i = 0; i < body.n_dofs && !body.rigid; ++i)
        if (body.mass(i, i) > 0.)
          ratio = std::max(ratio, shares.stiffness * body.stiffness(i, i) /
                                      body.mass(i, i));
    return communicator.max(ratio);
  }

  /**
   * Substructures where few nodes may be parted. Conjugate gradients with
   * blocks on the diagonal are cheaper than factors where steps are short and
   * unknowns are many. The step of the matrix is the present one from then on.
   */
  template <int dim>
  auto JoinedBodies<dim>::means() const -> Means
  {
    const StepShares shares = this->shares(this->time_step_, this->theta_);
    matrix().set_step(shares);
    if (means_ != Means::unknown)
      return means_;
    const CoarseSpace &space = conforming_->space();
    const long long n = space.n_global;
    const double stiffest = n <= largest_joined_factor<dim>
                                ? stiffest_beside_factor
                                : stiffest_of_iterations;
    if (space.ties.empty() && finest_.pays())
      means_ = Means::substructures;
    else if (n > smallest_of_iterations && space.ties.empty() &&
             stiffness_over_mass(this->bodies_, shares, this->communicator_) <
                 stiffest)
      means_ = Means::iterations;
    else
      means_ = Means::factors;
    return means_;
  }

  /** @p general: springs that are not symmetric, for iterations and
      substructures alone. */
  template <int dim>
  bool JoinedBodies<dim>::factor_tangent(const std::vector<double> &springs,
                                         const bool general)
  {
    const Charge charge(Cost::preconditioner);
    if (means() == Means::iterations)
      return tangent_.precondition(matrix(), springs, general);
    ++this->counters_.global_factorisations;
    if (means() == Means::substructures)
      return tangent_.factor_border(
          matrix(), this->shares(this->time_step_, this->theta_), springs,
          general);
    if (tangent_.has_cycles()) {
      matrix().set_step(this->shares(this->time_step_, this->theta_));
      return tangent_.precondition_by_cycles(matrix(), springs);
    }
    return tangent_.factor(assemble(springs), springs);
  }

  /**
   * From rows_ to columns_ with any T, preconditioned by the springs that were
   * factored; of what is not symmetric, the positive part where its factor is
   * one of Cholesky.
   */
  template <int dim>
  bool JoinedBodies<dim>::solve_tangent(const std::vector<double> &T,
                                        const bool symmetric, const Goal &goal)
  {
    const bool iterates = means() == Means::iterations,
               condenses = means() == Means::substructures,
               general =
                   !symmetric &&
                   (condenses || (iterates && this->communicator_.size() == 1));
    const auto &points = matrix().parting_points();
    std::vector<double> positive;
    if (!symmetric && !general) {
      positive = T;
      for (const std::size_t i : points)
        take_positive_part<dim>(&positive[i * dim * dim]);
    }
    const std::vector<double> &springs = positive.empty() ? T : positive;
    using Fit = typename TangentFactor<dim>::Fit;
    const bool cycles = !iterates && !condenses && tangent_.has_cycles();
    const auto solved = [&](const bool exact) {
      const Charge charge(Cost::precondition);
      if (exact)
        tangent_.solver().set_product(nullptr);
      else
        tangent_.solver().set_product(
            [this, &T](const std::vector<double> &x, std::vector<double> &y) {
              matrix().apply_step(T.data(), x, y);
            });
      const auto outcome = solve(tangent_.solver(), goal);
      if (cycles && exact && outcome.converged)
        tangent_.note(outcome.iterations, outcome.reduction);
      return outcome.converged;
    };
    if (cycles) {
      matrix().set_step(this->shares(this->time_step_, this->theta_));
      const bool old = tangent_.adjust_cycles(matrix(), springs);
      // conjugate gradients end where tangents soften too much, minimal
      // residuals need not; no other hierarchy does more there
      const auto either = [&] {
        return (symmetric && solved(true)) || solved(false);
      };
      return ((old || factor_tangent(springs, false)) && either()) ||
             (old && tangent_.is_worn() && factor_tangent(springs, false) &&
              either());
    }
    // a point that changes costs about an iteration, a factor some five of
    // them, blocks on the diagonal some two or, vertex by vertex, none
    Fit fit = tangent_.fit(matrix(), springs,
                           condenses   ? tangent_.substructures().worth(5.)
                           : !iterates ? 5
                           : tangent_.is_cheap() ? 0
                                                 : 2);
    if (iterates && symmetric && tangent_.is_general())
      fit = Fit::none; // conjugate gradients need a symmetric one
    if (iterates && symmetric && fit != Fit::none)
      tangent_.iterate_on(matrix(), springs);
    if ((fit != Fit::none &&
         solved(fit == Fit::exact ? symmetric || condenses
                                  : symmetric && iterates)) ||
        (factor_tangent(springs, general) && solved(symmetric || condenses)))
      return true;
    if (!iterates)
      return false;
    means_ = Means::factors_once;
    valid_ = false;
    tangent_.clear();
    return solve_tangent(T, symmetric, goal);
  }

  template <int dim>
  bool JoinedBodies<dim>::solve_linearised(const std::vector<double> &T,
                                           const std::vector<double> &c,
                                           const double tolerance,
                                           std::vector<double> &dP,
                                           std::vector<double> &dU)
  {
    dU.resize(c.size());
    matrix().impulse(c.data(), rows_);
    if (!solve_tangent(T, true, std::max(tight, tolerance)))
      return false;
    matrix().velocity(columns_, dU.data());
    answer_of_points<dim>(matrix().parting_points(), T, c, dU, dP);
    return true;
  }

#define INSTANTIATE(dim)                                                       \
  template auto JoinedBodies<dim>::means() const->Means;                       \
  template bool JoinedBodies<dim>::factor_tangent(const std::vector<double> &, \
                                                  bool);                       \
  template bool JoinedBodies<dim>::solve_tangent(const std::vector<double> &,  \
                                                 bool, const Goal &);          \
  template bool JoinedBodies<dim>::solve_linearised(                           \
      const std::vector<double> &, const std::vector<double> &, double,        \
      std::vector<double> &, std::vector<double> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
