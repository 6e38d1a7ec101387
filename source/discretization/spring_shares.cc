#include "spring_shares.h"

#include "nsfd/scene/scene_input.h"

#include <cmath>

namespace nsfd
{
  using namespace dealii;

  template <int dim>
  SpringShares<dim>::SpringShares(const SceneInput &input,
                                  const MeshGroups<dim> &groups,
                                  const std::vector<unsigned int> &materials)
      : input_(input), groups_(groups), materials_(materials)
  {
    if (!input.adaptivity || !input.adaptivity->constant_modulus)
      return;
    for (unsigned int b = 0; b < input.interfaces.size(); ++b)
      any_ = any_ || has_springs(b);
  }

  template <int dim>
  bool SpringShares<dim>::has_springs(const unsigned int b) const
  {
    const InterfaceInput &block = input_.interfaces[b];
    return block.intact != IntactFaces::bonded &&
           block.intact != IntactFaces::rigid &&
           (block.law ? !block.law->extrinsic() : block.law_name == "elastic");
  }

  template <int dim>
  int SpringShares<dim>::inside(const Cell &cell) const
  {
    typename Triangulation<dim>::cell_iterator first = cell;
    while (first->level() > 0)
      first = first->parent();
    const std::string &material =
        input_.materials[materials_[cell->active_cell_index()]].name;
    for (unsigned int b = 0; b < input_.interfaces.size(); ++b)
      if (input_.interfaces[b].obstacle < 0 &&
          groups_.holds_interior_face(
              input_.interfaces[b].where, first->center(), material, material,
              {{first->material_id(), first->material_id()}},
              numbers::flat_manifold_id))
        return has_springs(b) ? int(b) : -1;
    return -1;
  }

  template <int dim>
  double SpringShares<dim>::of_face(const Cell &cell_1, const Cell &cell_2,
                                    const unsigned int block) const
  {
    if (!any_ || !has_springs(block))
      return 1.;
    double share = 0.;
    for (const Cell *cell : {&cell_1, &cell_2})
      share += (*cell)->level() > 0 && inside(*cell) == int(block)
                   ? std::ldexp(0.5, -(*cell)->level())
                   : 0.5;
    return share;
  }

  template class SpringShares<2>;
  template class SpringShares<3>;
} // namespace nsfd
