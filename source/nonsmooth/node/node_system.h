#pragma once

#include "linear_algebra/dense_lu.h"
#include "node_problem.h"
#include "nonsmooth/point_law.h"

namespace nsfd
{
  /**
   * The equations of the points around one node,
   *
   *     v = v_free + M^-1 H^T P,    P = S(H v - R P),
   *
   * S the answer of each point by itself (solve_point()) against R times the
   * identity, R the largest entry of the inverse masses on both its sides. What
   * one method to solve them needs; NodeSolver says when.
   */
  template <int dim>
  class NodeSystem
  {
  public:
    /** Without what carries nothing for certain; these are told at once. */
    void reinit(const OneStepProblem<dim> &problem,
                const std::vector<double> &frames, const NodeProblem<dim> &node,
                std::vector<double> &impulses,
                std::vector<LocalSolution<dim>> &solutions);

    std::size_t n_points() const { return n_; }

    /** One point whose W is R times the identity: then S is the solution. */
    bool is_single() const { return n_ == 1 && points_[0].scalar; }
    void solve_single();

    /** S of all points at the present P, and | P - S |_R. */
    double evaluate();

    /** The same point by point, each answer taken at once. */
    double sweep();

    /** (|P|_R^2 + floor^2)^1/2 of the last of both: the natural map is relative
     * to it. The floor is 4e-3 of the speeds: round-off of free flight. */
    double scale() const { return scale_; }

    /** R times @p factor from now on: another map with the same solutions. */
    void scale_majorant(double factor);

    /**
     * From now on every law has a spring in series with it, which gives way by
     * R times @p share of the impulse, or of what it is beyond the present one:
     * W + share R in place of W. None for 0.
     */
    void soften(double share, bool from_here);

    /** Derivatives of S where it was evaluated. */
    void linearise();

    /**
     * Newton's direction of P = S, with R W^-1 softened by the share @p soft:
     * cycles of points that hold each other share what they hold. In scaled
     * velocities of the groups, of which there may be far fewer than points.
     */
    bool find_direction(double soft, bool refine);

    /**
     * How the impulses on @p groups, whose motion is prescribed, answer to
     * their velocities, at the solution: kg, row by row in the axes of space.
     * False if there is no such derivative.
     */
    bool respond(const std::vector<int> &groups, std::vector<double> &response);

    /** To the kept state plus @p length times the direction. */
    void move(double length);

    /** A state and what was evaluated there, to come back to. */
    void keep(unsigned int slot);
    void restore(unsigned int slot);

    /** All impulses times numbers between 0 and @p spread. */
    void scatter(std::uint64_t seed, double spread);

    /** v from the impulses, without the round-off of all changes. */
    void refresh_velocity();

    /** With the answers of the points in place of P where @p exact. */
    void store(bool exact, NodeProblem<dim> &node,
               std::vector<double> &impulses,
               std::vector<LocalSolution<dim>> &solutions);

  private:
    using Vector = std::array<double, dim>;
    using Matrix = std::array<double, dim * dim>;

    /** What changes of a point. */
    struct State {
      Vector impulse, local; ///< P, U_loc
      LocalSolution<dim> solution;
      bool carries; ///< else S and its derivative are 0
    };
    struct Point : State {
      std::size_t index;
      const double *frame;
      std::array<int, 2> groups;
      const PointEnds *ends;
      Vector start; ///< U where the groups have no velocity
      double R, speed;
      bool scalar;                ///< W of the point is R times the identity
      Vector rest;                ///< impulse at which its spring is slack
      Matrix slopes;              ///< D = -dS/dU_loc
      Matrix inverse, stiffness;  ///< (1 - soft' R D)^-1 and this times D
      Vector residual, direction; ///< of P
    };
    struct Kept {
      std::vector<State> points;
      std::vector<Vector> velocity;
      double scale;
    };

    const OneStepProblem<dim> *problem_ = nullptr;
    const std::vector<Vector> *inverse_mass_ = nullptr;
    std::vector<Point> points_; ///< the first n_ of them
    std::size_t n_ = 0;
    std::vector<Vector> free_, velocity_, change_, root_mass_;
    double floor_ = 0., scale_ = 0., soft_ = 0.;
    std::array<Kept, 3> kept_;
    std::vector<int> unknown_; ///< first of a group, -1: none
    int n_unknowns_ = 0;
    DenseLU matrix_;
    std::vector<double> right_side_;

    void add(const typename NodeProblem<dim>::Point &point,
             const std::vector<double> &frames);
    void push(const Point &point, const Vector &impulse,
              std::vector<Vector> &velocity) const;
    void answer(Point &point, bool near_first = true) const;
    bool invert_slopes(Point &point, double soft, double &stiffest) const;
    void assemble();
    double correct(double soft);
    bool held_by_round_off(const Point &point) const;
  };
} // namespace nsfd
