#include "materials/j2_flow.h"
#include "nsfd/scene/material_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

// One point of a plastic material, driven through strains whose stresses are
// known, and through strains by chance.

using namespace nsfd;

namespace test_j2_flow
{
  using Strain = J2Flow::Strain;

  constexpr double young = 200e9, poisson = 0.3, yield = 250e6;
  const double shear = young / (2. * (1. + poisson));

  PlasticInput perfect()
  {
    PlasticInput plastic;
    plastic.yield_stress = yield;
    return plastic;
  }

  PlasticInput hardens(const double isotropic, const double kinematic)
  {
    PlasticInput plastic = perfect();
    plastic.isotropic = isotropic;
    plastic.kinematic = kinematic;
    return plastic;
  }

  PlasticInput saturates()
  {
    PlasticInput plastic = hardens(1e9, 2e9);
    plastic.saturation_stress = 150e6;
    plastic.saturation_exponent = 40.;
    return plastic;
  }

  PlasticInput hardens_by_power(const double N)
  {
    PlasticInput plastic = perfect();
    plastic.hardening_exponent = N;
    return plastic;
  }

  PlasticInput flows_slowly(const double viscosity, const double exponent)
  {
    PlasticInput plastic = saturates();
    plastic.viscosity = viscosity;
    plastic.rate_exponent = exponent;
    plastic.reference_rate = 3.;
    return plastic;
  }

  Strain sum(const Strain &A, const double s, const Strain &B)
  {
    Strain result;
    for (unsigned int i = 0; i < A.size(); ++i)
      result[i] = A[i] + s * B[i];
    return result;
  }

  double size(const Strain &A) { return std::sqrt(contract<3>(A, A)); }

  /** A point and the energy balance of its way. */
  struct Driven {
    Driven(const PlasticInput &plastic, const bool plane_stress = false)
        : flow(young, poisson, plane_stress, plastic)
    {
    }

    void go(const Strain &to, const double h = 1., const double theta = 0.5)
    {
      const Strain start = sum(strain, -1., variables.alpha),
                   trial = sum(to, -1., variables.alpha);
      const double before = flow.energy(start, variables);
      ASSERT_TRUE(flow.step(start, trial, variables, h, theta, false, step));
      variables.alpha = sum(variables.alpha, 1., step.plastic_strain);
      variables.equivalent += step.flow;
      const double work = contract<3>(step.stress, sum(to, -1., strain));
      strain = to;
      stress = flow.stress(sum(strain, -1., variables.alpha));
      const double stored =
          flow.energy(sum(strain, -1., variables.alpha), variables);
      plastic += step.plastic;
      viscous += step.viscous;
      numerical += step.numerical;
      largest = std::max({largest, stored, std::abs(work)});
      defect =
          std::max(defect, std::abs(work - (stored - before) - step.plastic -
                                    step.viscous - step.numerical) /
                               largest);
    }

    J2Flow flow;
    J2Flow::InternalVariables variables;
    J2Flow::Step step;
    Strain strain{}, stress{};
    double plastic = 0., viscous = 0., numerical = 0., defect = 0.,
           largest = 0.;
  };

  /** Strains of a uniaxial stress, where the bar has flown by @p alpha. */
  Strain uniaxial(const double stress, const double alpha)
  {
    const double lateral = -poisson * stress / young - alpha / 2.;
    return {stress / young + alpha, lateral, lateral, 0., 0., 0.};
  }

  void expect_uniaxial(const Strain &stress, const double expected)
  {
    EXPECT_NEAR(stress[0], expected, 1e-10 * yield);
    for (unsigned int i = 1; i < 6; ++i)
      EXPECT_NEAR(stress[i], 0., 1e-10 * yield) << i;
  }

  double von_mises(const Strain &sigma)
  {
    const double mean = (sigma[0] + sigma[1] + sigma[2]) / 3.;
    Strain s = sigma;
    for (unsigned int c = 0; c < 3; ++c)
      s[c] -= mean;
    return std::sqrt(1.5) * size(s);
  }

