#pragma once

#include "delassus/velocity_solver.h"
#include "nonsmooth/solver.h"
#include "vertex_elimination.h"

namespace nsfd
{
  /**
   * Newton's method in the velocities of the bodies, where points may be more
   * than motions, so that impulses are not unique: of bodies that share nodes,
   * or round a node that faces of cells apart have in common.
   *
   * A spring in series with every law gives way by A = share R times what the
   * impulse is beyond P_0, so that the impulse follows from the velocity,
   *
   *     P = S(U),  S the answer of each point by itself against A,
   *     M_hat (v - v_free) = H^T S(H v),
   *
   * the gradient of the incremental energy of the bodies and of the softened
   * laws. It is convex where the step is unique, softening or not, whatever
   * rows W lacks; along Newton's direction
   *
   *     (M_hat + H^T T H) dv = H^T (S - P),   T = -dS/dU,
   *
   * its slope dU . (P + alpha dP - S(U + alpha dU)) needs the laws alone, and
   * where it vanishes the step ends. P_0 then follows P (method of multipliers:
   * Hestenes 1969, Powell 1969; with friction Alart & Curnier 1991), until the
   * springs carry no more than the tolerance. Springs that are too stiff for
   * the method to get on are replaced by softer ones.
   *
   * What goes on round after round at a few points of one vertex is eliminated,
   * see VertexElimination.
   *
   * Rows with a prescribed velocity are linear, and what is left of them works
   * with their impulses, which in long steps are far larger than what moves:
   * further Newton steps solve them to SolverControl::row_energy.
   *
   * The operator is a VelocitySolver, or there is a motion of its bodies.
   */
  template <int dim>
  class AugmentedLagrangian final : public NonsmoothSolver<dim>
  {
  public:
    /** Of bodies apart, which have none of their own; it stays the owner's. */
    void set_motion(NodeMotion *motion) { own_motion_ = motion; }
    SolverReport solve(const OneStepProblem<dim> &problem,
                       DelassusOperator<dim> &delassus, double energy_scale,
                       const SolverControl &control,
                       std::vector<double> &impulse,
                       LawEvaluation<dim> &evaluation) override;

  private:
    using Vector = std::vector<double>;
    struct Work {
      const OneStepProblem<dim> &problem;
      const DelassusOperator<dim> &delassus;
      NodeMotion &motion; ///< of its bodies
      LawEvaluation<dim> &evaluation;
      double tolerance;
      unsigned int most; ///< Newton steps
      SolverReport &report;
      bool from_rest; ///< a round of statics

      /** A support in a step from rest: held in every Newton step. */
      bool holds(const std::size_t i) const
      {
        return from_rest && problem.kind[i] == PointKind::prescribed;
      }
    };

    /** What is sought: P, and the motion of the nodes. */
    struct Iterate {
      Vector impulse, motion;
    };
    struct Errors {
      double defect, shift;
    };

    /// A over R of the last springs, and what is left of those of what is rigid
    static constexpr double last_share = 1e-7;
    /// the latter where U is that of the nodes and not a difference of large
    /// numbers: what is rigid is so beside laws that have just begun to open
    static constexpr double of_nodes = 1e-11;
    /// of the momenta, what a step may lose of them
    static constexpr double lost = 1e-15;

    bool may_be_rough(const Work &work) const;
    double enough(const Work &work) const;
    void begin(const Work &work, const Vector &impulse);
    void polish(const Work &work);
    Iterate iterate(const Work &work) const;
    void return_to(const Work &work, const Iterate &iterate);
    void soften(const Work &work, double share);
    void answer(const Work &work, const Vector &U);
    Errors errors(const Work &work);
    bool differentiate(const Work &work);
    void symmetrise(const Work &work, bool convex);
    double slope(const Work &work, double length) const;
    void set_right_side(const Work &work);
    bool rests(const Work &work, std::size_t i) const;
    void keep_tangents_at_rest(const Work &work);
    void remove_springs(const Work &work);
    bool take_step(const Work &work, double tolerance, double share);
    double eliminate(const Work &work, double error);
    bool jump(const Work &work, unsigned int most_idle);
    void judge_velocities(const Work &work);
    void hold_rows(const Work &work, double most);
    bool find_direction(const Work &work);
    void advance(const Work &work);

    NodeMotion *own_motion_ = nullptr;
    std::vector<unsigned int> points_; ///< that act
    Vector impulse_, rest_, velocity_; ///< P, P_0, U
    Vector compliance_;                ///< A
    double rigid_ = last_share; ///< what rigid points give way by, over A
    double scale_ = 0.;         ///< of errors, with the last impulses
    std::vector<LocalSolution<dim>> solutions_;
    Vector tangents_; ///< T, dim x dim per point
    Vector right_side_, defect_, dP_, dU_;
    Vector moved_; ///< U of a trial
    VertexElimination<dim> elimination_;
  };
} // namespace nsfd
