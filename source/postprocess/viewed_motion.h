#pragma once

#include "bodies/cell_stresses.h"

#include "discretization/discretization.h"
#include "nsfd/postprocess/observable.h"
#include "state/state.h"

#include <memory>
#include <optional>
#include <vector>

namespace nsfd
{
  /**
   * The states that observables look at, and what follows from them once
   * somebody asks for it.
   */
  template <int dim>
  class ViewedMotion
  {
  public:
    ViewedMotion(const SceneInput &input,
                 const Discretization<dim> &discretization);

    /** @p previous: before the step that ends in @p state, or null. */
    void show(const State &state, const State *previous, const HistoryRow &row);
    /** What was shown is gone. */
    void forget();

    const State *state() const { return state_; }       ///< or null
    const State *previous() const { return previous_; } ///< or null
    const HistoryRow &row() const { return *row_; }

    /** Nodal values at t_k + theta h, of a cell as of all. */
    struct Middle {
      std::vector<double> displacement, velocity, acceleration;
      double time = 0.;
    };
    const Middle &middle() const;
    /** Nodal values at the end of the step. */
    const std::vector<double> &displacement() const;
    const std::vector<double> &velocity() const;
    CellStresses<dim> &stresses() const;
    /** sigma n on body 1, Pa; mean of the step. */
    RunView::Vector traction(std::size_t point) const;

  private:
    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const State *state_ = nullptr, *previous_ = nullptr;
    const HistoryRow *row_ = nullptr;
    const HistoryRow no_row_;
    mutable std::optional<Middle> middle_;
    mutable std::optional<std::vector<double>> displacement_, velocity_;
    mutable std::unique_ptr<CellStresses<dim>> stresses_;
  };
} // namespace nsfd
