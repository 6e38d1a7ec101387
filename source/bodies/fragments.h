#pragma once

#include "joined/connected_cells.h"
#include "state/state.h"

#include <vector>

namespace nsfd
{
  /** Fragments: cells that hang together through faces that are not open. */
  template <int dim>
  class Fragments
  {
  public:
    Fragments(const Discretization<dim> &discretization,
              const Communicator &communicator)
        : cells_(discretization, communicator)
    {
    }

    /** Collective. Does nothing if no point has broken since the last call. */
    void update(const State &state)
    {
      if (state.broken_area == broken_area_)
        return;
      broken_area_ = state.broken_area;
      cells_.connect([&state](const auto &face) {
        return connection<dim>(state, face) != Connection::open;
      });
    }

    unsigned int count() const { return cells_.count(); }

    /** Of each cell of this rank, see ConnectedCells::numbers(). Collective. */
    std::vector<unsigned int> number_bodies() const { return cells_.numbers(); }

  private:
    ConnectedCells<dim> cells_;
    double broken_area_ = -1.;
  };
} // namespace nsfd
