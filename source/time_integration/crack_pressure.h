#pragma once

#include "discretization/discretization.h"

#include <memory>
#include <vector>

namespace nsfd
{
  struct SceneInput;
  struct State;

  /**
   * The pressure of a fluid in open cracks, (22) of [AM06]: p n on points
   * whose beta at the start of a step is at or below the threshold of their
   * block, nothing on the others. So it is a load, known before the step is
   * solved, and contact and friction act next to it.
   */
  template <int dim>
  class CrackPressure
  {
  public:
    /** Null if no block of the scene has a pressure. */
    static std::unique_ptr<CrackPressure>
    make(const SceneInput &input, const Discretization<dim> &discretization);

    CrackPressure(const SceneInput &input,
                  const Discretization<dim> &discretization);

    /** p in Pa at @p time on all points, broken as they are in @p old. */
    void evaluate(const State &old, double time,
                  std::vector<double> &pressure) const;

    /** w h p n in the frames of the points, on body 2. */
    std::vector<double> impulse(const std::vector<double> &pressure,
                                double time_step) const;

  private:
    const SceneInput &input_;
    const Discretization<dim> &discretization_;
  };
} // namespace nsfd
