#pragma once

#include "delassus/delassus_operator.h"
#include "nsfd/core/registry.h"
#include "one_step_problem.h"
#include "point_law.h"
#include "solver_report.h"

namespace nsfd
{
  class ContactSolver;

  /**
   * The point laws at the current impulses: velocities U, the solutions P* of
   * every local problem, and the natural map P - P*. All solvers and the step
   * judge by the same number,
   *
   *     error = |P - P*|_R / ( |P|_R + floor ),   |x|_R^2 = sum R x^2,
   *
   * R the majorant of the problem. The floor is 1e-6 (or 1e-14 / tolerance)
   * times the square root of the kinetic energy: round-off of free flight.
   */
  template <int dim>
  class LawEvaluation
  {
  public:
    LawEvaluation(const OneStepProblem<dim> &problem,
                  const DelassusOperator<dim> &delassus, double energy_scale,
                  double tolerance);

    /** As a new one of what the problem is now. */
    void renew(double energy_scale, double tolerance);

    /** Recompute U = U_free + W P and everything that follows. */
    void update(const std::vector<double> &impulse);

    /**
     * From now on the laws with damage and friction thresholds as given (one
     * per point, kept by the caller), except for points without a convex law:
     * rigid before the step, on a plateau, or lifted by sliding. Null: the full
     * laws.
     */
    void freeze(const std::vector<FrozenPoint> *frozen) { frozen_ = frozen; }
    bool is_frozen() const { return frozen_ != nullptr; }
    bool is_frozen(const std::size_t point) const
    {
      return frozen_ && has_frozen_law<dim>(problem_, point);
    }

    /** The same when W P is known already. */
    void update_laws(const std::vector<double> &impulse);

    double error = 0.;
    std::vector<double> velocity; ///< U
    std::vector<double> defect;   ///< P - P*
    std::vector<LocalSolution<dim>> solutions;

    /** The law at the last solution of a point, if it is linear there. */
    const LinearPoint<dim> *linear(const std::size_t point) const
    {
      return linear_[point].exists() && !solutions[point].damages &&
                     !is_frozen()
                 ? &linear_[point]
                 : nullptr;
    }
    std::size_t worst_point = 0;
    double worst_error = 0.;
    unsigned int law_calls = 0;

    std::array<double, dim> local_velocity(const std::vector<double> &impulse,
                                           std::size_t point) const;
    double majorant(const std::size_t point, const unsigned int c) const
    {
      return c == 0 ? problem_.majorant_normal[point]
                    : problem_.majorant_tangential[point];
    }

    double floor() const { return floor_; }

  private:
    const OneStepProblem<dim> &problem_;
    const DelassusOperator<dim> &delassus_;
    double floor_ = 0.;
    std::vector<unsigned int> points_; ///< that acted at the last renew()
    std::vector<LinearPoint<dim>> linear_;
    std::vector<double> terms_;
    const std::vector<FrozenPoint> *frozen_ = nullptr;
  };

  /**
   * Solves the cone problem of a step, with the laws of its points: impulses in
   * and out (warm start), velocities out. No printing, no throwing; the report
   * tells.
   */
  template <int dim>
  class NonsmoothSolver
  {
  public:
    virtual ~NonsmoothSolver() = default;
    virtual SolverReport
    solve(const OneStepProblem<dim> &problem, DelassusOperator<dim> &delassus,
          double energy_scale, const SolverControl &control,
          std::vector<double> &impulse, LawEvaluation<dim> &evaluation) = 0;

    /**
     * The same solver for problems of contact and friction alone whose W is
     * assembled; null where it needs the laws of points.
     */
    virtual const ContactSolver *contact_solver() const { return nullptr; }

    /** What one solve leaves to the next, if anything. */
    virtual void serialize(Archive &) {}
  };

  template <int dim>
  using SolverRegistry = Registry<NonsmoothSolver<dim>>;

  /** Faces in colours: no two faces of a colour share a body. */
  template <int dim>
  std::vector<std::vector<unsigned int>>
  colour_faces(const DelassusOperator<dim> &delassus);

  /**
   * @p count sweeps of nonlinear Gauss-Seidel over the colours: the full law,
   * damage included, in each local solve. The same on every number of ranks.
   */
  template <int dim>
  void gauss_seidel(const OneStepProblem<dim> &problem,
                    const DelassusOperator<dim> &delassus,
                    const std::vector<std::vector<unsigned int>> &colours,
                    unsigned int count, std::vector<double> &impulse);
} // namespace nsfd
