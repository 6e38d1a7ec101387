#pragma once

#include "extremes.h"
#include "model.h"

#include "records/certificate.h"
#include "time_integration/energy_watch.h"
#include "time_integration/time_integrator.h"

namespace nsfd
{
  class Archive;

  /** How the accepted steps of a run were solved, by what their residual is. */
  class SolvedSteps
  {
  public:
    void add(ResidualKind kind, double residual);
    void fill(RunFacts &facts) const;
    void serialize(Archive &archive);

  private:
    unsigned long long dynamic_ = 0, quasi_static_ = 0, smooth_ = 0;
    double residual_ = 0., imbalance_ = 0.;
  };

  /** What the certificate of a run is made from. Collective. */
  template <int dim>
  RunFacts run_facts(const SceneInput &input, const Model<dim> &model,
                     const SolvedSteps &steps, const Extremes<dim> &extremes,
                     const EnergyWatch &watch, const State &state,
                     const Summary &summary, const Communicator &communicator);
} // namespace nsfd
