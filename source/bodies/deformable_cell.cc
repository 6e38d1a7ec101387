#include "deformable_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nsfd
{
  namespace
  {
    constexpr double round_off = std::numeric_limits<double>::epsilon();

    double norm(const double *x, const std::size_t n)
    {
      double sum = 0.;
      for (std::size_t i = 0; i < n; ++i)
        sum += x[i] * x[i];
      return std::sqrt(sum);
    }

    /** FS = F S. */
    template <int dim>
    void multiply(const double *F, const Voigt<dim> &S, double *FS)
    {
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int b = 0; b < dim; ++b) {
          double sum = 0.;
          for (unsigned int a = 0; a < dim; ++a)
            sum += F[c * dim + a] * S[voigt_place<dim>(a, b)];
          FS[c * dim + b] = sum;
        }
    }

    /** S and so much of pressure that, by Gershgorin, none is compressed. */
    template <int dim>
    Voigt<dim> without_compression(Voigt<dim> S)
    {
      double pressure = 0.;
      for (unsigned int a = 0; a < dim; ++a) {
        double radius = 0.;
        for (unsigned int b = 0; b < dim; ++b)
          if (b != a)
            radius += std::abs(S[voigt_place<dim>(a, b)]);
        pressure = std::max(pressure, radius - S[a]);
      }
      for (unsigned int a = 0; a < dim; ++a)
        S[a] += pressure;
      return S;
    }

    /** Of A:T:A for symmetric matrices A, by Cholesky's factorization. */
    template <int dim>
    bool positive_definite(const VoigtBlock<dim> &T)
    {
      constexpr unsigned int n = dim * (dim + 1) / 2;
      double L[n][n];
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j <= i; ++j) {
          double rest =
              voigt_weight<dim>(i) * T[i * n + j] * voigt_weight<dim>(j);
          for (unsigned int k = 0; k < j; ++k)
            rest -= L[i][k] * L[j][k];
          if (i == j && !(rest > 0.))
            return false;
          L[i][j] = i == j ? std::sqrt(rest) : rest / L[j][j];
        }
      return true;
    }

    /** Adds @p share of @p at_rest, more where that is not enough, or is it. */
    template <int dim>
    void make_definite(const VoigtBlock<dim> &at_rest, double share,
                       VoigtBlock<dim> &T)
    {
      const VoigtBlock<dim> given = T;
      for (; !positive_definite<dim>(T); share *= 1e3) {
        if (share >= 1.) {
          T = at_rest;
          return;
        }
        for (unsigned int i = 0; i < T.size(); ++i)
          T[i] = given[i] + share * at_rest[i];
      }
    }

    template <int dim>
    void symmetrize(VoigtBlock<dim> &T)
    {
      constexpr unsigned int n = dim * (dim + 1) / 2;
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < i; ++j)
          T[i * n + j] = T[j * n + i] = (T[i * n + j] + T[j * n + i]) / 2.;
    }

    void symmetrize(const unsigned int n, double *K)
    {
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < i; ++j) {
          double &a = K[std::size_t(i) * n + j], &b = K[std::size_t(j) * n + i];
          a = b = (a + b) / 2.;
        }
    }

    /** By Cholesky's factorization, which takes the place of @p A. */
    bool positive_definite(const unsigned int n, double *A)
    {
      for (unsigned int k = 0; k < n; ++k) {
        double *column = A + std::size_t(k) * n;
        if (!(column[k] > 0.))
          return false;
        for (unsigned int j = k + 1; j < n; ++j) {
          const double factor = column[j] / column[k];
          double *other = A + std::size_t(j) * n;
          for (unsigned int i = j; i < n; ++i)
            other[i] -= factor * column[i];
        }
      }
      return true;
    }

    CellMotion motion_of(const FiniteStep &step, const double *end)
    {
      return {step.displacement, end, step.theta, step.time_step, step.history};
    }

    /** L U of rows in a new order, in place; column-major. */
    bool factorize(const unsigned int n, double *A, unsigned int *pivots)
    {
      for (unsigned int k = 0; k < n; ++k) {
        double *column = A + std::size_t(k) * n;
        unsigned int p = k;
        for (unsigned int i = k + 1; i < n; ++i)
          if (std::abs(column[i]) > std::abs(column[p]))
            p = i;
        pivots[k] = p;
        if (!(std::abs(column[p]) > 0.))
          return false;
        if (p != k)
          for (unsigned int j = 0; j < n; ++j)
            std::swap(A[std::size_t(j) * n + k], A[std::size_t(j) * n + p]);
        const double inverse = 1. / column[k];
        for (unsigned int i = k + 1; i < n; ++i)
          column[i] *= inverse;
        for (unsigned int j = k + 1; j < n; ++j) {
          double *other = A + std::size_t(j) * n;
          const double factor = other[k];
          for (unsigned int i = k + 1; i < n; ++i)
            other[i] -= factor * column[i];
        }
      }
      return true;
    }

    void solve_factorized(const unsigned int n, const double *LU,
                          const unsigned int *pivots, double *x)
    {
      for (unsigned int k = 0; k < n; ++k)
        std::swap(x[k], x[pivots[k]]);
      for (unsigned int k = 0; k < n; ++k)
        for (unsigned int i = k + 1; i < n; ++i)
          x[i] -= x[k] * LU[std::size_t(k) * n + i];
      for (unsigned int k = n; k-- > 0;) {
        x[k] /= LU[std::size_t(k) * n + k];
        for (unsigned int i = 0; i < k; ++i)
          x[i] -= x[k] * LU[std::size_t(k) * n + i];
      }
    }
  } // namespace

  /** Of the step of a cell: what is left, and what it is summed from. */
  template <int dim>
  struct DeformableCell<dim>::Balance {
    double size = 0., scale = 0.;

    bool at_round_off() const { return size <= 16. * round_off * scale; }
  };

  template <int dim>
  DeformableCell<dim>::DeformableCell(std::vector<double> JxW,
                                      std::vector<double> gradients,
                                      const double modulus)
      : n_nodes_(gradients.size() / (JxW.size() * dim)), JxW_(std::move(JxW)),
        gradients_(std::move(gradients))
  {
    for (unsigned int i = 0; i < n_nodes_; ++i) {
      double sum = 0.;
      for (std::size_t q = 0; q < JxW_.size(); ++q) {
        const double size = norm(&gradients_[(q * n_nodes_ + i) * dim], dim);
        sum += JxW_[q] * size;
        largest_gradient_ = std::max(largest_gradient_, size);
      }
      strain_force_ = std::max(strain_force_, sum * modulus);
    }
  }

  template <int dim>
  void DeformableCell<dim>::gradient(const unsigned int q, const double *u,
                                     double *F, const double unit) const
  {
    const double *g = &gradients_[std::size_t(q) * n_nodes_ * dim];
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int d = 0; d < dim; ++d)
        F[c * dim + d] = c == d ? unit : 0.;
    // relative to the first node: bodies may have moved far
    for (unsigned int i = 1; i < n_nodes_; ++i)
      for (unsigned int c = 0; c < dim; ++c) {
        const double relative = u[i * dim + c] - u[c];
        for (unsigned int d = 0; d < dim; ++d)
          F[c * dim + d] += relative * g[i * dim + d];
      }
  }

  template <int dim>
  bool DeformableCell<dim>::force(const CellMotion &motion, double *f) const
  {
    std::fill_n(f, n_dofs(), 0.);
    Point point;
    double P[dim * dim];
    for (unsigned int q = 0; q < JxW_.size(); ++q) {
      if (!set_point(q, motion, false, point))
        return false;
      multiply<dim>(point.F, point.S, P);
      const double *g = &gradients_[std::size_t(q) * n_nodes_ * dim];
      for (unsigned int i = 0; i < n_nodes_; ++i)
        for (unsigned int c = 0; c < dim; ++c) {
          double sum = 0.;
          for (unsigned int d = 0; d < dim; ++d)
            sum += P[c * dim + d] * g[i * dim + d];
          f[i * dim + c] += JxW_[q] * sum;
        }
    }
    return true;
  }

  // Column (j, e): F1 changes by e_e (x) g_j, so that C1 changes by twice the
  // symmetric part of (F1^T e_e) (x) g_j and S by T times this.
  template <int dim>
  void DeformableCell<dim>::add_tangent(const unsigned int q,
                                        const double *F_left,
                                        const double *F_right,
                                        const Voigt<dim> &geometric,
                                        const VoigtBlock<dim> &tangent,
                                        double *K) const
  {
    constexpr unsigned int n = dim * (dim + 1) / 2;
    const double *g = &gradients_[std::size_t(q) * n_nodes_ * dim];
    for (unsigned int j = 0; j < n_nodes_; ++j) {
      const double *gj = g + j * dim;
      double pull[dim] = {}; // S g_j / 2: F_mid has half of the change
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          pull[a] += JxW_[q] / 2. * geometric[voigt_place<dim>(a, b)] * gj[b];
      for (unsigned int e = 0; e < dim; ++e) {
        const double *row = F_right + e * dim;
        Voigt<dim> dS{};
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = a; b < dim; ++b) {
            // twice where a != b: such entries count twice
            const double dC = (a == b ? 1. : 2.) * JxW_[q] *
                              (row[a] * gj[b] + row[b] * gj[a]);
            for (unsigned int i = 0; i < n; ++i)
              dS[i] += tangent[i * n + voigt_place<dim>(a, b)] * dC;
          }
        double P[dim * dim];
        multiply<dim>(F_left, dS, P);
        for (unsigned int d = 0; d < dim; ++d)
          P[e * dim + d] += pull[d];
        double *column = K + std::size_t(j * dim + e) * n_dofs();
        for (unsigned int i = 0; i < n_nodes_; ++i)
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int d = 0; d < dim; ++d)
              column[i * dim + c] += P[c * dim + d] * g[i * dim + d];
      }
    }
  }

  template <int dim>
  bool DeformableCell<dim>::tangent(const CellMotion &motion, double *K) const
  {
    std::fill_n(K, std::size_t(n_dofs()) * n_dofs(), 0.);
    Point point;
    for (unsigned int q = 0; q < JxW_.size(); ++q) {
      if (!set_point(q, motion, true, point))
        return false;
      add_tangent(q, point.F, point.F_end, point.turning, point.tangent, K);
    }
    return true;
  }

  template <int dim>
  bool DeformableCell<dim>::add_symmetric(const CellMotion &motion,
                                          const bool definite, double *K) const
  {
    std::fill_n(K, std::size_t(n_dofs()) * n_dofs(), 0.);
    Point point;
    const VoigtBlock<dim> at_rest = tangent_at_rest(motion.theta);
    for (unsigned int q = 0; q < JxW_.size(); ++q) {
      if (!set_point(q, motion, true, point))
        return false;
      symmetrize<dim>(point.tangent);
      if (definite)
        make_definite<dim>(at_rest, least_share(), point.tangent);
      add_tangent(q, point.F, point.F,
                  definite ? without_compression<dim>(point.turning)
                           : point.turning,
                  point.tangent, K);
    }
    symmetrize(n_dofs(), K); // equal in exact arithmetic only
    return true;
  }

  template <int dim>
  bool DeformableCell<dim>::symmetric_tangent(const CellMotion &motion,
                                              double *K) const
  {
    return add_symmetric(motion, true, K);
  }

  template <int dim>
  bool DeformableCell<dim>::step_tangent(const CellMotion &motion,
                                         const double *mass, double *K) const
  {
    constexpr double least_mass = 0.1;
    const unsigned int n = n_dofs();
    // what there is of the other one is definite even where a point has none
    if (!add_symmetric(motion, false, K))
      return add_symmetric(motion, true, K);
    std::vector<double> A(std::size_t(n) * n);
    const double factor = motion.time_step * motion.time_step * motion.theta;
    for (std::size_t i = 0; i < A.size(); ++i)
      A[i] = (1. - least_mass) * mass[i] + factor * K[i];
    return positive_definite(n, A.data()) || add_symmetric(motion, true, K);
  }

  /** The residual at @p v, with the end of the step it leads to. */
  template <int dim>
  bool DeformableCell<dim>::balance(const FiniteStep &step, const double *v,
                                    FiniteScratch &scratch,
                                    Balance &result) const
  {
    const unsigned int n = n_dofs();
    const double h = step.time_step;
    double farthest = 0.;
    for (unsigned int i = 0; i < n; ++i) {
      scratch.end[i] =
          step.displacement[i] +
          h * (step.theta * v[i] + (1. - step.theta) * step.velocity[i]);
      farthest = std::max(farthest, std::abs(scratch.end[i]));
    }
    if (!force(motion_of(step, scratch.end.data()), scratch.force.data()))
      return false;

    double *r = scratch.residual.data();
    double given = 0., heaviest = 0.;
    for (unsigned int i = 0; i < n; ++i) {
      const double gift =
          h * step.load[i] + (step.impulse ? step.impulse[i] : 0.);
      r[i] = h * scratch.force[i] - gift;
      given += gift * gift;
      heaviest = std::max(heaviest, step.mass[std::size_t(i) * n + i]);
    }
    for (unsigned int j = 0; j < n; ++j)
      for (unsigned int i = 0; i < n; ++i)
        r[i] += step.mass[std::size_t(j) * n + i] * (v[j] - step.velocity[j]);
    result.size = norm(r, n);
    // the last term: F and C are sums of numbers of about one, or of what the
    // displacements at the nodes differ by
    result.scale = heaviest * (norm(v, n) + norm(step.velocity, n)) +
                   std::sqrt(given) + h * norm(scratch.force.data(), n) +
                   h * strain_force_ * (1. + farthest * largest_gradient_);
    return std::isfinite(result.scale) && std::isfinite(result.size);
  }

  /** The derivative of balance() at the end of the step it was asked for. */
  template <int dim>
  bool DeformableCell<dim>::factorize_derivative(const FiniteStep &step,
                                                 FiniteScratch &scratch) const
  {
    const unsigned int n = n_dofs();
    double *J = scratch.matrix.data();
    if (!tangent(motion_of(step, scratch.end.data()), J))
      return false;
    const double factor = step.time_step * step.time_step * step.theta;
    for (std::size_t i = 0; i < std::size_t(n) * n; ++i)
      J[i] = step.mass[i] + factor * J[i];
    return factorize(n, J, scratch.pivots.data());
  }

  /** Moves @p v along a Newton step as far as the residual gets smaller. */
  template <int dim>
  bool DeformableCell<dim>::improve(const FiniteStep &step, double *v,
                                    FiniteScratch &scratch, Balance &now) const
  {
    constexpr unsigned int most_bisections = 20;
    const unsigned int n = n_dofs();
    std::copy_n(scratch.residual.begin(), n, scratch.step.begin());
    solve_factorized(n, scratch.matrix.data(), scratch.pivots.data(),
                     scratch.step.data());
    double share = 1.;
    for (unsigned int i = 0; i < most_bisections; ++i, share /= 2.) {
      for (unsigned int k = 0; k < n; ++k)
        scratch.trial[k] = v[k] - share * scratch.step[k];
      Balance next;
      if (balance(step, scratch.trial.data(), scratch, next) &&
          next.size < now.size) {
        now = next;
        std::copy_n(scratch.trial.begin(), n, v);
        return true;
      }
      if (now.at_round_off())
        return false;
    }
    return false;
  }

  template <int dim>
  bool DeformableCell<dim>::iterate(const FiniteStep &step, double *v,
                                    FiniteScratch &scratch) const
  {
    constexpr unsigned int most_steps = 50;
    constexpr double fast = 0.1;
    Balance now;
    if (!balance(step, v, scratch, now))
      return false;
    bool keep = false; // a factorization that served so well serves again
    for (unsigned int i = 0; i < most_steps && now.size > 0.; ++i) {
      if (!keep && !factorize_derivative(step, scratch))
        return false;
      const double before = now.size;
      const bool better = improve(step, v, scratch, now);
      if (!better && now.at_round_off())
        return true;
      if (!better && (!keep || !balance(step, v, scratch, now)))
        return false;
      keep = now.size < fast * before;
    }
    return now.at_round_off();
  }

  template <int dim>
  bool DeformableCell<dim>::solve(const FiniteStep &step, double *v,
                                  FiniteScratch &scratch) const
  {
    const unsigned int n = n_dofs();
    scratch.matrix.resize(std::size_t(n) * n);
    scratch.pivots.resize(n);
    for (auto *vector : {&scratch.end, &scratch.force, &scratch.residual,
                         &scratch.step, &scratch.trial, &scratch.solution})
      vector->resize(n);
    std::copy_n(v, n, scratch.solution.begin());
    if (!iterate(step, scratch.solution.data(), scratch))
      return false;
    std::copy_n(scratch.solution.begin(), n, v);
    return true;
  }

  template class DeformableCell<2>;
  template class DeformableCell<3>;
} // namespace nsfd
