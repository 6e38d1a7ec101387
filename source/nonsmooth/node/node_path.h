#pragma once

namespace nsfd
{
  struct NodeReport;
  template <int dim>
  class NodeSystem;

  /**
   * The way to the impulses of a node by softer ones: with a spring in series
   * with every law, W + s R in place of W, impulses are unique where cycles of
   * points hold each other, and those that slide, hold or open change one after
   * the other as s falls from 1. From each s to the next by full steps of
   * Newton's method: what a point is beyond its friction or strength is large
   * for a moment beside what is wrong with the velocities, so that the natural
   * map is no measure of a step; and never far, so that none is needed.
   */
  template <int dim>
  class NodePath
  {
  public:
    enum class Slack {
      nothing,   ///< springs without load at P = 0: one way for all starts
      here_first ///< at the impulses of the s before
    };

    /** Uses the slots 0 and 2 of @p system. */
    NodePath(NodeSystem<dim> &system, NodeReport &report)
        : system_(system), report_(report)
    {
    }

    /**
     * To a solution without springs, which has @p part of R from then on;
     * false: somewhere near the end, with R as it was.
     */
    bool follow(double part, Slack slack);

  private:
    bool newton(double share, double tolerance, unsigned int most);
    bool begin(double part, Slack slack);
    bool descend(Slack slack);
    bool finish();

    NodeSystem<dim> &system_;
    NodeReport &report_;
  };
} // namespace nsfd
