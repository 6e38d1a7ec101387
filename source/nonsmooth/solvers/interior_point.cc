#include "contact_path.h"
#include "gathered.h"

#include "nonsmooth/frictional_contact/contact_solver.h"
#include "nsfd/core/archive.h"

namespace nsfd
{
  namespace
  {
    /**
     * Interior points for Coulomb friction on many points: a start by the
     * alternating direction method, the central path with the friction law
     * inside the Newton system, Newton's method on the full laws at its end.
     * Coulomb's law is not convex: what is not solved is reported.
     */
    template <int dim>
    class InteriorPoint final
        : public NonsmoothSolver<dim>,
          public AssembledMethod<ContactMethod::interior_point>
    {
    public:
      SolverReport solve(const OneStepProblem<dim> &problem,
                         DelassusOperator<dim> &delassus,
                         const double energy_scale,
                         const SolverControl &control,
                         std::vector<double> &impulse,
                         LawEvaluation<dim> &evaluation) override
      {
        return solve_on_one_rank(
            gathered_, problem, delassus, energy_scale, control,
            control.tolerance, impulse, evaluation,
            [&](const auto &whole, auto &bodies, auto &all, auto &laws,
                auto &report) {
              follow(whole, bodies, control, all, laws, report);
            });
      }

      /** Whether iterations have failed, so that factors came back. */
      void serialize(Archive &archive) override
      {
        if (system_)
          iterates_ = system_->may_iterate();
        archive.numbers("iterates", iterates_);
      }

      const ContactSolver *contact_solver() const override { return this; }

    private:
      using Stage = typename ContactPath<dim>::Stage;

      void follow(const OneStepProblem<dim> &problem,
                  const DelassusOperator<dim> &delassus,
                  const SolverControl &control, std::vector<double> &impulse,
                  LawEvaluation<dim> &evaluation, SolverReport &report)
      {
        if (!system_) {
          system_ = std::make_unique<BodySystem<dim>>(
              delassus, problem.time_step, delassus.bulk_theta());
          if (!iterates_)
            system_->forbid_iterations();
        } else if (system_->time_step() != problem.time_step ||
                   system_->theta() != delassus.bulk_theta())
          system_->reinit(problem.time_step, delassus.bulk_theta());
        ContactPath<dim> path(problem, delassus, *system_, control, impulse,
                              evaluation, report);
        run(path);
        path.restore();
      }

      /** Dear parts last; each begins where the one before has come to. */
      bool run(ContactPath<dim> &path)
      {
        if (path.alternate(40, 0.5) || path.refine() ||
            path.alternate(60, 1.) || path.refine() ||
            path.follow({1., 1.}, 60) || path.refine())
          return true;
        for (const Stage stage : {Stage{1e-3, 3e-3}, Stage{1e-5, 3e-4}})
          if (path.alternate(20, 1.) || path.follow(stage, 60) || path.refine())
            return true;
        return path.alternate(200, 0.5) || path.refine() ||
               path.follow({1., 1.}, 60) || path.refine();
      }

      std::unique_ptr<Gathered<dim>> gathered_; // before what refers to it
      std::unique_ptr<BodySystem<dim>> system_;
      bool iterates_ = true; ///< what system_ is to begin with
    };

    using InteriorPoint2 = InteriorPoint<2>;
    using InteriorPoint3 = InteriorPoint<3>;
    NSFD_REGISTER(SolverRegistry<2>, InteriorPoint2, "interior point",
                  "central path with Coulomb friction inside, sparse factors; "
                  "for many rubbing faces and long steps");
    NSFD_REGISTER(SolverRegistry<3>, InteriorPoint3, "interior point",
                  "central path with Coulomb friction inside, sparse factors; "
                  "for many rubbing faces and long steps");
  } // namespace
} // namespace nsfd
