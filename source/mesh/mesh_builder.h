#pragma once

#include "nsfd/scene/scene_input.h"

#include <deal.II/base/point.h>
#include <deal.II/grid/tria.h>

#include <array>
#include <map>
#include <memory>
#include <mpi.h>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /**
   * Build the mesh that the input names, with straight cells and no manifolds.
   * Quads and hexes live on parallel::distributed. Triangles and tetrahedra are
   * made by rank 0, and every rank holds its part and the cells around it
   * (spread_simplices()). Where SceneInput::has_body_table() every rank knows
   * all cells, and whole bodies belong to one; @p input outlives the mesh then.
   * A plain rectangle or brick is refined by p4est; every other mesh is refined
   * first and handed over as one level, so that a vertex never depends on what
   * a rank has stored.
   *
   * What is wrong with the mesh is added to @p problems, one sentence each and
   * the same on every rank; the result is then a null pointer.
   */
  template <int dim>
  std::unique_ptr<dealii::Triangulation<dim>>
  build_mesh(const SceneInput &input, MPI_Comm communicator,
             std::vector<std::string> &problems);

  /**
   * Decides which cells and faces a `where` means, by the centre of the cell
   * or face. Sides are those of the bounding box of the whole mesh. A group is
   * the name of a body (mesh type `bodies`), a name or number of a mesh that
   * has its own (`file`, `voronoi`), or the number of a material id (cells) or
   * boundary id (boundary faces). Cells of a mesh with groups of its own carry
   * its set of groups as material id, faces as manifold id.
   */
  template <int dim>
  class MeshGroups
  {
  public:
    using Cell = typename dealii::Triangulation<dim>::cell_iterator;

    /** Collective. */
    MeshGroups(const SceneInput &input,
               const dealii::Triangulation<dim> &triangulation);

    /** A side holds for the cells that have a face on it. */
    bool holds_cell(const Where &where, const Cell &cell) const;

    /** False inside the mesh. A body holds for all its boundary faces. */
    bool holds_boundary_face(const Where &where, const Cell &cell,
                             unsigned int face_no) const;

    /**
     * Order of the two sides does not matter. A group of faces holds for its
     * faces, which takes the manifold id; one of cells for the faces whose two
     * cells belong to it, which takes the material ids of both.
     */
    bool holds_interior_face(
        const Where &where, const dealii::Point<dim> &face_centre,
        const std::string &material_1, const std::string &material_2,
        const std::array<dealii::types::material_id, 2> &material_ids =
            {{dealii::numbers::invalid_material_id,
              dealii::numbers::invalid_material_id}},
        dealii::types::manifold_id face_id =
            dealii::numbers::flat_manifold_id) const;

    /** By the index of a face, where faces may be parts of those of the first
        mesh: the middle of the whole one, where it is asked what holds. */
    void set_middles(std::vector<dealii::Point<dim>> middles)
    {
      middles_ = std::move(middles);
    }
    /** @p own, or that. */
    dealii::Point<dim> asked_at(const int face,
                                const dealii::Point<dim> &own) const
    {
      return middles_.empty() ? own : middles_[std::size_t(face)];
    }

    /** Empty, or a sentence: this mesh has no such group or side. */
    std::string missing(const Where &where) const;

    const dealii::Point<dim> &lower() const { return box_.first; }
    const dealii::Point<dim> &upper() const { return box_.second; }

  private:
    bool holds_side(const std::string &side,
                    const dealii::Point<dim> &face_centre) const;
    bool holds_material_id(const std::string &group,
                           dealii::types::material_id id) const;
    bool
    between_groups(const std::array<std::string, 2> &names,
                   const std::array<dealii::types::material_id, 2> &ids) const;

    std::pair<dealii::Point<dim>, dealii::Point<dim>> box_;
    std::vector<dealii::Point<dim>> middles_;
    std::vector<std::string> bodies_;
    std::vector<std::string> material_ids_, boundary_ids_;

    /** Which sets of groups have a group, by its name and by its number. */
    struct SetsOfGroup {
      std::vector<bool> of_cells, of_faces; ///< empty: no such group
    };
    bool has_named_ = false; ///< the mesh has groups of its own
    std::vector<unsigned int> first_of_groups_; ///< by set of such a mesh
    std::map<std::string, SetsOfGroup> named_;
  };

  /**
   * Index into the materials of the input by active_cell_index: the first
   * block whose `where` holds. Own and ghost cells; others have
   * numbers::invalid_unsigned_int. Collective; cells without a material are a
   * problem, blocks that own no cell are worth a warning.
   */
  template <int dim>
  std::vector<unsigned int>
  material_indices(const SceneInput &input, const MeshGroups<dim> &groups,
                   const dealii::Triangulation<dim> &triangulation,
                   std::vector<std::string> &problems,
                   std::vector<std::string> &warnings);

  struct MeshReport {
    unsigned long long n_cells = 0;
    double smallest_edge = 0., largest_edge = 0.;
    /// way of a wave through a cell: volume / largest face area of quads and
    /// hexes, dim * volume / largest face area (lowest height) of simplices
    double smallest_height = 0.;
    /// between two edges of a cell at a corner, degrees
    double smallest_angle = 0., largest_angle = 0.;
    /// Jacobian at the corners over the product of the edge lengths: 1 for
    /// bricks and for equilateral simplices, 0 if degenerate
    double smallest_scaled_jacobian = 0.;
    /// dim times the inscribed over the circumscribed radius of simplices: 1
    /// if equilateral; 0 where cells are quads or hexes
    double smallest_radius_ratio = 0.;
    double volume = 0., inner_face_area = 0.;
    /// inner_face_area / volume: Z of the added compliance
    double interface_density = 0.;
  };

  /** The same bits for any number of ranks. Collective. */
  template <int dim>
  MeshReport mesh_report(const dealii::Triangulation<dim> &triangulation);
} // namespace nsfd
