#pragma once

#include "body_layout.h"
#include "rigid_supports.h"

#include "core/communicator.h"

#include <array>
#include <vector>

namespace nsfd
{
  /**
   * Places and turns of the rigid bodies in a state: State::rigid, in the order
   * of BodyTable and known to all ranks, and the displacements and velocities
   * of their nodes that follow from it.
   */
  template <int dim>
  class RigidMotions
  {
  public:
    RigidMotions(const SceneInput &input,
                 const Discretization<dim> &discretization,
                 const BodyLayout<dim> &layout,
                 const Communicator &communicator)
        : input_(input), discretization_(discretization), layout_(layout),
          all_(communicator), supports_(input, discretization, layout)
    {
    }

    const RigidSupports<dim> &supports() const { return supports_; }

    /** What @p state says of @p body. */
    RigidState of(const State &state, const MovingBody &body) const
    {
      return nsfd::rigid_state(state.rigid.data() + 13 * body.rigid_number);
    }

    /** Those nearest to the nodal fields of @p state. Collective. */
    void set_nearest(State &state) const;
    /** On this rank, until share() is called. */
    void put(const RigidState &rigid, const MovingBody &body,
             State &state) const;
    /** What each rank has put there, to all of them. Collective. */
    void share(State &state) const;
    /** Nodal displacements of a place and turn. */
    void place(const RigidState &rigid, const MovingBody &body,
               std::vector<double> &displacement) const;

    /** The body of the table that pin @p k holds; how far its place is off if
        it is a body of this rank. */
    unsigned int body_of_pin(unsigned int k) const;
    std::array<double, dim> pin_drift(unsigned int k, const State &state) const;
    /** Likewise, with which velocity it moves. */
    std::array<double, dim> pin_velocity(unsigned int k,
                                         const State &state) const;

  private:
    using Vector = dealii::Tensor<1, dim>;

    struct Pinned {
      RigidState rigid;
      Vec3 at, arm; ///< the place of the pin, from the centre at rest
    };
    Pinned pinned(unsigned int pin, const State &state) const;

    RigidState nearest(const State &state, const MovingBody &body) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const BodyLayout<dim> &layout_;
    const Communicator &all_;
    const RigidSupports<dim> supports_;
  };
} // namespace nsfd
