#pragma once

#include "mesh/mesh_builder.h"

#include <deal.II/grid/tria.h>

#include <vector>

namespace nsfd
{
  struct SceneInput;

  /**
   * How the compliance of springs is shared among the faces of an adaptive mesh
   * so that it stays what it is at level 0, per length. A face of level 0
   * stands for half of the cell on either side. Smaller cells have new faces
   * inside, each of which stands for its own halves: a spring between cells of
   * levels i and j has the share (2^-i + 2^-j) / 2, and the sum over any line
   * of faces is that of level 0. A half whose new faces have no springs of the
   * same block (a weak plane between cells that are joined otherwise) keeps all
   * of it.
   */
  template <int dim>
  class SpringShares
  {
  public:
    using Cell = typename dealii::Triangulation<dim>::active_cell_iterator;

    /** @p materials by active_cell_index. */
    SpringShares(const SceneInput &input, const MeshGroups<dim> &groups,
                 const std::vector<unsigned int> &materials);

    /** Some block has springs that keep the modulus of the body. */
    bool any() const { return any_; }

    /** The block with such springs at the centre of a cell of level 0, or -1.
     */
    int inside(const Cell &cell) const;

    /** Of the face of the block @p block between two cells, in (0, 1]. */
    double of_face(const Cell &cell_1, const Cell &cell_2,
                   unsigned int block) const;

  private:
    bool has_springs(unsigned int block) const;

    const SceneInput &input_;
    const MeshGroups<dim> &groups_;
    const std::vector<unsigned int> &materials_;
    bool any_ = false;
  };
} // namespace nsfd
