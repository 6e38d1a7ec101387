#pragma once

#include <array>
#include <cstddef>
#include <limits>

namespace nsfd
{
  /**
   * A contact of one step between body 2, whose place it follows, and body 1
   * or an obstacle: a node or a ball of body 2 against a facet, a ball, an
   * obstacle; an edge against an edge; or a pin that holds a place of body 2.
   * The normal leads from body 1 to body 2. Bodies, cells and nodes of all
   * ranks: SurfaceCells.
   */
  template <int dim>
  struct MovingRow {
    enum class Partner : unsigned char { facet, ball, obstacle, edge, pin };
    static constexpr std::size_t nowhere =
        std::numeric_limits<std::size_t>::max();

    Partner partner = Partner::facet;
    std::size_t index = 0; ///< among the rows of the step, of all ranks
    int body_1 = -1;
    unsigned int body_2 = 0;
    std::size_t node = nowhere;  ///< of body 2; nowhere: a ball or an edge
    double radius = 0.;          ///< of a ball, m
    unsigned int cell = 0;       ///< with this node or edge
    unsigned int facet_cell = 0; ///< of body 1
    std::array<std::size_t, 4> facet{}; ///< nodes, the outside as in Surfaces;
                                        ///< 2 of an edge
    unsigned int n_facet = 0;
    std::array<double, 4> weights{}; ///< of these nodes at the start
    /// nodes of the edge of body 2, so that it, turned towards the edge of
    /// body 1 by a right-handed screw, moves to body 2
    std::array<std::size_t, 2> edge{};
    std::array<double, 2> edge_weights{};
    unsigned int obstacle = 0, pin = 0;
    double gap = 0.;  ///< at the start of the step, m
    double rate = 0.; ///< of the gap at the start of the step, m/s
    double approach = 0., overlap = 0.; ///< known of it from elsewhere, m
    double weight = 0.;                 ///< m or m^2
    unsigned int interaction = 0; ///< index into OneStepProblem::interactions
    unsigned int block = 0;
    std::size_t place = nowhere; ///< of what it keeps
    /// of its impulse, if that has another one
    std::size_t place_of_impulse = nowhere;
    /// place of the corner that would ask for nearly the same from the other
    /// side: both know the same bound of their overlap
    std::size_t twin = nowhere;
    bool released = false;          ///< a body has been left in the last step
    double share = 1.;              ///< of the impulse that its place keeps
    std::array<double, dim> jump{}; ///< of a pin: how far it is off, m
  };

  /** What keeps the impulse of a row. */
  template <int dim>
  std::size_t place_of_impulse(const MovingRow<dim> &row)
  {
    return row.place_of_impulse == row.nowhere ? row.place
                                               : row.place_of_impulse;
  }

  /** Body 2 is a ball. */
  template <int dim>
  bool is_ball(const MovingRow<dim> &row)
  {
    using Partner = typename MovingRow<dim>::Partner;
    return row.node == row.nowhere && row.partner != Partner::edge &&
           row.partner != Partner::pin;
  }
} // namespace nsfd
