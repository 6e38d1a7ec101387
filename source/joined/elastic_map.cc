#include "elastic_node.h"

#include "linear_algebra/small_inverse.h"

#include <algorithm>

// The map of ElasticNode: which rows it has, its inverse, and that of another
// set of closed points.

namespace nsfd
{
  namespace
  {
    /// of a row: less is left only where closed points hold each other
    constexpr double independent = 1e-10;
  } // namespace

  /** Rows of closed points last: of these some may follow from others. @return
      their number, with @p row_of dim times the point plus the direction. */
  template <int dim>
  std::size_t ElasticNode<dim>::number_rows(const Step &step,
                                            std::array<int, most> &row_of)
  {
    std::size_t n = 0;
    for (const bool contact : {false, true})
      for (std::size_t k = 0; k < points_.size(); ++k) {
        Placed &point = points_[k];
        if (!contact) {
          point.rows.fill(-1);
          point.follows = false;
          point.own.closed = step.closed[k];
        }
        if (point.held >= 0 || point.is_inside)
          continue;
        for (unsigned int c = 0; c < dim; ++c) {
          const bool is_contact = c == 0 && step.closed[k];
          if (is_contact != contact || (!is_contact && point.own.law.broken))
            continue;
          if (n < most)
            row_of[n] = int(k * dim + c);
          point.rows[c] = int(n++);
        }
      }
    return n;
  }

  /** The inverse of W + 1/(kappa s), of W alone where a point is closed. */
  template <int dim>
  bool ElasticNode<dim>::set_map(const NodeProblem<dim> &node,
                                 const std::vector<double> &frames,
                                 const Step &step)
  {
    std::array<int, most> row_of;
    const std::size_t n = number_rows(step, row_of);
    if (n > most)
      return false;
    size_ = n;
    stride_ = (n + lanes - 1) / lanes * lanes;
    inverse_.assign(n * stride_, 0.);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t k = std::size_t(row_of[i]) / dim;
      const unsigned int c = unsigned(row_of[i]) % dim;
      const Placed &one = points_[k];
      const double *normal = &frames[(node.points[k].point * dim + c) * dim];
      for (std::size_t j = 0; j <= i; ++j) {
        const std::size_t l = std::size_t(row_of[j]) / dim;
        const double *other =
            &frames[(node.points[l].point * dim + unsigned(row_of[j]) % dim) *
                    dim];
        double sum = 0.;
        for (unsigned int s = 0; s < 2; ++s)
          for (unsigned int t = 0; t < 2; ++t) {
            const int g = one.groups[s];
            if (g < 0 || g != points_[l].groups[t])
              continue;
            const Vector &inverse = merged_.inverse_mass()[std::size_t(g)];
            double part = 0.;
            for (unsigned int d = 0; d < dim; ++d)
              part += normal[d] * inverse[d] * other[d];
            sum += s == t ? part : -part;
          }
        inverse_[i * stride_ + j] = inverse_[j * stride_ + i] = sum;
      }
      if (c > 0 || !one.own.closed)
        inverse_[i * stride_ + i] += one.own.flexibility[c];
    }
    bool possible = true;
    invert_in_place<most>(
        inverse_.data(), n, stride_, independent, [&](const std::size_t i) {
          Placed &point = points_[std::size_t(row_of[i]) / dim];
          possible = possible && row_of[i] % dim == 0 && point.own.closed;
          point.rows[0] = -1;
          point.follows = true;
        });
    return possible;
  }

  /**
   * Springs close or open: of W + 1/(kappa s) one number of the diagonal
   * changes, and its inverse by one product. False where that is not all.
   */
  template <int dim>
  bool ElasticNode<dim>::change_map(const Step &step)
  {
    // of a number of the diagonal: less is left of it by others alone
    constexpr double least = 1e-6;
    bool same = true, can_change = n_changes_ < 100;
    for (const Placed &point : points_) {
      const std::size_t k = std::size_t(&point - points_.data());
      if (point.is_inside)
        continue;
      if (point.own.closed != step.closed[k]) {
        same = false;
        can_change = can_change && !point.own.law.broken;
      }
      can_change = can_change && !point.follows;
    }
    if (same || !can_change)
      return same;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      Placed &point = points_[k];
      if (point.is_inside || point.own.closed == step.closed[k])
        continue;
      const auto row = std::size_t(point.rows[0]);
      const double more =
          step.closed[k] ? -point.own.flexibility[0] : point.own.flexibility[0];
      const double left = 1. + more * inverse_[row * stride_ + row];
      if (!(left > least))
        return false;
      Unknowns column;
      std::copy_n(&inverse_[row * stride_], stride_, column.begin());
      for (std::size_t j = 0; j < size_; ++j)
        for (std::size_t l = 0; l < stride_; ++l)
          inverse_[j * stride_ + l] -= more / left * column[j] * column[l];
      point.own.closed = step.closed[k];
      ++n_changes_;
    }
    return true;
  }

  template bool ElasticNode<2>::change_map(const Step &);
  template bool ElasticNode<3>::change_map(const Step &);
  template bool ElasticNode<2>::set_map(const NodeProblem<2> &,
                                        const std::vector<double> &,
                                        const Step &);
  template bool ElasticNode<3>::set_map(const NodeProblem<3> &,
                                        const std::vector<double> &,
                                        const Step &);
} // namespace nsfd
