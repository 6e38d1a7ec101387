#pragma once

#include "delassus/joined_delassus.h"
#include "nonsmooth/one_step_problem.h"

#include <vector>

namespace nsfd
{
  struct PointOrigin;

  /**
   * Supports of bodies that share nodes: points at one node say the same of its
   * motion, one of them is enough, and two would differ by round-off.
   */
  template <int dim>
  class NodeSupports
  {
  public:
    /**
     * The masks of prescribed motion in @p problem, each component of a node
     * once. @p others: the bonds have changed since the last call. Collective.
     */
    void prescribe_once(JoinedDelassus<dim> &bonded,
                        const std::vector<PointOrigin> &origins, bool others,
                        OneStepProblem<dim> &problem);

  private:
    std::vector<std::uint8_t> given_, once_; ///< masks, as they are and once
  };
} // namespace nsfd
