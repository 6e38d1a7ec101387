#include "condensed.h"

#include "linear_algebra/lapack.h"

#include <algorithm>
#include <stdexcept>

namespace nsfd
{
  void CondensedDelassus::clear()
  {
    rows_.clear();
    matrix_.clear();
    D_.clear();
  }

  void CondensedDelassus::reset(const std::size_t n,
                                const std::vector<std::size_t> &rows)
  {
    n_ = n;
    rows_ = rows;
    matrix_.assign(rows.size() * rows.size(), 0.);
    D_.clear();
  }

  void CondensedDelassus::set_column(const std::size_t k,
                                     const double *velocity)
  {
    const std::size_t m = rows_.size();
    for (std::size_t i = 0; i < m; ++i)
      matrix_[k * m + i] = velocity[rows_[i]];
  }

  void CondensedDelassus::apply(const double *impulse, double *velocity) const
  {
    const int m = int(rows_.size()), one = 1;
    const double alpha = 1., beta = 0.;
    in_.resize(m);
    out_.resize(m);
    for (int i = 0; i < m; ++i)
      in_[i] = impulse[rows_[i]];
    dsymv_("L", &m, &alpha, matrix_.data(), &m, in_.data(), &one, &beta,
           out_.data(), &one);
    std::fill(velocity, velocity + n_, 0.);
    for (int i = 0; i < m; ++i)
      velocity[rows_[i]] = out_[i];
  }

  void CondensedDelassus::factor(const std::vector<double> &D)
  {
    if (D == D_)
      return;
    D_ = D;
    part_.clear();
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (D[rows_[i]] >= 0.)
        part_.push_back(i);
    const std::size_t m = rows_.size(), p = part_.size();
    if (p == 0)
      return;
    // rows that nothing moves, between bodies that share the node there
    double largest = 0.;
    for (const std::size_t j : part_)
      largest = std::max(largest, matrix_[j * m + j]);
    const double nothing = 1e-14 * largest;
    if (!(largest > 0.))
      largest = 1.;
    // rows that repeat each other make W singular: the least that round-off
    // needs, doubled until the factor exists
    for (double share = 1e-10;; share *= 100.) {
      factor_.assign(p * p, 0.);
      for (std::size_t j = 0; j < p; ++j) {
        for (std::size_t i = j; i < p; ++i)
          factor_[j * p + i] = matrix_[part_[j] * m + part_[i]];
        double &diagonal = factor_[j * p + j];
        diagonal += std::max(D[rows_[part_[j]]],
                             share * (diagonal > nothing ? diagonal : largest));
      }
      const int size = int(p);
      int info = 0;
      dpotrf_("L", &size, factor_.data(), &size, &info);
      if (info == 0)
        return;
      if (share > 1.)
        throw std::runtime_error(
            "the Delassus matrix has no positive diagonal");
    }
  }

  void CondensedDelassus::solve(const double *r, double *z) const
  {
    std::fill(z, z + n_, 0.);
    const int p = int(part_.size()), one = 1;
    if (p == 0)
      return;
    in_.resize(p);
    for (int i = 0; i < p; ++i)
      in_[i] = r[rows_[part_[i]]];
    int info = 0;
    dpotrs_("L", &p, &one, factor_.data(), &p, in_.data(), &p, &info);
    for (int i = 0; i < p; ++i)
      z[rows_[part_[i]]] = in_[i];
  }
} // namespace nsfd
