#include "apart_motion.h"
#include "augmented_lagrangian.h"
#include "gathered.h"

#include <algorithm>
#include <memory>

namespace nsfd
{
  namespace
  {
    /** The method of multipliers; bodies apart are those of all ranks on one,
        as their factor is serial. */
    template <int dim>
    class Multipliers final : public NonsmoothSolver<dim>
    {
    public:
      SolverReport solve(const OneStepProblem<dim> &problem,
                         DelassusOperator<dim> &delassus,
                         const double energy_scale,
                         const SolverControl &control,
                         std::vector<double> &impulse,
                         LawEvaluation<dim> &evaluation) override
      {
        if (dynamic_cast<VelocitySolver *>(&delassus))
          return method_.solve(problem, delassus, energy_scale, control,
                               impulse, evaluation);
        // One more step costs little, and what is left adds up: over steps, and
        // in the rounds of a large motion, which begin near their solution.
        SolverControl aim = control;
        aim.tolerance *= 0.1;
        return solve_on_one_rank(
            gathered_, problem, delassus, energy_scale, control, aim.tolerance,
            impulse, evaluation,
            [&](const auto &whole, auto &bodies, auto &all, auto &laws,
                auto &report) {
              solve_apart(whole, bodies, energy_scale, aim, all, laws, report);
            },
            true);
      }

    private:
      void solve_apart(const OneStepProblem<dim> &problem,
                       DelassusOperator<dim> &delassus,
                       const double energy_scale, const SolverControl &control,
                       std::vector<double> &impulse,
                       LawEvaluation<dim> &evaluation, SolverReport &report)
      {
        std::vector<char> held(problem.n_points, 0);
        for (const std::size_t i : problem.acting)
          held[i] = is_held(problem, i);
        const TiedNodes<dim> ties(delassus, held);
        OneStepProblem<dim> rest = problem;
        rest.acting.erase(std::remove_if(rest.acting.begin(), rest.acting.end(),
                                         [&](const unsigned int i) {
                                           return ties.points()[i] != 0;
                                         }),
                          rest.acting.end());
        ApartMotion<dim> motion(rest, delassus, ties);
        method_.set_motion(&motion);
        report = method_.solve(rest, delassus, energy_scale, control, impulse,
                               evaluation);
        method_.set_motion(nullptr);
        motion.complete(impulse);
        evaluation.update(impulse);
      }

      std::unique_ptr<Gathered<dim>> gathered_; // before what refers to it
      AugmentedLagrangian<dim> method_;
    };

    using Multipliers2 = Multipliers<2>;
    using Multipliers3 = Multipliers<3>;
    NSFD_REGISTER(SolverRegistry<2>, Multipliers2, "multipliers",
                  "Newton's method in the velocities, with springs that give "
                  "way before every law: impulses need not be unique");
    NSFD_REGISTER(SolverRegistry<3>, Multipliers3, "multipliers",
                  "Newton's method in the velocities, with springs that give "
                  "way before every law: impulses need not be unique");
  } // namespace
} // namespace nsfd
