#include "point_nodes.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  bool PointNodes<dim>::number(const JoinedMatrix<dim> &matrix,
                               const std::vector<double> &springs)
  {
    const auto &communicator = matrix.delassus_.communicator();
    const auto &first = matrix.sights_.first;
    std::vector<char> stiff(first.size() - 1, 0);
    for (std::size_t i = 0; i < stiff.size(); ++i) {
      const auto T = springs.begin() + long(i * dim * dim);
      stiff[i] =
          first[i] != first[i + 1] &&
          std::any_of(T, T + dim * dim, [](const double t) { return t != 0.; });
    }
    if (!communicator.any(stiff != known_))
      return false;
    known_ = std::move(stiff);
    points_.clear();
    const unsigned int size = matrix.size_;
    auto &at_nodes = matrix.shared_.values;
    std::fill(at_nodes.begin(), at_nodes.end(), 0.);
    for (std::size_t i = 0; i < known_.size(); ++i) {
      if (!known_[i])
        continue;
      points_.push_back(i);
      for (std::size_t k = first[i]; k < first[i + 1]; ++k)
        at_nodes[std::size_t(matrix.sights_.entries[k].block) * size] = 1.;
    }
    std::vector<double> own;
    matrix.return_ghosts(own);

    space_ = CoarseSpace();
    space_.per_node = size;
    places_.clear();
    unknowns_.clear();
    for (std::size_t r = 0; r < std::size_t(matrix.n_own_); ++r)
      if (own[r * size] > 0.) {
        places_.push_back(r);
        for (unsigned int c = 0; c < size; ++c)
          unknowns_.push_back(r * size + c);
      }
    space_.n_own = static_cast<long long>(unknowns_.size());
    MPI_Scan(&space_.n_own, &space_.first, 1, MPI_LONG_LONG, MPI_SUM,
             communicator.mpi());
    space_.first -= space_.n_own;
    space_.n_global =
        static_cast<long long>(communicator.sum_integer(space_.n_own));
    // numbers are exact in a double
    for (std::size_t k = 0; k < places_.size(); ++k)
      own[places_[k] * size] =
          double(space_.first + static_cast<long long>(k * size));
    matrix.fetch_ghosts(own);
    numbers_.resize(at_nodes.size() / size);
    for (std::size_t r = 0; r < numbers_.size(); ++r)
      numbers_[r] = static_cast<long long>(at_nodes[r * size]);
    if (!none())
      set_pattern(matrix);
    return true;
  }

  template <int dim>
  void PointNodes<dim>::set_pattern(const JoinedMatrix<dim> &matrix)
  {
    const unsigned int size = matrix.size_;
    const auto &sights = matrix.sights_;
    std::vector<SparseEntry> entries; // in the order of the values
    const auto add = [&](const std::size_t row, const std::size_t column) {
      for (unsigned int k = 0; k < size; ++k)
        for (unsigned int l = 0; l < size; ++l)
          entries.push_back({numbers_[row] + k, numbers_[column] + l, 0.});
    };
    for (const std::size_t r : places_)
      add(r, r);
    for (const std::size_t i : points_)
      for (std::size_t c = sights.first[i]; c < sights.first[i + 1]; ++c)
        for (std::size_t r = sights.first[i]; r < sights.first[i + 1]; ++r)
          add(std::size_t(sights.entries[r].block),
              std::size_t(sights.entries[c].block));
    sums_ = RowSums(matrix.delassus_.communicator(), space_, entries);
  }

  template <int dim>
  const SparseRows &PointNodes<dim>::rows(const JoinedMatrix<dim> &matrix,
                                          const std::vector<double> &diagonal,
                                          const std::vector<double> &springs)
  {
    const unsigned int size = matrix.size_;
    const auto &sights = matrix.sights_;
    values_.clear();
    for (const std::size_t r : places_)
      values_.insert(values_.end(), diagonal.begin() + long(r * size * size),
                     diagonal.begin() + long((r + 1) * size * size));
    for (const std::size_t i : points_) {
      const double *T = &springs[i * dim * dim];
      for (std::size_t c = sights.first[i]; c < sights.first[i + 1]; ++c) {
        const auto &column = sights.entries[c].all;
        double product[dim * dim] = {};
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int e = 0; e < dim; ++e)
            for (unsigned int l = 0; l < size; ++l)
              product[d * size + l] += T[d * dim + e] * column[e * size + l];
        for (std::size_t r = sights.first[i]; r < sights.first[i + 1]; ++r) {
          const auto &row = sights.entries[r].own;
          for (unsigned int k = 0; k < size; ++k)
            for (unsigned int l = 0; l < size; ++l) {
              double value = 0.;
              for (unsigned int d = 0; d < dim; ++d)
                value += row[d * size + k] * product[d * size + l];
              values_.push_back(value);
            }
        }
      }
    }
    return sums_.sum(values_);
  }

  template class PointNodes<2>;
  template class PointNodes<3>;
} // namespace nsfd
