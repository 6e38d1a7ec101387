#pragma once

#include "bar.h"
#include "read_law.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** What viscosity has taken from grips of several speeds. */
  struct SpeedSweep {
    std::vector<double> speeds, viscous; ///< m/s, J/m^2
  };

  /** Pull against opening: the law, the bar, the jump (figure 6). */
  std::string bar_chart(const LawInput &input, const std::vector<BarRun> &runs);

  /** Pull against the displacement of the grip. */
  std::string grip_chart(const LawInput &input,
                         const std::vector<BarRun> &runs);

  std::string bar_energy_chart(const LawInput &input,
                               const std::vector<BarRun> &runs);

  /** The area between bar and law, if the equilibrium jumps (figure 8). */
  std::string floor_chart(const LawInput &input, const BarJump &jump);

  /** What viscosity takes against the speed (figure 8). */
  std::string speed_chart(const LawInput &input, const SpeedSweep &sweep);

  /** Slopes that one solution of a step compares (figure 9). */
  std::string slope_chart(const LawInput &input);
} // namespace nsfd
