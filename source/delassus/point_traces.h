#pragma once

#include "delassus_operator.h"

#include <array>
#include <vector>

namespace nsfd
{
  /**
   * What a point sees of the unknowns of its bodies, in its frame and known on
   * every rank that has the point: rows of the jump.
   */
  struct PointTrace {
    long long first = -1; ///< first unknown among those of all ranks, or none
    unsigned int n_dofs = 0;
    std::vector<double> jump; ///< dim x n_dofs, with the sign of the side
  };

  /** Those of some of the points. */
  class PointTraces
  {
  public:
    PointTraces() = default;

    /** Of the points that are @p wanted, none of the others. Collective. */
    template <int dim>
    PointTraces(const DelassusOperator<dim> &delassus, long long first_dof,
                const std::vector<char> &wanted);

    const PointTrace &operator()(const unsigned int side,
                                 const std::size_t point) const
    {
      static const PointTrace none;
      return place_[point] < 0 ? none : sides_[side][place_[point]];
    }
    /** All of a side, in the order of the points. */
    const std::vector<PointTrace> &of_side(const unsigned int side) const
    {
      return sides_[side];
    }

  private:
    std::vector<int> place_; ///< by point, or -1
    std::array<std::vector<PointTrace>, 2> sides_;
  };
} // namespace nsfd
