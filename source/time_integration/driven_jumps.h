#pragma once

#include "discretization/discretization.h"

#include <vector>

namespace nsfd
{
  struct SceneInput;
  struct State;

  /** Where prescribed motion has brought points at the end of a load step. */
  template <int dim>
  class DrivenJumps
  {
  public:
    DrivenJumps(const SceneInput &input,
                const Discretization<dim> &discretization)
        : input_(input), discretization_(discretization)
    {
    }

    /**
     * From the equilibrium @p old to the load time @p time (s), by @p duration
     * of prescribed velocities, below zero where loads run backwards.
     */
    void set(const State &old, double time, double duration);

    /** Component @p c of the jump of point @p i, in its frame, m. */
    double at(const std::size_t i, const unsigned int c) const
    {
      return jump_[i * dim + c];
    }
    /** The largest of this rank, m. */
    double largest() const;

  private:
    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    std::vector<double> jump_; ///< of the other points that of the start
  };
} // namespace nsfd
