#include "tangent_multigrid.h"

#include <deal.II/base/symmetric_tensor.h>

#include "core/pages_of_zeros.h"
#include "linear_algebra/small_inverse.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  template <int dim>
  TangentMultigrid<dim>::TangentMultigrid(const Communicator &communicator)
      : communicator_(communicator), coarser_(communicator)
  {
  }

  namespace
  {
    /** A block without what its eigenvalues have beyond @p largest. */
    template <int dim>
    void limit_eigenvalues(double *block, const double largest)
    {
      dealii::SymmetricTensor<2, dim> given, rest;
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = c; d < dim; ++d)
          given[c][d] = block[c * dim + d];
      if (!(given.norm() > largest))
        return;
      for (const auto &[value, mode] : dealii::eigenvectors(
               given, dealii::SymmetricTensorEigenvectorMethod::jacobi))
        rest += std::min(value, largest) *
                dealii::symmetrize(outer_product(mode, mode));
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          block[c * dim + d] = rest[c][d];
    }
  } // namespace

  /** T_c of T: no point more than the softest direction of its nodes.
      Collective. */
  template <int dim>
  void TangentMultigrid<dim>::limit(const JoinedMatrix<dim> &matrix,
                                    std::vector<double> &springs)
  {
    const unsigned int size = matrix.size_;
    std::vector<double> own(std::size_t(matrix.n_own_) * size);
    for (std::size_t k = 0; k < own.size(); ++k)
      own[k] = diagonal_[k * size + k % size];
    matrix.fetch_ghosts(own);
    const auto &sights = matrix.sights_;
    for (std::size_t i = 0; i + 1 < sights.first.size(); ++i) {
      double softest = std::numeric_limits<double>::infinity();
      for (std::size_t k = sights.first[i]; k < sights.first[i + 1]; ++k)
        for (unsigned int c = 0; c < size; ++c)
          softest = std::min(
              softest,
              matrix.shared_
                  .values[std::size_t(sights.entries[k].block) * size + c]);
      limit_eigenvalues<dim>(&springs[i * dim * dim], softest);
    }
  }

  template <int dim>
  bool TangentMultigrid<dim>::prepare(JoinedMatrix<dim> &matrix,
                                      const std::vector<double> &springs)
  {
    nodes_.clear();
    diagonal_ = matrix.diagonal_blocks();
    limited_ = springs;
    limit(matrix, limited_);
    release_pages_of_zeros(limited_);
    coarser_.set_matrix(matrix.assemble(limited_.data()));
    // before the hierarchy takes its room
    matrix.matrix_.value = std::vector<double>();
    matrix.joint_.values = std::vector<double>();
    release_freed_memory();
    coarser_.build(matrix.space_->modes, matrix.size_, Multigrid::Finest::left);
    release_freed_memory();
    matrix_ = &matrix;
    invert_diagonal(matrix);
    if (!adjust(matrix, springs))
      return false;
    find_largest_eigenvalue();
    return true;
  }

  template <int dim>
  bool TangentMultigrid<dim>::adjust(const JoinedMatrix<dim> &matrix,
                                     const std::vector<double> &springs)
  {
    // where either has springs
    std::vector<double> either(springs);
    for (std::size_t k = 0; k < either.size(); ++k)
      if (either[k] == 0.)
        either[k] = limited_[k];
    const bool others = nodes_.number(matrix, either);
    if (nodes_.none()) {
      of_limited_ = present_ = Springs();
      factor_.reset();
      return true;
    }
    if (others) {
      set_springs(matrix, limited_, of_limited_);
      local_.resize(nodes_.unknowns().size());
      factor_ = std::make_unique<Cholesky>(communicator_);
    }
    set_springs(matrix, springs, present_);
    return factor_->try_factorise(nodes_.rows(matrix, diagonal_, springs),
                                  others);
  }

  template <int dim>
  void TangentMultigrid<dim>::invert_diagonal(const JoinedMatrix<dim> &matrix)
  {
    const unsigned int size = matrix.size_;
    inverse_ = matrix.diagonal_blocks(limited_.data());
    for (std::size_t first = 0; first < inverse_.size(); first += size * size)
      invert_in_place<dim>(&inverse_[first], size, size, 0.,
                           [](const std::size_t) {});
  }

  /** z = D^-1 r. */
  template <int dim>
  void TangentMultigrid<dim>::scale(const Vector &r, Vector &z) const
  {
    const std::size_t size = inverse_.size() / r.size();
    for (std::size_t k = 0; k < r.size(); ++k) {
      const double *block = &inverse_[k * size], *in = &r[k / size * size];
      double sum = 0.;
      for (std::size_t l = 0; l < size; ++l)
        sum += block[l] * in[l];
      z[k] = sum;
    }
  }

  /** y = A_c x. Collective. */
  template <int dim>
  void TangentMultigrid<dim>::multiply_cycle(const Vector &x, Vector &y)
  {
    matrix_->apply_step(nullptr, x, y);
    add_springs(of_limited_, x, y);
  }

  /** Of D^-1 A_c, by its powers, from below. Collective. */
  template <int dim>
  void TangentMultigrid<dim>::find_largest_eigenvalue()
  {
    constexpr unsigned int rounds = 12;
    const std::size_t n = inverse_.size() / matrix_->size_;
    change_.resize(n);
    product_.resize(n);
    // high frequencies
    for (std::size_t k = 0; k < n; ++k)
      change_[k] =
          std::sin(1. + double((matrix_->space_->first + long(k)) % 1009));
    largest_ = 1.;
    for (unsigned int round = 0; round < rounds; ++round) {
      double sums[2] = {};
      multiply_cycle(change_, product_);
      for (std::size_t k = 0; k < n; ++k)
        sums[0] += change_[k] * change_[k];
      scale(product_, change_);
      for (std::size_t k = 0; k < n; ++k)
        sums[1] += change_[k] * change_[k];
      MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM,
                    communicator_.mpi());
      largest_ = std::sqrt(sums[1] / sums[0]);
      for (double &value : change_)
        value /= largest_;
    }
  }

  /** A Chebyshev polynomial of second degree from x = 0; its residual. */
  template <int dim>
  void TangentMultigrid<dim>::smooth(Vector &residual, Vector &x)
  {
    constexpr double safety = 1.1, range = 10.;
    const double high = safety * largest_, low = high / range,
                 middle = (high + low) / 2., half = (high - low) / 2.,
                 sigma = middle / half, rho = 1. / (2. * sigma - 1. / sigma);
    const std::size_t n = residual.size();
    change_.resize(n);
    product_.resize(n);
    scale(residual, change_);
    for (double &value : change_)
      value /= middle;
    x = change_;
    multiply_cycle(change_, product_);
    for (std::size_t k = 0; k < n; ++k)
      residual[k] -= product_[k];
    scale(residual, product_);
    for (std::size_t k = 0; k < n; ++k)
      x[k] += change_[k] =
          rho / sigma * change_[k] + 2. * rho / half * product_[k];
  }

  /** z = V r. */
  template <int dim>
  void TangentMultigrid<dim>::cycle(const Vector &r, Vector &z)
  {
    const std::size_t n = r.size();
    residual_ = r;
    const auto subtract = [&](const Vector &x) {
      multiply_cycle(x, product_);
      for (std::size_t k = 0; k < n; ++k)
        residual_[k] -= product_[k];
    };
    smooth(residual_, z);
    subtract(Vector(change_));
    Vector more(n);
    coarser_.apply(residual_.data(), more.data());
    for (std::size_t k = 0; k < n; ++k)
      z[k] += more[k];
    subtract(more);
    smooth(residual_, more);
    for (std::size_t k = 0; k < n; ++k)
      z[k] += more[k];
  }

  template <int dim>
  void TangentMultigrid<dim>::set_springs(const JoinedMatrix<dim> &matrix,
                                          const Vector &springs,
                                          Springs &result)
  {
    result.rows = nodes_.rows(matrix, Vector(diagonal_.size(), 0.), springs);
    result.exchange = GhostValues(communicator_, result.rows.first_row,
                                  nodes_.unknowns().size(), result.rows.ghosts);
  }

  /** y += H^T T H x. Collective. */
  template <int dim>
  void TangentMultigrid<dim>::add_springs(const Springs &springs,
                                          const Vector &x, Vector &y)
  {
    const auto &unknowns = nodes_.unknowns();
    if (nodes_.none())
      return;
    const std::size_t n = unknowns.size();
    part_.resize(n + springs.rows.ghosts.size());
    forces_.resize(n);
    for (std::size_t k = 0; k < n; ++k)
      part_[k] = x[unknowns[k]];
    nsfd::multiply(springs.rows, springs.exchange, part_.data(),
                   forces_.data());
    for (std::size_t k = 0; k < n; ++k)
      y[unknowns[k]] += forces_[k];
  }

  template <int dim>
  void TangentMultigrid<dim>::multiply(const Vector &x, Vector &y)
  {
    matrix_->apply_step(nullptr, x, y);
    add_springs(present_, x, y);
  }

  /** B_c x of values at the nodes of points. */
  template <int dim>
  void TangentMultigrid<dim>::multiply_limited(Vector &x)
  {
    const auto &unknowns = nodes_.unknowns();
    const std::size_t n = unknowns.size(), size = matrix_->size_;
    part_.resize(n + of_limited_.rows.ghosts.size());
    std::copy(x.begin(), x.end(), part_.begin());
    nsfd::multiply(of_limited_.rows, of_limited_.exchange, part_.data(),
                   x.data());
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t l = 0; l < size; ++l)
        x[k] += diagonal_[unknowns[k] * size + l] * part_[k / size * size + l];
  }

  template <int dim>
  void TangentMultigrid<dim>::apply(const std::vector<double> &r,
                                    std::vector<double> &z)
  {
    if (!factor_)
      return cycle(r, z);
    const auto &unknowns = nodes_.unknowns();
    const std::size_t n = unknowns.size();
    right_ = r;
    Vector other(n), at_nodes(n);
    for (std::size_t k = 0; k < n; ++k)
      at_nodes[k] = r[unknowns[k]];
    factor_->solve(at_nodes.data(), local_.data());
    other = local_;
    multiply_limited(other);
    for (std::size_t k = 0; k < n; ++k)
      right_[unknowns[k]] = other[k];
    cycle(right_, z);
    for (std::size_t k = 0; k < n; ++k)
      other[k] = z[unknowns[k]];
    multiply_limited(other);
    factor_->solve(other.data(), at_nodes.data());
    for (std::size_t k = 0; k < n; ++k)
      z[unknowns[k]] = at_nodes[k] + local_[k];
  }

  template class TangentMultigrid<2>;
  template class TangentMultigrid<3>;
} // namespace nsfd
