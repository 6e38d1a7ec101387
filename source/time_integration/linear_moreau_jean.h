#pragma once

#include "moreau_jean.h"
#include "node_supports.h"

namespace nsfd
{
  template <int dim>
  class JoinedDelassus;
  template <int dim>
  class BulkTraction;
  template <int dim>
  class ElasticForces;

  /**
   * The Moreau-Jean step of linear bodies: one free motion, one nonsmooth
   * problem. With `scheme = symplectic` the bodies are explicit.
   */
  template <int dim>
  class LinearMoreauJean final : public MoreauJean<dim>
  {
  public:
    /** @p bonded is @p delassus if the scene has bonded faces, else null. */
    LinearMoreauJean(const SceneInput &input,
                     const Discretization<dim> &discretization,
                     DelassusOperator<dim> &delassus,
                     NonsmoothSolver<dim> &solver,
                     JoinedDelassus<dim> *bonded = nullptr);
    ~LinearMoreauJean() override;

    State initial_state() const override;
    void complete(State &state) const override;
    void show(State &state) const override;
    /** Rejected is what was not solved to the tolerance. */
    StepReport
    advance(const State &old, double time_step, State &next,
            unsigned int idle_rounds = SolverControl().idle_rounds) override;

  protected:
    std::string describe(std::size_t point) const override;

  private:
    void start(const State &old, double time_step, State &next);
    void finish(const State &old, const LawEvaluation<dim> &evaluation,
                State &next) const;

    NonsmoothSolver<dim> &solver_;
    JoinedDelassus<dim> *bonded_;             ///< or null
    NodeSupports<dim> supports_;              ///< of bodies that share nodes
    std::unique_ptr<BulkTraction<dim>> bulk_; ///< or null: no bonded faces
    /// of what holds an initial stress by common nodes, W/s; 0: nothing does
    double stress_scale_ = 0.;
    std::unique_ptr<ElasticForces<dim>> elastic_forces_; ///< of explicit steps
    std::unique_ptr<LawEvaluation<dim>> evaluation_;     ///< of the last step
  };
} // namespace nsfd
