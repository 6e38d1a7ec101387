#pragma once

namespace nsfd
{
  /** What a run does where no equilibrium continues the last one. */
  enum class SolutionJump {
    stop,      ///< ends with the last equilibrium
    dynamic,   ///< goes on from it with Moreau-Jean
    relax,     ///< takes the next equilibrium, counts the released energy
    arc_length ///< follows the equilibria, with the load time as an unknown
  };

  /** Equilibria: at the start, and from step to step of the load. */
  struct StaticInput {
    bool steps = false; ///< scheme = quasi-static, else the start alone
    double until = 0.;  ///< s, end of the quasi-static steps
    double step = 0.;   ///< s, of the load
    SolutionJump at_jump = SolutionJump::stop;
    /// of a load step before it relaxes: it is found to a 32nd of the step
    unsigned int jump_bisections = 5;
    double tolerance = 1e-11; ///< unbalanced force, relative to those present
  };
} // namespace nsfd
