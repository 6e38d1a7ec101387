#pragma once

#include "mesh_view.h"

#include <deal.II/distributed/tria.h>

namespace nsfd
{
  /**
   * Decides which cells change: smaller where an indicator asks for it, larger
   * where no one minds, where no point of their faces keeps anything, so
   * that nothing heals, and where the larger cell has the motion of the smaller
   * ones: their energies may change by 1e-4, of that of the family or of as
   * many mean cells.
   */
  template <int dim>
  class MeshAdaptor
  {
  public:
    /** @p triangulation as it is now is the mesh with level 0. */
    MeshAdaptor(
        const SceneInput &input,
        dealii::parallel::distributed::Triangulation<dim> &triangulation);

    /**
     * Flags the cells by the state at the end of a step; the bodies of @p mesh
     * are those of the triangulation. True on all ranks if one will change.
     * Collective.
     */
    bool mark(const MeshState<dim> &mesh, bool may_coarsen);

  private:
    void keep_rough_families(const MeshState<dim> &mesh);
    bool will_change(const Communicator &communicator);

    const SceneInput &input_;
    dealii::parallel::distributed::Triangulation<dim> &triangulation_;
  };
} // namespace nsfd
