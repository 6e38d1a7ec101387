#pragma once

#include "bodies/fragments.h"
#include "discretization/discretization.h"
#include "records/fragment_record.h"
#include "state/state.h"

#include <memory>
#include <vector>

namespace nsfd
{
  template <int dim>
  class BodyLayout;
  template <int dim>
  class MovingBodies;
  struct MovingBody;

  /**
   * Mass, place, momentum, spin and energy of every fragment, with the mass
   * matrices of the bodies, so that the momenta of the fragments add up to that
   * of the scene and their kinetic energies to that of the energy balance. Sums
   * do not depend on the ranks.
   */
  template <int dim>
  class FragmentMotion
  {
  public:
    /**
     * @p start is the state at t = 0: what is broken there is no new surface.
     * @p moving are the bodies of implicit large motions, or null.
     */
    FragmentMotion(const Discretization<dim> &discretization,
                   const Communicator &communicator,
                   const MovingBodies<dim> *moving, const State &start);

    /** Bodies and points are others now. */
    void mesh_changed(const State &start);

    /** By number; empty except on the first rank. Collective. */
    std::vector<FragmentRecord> measure(const State &state,
                                        const Fragments<dim> &fragments) const;

  private:
    struct Body;
    struct Place;
    struct Amounts;
    struct Motions;
    class Pieces;

    Body cell_body(unsigned int cell, const std::vector<double> &displacement,
                   const std::vector<double> &velocity) const;
    Body rigid_body(const MovingBody &moving, const State &state) const;
    template <typename Visit>
    void for_bodies(const State &state, Visit &&visit) const;
    std::vector<Amounts> amounts(const State &state,
                                 const Pieces &pieces) const;

    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    /// of explicit steps with rigid bodies of any motion: their mass need not
    /// be that of their cells
    std::shared_ptr<const BodyLayout<dim>> own_layout_;
    const BodyLayout<dim> *layout_; ///< of bodies of large motions, or null
    std::vector<std::vector<double>> masses_; ///< by class, node x node;
                                              ///< none where cells differ()
    std::vector<bool> held_at_start_;         ///< by point: not broken
  };
} // namespace nsfd
