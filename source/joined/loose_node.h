#pragma once

#include "elastic_point.h"
#include "merged_groups.h"

namespace nsfd
{
  /**
   * The problem of a node whose points all hold or are broken, as long as the
   * broken ones stay apart: there is nothing to solve. Merged groups move
   * freely, and what holds carries what their momentum asks for. Most nodes of
   * a body that falls to pieces are such; what they need lies together.
   */
  template <int dim>
  class LooseNode
  {
  public:
    /** Nothing is here. */
    void clear();
    /** The next point of the node, @p index of the problem, holds. */
    void add_held(std::size_t index, const ElasticPoint<dim> &law);
    /** It is broken, between the merged @p groups. False if it is none that is
        free of forces whenever it is open. */
    bool add_broken(const OneStepProblem<dim> &problem, std::size_t index,
                    const std::array<int, 2> &groups);

    struct Broken {
      unsigned int index;        ///< of the problem
      std::array<int, 2> groups; ///< merged
    };
    const std::vector<Broken> &broken() const { return broken_; }
    /** It is solved soon. */
    void prefetch() const
    {
      nsfd::prefetch(held_);
      nsfd::prefetch(broken_);
    }

    /**
     * Velocities of the groups of @p node, of its broken points, and impulses
     * of those that hold; these are not touched otherwise: in the last steps
     * too they have been at rest, or apart. False where one of them is at the
     * end of what it can do; then only impulses and velocities of points may
     * have changed.
     */
    bool solve(const OneStepProblem<dim> &problem,
               const std::vector<double> &frames,
               const std::vector<double> &released_overlap,
               const MergedGroups<dim> &merged, NodeProblem<dim> &node,
               std::vector<double> &impulses,
               std::vector<double> &velocities) const;

  private:
    using Vector = std::array<double, dim>;

    struct Held {
      unsigned int index;
      double surely_held; ///< see ElasticPoint
    };

    bool carry(const std::vector<double> &frames,
               const MergedGroups<dim> &merged, const NodeProblem<dim> &node,
               const Vector *moving, std::vector<double> &impulses) const;
    bool stay_apart(const OneStepProblem<dim> &problem,
                    const std::vector<double> &frames,
                    const std::vector<double> &released_overlap,
                    const NodeProblem<dim> &node, const Vector *moving,
                    std::vector<double> &velocities) const;

    std::vector<Held> held_;
    std::vector<Broken> broken_;
  };
} // namespace nsfd
