#pragma once

#include "make_law.h"

#include "cohesive_laws/friction_weight.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/scatter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

// Closed forms of the laws. A number with few digits is as printed in the
// literature and compared to its printed precision; the formula behind it is
// compared to 1e-12.

namespace law_formulas
{
  using namespace nsfd;
  using nsfd::test::law_errors;
  using nsfd::test::make_law;

  const double infinity = std::numeric_limits<double>::infinity();

  inline void expect_relative(const double value, const double reference,
                              const double tolerance = 1e-12)
  {
    EXPECT_NEAR(value, reference, tolerance * std::abs(reference));
  }

  /** Composite Simpson rule. */
  inline double integral(const std::function<double(double)> &f,
                         const double lower, const double upper,
                         const unsigned int n = 2000)
  {
    const double h = (upper - lower) / n;
    double sum = 0.;
    for (unsigned int i = 0; i < n; ++i) {
      const double x = lower + i * h;
      sum += f(x) + 4. * f(x + 0.5 * h) + f(x + h);
    }
    return sum * h / 6.;
  }

  inline double area(const CohesiveLaw &law, const double lower,
                     const double upper)
  {
    return integral([&law](const double d) { return law.traction(d); }, lower,
                    upper);
  }

  inline double stored(const CohesiveLaw &law, const double d)
  {
    return 0.5 * law.secant(d) * d * d;
  }

  struct Components {
    double normal, tangential;
  };

  /** Traction at a jump on the envelope, u_N >= 0. */
  inline Components traction(const CohesiveLaw &law, const double u_N,
                             const double u_T)
  {
    const double d = std::sqrt(u_N * u_N + law.shear_weight() * u_T * u_T);
    const double k = law.secant(d);
    return {k * u_N, k * law.stiffness_ratio() * u_T};
  }

  /** Work of the traction to (u_N, u_T), first along one axis, then the other.
   */
  inline double work_normal_first(const CohesiveLaw &law, double u_N,
                                  double u_T)
  {
    return integral([&](double x) { return traction(law, x, 0.).normal; }, 0.,
                    u_N) +
           integral([&](double x) { return traction(law, u_N, x).tangential; },
                    0., u_T);
  }

  inline double work_shear_first(const CohesiveLaw &law, double u_N, double u_T)
  {
    return integral([&](double x) { return traction(law, 0., x).tangential; },
                    0., u_T) +
           integral([&](double x) { return traction(law, x, u_T).normal; }, 0.,
                    u_N);
  }

  // R_max = 3 MPa, delta_N = 2 um
  inline std::unique_ptr<CohesiveLaw> tvergaard()
  {
    return make_law("tvergaard",
                    {{"strength", "3 MPa"}, {"critical opening", "2 um"}});
  }

  // C = 5e12 Pa/m, R_max = 10 MPa, hence d_c = 2 um
  inline std::unique_ptr<CohesiveLaw> michel_suquet()
  {
    return make_law("michel-suquet",
                    {{"stiffness", "5e12"}, {"strength", "10 MPa"}});
  }

  // R_max = 300 MPa, G = 0.5 J/m^2, hence d_c = 3.333 nm
  inline std::unique_ptr<CohesiveLaw> camacho_ortiz()
  {
    return make_law("camacho-ortiz",
                    {{"strength", "300 MPa"}, {"toughness", "0.5 J/m^2"}});
  }

  // C = 2e12 Pa/m, w = 8 J/m^2, hence u_0 = 2 um, R_max = 4 MPa
  inline std::unique_ptr<CohesiveLaw> rcc()
  {
    return make_law("rcc",
                    {{"stiffness", "2e12"}, {"adhesion energy", "8 J/m^2"}});
  }

  inline std::vector<std::unique_ptr<CohesiveLaw>> all_laws()
  {
    std::vector<std::unique_ptr<CohesiveLaw>> laws;
    laws.push_back(tvergaard());
    laws.push_back(michel_suquet());
    laws.push_back(camacho_ortiz());
    laws.push_back(rcc());
    return laws;
  }

  /** An opening typical of the law. */
  inline double scale(const CohesiveLaw &law)
  {
    return law.toughness() / law.strength();
  }
} // namespace law_formulas
