#pragma once

#include <cstddef>
#include <vector>

namespace nsfd
{
  /**
   * Numbers that belong to the cells of a mesh, as formulas see them: functions
   * of the place. Several cells meet at a place on a face.
   */
  class PlaceFields
  {
  public:
    virtual ~PlaceFields() = default;

    /** The cells that hold (x, y, z), in ascending order; none outside. */
    virtual void find(double x, double y, double z,
                      std::vector<std::size_t> &cells) const = 0;

    /** Of field @p field in cell @p cell. */
    virtual double value(std::size_t field, std::size_t cell) const = 0;
  };
} // namespace nsfd