  TEST(J2Flow, UniaxialHardening)
  {
    const double H = 3e9;
    for (const unsigned int n : {1u, 2u, 7u, 100u}) {
      Driven bar(hardens(H, 0.));
      for (unsigned int k = 1; k <= n; ++k) {
        // of equal parts of the way that has first the elastic strain
        const double way = 0.02 * k / n, elastic = yield / young;
        const double p = std::max(0., (way - elastic) / (1. + H / young));
        const double sigma = p > 0. ? yield + H * p : way * young;
        bar.go(uniaxial(sigma, p));
        expect_uniaxial(bar.stress, sigma);
        EXPECT_NEAR(bar.variables.equivalent, p, 1e-12);
      }
      EXPECT_NEAR(bar.plastic, yield * bar.variables.equivalent,
                  1e-12 * bar.plastic);
      EXPECT_LT(bar.defect, 1e-13);
      EXPECT_LT(std::abs(bar.numerical), 1e-14 * bar.plastic);
    }
  }

  TEST(J2Flow, SaturatingHardening)
  {
    const PlasticInput plastic = saturates();
    Driven bar(plastic);
    for (const double p : {1e-3, 2e-2, 2.1e-2, 0.3}) {
      const double sigma =
          yield + (plastic.isotropic + plastic.kinematic) * p +
          plastic.saturation_stress *
              (1. - std::exp(-plastic.saturation_exponent * p));
      bar.go(uniaxial(sigma, p));
      expect_uniaxial(bar.stress, sigma);
    }
    EXPECT_LT(bar.defect, 1e-13);
    EXPECT_LT(std::abs(bar.numerical), 1e-14 * bar.plastic);
  }

  // strain = yield/E (stress/yield)^(1/N) of a bar beyond yield.
  TEST(J2Flow, PowerLawHardening)
  {
    for (const double N : {0.02, 0.1, 0.5, 0.9}) {
      SCOPED_TRACE(N);
      for (const unsigned int n : {1u, 40u}) {
        Driven bar(hardens_by_power(N));
        for (unsigned int k = 1; k <= n; ++k) {
          // up to 100 times the strain of yield
          const double strain = yield / young * std::pow(100., double(k) / n);
          const double sigma = yield * std::pow(100., N * k / n);
          const double p = strain - sigma / young;
          bar.go(uniaxial(sigma, p));
          expect_uniaxial(bar.stress, sigma);
          EXPECT_NEAR(bar.variables.equivalent, p, 1e-10 * p);
        }
        // all that was done: the integral of the stress over the way
        const double total = yield * yield / young *
                             (0.5 + (std::pow(100., 1. + N) - 1.) / (1. + N));
        const double stored = bar.flow.energy(
            sum(bar.strain, -1., bar.variables.alpha), bar.variables);
        EXPECT_NEAR(stored + bar.plastic, total, 1e-12 * total);
        EXPECT_LT(bar.defect, 1e-13);
        EXPECT_LT(std::abs(bar.numerical), 1e-14 * bar.plastic);
      }
    }
  }

  // Up, down and up again: the surface keeps its size and follows.
  TEST(J2Flow, CyclesOfKinematicHardening)
  {
    const double H = 5e9;
    for (const unsigned int n : {1u, 3u, 50u}) {
      Driven bar(hardens(0., H));
      double alpha = 0., p = 0.;
      for (const double turn : {0.01, -0.015, 0.02, -0.001}) {
        const double before = alpha, sign = turn > before ? 1. : -1.;
        // the elastic part of the way first, then flow in n steps
        bar.go(uniaxial(H * before + 0.9 * sign * yield, before));
        expect_uniaxial(bar.stress, H * before + 0.9 * sign * yield);
        for (unsigned int k = 1; k <= n; ++k) {
          alpha = before + (turn - before) * k / n;
          bar.go(uniaxial(H * alpha + sign * yield, alpha));
          expect_uniaxial(bar.stress, H * alpha + sign * yield);
        }
        p += std::abs(turn - before);
        EXPECT_NEAR(bar.variables.equivalent, p, 1e-12);
      }
      EXPECT_NEAR(bar.plastic, yield * p, 1e-10 * yield * p);
      EXPECT_LT(bar.defect, 1e-13);
    }
  }

