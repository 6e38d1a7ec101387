#include "nsfd/postprocess/running_crack.h"

#include "nsfd/scene/material_input.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /** a_d and a_s of a speed. */
    struct Contraction {
      Contraction(const double v, const double pressure, const double shear)
          : d_square(1. - v * v / (pressure * pressure)),
            s_square(1. - v * v / (shear * shear)), d(std::sqrt(d_square)),
            s(std::sqrt(s_square))
      {
      }
      double d_square, s_square, d, s;

      /** Zero at rest and at the speed of Rayleigh waves. */
      double determinant() const
      {
        return 4. * d * s - (1. + s_square) * (1. + s_square);
      }
    };
  } // namespace

  RunningCrack::RunningCrack(const double young, const double poisson,
                             const double density, const bool plane_stress)
      : stiffness_(plane_stress ? young : young / (1. - poisson * poisson)),
        poisson_(plane_stress ? poisson / (1. + poisson) : poisson)
  {
    const double mu = young / (2. * (1. + poisson));
    shear_ = std::sqrt(mu / density);
    pressure_ = shear_ * std::sqrt(2. * (1. - poisson_) / (1. - 2. * poisson_));
    double low = 0.5 * shear_, high = shear_;
    for (unsigned int k = 0; k < 60; ++k) {
      const double v = 0.5 * (low + high);
      (Contraction(v, pressure_, shear_).determinant() > 0. ? low : high) = v;
    }
    rayleigh_ = low;
  }

  RunningCrack::RunningCrack(const double young, const double poisson,
                             const double density)
      : RunningCrack(young, poisson, density, false)
  {
  }

  RunningCrack::RunningCrack(const MaterialInput &material,
                             const bool plane_stress)
      : RunningCrack(material.young, material.poisson, material.density,
                     plane_stress)
  {
  }

  /** v^2 a/((1 - nu) c_s^2 D), a = a_d or a_s. */
  double RunningCrack::function(const double v, const bool sliding) const
  {
    if (!(v < rayleigh_))
      return std::numeric_limits<double>::quiet_NaN();
    const double square = v * v / (shear_ * shear_);
    // 1 + O(v^2/c_s^2); D is a difference of numbers near 4
    if (square < 1e-7)
      return 1.;
    const Contraction a(v, pressure_, shear_);
    return square * (sliding ? a.s : a.d) / ((1. - poisson_) * a.determinant());
  }

  double RunningCrack::opening_function(const double v) const
  {
    return function(v, false);
  }

  double RunningCrack::sliding_function(const double v) const
  {
    return function(v, true);
  }

  double RunningCrack::opening_intensity(const double G, const double v) const
  {
    return std::sqrt(std::max(G, 0.) * stiffness_ / opening_function(v));
  }
} // namespace nsfd
