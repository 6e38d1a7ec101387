#pragma once

#include <cstddef>
#include <vector>

namespace dealii
{
  template <int dim, int spacedim>
  class Triangulation;
} // namespace dealii

namespace nsfd
{
  struct SceneInput;

  /**
   * The bodies of a scene with large motions, of all ranks and the same on all
   * of them: deformable cells, and rigid bodies of one cell or of all connected
   * cells of a material. Cells and bodies are numbered as one rank alone would
   * number them, bodies by their first cell.
   */
  struct BodyTable {
    struct Body {
      unsigned int first_cell = 0, material = 0;
      int rank = 0;
      int rigid = -1; ///< number among the rigid ones, or -1
    };
    std::vector<Body> bodies;
    std::size_t n_rigid = 0;
    std::vector<unsigned int> body_of_cell;
    /// cells by global_active_cell_index(), whose order depends on the ranks
    std::vector<unsigned int> cell_of_global;

    std::size_t n_cells() const { return body_of_cell.size(); }
    unsigned int body_of_global(const unsigned long long cell) const
    {
      return body_of_cell[cell_of_global[cell]];
    }
    bool is_rigid(const std::size_t body) const
    {
      return bodies[body].rigid >= 0;
    }
  };

  /**
   * Of a triangulation whose cells are known to all ranks, @p materials by
   * active_cell_index().
   */
  template <int dim>
  BodyTable
  make_body_table(const SceneInput &input,
                  const dealii::Triangulation<dim, dim> &triangulation,
                  const std::vector<unsigned int> &materials);

  /**
   * Gives every cell to a rank, whole bodies and about as many cells to each:
   * bodies are halved by their places, again and again. Collective.
   */
  template <int dim>
  void partition_by_bodies(const SceneInput &input,
                           dealii::Triangulation<dim, dim> &triangulation,
                           int n_ranks);
} // namespace nsfd
