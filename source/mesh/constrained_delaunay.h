#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace nsfd
{
  using PlanePoint = std::array<double, 2>;

  /** Triangles between given points, along given edges. */
  struct PlaneTriangles {
    std::vector<std::array<unsigned int, 3>> corners; ///< anticlockwise
    /// which parts of the plane the given edges separate, per triangle; from 0
    std::vector<unsigned int> part;
    unsigned int n_parts = 0;
  };

  /**
   * The constrained Delaunay triangulation of points in the plane, made again
   * and again while the points move a little.
   */
  class ConstrainedDelaunay
  {
  public:
    /** @p edges between points, which triangles do not cross. */
    explicit ConstrainedDelaunay(
        const std::vector<std::array<unsigned int, 2>> &edges);

    /**
     * Without the triangles that no edge keeps apart from the outside.
     *
     * @throws std::runtime_error if edges cross, or if points coincide
     */
    PlaneTriangles operator()(const std::vector<PlanePoint> &points);

  private:
    const std::vector<std::array<unsigned int, 2>> &edges_;
    std::vector<std::size_t> order_; ///< neighbours one after the other
  };
} // namespace nsfd
