#pragma once

#include "mesh_view.h"
#include "point_history.h"
#include "spring_shift.h"

#include <deal.II/distributed/tria.h>

#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * Carries a state over one change of the mesh, with the cells, to the ranks
   * that own them afterwards. Smaller cells take the polynomials of the larger
   * one: nothing changes. A larger one interpolates the displacement of its
   * children (mean where they meet) and takes the velocity nearest to theirs
   * in the norm of mass, which keeps both momenta. Points inherit from the
   * nearest one of the same face; new faces inside a cell are born intact.
   * Where springs keep the modulus of the body, smaller cells are translated to
   * where their springs carry what the bulk does, see SpringShift.
   */
  template <int dim>
  class StateTransfer
  {
  public:
    using Mesh = dealii::parallel::distributed::Triangulation<dim>;

    /**
     * Attach the state to the cells of @p mesh, whose flags are set; it is to
     * live until finish().
     */
    StateTransfer(const SceneInput &input, Mesh &triangulation,
                  const MeshState<dim> &mesh);

    /** What came with the cells; once, right after the mesh has changed. */
    void receive();

    /**
     * The state on the new bodies, without energies and tractions of bonds.
     * @p fresh is the state at t = 0 there, with what points are born as.
     * Collective.
     */
    State finish(const MeshState<dim> &fresh) const;

  private:
    using Cell = typename dealii::Triangulation<dim>::cell_iterator;
    using Status = typename dealii::Triangulation<dim>::CellStatus;
    /// of a cell: n, q (n), v or a momentum (n), translations of children that
    /// it will have (n_translations), then memories of its points
    using Parcel = std::vector<double>;
    static constexpr unsigned int n_translations = dim << dim;

    struct Received {
      std::shared_ptr<const Parcel> parcel;
      Status status = Mesh::CELL_PERSIST;
      unsigned int child = 0;
    };

    std::vector<char> pack(const Cell &cell, Status status) const;
    Parcel pack_one(unsigned int body, int level_of_children) const;
    Parcel pack_children(const Cell &parent) const;
    void add_memories(unsigned int body, unsigned int child, Parcel &parcel,
                      bool all_faces) const;
    void set_motion(const MeshState<dim> &fresh, State &state) const;
    void set_springs(const MeshState<dim> &fresh, const double *row,
                     std::size_t point, State &state) const;
    static std::size_t first_history(const Parcel &parcel)
    {
      return 1 + 2 * std::size_t(parcel[0]) + n_translations;
    }
    const double *history_of(const Received &received, unsigned int face_no,
                             std::size_t point, const MeshState<dim> &fresh,
                             bool &inside) const;

    const SceneInput &input_;
    Mesh &triangulation_;
    unsigned int handle_ = 0;
    const PointHistory<dim> history_;
    const SpringShift<dim> shift_;
    // of the old mesh, while it lives; its state lives until the end
    const MeshState<dim> old_;
    std::vector<int> body_of_;   ///< by active cell index, -1: not ours
    std::vector<double> offset_; ///< jump - H q - gap at t = 0, by point
    std::vector<std::vector<std::pair<unsigned int, unsigned int>>>
        points_of_;                  ///< per body: slot, point
    std::vector<Received> received_; ///< per new body
  };
} // namespace nsfd
