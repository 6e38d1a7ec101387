#pragma once

#include "make_law.h"
#include "make_scene.h"
#include "rigid_in_rubber.h"

#include "cohesive_laws/friction_weight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

// Every registered solver on problems with known solutions, and against each
// other on problems without. Impulses need not be unique (W may be singular):
// velocities and objectives are compared.

namespace solver_checks
{
  using namespace nsfd;
  using nsfd::test::make_law;
  using nsfd::test::Scene;

  using Vector = std::vector<double>;

  inline std::vector<std::string> solvers()
  {
    return SolverRegistry<2>::instance().names();
  }

  inline double largest(const Vector &x)
  {
    double result = 0.;
    for (const double value : x)
      result = std::max(result, std::abs(value));
    return result;
  }

  inline double dot(const Vector &a, const Vector &b)
  {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.);
  }
} // namespace solver_checks
