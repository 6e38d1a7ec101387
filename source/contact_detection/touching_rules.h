#pragma once

namespace nsfd
{
  /**
   * A point touches facets that look at its own facet. Flush sides and corners
   * of boxes are at right angles: the limit keeps them apart from facets that
   * oppose, whatever the rounding and the small turns of a step.
   */
  constexpr double opposed_below = -0.1;

  /**
   * A corner touches facets whose normals point back into the cone of its own
   * ones, or nearly opposite to that of its facet (45 degrees): the bottom
   * corner of a box that leans over another one does not touch its side,
   * however near it is, while it sinks into its top.
   */
  constexpr double face_to_face = -0.7;

  /** Deeper inside, in sizes of the smaller facet, a point has not come through
   * this facet. */
  constexpr double deepest = 0.25;

  /**
   * A point is moved by this part of the way to the centre of its own facet
   * before it is asked what it lies over: boxes that stand flush, or meet in a
   * corner only, do not catch each other's sides.
   */
  constexpr double inset = 0.02;

  /**
   * Two edges that cross next to an end of each, in parts of their lengths, are
   * two corners that meet: as far as the inset goes, corners do not touch.
   */
  constexpr double edge_end = 0.5 * inset;

  /** Sine between two edges that are not parallel. */
  constexpr double least_crossing = 0.03;

  /**
   * Sine and cosine between the normals of two facets that have no edge (0.26
   * degrees): it sticks out by this part of a facet before it is seen.
   */
  constexpr double crease = 0.0045, flat = 1. - crease * crease / 2.;

  /**
   * A normal may be as far outside of the normals around an edge, as a sine:
   * bodies that lie flat on each other touch at crossing edges, too. What turns
   * by more in a step, up to the second number, while it is within reach, may
   * come to lie so.
   */
  constexpr double cone_room = 0.02, most_turn = 0.1;

  /**
   * Two touches of the same bodies are one if their normals are as parallel and
   * their places as near to each other, in sizes of a facet: rows that almost
   * depend on each other make the contact problem almost singular.
   */
  constexpr double same_direction = 0.999, same_place = 0.1;
} // namespace nsfd
