#include "node_jacobi.h"

#include "point_nodes.h"

#include "linear_algebra/dense_lu.h"
#include "linear_algebra/small_inverse.h"
#include "linear_algebra/sparse_rows.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  void NodeJacobi<dim>::set_diagonal(const JoinedMatrix<dim> &matrix)
  {
    const std::size_t width = size_ * size_;
    diagonal_ = matrix.diagonal_blocks();
    inverse_ = diagonal_;
    for (std::size_t first = 0; first < inverse_.size(); first += width)
      invert_in_place<dim>(&inverse_[first], size_, size_, 0.,
                           [](const std::size_t) {});
  }

  /** Of what points here see, without nodes that other ranks see too.
      Collective. */
  template <int dim>
  NodeClusters NodeJacobi<dim>::clusters_of(const JoinedMatrix<dim> &matrix)
  {
    const auto &sights = matrix.sights_;
    auto &at_nodes = matrix.shared_.values;
    const std::size_t n_own = std::size_t(matrix.n_own_);
    std::fill(at_nodes.begin(), at_nodes.end(), 0.);
    for (const auto &entry : sights.entries)
      if (std::size_t(entry.block) >= n_own)
        at_nodes[std::size_t(entry.block) * size_] = 1.;
    std::vector<double> own;
    matrix.return_ghosts(own);
    std::vector<char> excluded(n_own + matrix.ghosts_.size(), 1);
    for (std::size_t r = 0; r < n_own; ++r)
      excluded[r] = own[r * size_] > 0.;
    std::vector<int> nodes;
    return NodeClusters(
        excluded.size(), size_, sights.first.size() - 1,
        [&](const std::size_t i) -> const std::vector<int> & {
          nodes.clear();
          for (std::size_t k = sights.first[i]; k < sights.first[i + 1]; ++k)
            nodes.push_back(sights.entries[k].block);
          return nodes;
        },
        excluded);
  }

  /** Those whose springs have changed. False: one has no inverse. */
  template <int dim>
  bool NodeJacobi<dim>::invert_clusters(const JoinedMatrix<dim> &matrix,
                                        const std::vector<double> &springs,
                                        const bool general)
  {
    const bool known =
        springs_.size() == springs.size() && of_general_ == general;
    const auto differs = [&](const std::size_t i) {
      const auto first = springs.begin() + long(i * dim * dim);
      return !std::equal(first, first + dim * dim,
                         springs_.begin() + long(i * dim * dim));
    };
    bool positive = true;
    std::vector<double> unit;
    for (auto &cluster : clusters_.clusters) {
      if (known &&
          std::none_of(cluster.points.begin(), cluster.points.end(), differs))
        continue;
      const std::size_t n = cluster.nodes.size() * size_;
      auto &a = cluster.inverse;
      a.clear();
      for (const std::size_t i : cluster.points)
        matrix.sights_.for_spring(
            i, &springs[i * dim * dim], size_,
            [&](const auto &row, const auto &column, const double *product) {
              a.resize(n * n, 0.);
              const std::size_t first =
                                    std::size_t(clusters_.place[row.block]) *
                                    size_,
                                other =
                                    std::size_t(clusters_.place[column.block]) *
                                    size_;
              for (unsigned int k = 0; k < size_; ++k)
                for (unsigned int l = 0; l < size_; ++l)
                  for (unsigned int d = 0; d < dim; ++d)
                    a[(first + k) * n + other + l] +=
                        row.own[d * size_ + k] * product[d * size_ + l];
            });
      if (a.empty())
        continue; // no springs
      for (std::size_t b = 0; b < cluster.nodes.size(); ++b)
        for (unsigned int k = 0; k < size_; ++k)
          for (unsigned int l = 0; l < size_; ++l)
            a[(b * size_ + k) * n + b * size_ + l] +=
                diagonal_[(std::size_t(cluster.nodes[b]) * size_ + k) * size_ +
                          l];
      if (!general) {
        invert_in_place<NodeClusters::largest>(
            a.data(), n, n, 0., [&](const std::size_t) { positive = false; });
        continue;
      }
      DenseLU lu;
      lu.reinit(int(n));
      for (std::size_t k = 0; k < n; ++k)
        std::copy_n(&a[k * n], n, lu.row(int(k)));
      positive = positive && lu.factorise();
      for (std::size_t l = 0; positive && l < n; ++l) {
        unit.assign(n, 0.);
        unit[l] = 1.;
        lu.solve(unit.data());
        for (std::size_t k = 0; k < n; ++k)
          a[k * n + l] = unit[k];
      }
    }
    return positive;
  }

  template <int dim>
  bool NodeJacobi<dim>::prepare(const JoinedMatrix<dim> &matrix,
                                const double *springs, const bool general)
  {
    if (!placed_) {
      size_ = matrix.size_;
      set_diagonal(matrix);
      clustered_ = false;
      placed_ = true;
      by_vertex_ = false;
      springs_.clear();
    }
    if (springs && !clustered_) {
      clustered_ = true;
      clusters_ = clusters_of(matrix);
      const auto &covers = clusters_.covers;
      by_vertex_ = !communicator_.any(
          std::any_of(covers.begin(), covers.end(),
                      [](const char covered) { return !covered; }));
    }
    factor_.reset();
    general_.reset();
    stiffened_.clear();
    const std::vector<double> present(
        springs,
        springs + (springs ? clusters_.of_point.size() * dim * dim : 0));
    bool done = !springs || invert_clusters(matrix, present, general);
    if (springs && !by_vertex_)
      done = factorise(matrix, present, general) && done;
    springs_ = present;
    of_general_ = general;
    if (!communicator_.any(!done))
      return true;
    placed_ = false;
    return false;
  }

  /** B of the nodes at points with springs that are in no cluster. */
  template <int dim>
  bool NodeJacobi<dim>::factorise(const JoinedMatrix<dim> &matrix,
                                  const std::vector<double> &springs,
                                  const bool general)
  {
    std::vector<double> others(springs.size(), 0.);
    for (std::size_t i = 0; i < clusters_.covers.size(); ++i)
      for (unsigned int c = 0; c < dim && !clusters_.covers[i]; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          // rows are the columns of SparseLU
          others[(i * dim + c) * dim + d] =
              springs[general ? (i * dim + d) * dim + c
                              : (i * dim + c) * dim + d];
    PointNodes<dim> nodes;
    nodes.number(matrix, others);
    stiffened_ = nodes.unknowns();
    b_.resize(stiffened_.size());
    x_.resize(stiffened_.size());
    if (nodes.none())
      return true;
    rows_ = nodes.rows(matrix, diagonal_, others);
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
    double part[NodeClusters::largest];
    for (const auto &cluster : clusters_.clusters) {
      if (springs_.empty() || cluster.inverse.empty())
        continue;
      const std::size_t n = cluster.nodes.size() * size_;
      for (std::size_t k = 0; k < n; ++k)
        part[k] = r[std::size_t(cluster.nodes[k / size_]) * size_ + k % size_];
      for (std::size_t k = 0; k < n; ++k) {
        const double *row = &cluster.inverse[k * n];
        double sum = 0.;
        for (std::size_t l = 0; l < n; ++l)
          sum += row[l] * part[l];
        z[std::size_t(cluster.nodes[k / size_]) * size_ + k % size_] = sum;
      }
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
