#include "node_jacobi.h"

#include "linear_algebra/small_inverse.h"
#include "linear_algebra/sparse_rows.h"

#include <algorithm>

namespace nsfd
{
  /** Blocks of M_hat of own nodes. Collective. */
  template <int dim>
  void NodeJacobi<dim>::set_diagonal(const JoinedMatrix<dim> &matrix)
  {
    const std::size_t width = size_ * size_, n_own = std::size_t(matrix.n_own_);
    std::vector<double> all((n_own + matrix.ghosts_.size()) * width, 0.);
    if (matrix.by_bodies_.is_used())
      for (std::size_t b = 0; b < matrix.bodies_.size(); ++b) {
        const Block &from = matrix.by_bodies_.step(matrix.bodies_.class_of[b]);
        const std::size_t first = matrix.bodies_.first_dof[b],
                          n = matrix.bodies_.first_dof[b + 1] - first;
        for (unsigned int i = 0; i < n; i += size_)
          for (unsigned int k = 0; k < size_; ++k)
            for (unsigned int l = 0; l < size_; ++l)
              all[std::size_t(matrix.block_.own[first + i]) * width +
                  k * size_ + l] += from(i + k, i + l);
      }
    else
      for (std::size_t r = 0; r < n_own + matrix.ghosts_.size(); ++r) {
        if (matrix.pattern_.first[r] == matrix.pattern_.first[r + 1])
          continue; // a node of another rank that no body here has
        const std::size_t first = matrix.place(int(r), int(r));
        for (unsigned int k = 0; k < size_; ++k)
          for (unsigned int l = 0; l < size_; ++l)
            all[r * width + k * size_ + l] =
                matrix.operators_.step[first + k * matrix.width(int(r)) + l];
      }
    std::vector<double> own;
    inverse_.resize(n_own * width);
    for (unsigned int l = 0; l < size_; ++l) {
      for (std::size_t k = 0; k < matrix.shared_.values.size(); ++k)
        matrix.shared_.values[k] = all[k * size_ + l];
      matrix.return_ghosts(own);
      for (std::size_t k = 0; k < own.size(); ++k)
        inverse_[k * size_ + l] = own[k];
    }
  }

  /**
   * Nodes at points with @p springs, numbered by themselves in @p space: the
   * place of their first unknown in it, -1 for others, by own node. rows_ is B
   * of these nodes. Collective.
   */
  template <int dim>
  std::vector<long long>
  NodeJacobi<dim>::number_stiffened(const JoinedMatrix<dim> &matrix,
                                    const double *springs, CoarseSpace &space)
  {
    const auto &communicator = matrix.delassus_.communicator();
    auto &at_nodes = matrix.shared_.values;
    std::fill(at_nodes.begin(), at_nodes.end(), 0.);
    matrix.sights_.for_springs(
        springs, size_, [&](const auto &row, const auto &, const double *) {
          at_nodes[std::size_t(row.block) * size_] = 1.;
        });
    std::vector<double> own;
    matrix.return_ghosts(own);

    space = CoarseSpace();
    space.per_node = size_;
    std::vector<long long> place(std::size_t(matrix.n_own_), -1);
    for (std::size_t r = 0; r < place.size(); ++r)
      if (own[r * size_] > 0.) {
        place[r] = space.n_own;
        space.n_own += size_;
      }
    MPI_Scan(&space.n_own, &space.first, 1, MPI_LONG_LONG, MPI_SUM,
             communicator.mpi());
    space.first -= space.n_own;
    space.n_global =
        static_cast<long long>(communicator.sum_integer(space.n_own));
    if (space.n_global == 0)
      return place;
    // numbers are exact in a double
    for (std::size_t r = 0; r < place.size(); ++r)
      own[r * size_] = double(space.first + place[r]);
    matrix.fetch_ghosts(own);
    const auto number = [&](const int block, const unsigned int c) {
      return static_cast<long long>(at_nodes[std::size_t(block) * size_]) + c;
    };
    std::vector<SparseEntry> entries;
    for (std::size_t r = 0; r < place.size(); ++r)
      for (unsigned int k = 0; place[r] >= 0 && k < size_; ++k)
        for (unsigned int l = 0; l < size_; ++l)
          entries.push_back({number(int(r), k), number(int(r), l),
                             inverse_[(r * size_ + k) * size_ + l]});
    matrix.sights_.for_springs(
        springs, size_,
        [&](const auto &row, const auto &column, const double *product) {
          for (unsigned int k = 0; k < size_; ++k)
            for (unsigned int l = 0; l < size_; ++l) {
              double value = 0.;
              for (unsigned int d = 0; d < dim; ++d)
                value += row.own[d * size_ + k] * product[d * size_ + l];
              entries.push_back(
                  {number(row.block, k), number(column.block, l), value});
            }
        });
    rows_ = sum_at_owners(communicator, space, std::move(entries));
    return place;
  }

  template <int dim>
  bool NodeJacobi<dim>::prepare(const JoinedMatrix<dim> &matrix,
                                const double *springs, const bool general)
  {
    size_ = matrix.size_;
    set_diagonal(matrix);
    factor_.reset();
    general_.reset();
    stiffened_.clear();
    if (springs && !factorise(matrix, springs, general))
      return false;
    for (std::size_t first = 0; first < inverse_.size(); first += size_ * size_)
      invert_in_place<dim>(&inverse_[first], size_, size_, 0.,
                           [](const std::size_t) {});
    b_.resize(stiffened_.size());
    x_.resize(stiffened_.size());
    return true;
  }

  /** B of the nodes at points with springs. */
  template <int dim>
  bool NodeJacobi<dim>::factorise(const JoinedMatrix<dim> &matrix,
                                  const double *springs, const bool general)
  {
    std::vector<double> transposed; // rows are the columns of SparseLU
    for (std::size_t i = 0; general && i < matrix.points_.n_points; ++i)
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          transposed.push_back(springs[(i * dim + d) * dim + c]);
    CoarseSpace space;
    const auto place =
        number_stiffened(matrix, general ? transposed.data() : springs, space);
    for (std::size_t r = 0; r < place.size(); ++r)
      if (place[r] >= 0)
        for (unsigned int c = 0; c < size_; ++c)
          stiffened_.push_back(r * size_ + c);
    if (space.n_global == 0)
      return true;
    if (general) {
      general_ = std::make_unique<SparseLU>();
      return general_->factorise(rows_, true);
    }
    factor_ = std::make_unique<Cholesky>(communicator_);
    return factor_->try_factorise(rows_, true);
  }

  template <int dim>
  void NodeJacobi<dim>::apply(const std::vector<double> &r,
                              std::vector<double> &z)
  {
    for (std::size_t k = 0; k < r.size(); ++k) {
      const double *block = &inverse_[k * size_], *in = &r[k / size_ * size_];
      double sum = 0.;
      for (unsigned int l = 0; l < size_; ++l)
        sum += block[l] * in[l];
      z[k] = sum;
    }
    if (!factor_ && !general_)
      return;
    for (std::size_t k = 0; k < stiffened_.size(); ++k)
      b_[k] = r[stiffened_[k]];
    if (factor_)
      factor_->solve(b_.data(), x_.data());
    else
      general_->solve(b_.data(), x_.data());
    for (std::size_t k = 0; k < stiffened_.size(); ++k)
      z[stiffened_[k]] = x_[k];
  }

  template class NodeJacobi<2>;
  template class NodeJacobi<3>;
} // namespace nsfd
