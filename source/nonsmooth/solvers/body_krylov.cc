#include "body_krylov.h"

#include "core/stop_request.h"
#include "linear_algebra/gmres.h"

#include <deal.II/lac/lapack_templates.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    using Vector = std::vector<double>;

    double dot(const Vector &a, const Vector &b)
    {
      double sum = 0.;
      for (std::size_t i = 0; i < a.size(); ++i)
        sum += a[i] * b[i];
      return sum;
    }

    /** y = A x, A dim x dim row-major. */
    void multiply_small(const unsigned int dim, const double *A,
                        const double *x, double *y)
    {
      for (unsigned int r = 0; r < dim; ++r) {
        y[r] = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          y[r] += A[r * dim + c] * x[c];
      }
    }
  } // namespace

  BodyKrylov::BodyKrylov(const unsigned int dim,
                         const std::vector<std::size_t> &first_dof,
                         const std::vector<FaceRows> &faces)
      : dim_(dim), first_dof_(first_dof), faces_(faces),
        soft_(dim, first_dof, faces)
  {
  }

  const Vector &BodyKrylov::cap(const Vector &S, const Vector &resistance)
  {
    const unsigned int n = dim_;
    capped_ = S;
    gain_.assign(S.size(), 0.);
    cap_.assign(S.size() / (n * n), 0.);
    stiff_.clear();
    std::vector<double> A(n * n);
    std::vector<dealii::types::blas_int> pivots(n);
    for (std::size_t i = 0; i < cap_.size(); ++i) {
      const double *s = &S[i * n * n];
      double *G = &gain_[i * n * n];
      cap_[i] = 20. * resistance[i * n];
      for (unsigned int r = 0; r < n; ++r)
        G[r * n + r] = 1.;
      if (std::all_of(s, s + n * n,
                      [&](const double x) { return std::abs(x) <= cap_[i]; }))
        continue;
      stiff_.push_back(i);
      // rows as columns throughout: the transposed system
      for (unsigned int r = 0; r < n; ++r)
        for (unsigned int c = 0; c < n; ++c)
          A[r * n + c] = (r == c ? 1. : 0.) + s[r * n + c] / cap_[i];
      const dealii::types::blas_int m = n;
      dealii::types::blas_int info = 0;
      dealii::getrf(&m, &m, A.data(), &m, pivots.data(), &info);
      dealii::getrs("N", &m, &m, A.data(), &m, pivots.data(), G, &m, &info);
      // I - G = S_c/c without the cancellation of S G
      for (unsigned int r = 0; r < n; ++r)
        for (unsigned int c = 0; c < n; ++c)
          capped_[(i * n + r) * n + c] =
              cap_[i] * ((r == c ? 1. : 0.) - G[r * n + c]);
    }
    return capped_;
  }

  bool BodyKrylov::prepare(const SparseRows &K, const Vector &bodies)
  {
    K_ = &K;
    soft_.build(K, bodies);
    coarse_r_.resize(soft_.size());
    coarse_z_.resize(soft_.size());
    work_.resize(first_dof_.back());
    return coarse_.factorise(soft_.matrix(), true) && invert_bodies();
  }

  bool BodyKrylov::invert_bodies()
  {
    blocks_.clear();
    Vector block;
    std::vector<dealii::types::blas_int> pivots;
    for (std::size_t b = 0; b + 1 < first_dof_.size(); ++b) {
      const int first = int(first_dof_[b]), end = int(first_dof_[b + 1]);
      const dealii::types::blas_int n = end - first;
      const std::size_t offset = blocks_.size(), m = std::size_t(n);
      block.assign(m * m, 0.);
      pivots.resize(m);
      blocks_.resize(offset + m * m, 0.);
      for (int j = first; j < end; ++j) {
        blocks_[offset + std::size_t(j - first) * (m + 1)] = 1.;
        for (int k = K_->start[j]; k < K_->start[j + 1]; ++k)
          if (K_->column[k] >= first && K_->column[k] < end)
            block[std::size_t(j - first) * m + K_->column[k] - first] =
                K_->value[k];
      }
      dealii::types::blas_int info = 0;
      dealii::getrf(&n, &n, block.data(), &n, pivots.data(), &info);
      if (info != 0)
        return false;
      dealii::getrs("N", &n, &n, block.data(), &n, pivots.data(),
                    &blocks_[offset], &n, &info);
    }
    return true;
  }

  void BodyKrylov::add_bodies(const double *r, double *z) const
  {
    const double *column = blocks_.data();
    for (std::size_t b = 0; b + 1 < first_dof_.size(); ++b) {
      const std::size_t first = first_dof_[b], n = first_dof_[b + 1] - first;
      for (std::size_t j = 0; j < n; ++j, column += n)
        for (std::size_t i = 0; i < n; ++i)
          z[first + i] += column[i] * r[first + j];
    }
  }

  void BodyKrylov::multiply(const double *x, double *y) const
  {
    const int n = K_->n_rows();
    std::fill_n(y, n, 0.);
    for (int j = 0; j < n; ++j)
      for (int k = K_->start[j]; k < K_->start[j + 1]; ++k)
        y[K_->column[k]] += K_->value[k] * x[j];
  }

  void BodyKrylov::relative_velocity(const double *x, Vector &U) const
  {
    for (const FaceRows &face : faces_) {
      const std::size_t n = face.dofs.size();
      for (unsigned int k = 0; k < face.count * dim_; ++k) {
        double value = 0.;
        for (std::size_t a = 0; a < n; ++a)
          value += face.rows[k * n + a] * x[face.dofs[a]];
        U[face.first * dim_ + k] = value;
      }
    }
  }

  void BodyKrylov::add_momentum(const Vector &P, double *r) const
  {
    for (const FaceRows &face : faces_) {
      const std::size_t n = face.dofs.size();
      for (unsigned int k = 0; k < face.count * dim_; ++k) {
        const double p = P[face.first * dim_ + k];
        for (std::size_t a = 0; p != 0. && a < n; ++a)
          r[face.dofs[a]] += face.rows[k * n + a] * p;
      }
    }
  }

  /** Both rows; x is followed by the Q of the stiff points. */
  void BodyKrylov::apply(const double *x, double *y)
  {
    const std::size_t n = first_dof_.back();
    multiply(x, y);
    relative_velocity(x, U_);
    std::fill(impulse_.begin(), impulse_.end(), 0.);
    double a[3], b[3], c[3];
    for (std::size_t k = 0; k < stiff_.size(); ++k) {
      const std::size_t i = stiff_[k];
      const double *Q = x + n + k * dim_;
      std::copy_n(Q, dim_, &impulse_[i * dim_]);
      multiply_small(dim_, &capped_[i * dim_ * dim_], &U_[i * dim_], a);
      multiply_small(dim_, &capped_[i * dim_ * dim_], a, b);
      multiply_small(dim_, &gain_[i * dim_ * dim_], Q, c);
      for (unsigned int r = 0; r < dim_; ++r)
        y[n + k * dim_ + r] = b[r] / cap_[i] - c[r];
    }
    add_momentum(impulse_, y);
  }

  void BodyKrylov::precondition(const double *r, double *z)
  {
    const std::size_t n = first_dof_.back();
    soft_.restrict_to(r, coarse_r_.data());
    coarse_.solve(coarse_r_.data(), coarse_z_.data());
    soft_.prolong(coarse_z_.data(), z);
    multiply(z, work_.data());
    for (std::size_t i = 0; i < n; ++i)
      work_[i] = r[i] - work_[i];
    add_bodies(work_.data(), z);
    relative_velocity(z, U_);
    double a[3], b[3];
    for (std::size_t k = 0; k < stiff_.size(); ++k) {
      const std::size_t i = stiff_[k];
      multiply_small(dim_, &capped_[i * dim_ * dim_], &U_[i * dim_], a);
      multiply_small(dim_, &capped_[i * dim_ * dim_], a, b);
      for (unsigned int c = 0; c < dim_; ++c)
        z[n + k * dim_ + c] = b[c] / cap_[i] - r[n + k * dim_ + c];
    }
  }

  unsigned int BodyKrylov::solve(const Vector &b, const Vector &d,
                                 const double tolerance, Vector &x, Vector &P)
  {
    const std::size_t n = first_dof_.back(), size = n + stiff_.size() * dim_;
    U_.resize(d.size());
    impulse_.assign(d.size(), 0.);
    Vector held(d.size()); // G d
    for (std::size_t i = 0; i < cap_.size(); ++i)
      multiply_small(dim_, &gain_[i * dim_ * dim_], &d[i * dim_],
                     &held[i * dim_]);
    Vector all(b);
    all.resize(size, 0.);
    add_momentum(held, all.data());
    for (std::size_t k = 0; k < stiff_.size(); ++k) {
      const std::size_t i = stiff_[k];
      double *right = &all[n + k * dim_];
      multiply_small(dim_, &capped_[i * dim_ * dim_], &held[i * dim_], right);
      for (unsigned int r = 0; r < dim_; ++r)
        right[r] /= cap_[i];
    }
    const auto product = [&](const Vector &in, Vector &out) {
      apply(in.data(), out.data());
    };
    const auto precondition_by = [&](const Vector &in, Vector &out) {
      stop_request::leave_if_due();
      precondition(in.data(), out.data());
    };
    const unsigned int count =
        krylov::gmres(product, precondition_by, dot,
                      {tolerance, most_iterations}, {}, all)
            .iterations;

    x.assign(all.begin(), all.begin() + n);
    relative_velocity(x.data(), U_);
    P = held;
    double a[3];
    for (std::size_t i = 0; i < cap_.size(); ++i) {
      multiply_small(dim_, &capped_[i * dim_ * dim_], &U_[i * dim_], a);
      for (unsigned int r = 0; r < dim_; ++r)
        P[i * dim_ + r] -= a[r];
    }
    for (std::size_t k = 0; k < stiff_.size(); ++k)
      for (unsigned int r = 0; r < dim_; ++r)
        P[stiff_[k] * dim_ + r] -= all[n + k * dim_ + r];
    return count;
  }
} // namespace nsfd
