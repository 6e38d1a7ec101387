#pragma once

namespace nsfd
{
  /**
   * A point touches facets that look at its own facet. Flush sides and corners
   * of boxes are at right angles: the limit keeps them apart from facets that
   * oppose, whatever the rounding and the small turns of a step.
   */
  constexpr double opposed_below = -0.1;

  /** Deeper inside, in sizes of the smaller facet, a point has not come through
   * this facet. */
  constexpr double deepest = 0.25;

  /**
   * A point is moved by this part of the way to the centre of its own facet
   * before it is asked what it lies over: boxes that stand flush, or meet in a
   * corner only, do not catch each other's sides.
   */
  constexpr double inset = 0.02;
} // namespace nsfd
