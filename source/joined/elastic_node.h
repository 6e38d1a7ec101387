#pragma once

#include "linear_algebra/dense_lu.h"
#include "node_problem.h"
#include "nonsmooth/point_law.h"

#include <cstdint>

namespace nsfd
{
  /**
   * A point that is a spring as long as it is not open beyond its history: with
   * P = -kappa (y_0 + s U) in each direction and, where the spring is
   * one-sided, contact. Or one that is broken, as long as it is open; or one
   * that never was open, as long as it holds: U = 0.
   */
  template <int dim>
  struct ElasticPoint {
    Secant secant; ///< Pa/m
    double beta = 1.;
    double largest = 0.;    ///< of the square of the effective opening
    bool one_sided = false; ///< contact ends the spring
    bool rubs = false;      ///< once it is closed
    bool broken = false, holds = false;

    /** False if the point is anything else. @p beta: what it has. */
    bool reinit(const OneStepProblem<dim> &problem, std::size_t i, double beta);

    struct Energies {
      double stored, stored_old;        ///< J/m^2
      std::array<double, dim> traction; ///< of the spring, Pa
    };
    /** Of a step with @p velocity (dim) that was solved. */
    Energies energies(const OneStepProblem<dim> &problem, std::size_t i,
                      const double *velocity) const;
  };

  /**
   * The problem of a node in a step of joined cells, as long as every point of
   * it is an ElasticPoint: which of them are closed decides on a linear map
   * that is kept from step to step. Intrinsic laws everywhere cost little more
   * than a spring until something softens, whatever the stiffness: neither
   * does the law limit the step nor its stiffness the accuracy, since what
   * remains is measured in velocities.
   */
  template <int dim>
  class ElasticNode
  {
  public:
    /** The largest numbers of unknowns, since the map of a node is dense, and
       of points. */
    static constexpr unsigned int most = 48, most_points = 80;

    /**
     * Of the points as they are, with @p beta by point of the problem; until
     * one of them, or the step, changes. False if this is no such node.
     */
    bool reinit(const OneStepProblem<dim> &problem,
                const std::vector<double> &frames, const NodeProblem<dim> &node,
                const std::vector<double> &beta);

    struct Point {
      ElasticPoint<dim> law;
      std::array<double, dim> flexibility{}; ///< 1 / (kappa s), kg^-1
      bool closed = false;                   ///< in the map
      unsigned int first = 0; ///< of its unknowns; broken: it has none
    };
    /** By point of the node. */
    const Point &point(const std::size_t k) const { return points_[k]; }

    /**
     * Velocities of the groups of @p node; impulses and velocities of its
     * points (dim per point of the problem, local frame, N s and m/s). @p
     * closed: the points that were, where the search begins. False, and nothing
     * is changed, where a point would be damaged or rub, or more than round-off
     * is left.
     */
    bool solve(const OneStepProblem<dim> &problem,
               const std::vector<double> &frames,
               const std::vector<std::uint8_t> &closed, NodeProblem<dim> &node,
               std::vector<double> &impulses, std::vector<double> &velocities);

  private:
    using Vector = std::array<double, dim>;
    /// loops over a map go by as many numbers
    static constexpr std::size_t lanes = 4;
    using Unknowns = std::array<double, most>;
    /** Of the step that is solved. */
    struct Step {
      Unknowns impulse;
      std::array<Vector, most_points> free, offset, velocity; ///< y_0/s: m/s
      std::array<double, most_points> target;
      double speed = 0.;
      std::array<bool, most_points> closed;
    };

    void begin(const OneStepProblem<dim> &problem,
               const std::vector<double> &frames,
               const std::vector<std::uint8_t> &closed,
               const NodeProblem<dim> &node, Step &step) const;
    bool set_open_map(std::size_t n, const NodeProblem<dim> &node,
                      const std::vector<double> &frames);
    bool set_map(const Step &step);
    bool solve_map(const NodeProblem<dim> &node,
                   const std::vector<double> &frames, Step &step);
    bool find_closed(const OneStepProblem<dim> &problem,
                     const NodeProblem<dim> &node, Step &step) const;
    bool is_elastic(const OneStepProblem<dim> &problem,
                    const NodeProblem<dim> &node, const Step &step) const;
    bool can_hold(const OneStepProblem<dim> &problem, std::size_t i,
                  const double *impulse) const;
    double spring_impulse(const OneStepProblem<dim> &problem,
                          const NodeProblem<dim> &node, std::size_t k,
                          double velocity) const;

    std::vector<Point> points_;
    bool has_map_ = false;
    /// of the maps, column by column: with all points open, and now
    std::vector<double> open_, inverse_;
    std::size_t size_ = 0, stride_ = 0; ///< of them and of a column
    std::vector<Vector> velocity_;
    DenseLU lu_;
  };
} // namespace nsfd