  TEST(J2Flow, SimpleShear)
  {
    for (const double gamma : {0.01, 0.3}) {
      Driven point(perfect());
      point.go({0., 0., 0., gamma / 2., 0., 0.});
      EXPECT_NEAR(point.stress[3], yield / std::sqrt(3.), 1e-12 * yield);
      EXPECT_NEAR(point.plastic,
                  yield / std::sqrt(3.) *
                      (gamma - yield / std::sqrt(3.) / shear),
                  1e-12 * point.plastic);
      EXPECT_LT(point.defect, 1e-14);
    }
  }

  TEST(J2Flow, PressureDoesNotFlow)
  {
    for (const PlasticInput &plastic : {saturates(), flows_slowly(1e7, 3.)}) {
      Driven point(plastic);
      for (const double e : {-0.2, 0.3}) {
        point.go({e, e, e, 0., 0., 0.});
        EXPECT_EQ(point.variables.equivalent, 0.);
        const double bulk = young / (3. * (1. - 2. * poisson));
        EXPECT_NEAR(point.stress[0], 3. * bulk * e, 1e-12 * bulk);
      }
    }
  }

  TEST(J2Flow, PlaneStressOfABar)
  {
    const double H = 3e9, K = 1e9;
    Driven bar(hardens(H, K), true);
    for (const double p : {2e-3, 1e-2, 0.2}) {
      const double sigma = yield + (H + K) * p;
      Strain strain = uniaxial(sigma, p);
      strain[2] = 0.; // nobody asks for it
      bar.go(strain);
      expect_uniaxial(bar.stress, sigma);
      EXPECT_NEAR(bar.variables.alpha[2], -p / 2., 1e-12);
    }
    EXPECT_LT(bar.defect, 1e-13);
    // both ways at once: q = sigma, R = H p, X = K p
    Driven sheet(hardens(H, K), true);
    const double p = 0.05, sigma = yield + (H + K) * p;
    const double e = (1. - poisson) * sigma / young + p / 2.;
    sheet.go({e, e, 0., 0., 0., 0.});
    EXPECT_NEAR(sheet.stress[0], sigma, 1e-10 * yield);
    EXPECT_NEAR(sheet.stress[1], sigma, 1e-10 * yield);
    EXPECT_NEAR(sheet.variables.equivalent, p, 1e-12);
  }

  // ------------------------------------------------------------ viscoplastic

  TEST(J2Flow, SteadyOverstress)
  {
    for (const double exponent : {1., 3., 20.}) {
      PlasticInput plastic = perfect();
      plastic.viscosity = 2e6;
      plastic.rate_exponent = exponent;
      plastic.reference_rate = 3.;
      Driven point(plastic);
      const double h = 1e-3, rate = 40.; // of gamma
      for (unsigned int k = 1; k <= 400; ++k)
        point.go({0., 0., 0., rate * h * k / 2., 0., 0.}, h);
      const double over =
          2e6 * 3. * std::pow(rate / std::sqrt(3.) / 3., 1. / exponent);
      EXPECT_NEAR(point.stress[3] * std::sqrt(3.), yield + over, 1e-10 * yield);
      EXPECT_LT(point.defect, 1e-13);
    }
  }

  /** Error of the relaxed stress over its overstress at the start. */
  double relaxation_error(const unsigned int n)
  {
    PlasticInput plastic = perfect();
    plastic.viscosity = 1e7;
    Driven point(plastic);
    const double over = 4e8; // at once, without time to flow
    const double gamma = (yield + over) / std::sqrt(3.) / shear;
    point.go({0., 0., 0., gamma / 2., 0., 0.}, 0.);
    EXPECT_NEAR(von_mises(point.stress), yield + over, 1e-12 * yield);
    const double end = plastic.viscosity / (3. * shear);
    for (unsigned int k = 0; k < n; ++k)
      point.go(point.strain, end / n);
    EXPECT_LT(point.defect, 1e-13);
    EXPECT_NEAR(point.numerical, 0., 1e-13 * point.plastic);
    return von_mises(point.stress) / over - (yield / over + std::exp(-1.));
  }

