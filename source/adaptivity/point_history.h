#pragma once

#include "discretization/discretization.h"
#include "state/state.h"

#include <vector>

namespace nsfd
{
  /**
   * The history of a point, as one row of numbers: where it was, what it
   * belongs to, and its history. Rows of one state have the same length.
   */
  template <int dim>
  class PointHistory
  {
  public:
    explicit PointHistory(const SceneInput &input);

    static constexpr unsigned int face = 0, origin_kind = 1, origin_block = 2,
                                  position = 3, offset = 3 + dim,
                                  impulse = 3 + 2 * dim, ///< over the weight
        jump = 3 + 3 * dim,
                                  compliance = 3 + 4 * dim, ///< of its springs
        history = 4 + 4 * dim;
    static constexpr unsigned int beta = history; ///< the first of them

    unsigned int size() const { return size_; }

    /** Everything but `face`; @p jump_offset has dim entries. */
    void store(const Discretization<dim> &discretization, const State &state,
               std::size_t point, const double *jump_offset, double *row) const;

    /** History and impulse of a point whose vectors have their size. */
    void restore(const double *row, double weight, std::size_t point,
                 State &state) const;

    /** The vectors that rows hold. */
    void resize(std::size_t n_points, State &state) const;

  private:
    /** @p visit (PointField, member of State) for those that a row holds. */
    template <typename Visit>
    void for_fields(Visit &&visit) const;

    std::vector<bool> used_; ///< by field of for_point_fields()
    unsigned int size_;
  };
} // namespace nsfd
