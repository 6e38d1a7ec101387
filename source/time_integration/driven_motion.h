#pragma once

#include "discretization/discretization.h"
#include "nsfd/parameters/expression.h"

#include <vector>

namespace nsfd
{
  struct SceneInput;

  /**
   * Prescribed motion at the points of driven boundaries. What varies in space
   * is interpolated at the nodes of the cell first: the points of a cell that
   * is driven on two sides then ask for a motion that the cell has.
   */
  template <int dim>
  class DrivenMotion
  {
  public:
    DrivenMotion(const SceneInput &input,
                 const Discretization<dim> &discretization);

    /**
     * True if a boundary moves component @p c of point @p i and no other point
     * of its cell says the same.
     */
    bool drives(std::size_t i, unsigned int c) const;

    /** Velocity of a driven component at time @p t, or null. */
    const Expression *velocity(std::size_t i, unsigned int c) const;
    const Expression *displacement(std::size_t i, unsigned int c) const;

    /** @p motion as the cell of point @p i takes it. */
    double at(const Expression &motion, std::size_t i, double t) const;
    /** The same of a velocity, until @p clock has stopped it. */
    double velocity_at(const Expression &velocity, std::size_t i, double t,
                       const LoadClock &clock) const;
    /** The same of a displacement. */
    double place_at(const Expression &displacement, std::size_t i, double t,
                    const LoadClock &clock) const;

  private:
    /** A node of the cell, and its share in the point. */
    struct Sample {
      dealii::Point<dim> place;
      double share = 1.;
    };
    struct Row {
      std::size_t component; ///< of the points
      unsigned int trace;    ///< row of the trace of the body
    };
    void choose_rows();
    /** Components of @p rows of @p trace that others of them determine. */
    static std::vector<std::size_t>
    dependent_rows(const Block &trace, const std::vector<Row> &rows);
    bool jumps_at(std::size_t i, const dealii::Point<dim> &place,
                  const dealii::Point<dim> &inside) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    /// per point, size n + 1; empty: each is one by itself
    std::vector<std::size_t> first_;
    std::vector<Sample> samples_;
    std::vector<char> chosen_; ///< per point and component; empty: all
  };
} // namespace nsfd