  TEST(J2Flow, RelaxationIsOfFirstOrder)
  {
    const double coarse = relaxation_error(64), fine = relaxation_error(128);
    EXPECT_LT(std::abs(fine), 2e-3);
    EXPECT_NEAR(coarse / fine, 2., 0.02);
  }

  TEST(J2Flow, WithoutRateItIsPlastic)
  {
    const Strain strain = {0.01, -0.002, 0.003, 0.004, -0.001, 0.002};
    Driven fast(saturates()), slow(flows_slowly(1e7, 2.));
    fast.go(strain);
    slow.go(strain, 1e20);
    EXPECT_LT(size(sum(fast.stress, -1., slow.stress)), 1e-7 * yield);
    Driven sudden(flows_slowly(1e7, 2.));
    sudden.go(strain, 1e-30);
    EXPECT_LT(size(sum(sudden.stress, -1., sudden.flow.stress(strain))),
              1e-10 * yield);
  }

  // --------------------------------------------------------------- by chance

  struct Case {
    std::string name;
    PlasticInput plastic;
    bool plane_stress;
  };

  std::vector<Case> cases()
  {
    std::vector<Case> result;
    for (const bool plane : {false, true}) {
      const std::string where = plane ? ", plane stress" : "";
      result.push_back({"perfect" + where, perfect(), plane});
      result.push_back({"isotropic" + where, hardens(5e9, 0.), plane});
      result.push_back({"kinematic" + where, hardens(0., 8e9), plane});
      result.push_back({"saturating" + where, saturates(), plane});
      result.push_back({"power law" + where, hardens_by_power(0.1), plane});
      result.push_back({"viscous" + where, flows_slowly(1e6, 1.), plane});
      result.push_back({"power" + where, flows_slowly(1e7, 4.), plane});
    }
    return result;
  }

  class Chance
  {
  public:
    explicit Chance(const bool plane) : plane_(plane) {}

    Strain strain(const double scale)
    {
      Strain result;
      for (double &e : result)
        e = scale * normal_(engine_);
      if (plane_)
        result[2] = result[4] = result[5] = 0.;
      return result;
    }
    double log_uniform(const double from, const double to)
    {
      return from * std::pow(to / from, uniform_(engine_));
    }

  private:
    bool plane_;
    std::mt19937 engine_{4711};
    std::normal_distribution<double> normal_;
    std::uniform_real_distribution<double> uniform_{0., 1.};
  };

  /** Of the surface in terms of von Mises, after the flow @p p. */
  double radius_of(const PlasticInput &plastic, const double p)
  {
    const double N = plastic.hardening_exponent;
    if (N == 0.)
      return yield + plastic.isotropic * p -
             plastic.saturation_stress *
                 std::expm1(-plastic.saturation_exponent * p);
    double low = 1., high = 2. * std::pow(1. + p * young / yield, N) + 2.;
    for (unsigned int k = 0; k < 200; ++k) { // p grows with the radius
      const double s = (low + high) / 2.;
      (yield / young * (std::pow(s, 1. / N) - s) < p ? low : high) = s;
    }
    return yield * high;
  }

