#pragma once

#include "bodies/contact_points.h"

#include <vector>

namespace nsfd
{
  /**
   * Contacts live for one step. What the places of their surfaces keep,
   * `surface_...` of the state, they take over, and leave to them again.
   */
  template <int dim>
  class SurfaceHistory
  {
  public:
    SurfaceHistory(const Discretization<dim> &discretization,
                   const ContactPoints<dim> &contacts,
                   const Communicator &communicator)
        : discretization_(discretization), contacts_(contacts),
          all_(communicator)
    {
    }

    /** From the places in @p old to the contacts in @p with_contacts. */
    void take(const State &old, State &with_contacts) const;
    /** The impulses of the places, in the frames at hand, to those of the
        contacts. */
    void add_impulses(const State &old, std::vector<double> &impulse) const;
    /** From the contacts in @p next to their places, on all ranks. Collective.
     */
    void leave(const State &old, State &next) const;

    /** The contacts of this rank that carried something. */
    std::vector<SurfaceTouch> touches(const State &next) const;

  private:
    struct OfContact;

    void take(std::size_t row, const State &old, State &with_contacts) const;
    std::vector<OfContact> own_contacts(const State &next) const;

    const Discretization<dim> &discretization_;
    const ContactPoints<dim> &contacts_;
    const Communicator &all_;
  };
} // namespace nsfd
