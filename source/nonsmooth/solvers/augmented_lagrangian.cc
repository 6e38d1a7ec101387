#include "augmented_lagrangian.h"
#include "held_supports.h"

#include "core/cost.h"
#include "core/pages_of_zeros.h"
#include "delassus/node_values.h"
#include "linear_algebra/positive_part.h"
#include "nonsmooth/natural_map.h"
#include "nonsmooth/point_tangent.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /// A over R: of what a point carries beyond P_0 so much is left as an error
    constexpr double first_share = 1e-2;
    /// round-off of P - S, which a spring of A = share R makes larger by
    /// 1/share
    constexpr double round_off = 1e-15;
    /// a step of Newton's method is long enough
    constexpr double flat = 0.5;
    /// steps for the natural map that do not halve its error, of the first
    /// ones, and of those between two stages of the method of multipliers
    constexpr unsigned int patience = 4, between_stages = 0;
    /// of the tolerance, what the momenta of the nodes may lack
    constexpr double of_momenta = 1e-2, of_equilibria = 0.1;
    /// of the right-hand side, what a direction may lack: the next one makes it
    /// good, and stiff springs leave few more digits to iterations. With 1e-3
    /// ranks went different ways where a step hardly has one solution.
    constexpr double of_directions = 1e-6;
    /// of springs that are stiffer than the first: then softer ones are taken
    constexpr unsigned int most_of_stage = 10;
    /// a stage that has taken no more than so many steps was not too stiff
    constexpr unsigned int few_of_stage = 3;

    /// of what impulses drift by from one stage to the next
    constexpr double most_stretched = 64.;

    /** @p sum += @p length dx at these points. */
    template <int dim, typename Points>
    void add(const Points &points, const double length,
             const std::vector<double> &dx, std::vector<double> &sum)
    {
      for (const std::size_t i : points)
        for (std::size_t k = i * dim; k < (i + 1) * dim; ++k)
          sum[k] += length * dx[k];
    }

    /** Zeros in @p values, @p size per point, of which @p points may have had
        others. */
    void clear(const std::vector<unsigned int> &points,
               const std::size_t n_points, const std::size_t size,
               std::vector<double> &values)
    {
      if (values.size() != n_points * size) {
        values.assign(n_points * size, 0.);
        release_pages_of_zeros(values);
        return;
      }
      for (const std::size_t i : points)
        std::fill_n(&values[i * size], size, 0.);
    }
  } // namespace

  /** A step from rest does not ask for all digits of each solution. */
  template <int dim>
  bool AugmentedLagrangian<dim>::may_be_rough(const Work &work) const
  {
    return work.from_rest && work.motion.saves_by_rough_solutions();
  }

  /** See NodeMotion::solve(). */
  template <int dim>
  double AugmentedLagrangian<dim>::enough(const Work &work) const
  {
    // momenta of equilibria do not add up over steps
    return (may_be_rough(work) ? of_equilibria : of_momenta) * work.tolerance;
  }

  template <int dim>
  void AugmentedLagrangian<dim>::begin(const Work &work, const Vector &impulse)
  {
    const auto &problem = work.problem;
    const std::size_t n = problem.n_points * dim;
    impulse_ = impulse;
    // of points that do not act they stay without anything
    if (solutions_.size() != problem.n_points) {
      solutions_.assign(problem.n_points, {});
      release_pages_of_zeros(solutions_);
    }
    for (const std::size_t i : problem.acting)
      solutions_[i].reach = work.evaluation.solutions[i].reach;
    velocity_.assign(n, 0.);
    dU_.assign(n, 0.);
    for (Vector *vector : {&compliance_, &dP_, &rest_, &right_side_, &defect_})
      clear(points_, problem.n_points, dim, *vector);
    clear(points_, problem.n_points, dim * dim, tangents_);
    points_ = problem.acting;
    rigid_ = of_nodes;
    if (!work.from_rest) {
      // what is rigid is so beside the stiffness of the bodies as well, which
      // in long steps is far more than the mass that R knows
      rigid_ = std::max(of_nodes,
                        last_share /
                            std::max(1., work.motion.stiffness_over_mass()));
      work.motion.balance(impulse_, NodeMotion::rough);
    }
    return_to(work, iterate(work));
  }

  /** Momenta to round-off, with the present impulses. */
  template <int dim>
  void AugmentedLagrangian<dim>::polish(const Work &work)
  {
    work.motion.balance(impulse_, lost);
    return_to(work, iterate(work));
  }

  template <int dim>
  auto AugmentedLagrangian<dim>::iterate(const Work &work) const -> Iterate
  {
    return {impulse_, work.motion.motion()};
  }

  template <int dim>
  void AugmentedLagrangian<dim>::return_to(const Work &work,
                                           const Iterate &iterate)
  {
    impulse_ = iterate.impulse;
    work.motion.set_motion(iterate.motion, impulse_, velocity_);
  }

  /** A from now on, with springs that are slack at the present impulses. */
  template <int dim>
  void AugmentedLagrangian<dim>::soften(const Work &work, const double share)
  {
    for (const std::size_t i : work.problem.acting)
      for (unsigned int c = 0; c < dim; ++c) {
        rest_[i * dim + c] = impulse_[i * dim + c];
        compliance_[i * dim + c] =
            (work.holds(i) ? 1. : share) * work.evaluation.majorant(i, c);
      }
  }

  /** S of all points. */
  template <int dim>
  void AugmentedLagrangian<dim>::answer(const Work &work, const Vector &U)
  {
    const Charge charge(Cost::laws);
    for (const std::size_t i : work.problem.acting) {
      std::array<double, dim> local;
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t k = i * dim + c;
        local[c] = U[k] - compliance_[k] * rest_[k];
      }
      solutions_[i] =
          solve_point<dim>(work.problem, i, local, compliance_[i * dim],
                           compliance_[i * dim + 1], solutions_[i].reach);
    }
  }

  /** |P - S|_R, and |P - P_0|_R, over |P|_R. */
  template <int dim>
  auto AugmentedLagrangian<dim>::errors(const Work &work) -> Errors
  {
    const std::size_t n = owned_acting(work.problem);
    Vector terms(3 * n, 0.);
    for (std::size_t a = 0; a < n; ++a)
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t i = work.problem.acting[a];
        // what its spring makes of the last bit of U is no defect of a support
        const double R = work.evaluation.majorant(i, c),
                     P = impulse_[i * dim + c],
                     defect =
                         work.holds(i)
                             ? left_of_support(work.problem, velocity_, R, i, c)
                             : P - solutions_[i].impulse[c],
                     shift = P - rest_[i * dim + c];
        terms[a] += R * P * P;
        terms[n + a] += R * defect * defect;
        terms[2 * n + a] += R * shift * shift;
      }
    const auto sums = work.delassus.communicator().sums(terms.data(), 3, n);
    scale_ = std::sqrt(sums[0]) + work.evaluation.floor();
    return {relative_natural_map(std::sqrt(sums[1]), scale_),
            relative_natural_map(std::sqrt(sums[2]), scale_)};
  }

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

  /** dU . (P + length dP - S), at the last answers. */
  template <int dim>
  double AugmentedLagrangian<dim>::slope(const Work &work,
                                         const double length) const
  {
    const std::size_t n = owned_acting(work.problem);
    Vector terms(n, 0.);
    for (std::size_t a = 0; a < n; ++a)
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t i = work.problem.acting[a], k = i * dim + c;
        if (work.holds(i))
          continue; // it does not move
        terms[a] +=
            dU_[k] * (impulse_[k] + length * dP_[k] - solutions_[i].impulse[c]);
      }
    return work.delassus.communicator().sum(terms.data(), n);
  }

  template <int dim>
  void AugmentedLagrangian<dim>::set_right_side(const Work &work)
  {
    for (const std::size_t i : work.problem.acting)
      for (unsigned int c = 0; c < dim; ++c)
        right_side_[i * dim + c] =
            solutions_[i].impulse[c] - impulse_[i * dim + c];
  }

  /** Downhill; false where there is no such system. Collective. */
  template <int dim>
  bool AugmentedLagrangian<dim>::find_direction(const Work &work)
  {
    ++work.report.newton;
    set_right_side(work);
    copy_of_points<dim>(work.problem.acting, right_side_, defect_);
    const auto solved = [&](const bool symmetric) {
      const double tolerance = work.from_rest ? 0. : enough(work),
                   share = work.from_rest ? 0. : of_directions;
      return work.motion.solve(tangents_, symmetric, right_side_,
                               {tolerance, share, defect_}, dP_, dU_) &&
             slope(work, 0.) <= 0.;
    };
    const bool symmetric = differentiate(work);
    if (symmetric)
      symmetrise(work, false);
    if (work.from_rest)
      hold_supports(work.problem, work.evaluation, velocity_, tangents_,
                    right_side_);
    if (solved(symmetric))
      return true;
    symmetrise(work, true);
    return solved(true);
  }

  /** Along the direction, until the slope is a part of what it was. */
  template <int dim>
  void AugmentedLagrangian<dim>::advance(const Work &work)
  {
    const double start = -slope(work, 0.);
    double length = 1., low = 0., high = 1.;
    const auto try_length = [&] {
      copy_of_points<dim>(work.problem.acting, velocity_, moved_);
      add<dim>(work.problem.acting, length, dU_, moved_);
      answer(work, moved_);
    };
    try_length();
    double value = slope(work, length), at_low = -start, at_high = value;
    if (value > flat * start)
      ++work.report.line_searches;
    for (unsigned int k = 0; std::abs(value) > flat * start && k < 40; ++k) {
      if (k == 0 && value < 0.)
        break; // the end of the direction
      length = low - at_low * (high - low) / (at_high - at_low);
      if (!(length > low && length < high) || k % 3 == 2)
        length = 0.5 * (low + high);
      try_length();
      value = slope(work, length);
      (value < 0. ? low : high) = length;
      (value < 0. ? at_low : at_high) = value;
    }
    add<dim>(work.problem.acting, length, dP_, impulse_);
    for (const std::size_t i : work.problem.acting)
      if (work.holds(i))
        std::copy_n(impulse_.begin() + long(i * dim), dim,
                    rest_.begin() + long(i * dim));
    work.motion.move(length, impulse_, velocity_);
  }

  template <int dim>
  SolverReport
  AugmentedLagrangian<dim>::solve(const OneStepProblem<dim> &problem,
                                  DelassusOperator<dim> &delassus, const double,
                                  const SolverControl &control, Vector &impulse,
                                  LawEvaluation<dim> &evaluation)
  {
    SolverReport report;
    const double tolerance = control.tolerance;
    NodeMotion &motion =
        own_motion_ ? *own_motion_
                    : dynamic_cast<VelocitySolver &>(delassus).motion();
    const unsigned int most = control.iterations_or(80);
    const bool from_rest = problem.free_motion == FreeVelocity::unknown;
    const Work work{problem,   delassus, motion, evaluation,
                    tolerance, most,     report, from_rest};
    const bool own = !motion.is_on(); // U_free is known, and w the rest
    if (own)
      motion.start({}, {}, problem.free_velocity);
    begin(work, impulse);
    double share = first_share;
    const auto judge = [&] {
      if (!work.from_rest)
        polish(work); // momenta that are lost add up over steps
      judge_velocities(work);
      return evaluation.error <= tolerance;
    };
    bool solved = false;
    for (unsigned int k = 0; k < 2 && !solved && jump(work, patience); ++k)
      solved = judge(); // anew where round-off was left
    Iterate start;      // of a stage
    struct {
      Iterate iterate;
      double error = std::numeric_limits<double>::infinity();
    } nearest; // of the full steps between stages
    if (!solved) {
      if (!work.from_rest)
        polish(work);
      start = iterate(work);
      report.switches.push_back("multipliers");
      soften(work, share);
      answer(work, velocity_);
    }
    // a share over the one before
    const double smallest = work.from_rest ? 1e-2 : 0.1;
    double smaller = smallest;
    // Points that stay closed round a node can share what they carry in many
    // ways, and the springs, at their stiffest, let them come to the right one
    // at a constant rate: P_0 is taken ahead on this way, farther and farther.
    double stretch = 1., before = std::numeric_limits<double>::infinity();
    Vector shift;
    unsigned int taken = 0;
    while (!solved && report.newton < most) {
      if (!find_direction(work))
        break;
      advance(work);
      const Errors errors = this->errors(work);
      const double left = share * errors.shift;
      double ahead = 0.;
      if (errors.defect <= std::max(0.1 * std::max(tolerance, left),
                                    work.from_rest ? round_off / share : 0.)) {
        if (taken <= few_of_stage)
          smaller = std::max(smallest, 0.1 * smaller);
        taken = 0;
        start = iterate(work);
        const bool drifts =
            work.from_rest && share == last_share && left > 0.5 * before;
        stretch = drifts ? std::min(2. * stretch, most_stretched) : 1.;
        before = left;
        shift = impulse_;
        add<dim>(problem.acting, -1., rest_, shift);
        // what is left may be digits, which stiff springs do not show
        const bool last = left <= 0.1 * tolerance;
        const bool jumps = work.from_rest || !last;
        solved = (!jumps ||
                  jump(work, work.from_rest ? patience : between_stages)) &&
                 judge();
        if (!solved && jumps) {
          if (work.from_rest && evaluation.error < nearest.error)
            nearest = {iterate(work), evaluation.error};
          return_to(work, start);
        }
        if (work.from_rest && last)
          break;
        // stiff springs hide the last digits, softer ones show them
        if (!solved && last) {
          if (share == first_share)
            break;
          return_to(work, start);
          share = std::min(10. * share, first_share);
        }
        if (!last)
          share = std::max(last_share, smaller * share);
        ahead = stretch - 1.;
      } else if (++taken > most_of_stage && share < first_share) {
        taken = 0;
        return_to(work, start);
        share = std::min(10. * share, first_share);
        smaller = std::min(10. * smaller, 1.);
      } else
        continue;
      soften(work, share);
      if (ahead > 0.)
        add<dim>(problem.acting, ahead, shift, rest_);
      answer(work, velocity_);
    }
    report.converged = solved || judge();
    if (!report.converged && nearest.error < evaluation.error) {
      return_to(work, nearest.iterate);
      report.converged = judge();
    }
    if (report.converged && !work.from_rest)
      hold_rows(work, control.row_energy);
    impulse = impulse_;
    report.residual = evaluation.error;
    if (own)
      motion.cancel();
    return report;
  }

  template class AugmentedLagrangian<2>;
  template class AugmentedLagrangian<3>;
} // namespace nsfd
