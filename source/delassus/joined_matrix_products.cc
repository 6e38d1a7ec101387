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
    for (const std::size_t i : sights_.points)
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
    for (const std::size_t i : sights_.points)
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
    if (springs && size_ == 1)
      sights_.template multiply<1>(springs, in.data(), shared_.values.data());
    else if (springs)
      sights_.template multiply<dim>(springs, in.data(), shared_.values.data());
    return_ghosts(y);
  }

  template <int dim>
  std::vector<double>
  JoinedMatrix<dim>::diagonal_blocks(const double *springs) const
  {
    const std::size_t entries = size_ * size_, n_own = std::size_t(n_own_);
    std::vector<double> all((n_own + ghosts_.size()) * entries, 0.);
    if (by_bodies_.is_used())
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        const nsfd::Block &from = by_bodies_.step(bodies_.class_of[b]);
        const std::size_t first = bodies_.first_dof[b],
                          n = bodies_.first_dof[b + 1] - first;
        for (unsigned int i = 0; i < n; i += size_)
          for (unsigned int k = 0; k < size_; ++k)
            for (unsigned int l = 0; l < size_; ++l)
              all[std::size_t(block_.own[first + i]) * entries + k * size_ +
                  l] += from(i + k, i + l);
      }
    else
      for (std::size_t r = 0; r < n_own + ghosts_.size(); ++r) {
        if (pattern_.first[r] == pattern_.first[r + 1])
          continue; // a node of another rank that no body here has
        const std::size_t first = place(int(r), int(r));
        for (unsigned int k = 0; k < size_; ++k)
          for (unsigned int l = 0; l < size_; ++l)
            all[r * entries + k * size_ + l] =
                operators_.step[first + k * width(int(r)) + l];
      }
    if (springs)
      sights_.for_springs(
          springs, size_,
          [&](const Entry &row, const Entry &column, const double *product) {
            if (row.block != column.block)
              return;
            double *out = &all[std::size_t(row.block) * entries];
            for (unsigned int d = 0; d < dim; ++d)
              for (unsigned int k = 0; k < size_; ++k)
                for (unsigned int l = 0; l < size_; ++l)
                  out[k * size_ + l] +=
                      row.own[d * size_ + k] * product[d * size_ + l];
          });
    std::vector<double> own;
    std::vector<double> blocks(n_own * entries);
    for (unsigned int l = 0; l < size_; ++l) {
      for (std::size_t k = 0; k < shared_.values.size(); ++k)
        shared_.values[k] = all[k * size_ + l];
      return_ghosts(own);
      for (std::size_t k = 0; k < own.size(); ++k)
        blocks[k * size_ + l] = own[k];
    }
    return blocks;
  }

#define INSTANTIATE(dim)                                                       \
  template void JoinedMatrix<dim>::impulse(const double *,                     \
                                           std::vector<double> &) const;       \
  template void JoinedMatrix<dim>::velocity(const std::vector<double> &,       \
                                            double *) const;                   \
  template void JoinedMatrix<dim>::apply(                                      \
      Operator, const std::vector<double> &, std::vector<double> &) const;     \
  template std::vector<double> JoinedMatrix<dim>::diagonal_blocks(             \
      const double *) const;                                                   \
  template void JoinedMatrix<dim>::apply_step(const double *,                  \
                                              const std::vector<double> &,     \
                                              std::vector<double> &) const

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