  TEST(J2Flow, RandomStrainPathsCloseTheBalanceAndGainNothing)
  {
    for (const Case &c : cases()) {
      SCOPED_TRACE(c.name);
      for (const double theta : {0.5, 0.8}) {
        Chance chance(c.plane_stress);
        Driven point(c.plastic, c.plane_stress);
        for (unsigned int k = 0; k < 5000; ++k) {
          const Strain to = sum(point.strain, 1.,
                                chance.strain(chance.log_uniform(1e-9, 0.03)));
          point.go(k % 50 ? to : Strain{}, chance.log_uniform(1e-6, 1e3),
                   theta);
          ASSERT_GE(point.step.plastic, 0.);
          ASSERT_GE(point.step.viscous, 0.);
          if (c.plastic.viscosity == 0.) {
            ASSERT_GE(point.step.numerical,
                      theta == 0.5 ? 0. : -1e-12 * point.largest);
            const double radius =
                radius_of(c.plastic, point.variables.equivalent);
            const Strain centre =
                sum({}, 2. / 3. * c.plastic.kinematic, point.variables.alpha);
            ASSERT_LT(von_mises(sum(point.stress, -1., centre)),
                      radius * (1. + 1e-12) +
                          1e-15 * (young + c.plastic.kinematic) * 10.);
          }
          ASSERT_NEAR(point.variables.alpha[0] + point.variables.alpha[1] +
                          point.variables.alpha[2],
                      0., 1e-12 * (1. + point.variables.equivalent));
        }
        EXPECT_LT(point.defect, 1e-11);
        EXPECT_GT(point.plastic, 0.);
      }
    }
  }

  // At the end of a step of flow the state is on the surface but for round-off,
  // half of the time beyond it: a step that goes nowhere has no work to divide
  // what flows by.
  TEST(J2Flow, AStepOfNoWayChangesNothing)
  {
    for (const Case &c : cases()) {
      if (c.plastic.viscosity > 0.)
        continue; // it relaxes
      SCOPED_TRACE(c.name);
      Chance chance(c.plane_stress);
      Driven point(c.plastic, c.plane_stress);
      for (unsigned int k = 0; k < 2000; ++k) {
        point.go(sum(point.strain, 1.,
                     chance.strain(chance.log_uniform(1e-4, 0.03))),
                 1., 0.5);
        const Strain before = point.stress;
        point.go(point.strain, 1., 0.5);
        for (unsigned int i = 0; i < 6; ++i)
          ASSERT_NEAR(point.step.stress[i], before[i], 1e-14 * young)
              << k << " " << i;
      }
    }
  }

  TEST(J2Flow, TangentIsThatOfTheStress)
  {
    for (const Case &c : cases()) {
      SCOPED_TRACE(c.name);
      Chance chance(c.plane_stress);
      Driven point(c.plastic, c.plane_stress);
      unsigned int flowing = 0;
      for (unsigned int k = 0; k < 300; ++k) {
        const Strain to = sum(k % 5 ? point.strain : Strain{}, 1.,
                              chance.strain(chance.log_uniform(1e-5, 0.01)));
        const double h = chance.log_uniform(1e-3, 1e2), theta = 0.6;
        const J2Flow::InternalVariables variables = point.variables;
        const Strain start = sum(point.strain, -1., variables.alpha),
                     trial = sum(to, -1., variables.alpha),
                     along = chance.strain(1.);
        point.go(to, h, theta);
        J2Flow::Step here, up, down;
        ASSERT_TRUE(
            point.flow.step(start, trial, variables, h, theta, true, here));
        const double d = 1e-7 * size(trial);
        point.flow.step(start, sum(trial, d, along), variables, h, theta, false,
                        up);
        point.flow.step(start, sum(trial, -d, along), variables, h, theta,
                        false, down);
        if ((up.flow > 0.) != (down.flow > 0.))
          continue; // across a kink
        flowing += here.flow > 0.;
        Strain error;
        for (unsigned int i = 0; i < 6; ++i) {
          error[i] = (up.stress[i] - down.stress[i]) / (2. * d);
          for (unsigned int j = 0; j < 6; ++j)
            error[i] -= here.tangent[i * 6 + j] * voigt_weight<3>(j) * along[j];
        }
        EXPECT_LT(size(error), 2e-5 * young) << k;
      }
      EXPECT_GT(flowing, 100u);
    }
  }
} // namespace test_j2_flow
