#pragma once

#include <array>
#include <optional>
#include <string>

namespace nsfd
{
  /** The largest value of a number over a run, and where and when it was. */
  struct Peak {
    double value = 0., time = 0.;  ///< s
    std::array<double, 3> place{}; ///< m, at t = 0
  };

  /**
   * What comes into bodies faster than their cells can carry: a front leaves an
   * oscillation behind it, up to 0.4 of what rises within the transit time of a
   * cell (mean of two cells; 0.56 in single ones) and in proportion to it if it
   * rises more slowly. Damping leaves 0.016 / viscosity of that, measured for
   * 0.06 to 0.8, at a Courant number of 0.1; longer steps leave less.
   */
  struct SharpFront {
    /// Pa, within the transit time; since when, s
    double stress = 0., time = 0.;
    double strength = 0.; ///< the smallest one, Pa
    double crossing = 0.; ///< of the largest cell, s
    std::string name;     ///< "Boundary: left"
    bool can_rise = true; ///< a formula in time, not an impact
    double modulus = 0.;  ///< density c^2 of the stiffest body, Pa
    /// of the bodies and of the scheme, over modulus x crossing
    double viscosity = 0.;

    double damping() const
    {
      return viscosity > viscosity_that_counts
                 ? viscosity_that_counts / viscosity
                 : 1.;
    }
    double share() const { return stress / strength * damping(); }
    /** That takes the share to its bound, Pa s. */
    double enough_viscosity() const;

    static constexpr double viscosity_that_counts = 0.016;
  };

  /**
   * How far a run went towards what its method assumes to be small; nothing
   * where it assumes nothing of the kind.
   */
  struct MotionLimits {
    std::optional<Peak> rotation, strain; ///< of cells, of small motions
    /// way of bodies past each other in a step over the smallest thickness
    std::optional<Peak> stride;
    double thickness = 0.; ///< m
    /// difference in velocity of rigidly joined points at t = 0, over the
    /// largest speed
    std::optional<double> joints;
    std::optional<SharpFront> front; ///< the sharpest one, of faces that break
  };

  /// rad: a body that turns by it is 0.5 % too long, its forces 6 degrees off
  constexpr double largest_rotation = 0.1;
  /// stress is off by three halves of it
  constexpr double largest_strain = 0.05;
  /// of the thickness: what is farther in has left on the other side
  constexpr double largest_stride = 1.;
  /// of the strength, within the transit time of a cell: it leaves 0.1 to 0.15
  /// of the strength behind
  constexpr double largest_front = 0.25;
  /// of the largest speed: a hundredth of it is 1e-4 of the energy
  constexpr double largest_joint_speed = 1e-2;

  inline double SharpFront::enough_viscosity() const
  {
    return viscosity_that_counts * (stress / strength) / largest_front *
           modulus * crossing;
  }
} // namespace nsfd
