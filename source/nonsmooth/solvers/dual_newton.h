#pragma once

#include "delassus/inner_solver.h"
#include "linear_algebra/gmres.h"
#include "nonsmooth/frictional_contact/contact_solver.h"
#include "nonsmooth/solver.h"

namespace nsfd
{
  /**
   * Newton's method on the natural map of the dual problem.
   *
   * With damage and friction thresholds fixed, the laws are monotone and the
   * Newton system is (W + D) dP = -(D + R) Phi, D >= 0 the compliance of the
   * law at its local solution: conjugate gradients. Components without
   * compliance bound (open contacts, sliding friction) follow their law at
   * once and leave the system. A step that does not reduce the natural map is
   * replaced by an exact line search on the convex dual objective between
   * two points of its domain.
   *
   * Where damage grows or a friction threshold follows its normal impulse,
   * the local solutions are differentiated as they are, and the unsymmetric
   * system (I - J (W - R)) dP = -Phi goes to GMRES. What that does not
   * reduce is tried in shares, then by the convex step with the thresholds
   * frozen. Without them, sweeps of Gauss-Seidel take over what round-off
   * stops; all is judged by the natural map.
   * Newton systems are solved in single precision where the operator can.
   */
  template <int dim>
  class DualNewton final : public NonsmoothSolver<dim>,
                           public AssembledMethod<ContactMethod::newton>
  {
  public:
    SolverReport solve(const OneStepProblem<dim> &problem,
                       DelassusOperator<dim> &delassus,
                       const double energy_scale, const SolverControl &control,
                       std::vector<double> &impulse,
                       LawEvaluation<dim> &evaluation) override;

    const ContactSolver *contact_solver() const override { return this; }

  private:
    using Vector = std::vector<double>;
    struct Work {
      const OneStepProblem<dim> &problem;
      DelassusOperator<dim> &delassus;
      const SolverControl &control;
      LawEvaluation<dim> &evaluation;
      SolverReport &report;
      std::size_t n, n_owned; // components
      const Vector *impulse;  // where the evaluation is
      InnerSolver *inner;     // or null
    };

    bool differentiate(const Work &work, const Vector &impulse);
    bool spring_direction(const Work &work, double tolerance, Vector &dP);
    void symmetric_direction(const Work &work, double tolerance, Vector &dP);
    void coupled_direction(const Work &work, double tolerance, double shift,
                           Vector &dP);
    bool shorten(const Work &work, double before, const Vector &dP,
                 Vector &impulse, Vector &trial);
    bool line_search(const Work &work, const Vector &direction,
                     Vector &impulse);
    double majorant(const Work &work, const std::size_t k) const
    {
      return work.evaluation.majorant(k / dim, k % dim);
    }

    Vector slopes_;   // -dP*/dU_loc, frozen
    Vector jacobian_; // dP*/dU_loc, dim x dim per point, where coupled
    std::vector<char> coupled_;
    Vector compliance_; // D, -1: does not take part
    Vector majorants_;
    std::vector<LocalSolution<dim>> solutions_; // before the step, with
    Vector defect_, velocity_;                  // what follows from them
    krylov::CgVectors cg_;
    Vector rhs_;
    std::vector<std::vector<unsigned int>> colours_;
  };
} // namespace nsfd
