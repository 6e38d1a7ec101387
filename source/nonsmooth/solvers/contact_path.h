#pragma once

#include "linearised_laws.h"

#include <limits>
#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * The state of a solve that keeps the bodies as unknowns next to the
   * impulses: y = v - v_free, U = U_free + H y, and what both parts of the
   * interior point method, its start and its path, need to know.
   *
   * Candidates are the points in unilateral contact whose law is convex once
   * damage is given. The others, springs, joints and what else there is, are
   * linearised as they are in every step.
   */
  template <int dim>
  class ContactPath
  {
  public:
    using Vector = std::vector<double>;

    ContactPath(const OneStepProblem<dim> &problem,
                const DelassusOperator<dim> &delassus, BodySystem<dim> &system,
                const SolverControl &control, Vector &impulse,
                LawEvaluation<dim> &evaluation, SolverReport &report);

    /**
     * @p count steps of the alternating direction method of multipliers, one
     * factor for all: every candidate and every nonlinear point solves its own
     * full law against a stiffness that is the one of its bodies moved as a
     * whole (@p balance 0), of the point moved alone (1) or between them.
     * True as soon as the error is below the tolerance.
     */
    bool alternate(unsigned int count, double balance);

    /** Where the path begins and how points are weighted along it. */
    struct Stage {
      double floor;  ///< least local magnitude over the mean; 1: all alike
      double centre; ///< distance from the boundary at the start
    };
    /**
     * Primal-dual interior point steps along one stage of the central path.
     * True as soon as the error is below the tolerance.
     */
    bool follow(const Stage &stage, unsigned int limit);

    /**
     * Newton's method on the full laws from the best impulses, and where it
     * goes round between the states of a few points, solve_cluster().
     */
    bool refine();

    /** Back to the best impulses. */
    void restore();

    /**
     * The contacts that hold the error up, and their neighbours, exactly by
     * pivots; all other points as they are linearised at the best impulses. In
     * two dimensions. True below the tolerance; false also if there is nothing
     * to be done, and then @p moved is false.
     */
    bool solve_cluster(bool &moved);

  private:
    struct Candidate {
      std::size_t point;
      double friction;  // mu kappa
      double scale;     // s
      double r[dim], z; // density of the contact impulse, slack
      double k[dim];    // of the Newton step: dr = k - S dU
      double S[dim * dim];
    };

    bool is_held(const std::size_t point) const
    {
      return problem_.kind[point] == PointKind::prescribed;
    }
    bool is_linear(std::size_t point) const;
    double stiffness_at(std::size_t point, unsigned int c,
                        double balance) const;
    void begin();
    void look();
    void set_imbalance(const Vector &P);
    void equilibrate(const Vector &P, bool from_rest);
    bool newton(unsigned int patience);
    std::vector<std::size_t> find_cluster() const;
    void find_candidates();
    void start(double floor, double centre);
    bool step(double sigma, double &alpha);
    void linearise(Candidate &candidate, double barrier, double smoothing);
    double path_length(const Candidate &candidate, const double *dr,
                       double dz) const;
    void spring(std::size_t point, double *impulse, double *slope) const;
    void collect();
    bool judge();
    double mean_gap() const;
    double impedance(const std::size_t point, const unsigned int c) const
    {
      return system_.impedance()[point * dim + c] / problem_.weight[point];
    }

    const OneStepProblem<dim> &problem_;
    const DelassusOperator<dim> &delassus_;
    BodySystem<dim> &system_;
    const SolverControl &control_;
    Vector &impulse_;
    LawEvaluation<dim> &evaluation_;
    SolverReport &report_;

    std::vector<Candidate> candidates_;
    std::vector<FrozenPoint> frozen_; // of candidates
    std::vector<char> is_candidate_, others_;
    LinearisedLaws<dim> laws_;
    struct {
      Vector y, U, S, P;
    } at_; ///< the iterate; S: slopes of the linearised points
    struct {
      Vector y, U, P;
    } direction_; ///< the Newton step
    struct {
      Vector P;
      double error = std::numeric_limits<double>::infinity();
    } best_; ///< impulses so far
    Vector b_, residual_;
    double mean_impulse_ = 0., softening_ = 1e-7;
    /// best error when refine() was last called
    double refined_ = std::numeric_limits<double>::infinity();
  };
} // namespace nsfd
