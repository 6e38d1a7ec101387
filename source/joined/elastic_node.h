#pragma once

#include "loose_node.h"

#include <cstdint>

namespace nsfd
{
  /**
   * The problem of a node in a step of joined cells, as long as every point of
   * it is an ElasticPoint. Groups that points hold together are one; what is
   * left is linear once it is known which points are closed, and its inverse is
   * kept from step to step. Intrinsic laws everywhere cost little more than a
   * spring until something softens, whatever the stiffness: neither does the
   * law limit the step nor its stiffness the accuracy, since what remains is
   * measured in velocities.
   */
  template <int dim>
  class ElasticNode
  {
  public:
    /** The largest numbers of unknowns, since the map of a node is dense, and
       of points and groups. */
    static constexpr unsigned int most = 48,
                                  most_points = MergedGroups<dim>::most;
    /** Of velocities, over the size of those that they are differences of. */
    static constexpr double round_off = 4e-15;

    /**
     * Of the points as they are, with @p beta by point of the problem; until
     * one of them, or the step, changes. False if this is no such node.
     */
    bool reinit(const OneStepProblem<dim> &problem,
                const NodeProblem<dim> &node, const std::vector<double> &beta);

    struct Point {
      ElasticPoint<dim> law;
      std::array<double, dim> flexibility{}; ///< 1 / (kappa s), kg^-1
      bool closed = false;                   ///< in the map
    };
    /** By point of the node. */
    const Point &point(const std::size_t k) const { return points_[k].own; }

    /**
     * Velocities of the groups of @p node; impulses and velocities of its
     * points (dim per point of the problem, local frame, N s and m/s). @p
     * closed: the points that were, where the search begins. False where a
     * point would be damaged or rub, or more than round-off is left; then only
     * impulses may have changed, to others to begin with.
     */
    bool solve(const OneStepProblem<dim> &problem,
               const std::vector<double> &frames,
               const std::vector<std::uint8_t> &closed, NodeProblem<dim> &node,
               std::vector<double> &impulses, std::vector<double> &velocities);

    /** It is solved soon. */
    void prefetch() const
    {
      merged_.prefetch();
      if (is_loose_) {
        loose_.prefetch();
        return;
      }
      nsfd::prefetch(points_);
      nsfd::prefetch(inverse_);
    }

    /** LooseNode may solve it. */
    bool is_loose() const { return is_loose_; }
    const LooseNode<dim> &loose() const { return loose_; }
    const MergedGroups<dim> &merged() const { return merged_; }

  private:
    using Vector = std::array<double, dim>;
    /// loops over a map go by as many numbers
    static constexpr std::size_t lanes = 4;
    using Unknowns = std::array<double, most>;

    struct Placed {
      Point own;
      std::array<int, 2> groups{}; ///< merged
      std::array<int, dim> rows{}; ///< of the map; -1: none
      int held = -1;               ///< which one of those that hold
      /// both sides are held together: U = 0
      bool is_inside = false;
      bool follows = false; ///< closed, by what others do

      bool has_rows() const
      {
        for (const int row : rows)
          if (row >= 0)
            return true;
        return false;
      }
    };
    /** Of the step that is solved. */
    struct Step {
      std::array<Vector, most_points> free, moving;              ///< of groups
      std::array<Vector, most_points> impulse, offset, velocity; ///< y_0/s: m/s
      std::array<double, most_points> target;
      std::array<Vector, most_points> change; ///< of momentum of groups
      double speed = 0.;
      std::array<bool, most_points> closed;
    };
    enum class Found { yes, no, impossible };

    bool begin(const OneStepProblem<dim> &problem,
               const std::vector<std::uint8_t> &closed,
               const NodeProblem<dim> &node, Step &step) const;
    bool set_map(const NodeProblem<dim> &node,
                 const std::vector<double> &frames, const Step &step);
    std::size_t number_rows(const Step &step, std::array<int, most> &row_of);
    void begin_impulses(const OneStepProblem<dim> &problem,
                        const NodeProblem<dim> &node, Step &step) const;
    void move(const NodeProblem<dim> &node, const std::vector<double> &frames,
              Step &step) const;
    bool solve_map(const NodeProblem<dim> &node,
                   const std::vector<double> &frames, Step &step) const;
    void carry(const NodeProblem<dim> &node, const std::vector<double> &frames,
               Step &step) const;
    Found find_closed(const OneStepProblem<dim> &problem,
                      const NodeProblem<dim> &node, Step &step);
    bool is_elastic(const OneStepProblem<dim> &problem,
                    const NodeProblem<dim> &node, const Step &step) const;
    double spring_impulse(const OneStepProblem<dim> &problem,
                          const NodeProblem<dim> &node, std::size_t k,
                          double velocity) const;

    MergedGroups<dim> merged_;
    std::vector<Placed> points_;
    LooseNode<dim> loose_;
    bool has_map_ = false, any_held_ = false, is_loose_ = false;
    std::vector<double> inverse_;       ///< of the map, symmetric
    std::size_t size_ = 0, stride_ = 0; ///< of it and of a row
  };
} // namespace nsfd
