#include "leapfrog_ghosts.h"

#include "ghost_states.h"

#include "core/cost.h"
#include "discretization/cells.h"

#include <algorithm>
#include <numeric>

namespace nsfd
{
  template <int dim>
  LeapfrogGhosts<dim>::LeapfrogGhosts(
      const Communicator &communicator, const Discretization<dim> &own,
      std::unique_ptr<const GhostLayer<dim>> layer)
      : communicator_(communicator), alone_(MPI_COMM_SELF), own_(own),
        layer_(std::move(layer))
  {
    if (!layer_)
      return;
    std::vector<double> number(own.points().n_points);
    std::iota(number.begin(), number.end(), 1.);
    own_points_.assign(layer_->all().points().n_points, unsigned(-1));
    const auto at = layer_->spread_points(number, 1);
    for (std::size_t i = 0; i < at.size(); ++i)
      own_points_[i] = unsigned(at[i]) - 1u; // 0 where it is of other ranks
  }

  template <int dim>
  State LeapfrogGhosts<dim>::with(State own) const
  {
    if (layer_) {
      spread_state(*layer_, own);
      fetch_state(*layer_, own);
    }
    return own;
  }

  template <int dim>
  std::vector<double>
  LeapfrogGhosts<dim>::with_points(const std::vector<double> &own) const
  {
    if (!layer_)
      return own;
    auto all = layer_->spread_points(own, 1);
    layer_->fetch_points(1, all);
    return all;
  }

  template <int dim>
  State LeapfrogGhosts<dim>::without(State all) const
  {
    if (layer_)
      take_own(*layer_, all);
    count_once(all);
    return all;
  }

  template <int dim>
  void LeapfrogGhosts<dim>::count_once(State &own) const
  {
    if (divided() && !communicator_.is_root())
      own.touches.clear();
  }

  template <int dim>
  void LeapfrogGhosts<dim>::set_mesh(const JoinedMesh<dim> &mesh,
                                     const HangingNodes<dim> &hanging)
  {
    if (!cells())
      return;
    std::vector<std::size_t> beyond;
    for (std::size_t i = 0; i < mesh.n_corners(); ++i)
      if (!mesh.is_whole(mesh.node(i)) && !hanging.hangs(i))
        beyond.push_back(i);
    const unsigned int n_nodes =
        layer_->all().cells().element->n_dofs_per_cell();
    corners_.emplace(layer_->cells(), n_nodes, std::move(beyond));
  }

  template <int dim>
  void LeapfrogGhosts<dim>::start(const CornerGroups<dim> &groups) const
  {
    if (corners_)
      corners_->start(dim, [&](const std::size_t corner, double *v) {
        std::copy_n(&groups.velocity[groups.of(corner) * dim], dim, v);
      });
  }

  template <int dim>
  void LeapfrogGhosts<dim>::finish(CornerGroups<dim> &groups) const
  {
    if (corners_)
      corners_->finish(dim, [&](const std::size_t corner, const double *v) {
        std::copy_n(v, dim, &groups.velocity[groups.of(corner) * dim]);
      });
  }

  template <int dim>
  void LeapfrogGhosts<dim>::fetch_motion(CornerGroups<dim> &groups) const
  {
    if (!corners_)
      return;
    for (auto *values : {&groups.displacement, &groups.velocity}) {
      const auto place = [&](const std::size_t corner) {
        return &(*values)[std::size_t(groups.of(corner)) * dim];
      };
      corners_->start(dim, [&](const std::size_t corner, double *v) {
        std::copy_n(place(corner), dim, v);
      });
      corners_->finish(dim, [&](const std::size_t corner, const double *v) {
        std::copy_n(v, dim, place(corner));
      });
    }
  }

  template <int dim>
  double LeapfrogGhosts<dim>::sum(const CornerGroups<dim> &groups,
                                  std::vector<double> &terms) const
  {
    return sums(groups, terms, 1)[0];
  }

  template <int dim>
  std::vector<double> LeapfrogGhosts<dim>::sums(const CornerGroups<dim> &groups,
                                                std::vector<double> &terms,
                                                const std::size_t rows) const
  {
    const std::size_t n = groups.size() * dim;
    for (std::size_t row = 0; row < rows; ++row)
      for (const unsigned int group : groups.not_counted())
        std::fill_n(&terms[row * n + std::size_t(group) * dim], dim, 0.);
    return communicator().sums(terms.data(), rows, n);
  }

  template <int dim>
  double LeapfrogGhosts<dim>::dot(const CornerGroups<dim> &groups,
                                  const std::vector<double> &a,
                                  const std::vector<double> &b) const
  {
    if (!layer_)
      return communicator_.dot(a.data(), b.data(), a.size());
    const Charge charge(Cost::sums);
    products_.resize(a.size());
    for (std::size_t k = 0; k < a.size(); ++k)
      products_[k] = a[k] * b[k];
    return sum(groups, products_);
  }

  template class LeapfrogGhosts<2>;
  template class LeapfrogGhosts<3>;
} // namespace nsfd
