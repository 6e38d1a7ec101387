#pragma once

#include "nonsmooth/node/node_problem.h"
#include "nonsmooth/point_law.h"

#include <cstdint>

namespace nsfd
{
  /**
   * Points of nodes as they are at the start of a step, for as long as this
   * exists: what never was open holds whatever pulls, what has softened is the
   * spring of its history. For problems, beyond uniqueness, of which no
   * solution is found. A spring that goes on beyond its history takes more than
   * the law stores and dissipates: the step gives no energy.
   */
  template <int dim>
  class HeldNodes
  {
  public:
    explicit HeldNodes(OneStepProblem<dim> &problem);
    ~HeldNodes();
    HeldNodes(const HeldNodes &) = delete;
    HeldNodes &operator=(const HeldNodes &) = delete;

    void hold(const NodeProblem<dim> &node);

    /** False: no point could soften. */
    bool any() const { return !points_.empty(); }
    /** Tells the held @p solutions what they are. */
    void mark(std::vector<LocalSolution<dim>> &solutions) const;
    /** Of a held @p impulse over the strength, less 1, at least 0. */
    double excess(const std::vector<double> &impulses) const;

  private:
    struct Point {
      std::size_t index;
      PointKind kind;
      std::uint8_t mask;
      unsigned int interaction;
    };

    OneStepProblem<dim> &problem_;
    const std::size_t n_interactions_;
    std::vector<Point> points_;
  };
} // namespace nsfd
