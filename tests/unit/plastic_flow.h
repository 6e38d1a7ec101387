#pragma once

#include "materials/matrix_log.h"

#include "bodies/history_cell.h"
#include "nsfd/scene/material_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

// Materials with history in their strains, small and finite, and cells of them.

namespace plastic_flow
{
  using namespace nsfd;

  constexpr double young = 70e9, poisson = 0.3, yield = 300e6;

  inline PlasticInput flow(const double isotropic = 2e9,
                           const double kinematic = 3e9,
                           const double viscosity = 0.)
  {
    PlasticInput plastic;
    plastic.yield_stress = yield;
    plastic.isotropic = isotropic;
    plastic.kinematic = kinematic;
    plastic.viscosity = viscosity;
    return plastic;
  }

  class Random
  {
  public:
    double number(const double scale = 1.) { return scale * normal_(engine_); }

  private:
    std::mt19937 engine_{99};
    std::normal_distribution<double> normal_;
  };

  inline Voigt<3> symmetric(Random &random, const double scale)
  {
    Voigt<3> A;
    for (double &a : A)
      a = random.number(scale);
    return A;
  }

  inline Voigt<3> plus(const Voigt<3> &A, const double s, const Voigt<3> &B)
  {
    Voigt<3> result;
    for (unsigned int i = 0; i < 6; ++i)
      result[i] = A[i] + s * B[i];
    return result;
  }

  inline double size(const Voigt<3> &A) { return std::sqrt(contract<3>(A, A)); }
} // namespace plastic_flow
