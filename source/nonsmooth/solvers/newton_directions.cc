#include "dual_newton.h"

#include "nonsmooth/linear_spring.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  template <int dim>
  bool DualNewton<dim>::differentiate(const Work &work, const Vector &impulse)
  {
    const auto &problem = work.problem;
    slopes_.assign(work.n, 0.);
    coupled_.assign(problem.n_points, 0);
    bool any = false;
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      const auto &solution = work.evaluation.solutions[i];
      const double R_N = work.evaluation.majorant(i, 0),
                   R_T = work.evaluation.majorant(i, 1);
      if (const auto *linear = work.evaluation.linear(i)) {
        for (unsigned int c = 0; c < dim; ++c)
          slopes_[i * dim + c] =
              linear->slope * (c == 0 ? linear->normal : linear->tangential);
        continue;
      }
      const auto s =
          frozen_slopes<dim>(problem, i, solution.frozen, solution, R_N, R_T);
      std::copy(s.begin(), s.end(), slopes_.begin() + i * dim);
      if (work.evaluation.is_frozen(i) || !solution.coupled)
        continue;
      // difference quotients of the local solve, friction and damage in it
      coupled_[i] = 1;
      any = true;
      jacobian_.resize(work.n * dim);
      const auto local = work.evaluation.local_velocity(impulse, i);
      double size = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        size = std::max(
            {size, std::abs(local[c]),
             work.evaluation.majorant(i, c) * std::abs(solution.impulse[c])});
      const double step = 1e-7 * size;
      for (unsigned int c = 0; c < dim; ++c) {
        auto moved = local;
        moved[c] += step;
        const double h = moved[c] - local[c];
        const auto other =
            solve_point<dim>(problem, i, moved, R_N, R_T, solution.reach);
        for (unsigned int d = 0; d < dim; ++d)
          jacobian_[(i * dim + d) * dim + c] =
              h > 0. ? (other.impulse[d] - solution.impulse[d]) / h : 0.;
      }
    }
    // the compliance that preconditions either system
    compliance_.resize(work.n);
    for (std::size_t k = 0; k < work.n; ++k)
      compliance_[k] = slopes_[k] > 0.
                           ? std::max(0., 1. / slopes_[k] - majorant(work, k))
                           : -1.;
    // without the difference, of which stiff springs leave nothing
    for (std::size_t k = 0; k < work.n; ++k)
      if (const auto *law = work.evaluation.linear(k / dim))
        if (const LinearSpring spring(problem, *law, k); spring.stiffness > 0.)
          compliance_[k] = spring.compliance();
    const bool anywhere = work.delassus.communicator().any(any);
    if (anywhere)
      jacobian_.resize(work.n * dim);
    return anywhere;
  }

  /**
   * The same step in the velocities of the bodies, where that is possible.
   * With linear laws only, all that is left of the error can go at once.
   */
  template <int dim>
  bool DualNewton<dim>::spring_direction(const Work &work, double tolerance,
                                         Vector &dP)
  {
    const auto &problem = work.problem;
    const auto &communicator = work.delassus.communicator();
    const Vector &P = *work.impulse, &U = work.evaluation.velocity;
    work.delassus.prepare_preconditioner(compliance_);
    // r - U of the laws at hand; that of a linear one is known without the
    // present P and U, whose round-off its stiffness would raise. One such step
    // solves linear laws, a second one what its iterations have left; what is
    // left then is that W and A are not the same to the last digit, and of that
    // only U tells.
    const bool by_law = work.report.newton <= 2;
    rhs_.assign(work.n, 0.);
    bool linear = true;
    double ratio = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < work.n; ++k) {
      const std::size_t i = k / dim;
      const double defect = work.evaluation.defect[k];
      const auto *law = work.evaluation.linear(i);
      linear = linear && (i >= problem.n_owned || law ||
                          problem.kind[i] == PointKind::prescribed);
      if (compliance_[k] < 0.)
        dP[k] = P[k] - defect;
      else if (law && by_law) {
        rhs_[k] = compliance_[k] * P[k] -
                  LinearSpring(problem, *law, k).free_velocity();
        ratio = std::min(ratio, compliance_[k] / majorant(work, k));
      } else
        rhs_[k] = (compliance_[k] + majorant(work, k)) * defect - U[k];
    }
    ratio = communicator.min(ratio);
    // as far as an error of the velocities is, as jumps of the next step, not
    // more than the impulses themselves
    if (!communicator.any(!linear) && work.delassus.inverts())
      tolerance =
          std::min(tolerance, 0.1 * std::min(work.control.tolerance, ratio) /
                                  work.evaluation.error);
    if (!work.delassus.solve_springs(P.data(), nullptr, rhs_.data(), tolerance,
                                     dP.data())) {
      dP.assign(work.n, 0.);
      return false;
    }
    // rows without compliance are approached by proximal steps
    const auto size = [&](const Vector &r) {
      cg_.z.assign(work.n_owned, 0.);
      for (std::size_t k = 0; k < work.n_owned; ++k)
        if (compliance_[k] >= 0.)
          cg_.z[k] = r[k] * r[k] / majorant(work, k);
      return std::sqrt(communicator.sum(cg_.z.data(), work.n_owned));
    };
    if (!work.delassus.inverts()) {
      for (std::size_t k = 0; k < work.n; ++k)
        if (compliance_[k] >= 0.)
          rhs_[k] =
              (compliance_[k] + majorant(work, k)) * work.evaluation.defect[k];
      const double goal = tolerance * size(rhs_);
      for (unsigned int round = 0; round < 5; ++round) {
        cg_.q.resize(work.n);
        work.delassus.apply_delassus(dP.data(), cg_.q.data());
        cg_.r = rhs_;
        for (std::size_t k = 0; k < work.n; ++k) {
          cg_.q[k] += work.problem.free_velocity[k];
          cg_.r[k] += compliance_[k] * (dP[k] - (*work.impulse)[k]) + cg_.q[k] -
                      work.evaluation.velocity[k];
        }
        if (!(size(cg_.r) > goal))
          break;
        ++work.report.krylov;
        cg_.p = dP;
        work.delassus.solve_springs(cg_.p.data(), cg_.q.data(), cg_.r.data(),
                                    0.1, dP.data());
      }
    }
    for (std::size_t k = 0; k < work.n; ++k)
      dP[k] -= (*work.impulse)[k];
    return true;
  }

  /** Conjugate gradients for (W + D) dP = -(D + R) Phi. */
  template <int dim>
  void DualNewton<dim>::symmetric_direction(const Work &work,
                                            const double tolerance, Vector &dP)
  {
    const auto &communicator = work.delassus.communicator();
    const Vector &defect = work.evaluation.defect;
    dP.assign(work.n, 0.);
    if (!work.inner && spring_direction(work, tolerance, dP))
      return;
    rhs_.assign(work.n, 0.);
    bool moved = false;
    for (std::size_t k = 0; k < work.n; ++k)
      if (compliance_[k] < 0. && defect[k] != 0.) {
        dP[k] = -defect[k];
        moved = true;
      }
    cg_.q.assign(work.n, 0.);
    if (communicator.any(moved))
      work.delassus.apply_delassus(dP.data(), cg_.q.data());
    for (std::size_t k = 0; k < work.n; ++k)
      if (compliance_[k] >= 0.)
        rhs_[k] = -(compliance_[k] + majorant(work, k)) * defect[k] - cg_.q[k];

    if (work.inner) {
      cg_.z.assign(work.n, 0.);
      work.report.krylov += work.inner->solve_inner(
          {compliance_, tolerance, 2000, nullptr, nullptr, 0.}, rhs_, cg_.z);
      for (std::size_t k = 0; k < work.n; ++k)
        dP[k] += cg_.z[k];
      return;
    }
    work.delassus.prepare_preconditioner(compliance_);
    cg_.r = rhs_;
    cg_.z.assign(work.n, 0.);
    const auto product = [&](const Vector &in, Vector &out) {
      work.delassus.apply_delassus(in.data(), out.data());
      for (std::size_t k = 0; k < work.n; ++k)
        out[k] = compliance_[k] >= 0. ? out[k] + compliance_[k] * in[k] : 0.;
    };
    const auto precondition = [&](const Vector &in, Vector &out) {
      work.delassus.precondition(in.data(), out.data());
    };
    const auto dot = [&](const Vector &a, const Vector &b) {
      return communicator.dot(a.data(), b.data(), work.n_owned);
    };
    work.report.krylov +=
        krylov::conjugate_gradients(product, precondition, dot,
                                    {tolerance, 2000}, cg_, dP)
            .iterations;
  }

  /**
   * GMRES for (I - J (W + shift R - R)) dP = -Phi, preconditioned from the
   * right. Faces that stick all around an edge make W singular, and the
   * system without a shift may have no solution; with a shift, impulses move
   * along the null space until one of these faces is released.
   */
  template <int dim>
  void DualNewton<dim>::coupled_direction(const Work &work,
                                          const double tolerance,
                                          const double shift, Vector &dP)
  {
    const auto &communicator = work.delassus.communicator();
    if (work.inner) {
      for (std::size_t i = 0; i < coupled_.size(); ++i)
        if (!coupled_[i])
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int d = 0; d < dim; ++d)
              jacobian_[(i * dim + c) * dim + d] =
                  c == d ? -slopes_[i * dim + c] : 0.;
      rhs_ = work.evaluation.defect;
      for (double &value : rhs_)
        value = -value;
      dP.assign(work.n, 0.);
      majorants_.resize(work.n);
      for (std::size_t k = 0; k < work.n; ++k)
        majorants_[k] = majorant(work, k);
      work.report.krylov += work.inner->solve_inner(
          {compliance_, tolerance, 120, &jacobian_, &majorants_, shift}, rhs_,
          dP);
      return;
    }
    work.delassus.prepare_preconditioner(compliance_);
    const auto precondition = [&](const Vector &in, Vector &out) {
      cg_.r.assign(work.n, 0.);
      for (std::size_t k = 0; k < work.n; ++k)
        if (compliance_[k] >= 0.)
          cg_.r[k] = (compliance_[k] + majorant(work, k)) * in[k];
      out.assign(work.n, 0.);
      work.delassus.precondition(cg_.r.data(), out.data());
      for (std::size_t k = 0; k < work.n; ++k)
        if (compliance_[k] < 0.)
          out[k] = in[k];
    };
    const auto matrix = [&](const Vector &in, Vector &out) {
      out.resize(work.n);
      cg_.q.resize(work.n);
      work.delassus.apply_delassus(in.data(), cg_.q.data());
      for (std::size_t k = 0; k < work.n; ++k)
        cg_.q[k] -= (1. - shift) * majorant(work, k) * in[k];
      for (std::size_t i = 0; i < coupled_.size(); ++i)
        for (unsigned int c = 0; c < dim; ++c) {
          const std::size_t k = i * dim + c;
          double value = 0.;
          if (coupled_[i])
            for (unsigned int d = 0; d < dim; ++d)
              value += jacobian_[k * dim + d] * cg_.q[i * dim + d];
          else
            value = -slopes_[k] * cg_.q[k];
          out[k] = in[k] - value;
        }
    };
    // scale by the square root of the majorant: energies are compared
    Vector scale(work.n);
    for (std::size_t k = 0; k < work.n; ++k)
      scale[k] = majorant(work, k);
    const auto dot = [&](const Vector &a, const Vector &b) {
      cg_.p.resize(work.n_owned);
      for (std::size_t k = 0; k < work.n_owned; ++k)
        cg_.p[k] = scale[k] * a[k] * b[k];
      return communicator.sum(cg_.p.data(), work.n_owned);
    };

    dP = work.evaluation.defect;
    for (double &value : dP)
      value = -value;
    krylov::BasisOptions options;
    options.flexible = true;
    options.passes = 1;
    work.report.krylov +=
        krylov::gmres(matrix, precondition, dot, {tolerance, 120}, options, dP)
            .iterations;
  }

  template class DualNewton<2>;
  template class DualNewton<3>;
} // namespace nsfd
