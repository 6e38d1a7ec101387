#include "crack_network.h"

#include "mesh/mesh_builder.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** Asks the interface blocks of a scene. */
    template <int dim>
    class BreakableFaces
    {
    public:
      using Cell = typename Triangulation<dim>::cell_iterator;

      BreakableFaces(const SceneInput &input, const MeshGroups<dim> &groups,
                     const std::vector<unsigned int> &materials)
          : input_(input), groups_(groups), materials_(materials),
            all_(std::none_of(
                input.interfaces.begin(), input.interfaces.end(),
                [](const InterfaceInput &block) { return bool(block.law); }))
      {
      }

      bool contain(const Cell &cell, const unsigned int face_no) const
      {
        if (all_)
          return true;
        const Cell other = cell->neighbor(face_no);
        const auto face = cell->face(face_no);
        for (const InterfaceInput &block : input_.interfaces)
          if (block.obstacle < 0 &&
              groups_.holds_interior_face(
                  block.where, face->center(), material(cell), material(other),
                  {{cell->material_id(), other->material_id()}},
                  face->manifold_id()))
            return bool(block.law);
        return false;
      }

    private:
      const std::string &material(const Cell &cell) const
      {
        return input_.materials[materials_[cell->active_cell_index()]].name;
      }

      const SceneInput &input_;
      const MeshGroups<dim> &groups_;
      const std::vector<unsigned int> &materials_;
      bool all_; ///< no block has a law
    };

    /** Each inner face once. */
    template <int dim, typename Action>
    void for_each_inner_face(const Triangulation<dim> &triangulation,
                             const Action &action)
    {
      for (const auto &cell : triangulation.active_cell_iterators())
        for (const unsigned int f : cell->face_indices())
          if (!cell->face(f)->at_boundary() && cell->neighbor(f)->is_active() &&
              cell->neighbor(f)->index() > cell->index())
            action(cell, f);
    }
  } // namespace

  CrackNetwork crack_network(const SceneInput &input,
                             const Triangulation<2> &triangulation,
                             const MeshGroups<2> &groups,
                             const std::vector<unsigned int> &materials)
  {
    CrackNetwork network;
    for (const Point<2> &p : triangulation.get_vertices())
      network.points.push_back({{p[0], p[1]}});
    for (const auto &cell : triangulation.active_cell_iterators())
      network.area += cell->measure();
    const BreakableFaces<2> breakable(input, groups, materials);
    for_each_inner_face(triangulation, [&](const auto &cell,
                                           const unsigned int f) {
      if (breakable.contain(cell, f))
        network.faces.push_back(
            {{cell->face(f)->vertex_index(0), cell->face(f)->vertex_index(1)}});
    });
    return network;
  }

  CellNetwork cell_network(const SceneInput &input,
                           const Triangulation<3> &triangulation,
                           const MeshGroups<3> &groups,
                           const std::vector<unsigned int> &materials)
  {
    CellNetwork network;
    for (unsigned int d = 0; d < 3; ++d) {
      network.lower[d] = groups.lower()[d];
      network.upper[d] = groups.upper()[d];
    }
    for (const auto &cell : triangulation.active_cell_iterators()) {
      const Point<3> centre = cell->center();
      network.centres.push_back({{centre[0], centre[1], centre[2]}});
      network.is_at_boundary.push_back(cell->at_boundary());
    }
    const BreakableFaces<3> breakable(input, groups, materials);
    for_each_inner_face(
        triangulation, [&](const auto &cell, const unsigned int f) {
          const auto other = cell->neighbor(f);
          network.faces.push_back({unsigned(cell->active_cell_index()),
                                   unsigned(other->active_cell_index()),
                                   cell->face(f)->measure(),
                                   breakable.contain(cell, f)});
        });
    return network;
  }
} // namespace nsfd
