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
    const bool anywhere = work.dynamics.communicator().any(any);
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
    const auto &communicator = work.dynamics.communicator();
    const Vector &P = *work.impulse, &U = work.evaluation.velocity;
    work.dynamics.prepare_preconditioner(compliance_);
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
    if (!communicator.any(!linear) && work.dynamics.inverts())
      tolerance =
          std::min(tolerance, 0.1 * std::min(work.control.tolerance, ratio) /
                                  work.evaluation.error);
    if (!work.dynamics.solve_springs(P.data(), nullptr, rhs_.data(), tolerance,
                                     dP.data())) {
      dP.assign(work.n, 0.);
      return false;
    }
    // rows without compliance are approached by proximal steps
    const auto size = [&](const Vector &r) {
      z_.assign(work.n_owned, 0.);
      for (std::size_t k = 0; k < work.n_owned; ++k)
        if (compliance_[k] >= 0.)
          z_[k] = r[k] * r[k] / majorant(work, k);
      return std::sqrt(communicator.sum(z_.data(), work.n_owned));
    };
    if (!work.dynamics.inverts()) {
      for (std::size_t k = 0; k < work.n; ++k)
        if (compliance_[k] >= 0.)
          rhs_[k] =
              (compliance_[k] + majorant(work, k)) * work.evaluation.defect[k];
      const double goal = tolerance * size(rhs_);
      for (unsigned int round = 0; round < 5; ++round) {
        Ap_.resize(work.n);
        work.dynamics.apply_delassus(dP.data(), Ap_.data());
        r_ = rhs_;
        for (std::size_t k = 0; k < work.n; ++k) {
          Ap_[k] += work.problem.free_velocity[k];
          r_[k] += compliance_[k] * (dP[k] - (*work.impulse)[k]) + Ap_[k] -
                   work.evaluation.velocity[k];
        }
        if (!(size(r_) > goal))
          break;
        ++work.report.krylov;
        p_ = dP;
        work.dynamics.solve_springs(p_.data(), Ap_.data(), r_.data(), 0.1,
                                    dP.data());
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
    const auto &communicator = work.dynamics.communicator();
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
    Ap_.assign(work.n, 0.);
    if (communicator.any(moved))
      work.dynamics.apply_delassus(dP.data(), Ap_.data());
    for (std::size_t k = 0; k < work.n; ++k)
      if (compliance_[k] >= 0.)
        rhs_[k] = -(compliance_[k] + majorant(work, k)) * defect[k] - Ap_[k];

    if (work.inner) {
      z_.assign(work.n, 0.);
      work.report.krylov += work.inner->solve_inner(
          {compliance_, tolerance, 2000, nullptr, nullptr, 0.}, rhs_, z_);
      for (std::size_t k = 0; k < work.n; ++k)
        dP[k] += z_[k];
      return;
    }
    work.dynamics.prepare_preconditioner(compliance_);
    r_ = rhs_;
    z_.assign(work.n, 0.);
    work.dynamics.precondition(r_.data(), z_.data());
    p_ = z_;
    double rz = communicator.dot(r_.data(), z_.data(), work.n_owned);
    const double target = tolerance * tolerance * rz;
    const unsigned int limit = 2000;
    for (unsigned int k = 0; k < limit && rz > target; ++k) {
      work.dynamics.apply_delassus(p_.data(), Ap_.data());
      for (std::size_t j = 0; j < work.n; ++j)
        Ap_[j] = compliance_[j] >= 0. ? Ap_[j] + compliance_[j] * p_[j] : 0.;
      const double pAp = communicator.dot(p_.data(), Ap_.data(), work.n_owned);
      if (!(pAp > 0.))
        break;
      const double alpha = rz / pAp;
      for (std::size_t j = 0; j < work.n; ++j) {
        dP[j] += alpha * p_[j];
        r_[j] -= alpha * Ap_[j];
      }
      work.dynamics.precondition(r_.data(), z_.data());
      const double next = communicator.dot(r_.data(), z_.data(), work.n_owned);
      const double beta = next / rz;
      rz = next;
      for (std::size_t j = 0; j < work.n; ++j)
        p_[j] = z_[j] + beta * p_[j];
      ++work.report.krylov;
    }
  }

  /**
   * GMRES for (I - J (W + shift R - R)) dP = -Phi, preconditioned from the
   * right. Faces that stick all around an edge make W singular, and the
   * system without a shift may have no solution; with a shift, impulses move
   * along the null space until one of these faces lets go.
   */
  template <int dim>
  void DualNewton<dim>::coupled_direction(const Work &work,
                                          const double tolerance,
                                          const double shift, Vector &dP)
  {
    const auto &communicator = work.dynamics.communicator();
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
    work.dynamics.prepare_preconditioner(compliance_);
    const auto precondition = [&](const Vector &in, Vector &out) {
      r_.assign(work.n, 0.);
      for (std::size_t k = 0; k < work.n; ++k)
        if (compliance_[k] >= 0.)
          r_[k] = (compliance_[k] + majorant(work, k)) * in[k];
      out.assign(work.n, 0.);
      work.dynamics.precondition(r_.data(), out.data());
      for (std::size_t k = 0; k < work.n; ++k)
        if (compliance_[k] < 0.)
          out[k] = in[k];
    };
    const auto matrix = [&](const Vector &in, Vector &out) {
      out.resize(work.n);
      Ap_.resize(work.n);
      work.dynamics.apply_delassus(in.data(), Ap_.data());
      for (std::size_t k = 0; k < work.n; ++k)
        Ap_[k] -= (1. - shift) * majorant(work, k) * in[k];
      for (std::size_t i = 0; i < coupled_.size(); ++i)
        for (unsigned int c = 0; c < dim; ++c) {
          const std::size_t k = i * dim + c;
          double value = 0.;
          if (coupled_[i])
            for (unsigned int d = 0; d < dim; ++d)
              value += jacobian_[k * dim + d] * Ap_[i * dim + d];
          else
            value = -slopes_[k] * Ap_[k];
          out[k] = in[k] - value;
        }
    };
    // scale by the square root of the majorant: energies are compared
    Vector scale(work.n);
    for (std::size_t k = 0; k < work.n; ++k)
      scale[k] = majorant(work, k);
    const auto dot = [&](const Vector &a, const Vector &b) {
      p_.resize(work.n_owned);
      for (std::size_t k = 0; k < work.n_owned; ++k)
        p_[k] = scale[k] * a[k] * b[k];
      return communicator.sum(p_.data(), work.n_owned);
    };

    const unsigned int limit = 120;
    std::vector<Vector> V(1), Z;
    V[0] = work.evaluation.defect;
    for (double &value : V[0])
      value = -value;
    const double beta = std::sqrt(dot(V[0], V[0]));
    dP.assign(work.n, 0.);
    if (beta == 0.)
      return;
    for (double &value : V[0])
      value /= beta;
    std::vector<Vector> H;
    Vector g{beta}, cosines, sines;
    unsigned int k = 0;
    for (; k < limit && std::abs(g[k]) > tolerance * beta; ++k) {
      Z.emplace_back();
      precondition(V[k], Z[k]);
      V.emplace_back();
      matrix(Z[k], V[k + 1]);
      H.emplace_back(k + 2);
      for (unsigned int j = 0; j <= k; ++j) {
        H[k][j] = dot(V[k + 1], V[j]);
        for (std::size_t i = 0; i < work.n; ++i)
          V[k + 1][i] -= H[k][j] * V[j][i];
      }
      const double norm = std::sqrt(dot(V[k + 1], V[k + 1]));
      H[k][k + 1] = norm;
      ++work.report.krylov;
      if (norm > 0.)
        for (double &value : V[k + 1])
          value /= norm;
      for (unsigned int j = 0; j < k; ++j) {
        const double a = H[k][j], b = H[k][j + 1];
        H[k][j] = cosines[j] * a + sines[j] * b;
        H[k][j + 1] = -sines[j] * a + cosines[j] * b;
      }
      const double length = std::hypot(H[k][k], norm);
      if (length == 0.)
        break;
      cosines.push_back(H[k][k] / length);
      sines.push_back(norm / length);
      H[k][k] = length;
      g.push_back(-sines[k] * g[k]);
      g[k] *= cosines[k];
      if (norm == 0.) {
        ++k;
        break;
      }
    }
    Vector y(k);
    for (unsigned int i = k; i-- > 0;) {
      y[i] = g[i];
      for (unsigned int j = i + 1; j < k; ++j)
        y[i] -= H[j][i] * y[j];
      y[i] /= H[i][i];
    }
    for (unsigned int j = 0; j < k; ++j)
      for (std::size_t i = 0; i < work.n; ++i)
        dP[i] += y[j] * Z[j][i];
  }

  template class DualNewton<2>;
  template class DualNewton<3>;
} // namespace nsfd
