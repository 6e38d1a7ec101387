#pragma once

#include "body_model.h"
#include "moreau_jean.h"

#include <functional>

namespace nsfd
{
  template <int dim>
  class InelasticBodies;
  template <int dim>
  class MovingBodies;

  /**
   * The Moreau-Jean step of bodies whose motion is no linear function of the
   * impulses: Newton's iteration around the nonsmooth problem (report, (131)).
   * The bodies move under the impulses at hand, each by itself and exactly;
   * what more impulse would do is linear, with their tangents, and makes the
   * nonsmooth problem of linear bodies. It ends when the bodies move as the
   * last of these problems has taken them to.
   */
  template <int dim>
  class NewtonMoreauJean final : public MoreauJean<dim>
  {
  public:
    /** Rotations and strains of any size. @p delassus is that of @p bodies. */
    NewtonMoreauJean(const SceneInput &input,
                     const Discretization<dim> &discretization,
                     MovingBodies<dim> &bodies,
                     DelassusOperator<dim> &delassus);
    /** Small motions, history-dependent materials. */
    NewtonMoreauJean(const SceneInput &input,
                     const Discretization<dim> &discretization,
                     InelasticBodies<dim> &bodies,
                     DelassusOperator<dim> &delassus);
    ~NewtonMoreauJean() override;

    State initial_state() const override;
    void complete(State &state) const override;
    /** A step that has not converged after 40 rounds is rejected. */
    StepReport
    advance(const State &old, double time_step, State &next,
            unsigned int idle_rounds = SolverControl().idle_rounds) override;

    void fill_counters(std::map<std::string, double> &counters) const override;

    const BodyModel<dim> &bodies() const { return *bodies_; }

  protected:
    std::string describe(std::size_t point) const override;

  private:
    SolverReport iterate(const State &old, double time_step,
                         const SolverControl &control,
                         std::unique_ptr<LawEvaluation<dim>> &evaluation);
    bool has_settled(const State &old, double time_step,
                     const SolverControl &control, unsigned int round);

    std::unique_ptr<BodyModel<dim>> bodies_;
    std::function<void()> stay_; ///< in place of their motion
    const std::string solver_name_;
    bool only_rigid_ = false;
    unsigned long long iterations_ = 0, most_iterations_ = 0;

    // of the step
    std::vector<double> impulse_;
    std::vector<double> v_free_; ///< linear, by unknown
    double energy_scale_ = 0.;
    std::vector<double> errors_; ///< of its rounds
  };
} // namespace nsfd
