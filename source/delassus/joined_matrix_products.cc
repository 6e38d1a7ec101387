#include "joined_matrix.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  void JoinedMatrix<dim>::fetch_ghosts(const std::vector<double> &own) const
  {
    const auto n = std::size_t(n_own_) * size_;
    std::copy_n(own.begin(), n, shared_.values.begin());
    shared_.exchange.fetch(shared_.values.data(), shared_.values.data() + n);
  }

  template <int dim>
  void JoinedMatrix<dim>::return_ghosts(std::vector<double> &own) const
  {
    const auto n = std::size_t(n_own_) * size_;
    shared_.exchange.start_add_back(shared_.values.data() + n);
    shared_.exchange.finish_add_back(shared_.values.data());
    own.assign(shared_.values.begin(), shared_.values.begin() + long(n));
  }

  template <int dim>
  void JoinedMatrix<dim>::impulse(const double *P,
                                  std::vector<double> &own) const
  {
    std::fill(shared_.values.begin(), shared_.values.end(), 0.);
    for (std::size_t i = 0; i < points_.n_points; ++i)
      for (std::size_t k = sights_.first[i]; k < sights_.first[i + 1]; ++k) {
        const Entry &entry = sights_.entries[k];
        double *out = &shared_.values[std::size_t(entry.block) * size_];
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int c = 0; c < size_; ++c)
            out[c] += entry.own[d * size_ + c] * P[i * dim + d];
      }
    return_ghosts(own);
  }

  template <int dim>
  void JoinedMatrix<dim>::velocity(const std::vector<double> &x,
                                   double *U) const
  {
    fetch_ghosts(x);
    std::fill(U, U + points_.n_points * dim, 0.);
    for (std::size_t i = 0; i < points_.n_points; ++i)
      for (std::size_t k = sights_.first[i]; k < sights_.first[i + 1]; ++k) {
        const Entry &entry = sights_.entries[k];
        const double *in = &shared_.values[std::size_t(entry.block) * size_];
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int c = 0; c < size_; ++c)
            U[i * dim + d] += entry.all[d * size_ + c] * in[c];
      }
  }

  namespace
  {
    /** y = A x, A of blocks of @p size unknowns. */
    template <unsigned int size>
    void multiply_blocks(const std::vector<std::size_t> &first,
                         const std::vector<int> &column, const double *values,
                         const double *x, double *y)
    {
      for (std::size_t r = 0; r + 1 < first.size(); ++r)
        for (unsigned int k = 0; k < size; ++k) {
          double sums[size] = {};
          for (std::size_t c = first[r]; c < first[r + 1]; ++c) {
            const double *in = x + std::size_t(column[c]) * size;
            for (unsigned int l = 0; l < size; ++l)
              sums[l] += *values++ * in[l];
          }
          double sum = sums[0];
          for (unsigned int l = 1; l < size; ++l)
            sum += sums[l];
          y[r * size + k] = sum;
        }
    }
  } // namespace

  template <int dim>
  void JoinedMatrix<dim>::apply(const Operator op, const std::vector<double> &x,
                                std::vector<double> &y) const
  {
    if (by_bodies_.is_used()) {
      fetch_ghosts(x);
      by_bodies_.apply(op == Operator::mass        ? &BodyClass::mass
                       : op == Operator::stiffness ? &BodyClass::stiffness
                                                   : &BodyClass::damping,
                       std::vector<double>(shared_.values), shared_.values);
      return return_ghosts(y);
    }
    const auto &values = op == Operator::mass        ? operators_.mass
                         : op == Operator::stiffness ? operators_.stiffness
                                                     : operators_.damping;
    if (values.empty()) {
      y.assign(x.size(), 0.);
      return;
    }
    fetch_ghosts(x);
    multiply(values, std::vector<double>(shared_.values).data());
    return_ghosts(y);
  }

  /** Into shared_.values. */
  template <int dim>
  void JoinedMatrix<dim>::multiply(const std::vector<double> &values,
                                   const double *x) const
  {
    if (size_ == 1)
      multiply_blocks<1>(pattern_.first, pattern_.column, values.data(), x,
                         shared_.values.data());
    else
      multiply_blocks<dim>(pattern_.first, pattern_.column, values.data(), x,
                           shared_.values.data());
  }

  template <int dim>
  void JoinedMatrix<dim>::apply_step(const double *springs,
                                     const std::vector<double> &x,
                                     std::vector<double> &y) const
  {
    fetch_ghosts(x);
    const std::vector<double> in(shared_.values);
    if (by_bodies_.is_used())
      by_bodies_.apply_step(in, shared_.values);
    else
      multiply(operators_.step, in.data());
    for (std::size_t i = 0; springs && i < points_.n_points; ++i) {
      const std::size_t first = sights_.first[i], end = sights_.first[i + 1];
      if (first == end)
        continue;
      double U[dim] = {}, P[dim] = {};
      for (std::size_t k = first; k < end; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int c = 0; c < size_; ++c)
            U[d] += sights_.entries[k].all[d * size_ + c] *
                    in[std::size_t(sights_.entries[k].block) * size_ + c];
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int e = 0; e < dim; ++e)
          P[d] += springs[(i * dim + d) * dim + e] * U[e];
      for (std::size_t k = first; k < end; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int c = 0; c < size_; ++c)
            shared_.values[std::size_t(sights_.entries[k].block) * size_ + c] +=
                sights_.entries[k].own[d * size_ + c] * P[d];
    }
    return_ghosts(y);
  }

#define INSTANTIATE(dim)                                                       \
  template void JoinedMatrix<dim>::impulse(const double *,                     \
                                           std::vector<double> &) const;       \
  template void JoinedMatrix<dim>::velocity(const std::vector<double> &,       \
                                            double *) const;                   \
  template void JoinedMatrix<dim>::apply(                                      \
      Operator, const std::vector<double> &, std::vector<double> &) const;     \
  template void JoinedMatrix<dim>::apply_step(const double *,                  \
                                              const std::vector<double> &,     \
                                              std::vector<double> &) const

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
