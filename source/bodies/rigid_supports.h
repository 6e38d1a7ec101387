#pragma once

#include "body_layout.h"

#include <functional>
#include <vector>

namespace nsfd
{
  /**
   * Supports of rigid bodies that leave some of their motions free, as a side
   * of a block that is driven along itself. At rest the rows of such a support
   * depend on each other. Once the body has turned by an angle a their arms
   * differ by a times the size of the side, and together they would hold it
   * there, by impulses of 1/a times those that move it: a rotation that is free
   * and impossible at once. Rows of a body keep the range that they have at
   * rest, as weighted means of each other: of a side that is driven along
   * itself it is the mean of its points that moves as given.
   */
  template <int dim>
  class RigidSupports
  {
  public:
    RigidSupports(const SceneInput &input,
                  const Discretization<dim> &discretization,
                  const BodyLayout<dim> &layout);

    /** The rows of the supports of @p body in its @p trace, (slot, component)
        by unknown. */
    void project(std::size_t body, Block &trace) const;

    /** What is asked of them, m/s; @p given by point of the mesh and
        component. */
    void project(const std::function<double &(std::size_t point,
                                              unsigned int c)> &given) const;

  private:
    struct Row {
      unsigned int slot, component, point;
      double root; ///< of its weight
    };
    struct Support {
      std::vector<Row> rows;
      std::vector<std::vector<double>> basis; ///< of their range at rest
    };

    static void project(const Support &support, std::vector<double> &values);

    std::vector<Support> supports_; ///< by body; no basis: nothing changes
  };
} // namespace nsfd
