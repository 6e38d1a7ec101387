#include "surface_motion.h"

#include "core/gather.h"

#include <algorithm>

namespace nsfd
{
  using namespace dealii;

  template <int dim>
  void SurfaceMotion<dim>::set_nodes(std::vector<std::size_t> nodes)
  {
    nodes_ = std::move(nodes);
    std::sort(nodes_.begin(), nodes_.end());
    nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
    own_nodes_.clear();
    const auto rank_of = [this](const std::size_t node) {
      return table_.bodies[table_.body_of_cell[node / cells_.nodes_per_cell()]]
          .rank;
    };
    for (const std::size_t node : nodes_)
      if (rank_of(node) == all_.rank())
        own_nodes_.push_back(node);
    // as the ranks send them
    std::stable_sort(nodes_.begin(), nodes_.end(),
                     [&](const std::size_t a, const std::size_t b) {
                       return rank_of(a) < rank_of(b);
                     });
    x_.assign((cells_.n_nodes() + table_.n_rigid) * dim, 0.);
    v_.assign(cells_.n_nodes() * dim, 0.);
    way_ = v_;
    share_rest();
  }

  template <int dim>
  void SurfaceMotion<dim>::share_rest()
  {
    std::vector<double> own;
    own.reserve(own_nodes_.size() * dim);
    for (const std::size_t node : own_nodes_) {
      const auto x =
          bodies_.rest().begin() + long(bodies_.own_node(node) * dim);
      own.insert(own.end(), x, x + dim);
    }
    const auto places = gather_all(all_, own);
    rest_.assign(cells_.n_nodes() * dim, 0.);
    const double *from = places.data();
    for (const std::size_t node : nodes_) {
      std::copy_n(from, dim, rest_.data() + node * dim);
      from += dim;
    }
  }

  template <int dim>
  void SurfaceMotion<dim>::share(const State &old)
  {
    std::vector<double> own;
    own.reserve(own_nodes_.size() * 3 * dim);
    for (const std::size_t node : own_nodes_) {
      const std::size_t k = bodies_.own_node(node);
      const Point<dim> x = bodies_.place(old, k);
      own.insert(own.end(), x.begin_raw(), x.end_raw());
      own.insert(own.end(), old.velocity.begin() + long(k * dim),
                 old.velocity.begin() + long((k + 1) * dim));
      // explicit velocities are those of the middles of steps
      for (std::size_t i = k * dim; i < (k + 1) * dim; ++i)
        own.push_back(old.last_way.empty() ? old.last_step * old.velocity[i]
                                           : old.last_way[i]);
    }
    const auto motion = gather_all(all_, own);
    const double *from = motion.data();
    for (const std::size_t node : nodes_) {
      std::copy_n(from, dim, x_.data() + node * dim);
      std::copy_n(from + dim, dim, v_.data() + node * dim);
      std::copy_n(from + 2 * dim, dim, way_.data() + node * dim);
      from += 3 * dim;
    }
    for (std::size_t r = 0; r < table_.n_rigid; ++r)
      std::copy_n(old.rigid.data() + 13 * r, dim,
                  x_.data() + (cells_.n_nodes() + r) * dim);
  }

  template <int dim>
  std::vector<double> SurfaceMotion<dim>::places_in(const State &state) const
  {
    std::vector<double> own;
    own.reserve(own_nodes_.size() * dim);
    for (const std::size_t node : own_nodes_) {
      const Point<dim> x = bodies_.place(state, bodies_.own_node(node));
      own.insert(own.end(), x.begin_raw(), x.end_raw());
    }
    const auto places = gather_all(all_, own);
    std::vector<double> result(x_.size(), 0.);
    const double *from = places.data();
    for (const std::size_t node : nodes_) {
      std::copy_n(from, dim, result.data() + node * dim);
      from += dim;
    }
    for (std::size_t r = 0; r < table_.n_rigid; ++r)
      std::copy_n(state.rigid.data() + 13 * r, dim,
                  result.data() + (cells_.n_nodes() + r) * dim);
    return result;
  }

  template <int dim>
  Tensor<1, dim> SurfaceMotion<dim>::at(const std::vector<double> &values,
                                        const std::size_t node)
  {
    Vector result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = values[node * dim + d];
    return result;
  }

  template class SurfaceMotion<2>;
  template class SurfaceMotion<3>;
} // namespace nsfd
