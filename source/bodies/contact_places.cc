#include "contact_places.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  ContactPlaces<dim>::ContactPlaces(const SurfaceCells<dim> &cells,
                                    const BodyTable &table)
      : cells_(cells), n_bodies_(table.bodies.size())
  {
    first_.push_back(0);
    for (unsigned int c = 0; c < cells.size(); ++c) {
      std::size_t n = 0;
      for (const auto &face : cells.faces(c))
        n += face.nodes.size();
      first_.push_back(first_.back() + n);
    }
    if (dim == 2)
      return;
    // all edges of all cells: each has a place, whether it is a surface yet
    for (unsigned int c = 0; c < cells.size(); ++c)
      for (const auto &face : cells.faces(c))
        for (const auto &piece : face.pieces)
          for (std::size_t v = 0; v < piece.size(); ++v) {
            const std::size_t first = cells.first_node(c);
            edges_.push_back(
                pair_of(cells.merged(first + piece[v]),
                        cells.merged(first + piece[(v + 1) % piece.size()])));
          }
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
  }

  template <int dim>
  std::size_t ContactPlaces<dim>::size() const
  {
    return n_of_faces() + n_bodies_ + edges_.size();
  }

  template <int dim>
  std::size_t ContactPlaces<dim>::of_node(const unsigned int cell,
                                          const unsigned int face,
                                          const unsigned int node) const
  {
    const auto &faces = cells_.faces(cell);
    std::size_t place = first_[cell] + node;
    for (unsigned int f = 0; f < face; ++f)
      place += faces[f].nodes.size();
    return place;
  }

  template <int dim>
  std::size_t ContactPlaces<dim>::of_edge(const unsigned int node_1,
                                          const unsigned int node_2) const
  {
    const auto edge =
        std::lower_bound(edges_.begin(), edges_.end(), pair_of(node_1, node_2));
    return n_of_faces() + n_bodies_ + std::size_t(edge - edges_.begin());
  }

  template <int dim>
  int ContactPlaces<dim>::cell_of(const std::size_t place) const
  {
    const auto next = std::upper_bound(first_.begin(), first_.end(), place);
    return next == first_.end() ? -1 : int(next - first_.begin()) - 1;
  }

  ContactBlocks::ContactBlocks(const SceneInput &input, const BodyTable &table)
      : table_(table), n_materials_(input.materials.size()),
        blocks_(n_materials_ * n_materials_, -1)
  {
    const std::size_t n = n_materials_;
    for (std::size_t k = input.contacts.size(); k-- > 0;)
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b) {
          const auto &names = input.contacts[k].materials;
          const auto is = [&](const std::size_t i, const std::size_t j) {
            return names[0].empty() || (input.materials[i].name == names[0] &&
                                        input.materials[j].name == names[1]);
          };
          if (is(a, b) || is(b, a))
            blocks_[a * n + b] = int(k);
        }
  }

  bool ContactBlocks::may_touch(const unsigned int body) const
  {
    const auto n = long(n_materials_);
    const auto blocks =
        blocks_.begin() + long(table_.bodies[body].material) * n;
    return std::any_of(blocks, blocks + n, [](const int k) { return k >= 0; });
  }

  template class ContactPlaces<2>;
  template class ContactPlaces<3>;
} // namespace nsfd
