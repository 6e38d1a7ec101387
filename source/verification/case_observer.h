#pragma once

#include "discretization/discretization.h"
#include "nsfd/scene/time_input.h"
#include "nsfd/verification/verification_case.h"
#include "postprocess/crack_shape.h"
#include "state/state.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * Shows the states of a run to its verification case: averages of the cells
   * of all ranks after every step where the case wants them, and at the end
   * the errors of the fields it knows.
   */
  template <int dim>
  class CaseObserver
  {
  public:
    CaseObserver(VerificationCase &verification, const TimeInput &time,
                 const Discretization<dim> &discretization,
                 const Communicator &communicator);

    /** Of every step; else observe() needs what `row` has alone. */
    bool wants_states() const;

    /** @p observables: of this step, or null. Collective. */
    void observe(const State &state, const HistoryRow &row,
                 const std::vector<ObservableRecord> *observables = nullptr);

    /** Bodies and points are others now; @p start is their state at t = 0. */
    void mesh_changed(const State &start);

    /** What has been seen so far. Collective. */
    void serialize(Archive &archive);

    /** Relative errors at the time of @p state. Collective. */
    void finish(const State &state, std::map<std::string, double> &errors);

  private:
    std::vector<CellState> gather_cells(const State &state) const;
    void set_opening(const State &state, StepView &view) const;
    std::vector<BrokenPoint> gather_broken(const State &state) const;
    void field_errors(const State &state,
                      std::map<std::string, double> &errors) const;
    void face_errors(const State &state,
                     std::map<std::string, double> &errors) const;

    VerificationCase &case_;
    const TimeInput &time_;
    double time_step_ = 0.;                ///< the last one
    std::optional<bool> has_rigid_bodies_; ///< of large motions, on any rank
    std::vector<double> first_beta_; ///< at the start, if the case asks for it
    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
  };
} // namespace nsfd
