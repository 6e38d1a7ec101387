#include "node_jacobi.h"

#include "node_values.h"
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
  void NodeJacobi<dim>::place(const JoinedMatrix<dim> &matrix)
  {
    if (placed_)
      return;
    size_ = matrix.size_;
    set_diagonal(matrix);
    clustered_ = false;
    placed_ = true;
    by_vertex_ = false;
    springs_.clear();
  }

  template <int dim>
  void NodeJacobi<dim>::cluster(const JoinedMatrix<dim> &matrix)
  {
    if (clustered_)
      return;
    clustered_ = true;
    clusters_ = clusters_of(matrix);
    const auto &covers = clusters_.covers;
    by_vertex_ = !communicator_.any(
        std::any_of(covers.begin(), covers.end(),
                    [](const char covered) { return !covered; }));
  }

  template <int dim>
  const NodeClusters &NodeJacobi<dim>::vertices(const JoinedMatrix<dim> &matrix)
  {
    place(matrix);
    cluster(matrix);
    return clusters_;
  }

  template <int dim>
  bool NodeJacobi<dim>::prepare(const JoinedMatrix<dim> &matrix,
                                const std::vector<double> *const springs,
                                const bool general)
  {
    place(matrix);
    if (springs)
      cluster(matrix);
    factor_.reset();
    general_.reset();
    stiffened_.clear();
    bool done = !springs || invert_clusters(matrix, *springs, general);
    if (springs && !by_vertex_)
      done = factorise(matrix, *springs, general) && done;
    if (springs)
      copy_of_points<dim * dim>(matrix.parting_points(), *springs, springs_);
    else
      springs_.clear();
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

  /** Of the blocks at nodes, then of vertices. */
  template <int dim>
  template <unsigned int size>
  void NodeJacobi<dim>::apply_inverses(const double *r, double *z) const
  {
    const std::size_t n_nodes = diagonal_.size() / (size * size);
    for (std::size_t b = 0; b < n_nodes; ++b)
      for (unsigned int k = 0; k < size; ++k) {
        const double *row = &inverse_[(b * size + k) * size];
        double sum = 0.;
        for (unsigned int l = 0; l < size; ++l)
          sum += row[l] * r[b * size + l];
        z[b * size + k] = sum;
      }
    if (springs_.empty())
      return;
    double in[NodeClusters::largest], out[NodeClusters::largest];
    for (const auto &cluster : clusters_.clusters) {
      if (cluster.inverse.empty())
        continue;
      const std::size_t n = cluster.nodes.size() * size;
      for (std::size_t b = 0; b < cluster.nodes.size(); ++b)
        std::copy_n(r + std::size_t(cluster.nodes[b]) * size, size,
                    in + b * size);
      // four rows side by side: a sum alone waits for its last addition
      std::size_t k = 0;
      for (; k + 4 <= n; k += 4) {
        const double *a = &cluster.inverse[k * n];
        double s[4] = {};
        for (std::size_t l = 0; l < n; ++l)
          for (unsigned int q = 0; q < 4; ++q)
            s[q] += a[q * n + l] * in[l];
        std::copy_n(s, 4, out + k);
      }
      for (; k < n; ++k) {
        const double *a = &cluster.inverse[k * n];
        double s = 0.;
        for (std::size_t l = 0; l < n; ++l)
          s += a[l] * in[l];
        out[k] = s;
      }
      for (std::size_t b = 0; b < cluster.nodes.size(); ++b)
        std::copy_n(out + b * size, size,
                    z + std::size_t(cluster.nodes[b]) * size);
    }
  }

  template <int dim>
  void NodeJacobi<dim>::apply(const std::vector<double> &r,
                              std::vector<double> &z)
  {
    if (size_ == 1)
      apply_inverses<1>(r.data(), z.data());
    else
      apply_inverses<dim>(r.data(), z.data());
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
