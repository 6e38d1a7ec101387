#include "../unit/make_law.h"

#include "nonsmooth/point_law.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/scene/scene_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <unistd.h>
#include <vector>

// What every registered cohesive law must satisfy, whatever its shape.

using namespace nsfd;
using nsfd::test::entries_of;
using nsfd::test::make_law;

namespace test_laws_contract
{
  /** Kinks of the envelope, in order. */
  std::vector<double> kinks(const CohesiveLaw &law)
  {
    std::vector<double> result{0., law.elastic_limit(), law.peak_opening()};
    if (std::isfinite(law.final_opening()))
      result.push_back(law.final_opening());
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  /** An opening by which most of the energy is spent. */
  double end_of_softening(const CohesiveLaw &law)
  {
    return std::isfinite(law.final_opening())
               ? law.final_opening()
               : law.peak_opening() + 30. * law.toughness() / law.strength();
  }

  /** Openings in order: a fine grid, points next to the kinks, far away. */
  std::vector<double> samples(const CohesiveLaw &law)
  {
    const double end = end_of_softening(law);
    std::vector<double> result;
    for (unsigned int i = 0; i <= 4000; ++i)
      result.push_back(1.5 * end * i / 4000.);
    for (const double kink : kinks(law))
      for (const double offset : {-1e-4, -1e-9, 0., 1e-9, 1e-4})
        result.push_back(std::max(0., kink + offset * end));
    for (const double factor : {1e1, 1e2, 1e4, 1e6, 1e9})
      result.push_back(factor * end);
    std::sort(result.begin(), result.end());
    return result;
  }

  bool kink_between(const CohesiveLaw &law, double lower, double upper)
  {
    for (const double kink : kinks(law))
      if (lower < kink && kink < upper)
        return true;
    return false;
  }

  /** Work of the traction on the straight way from (u_N, u_T) to (v_N, v_T). */
  double work(const CohesiveLaw &law, double u_N, double u_T, double v_N,
              double v_T)
  {
    const unsigned int n = 20000;
    double sum = 0.;
    for (unsigned int i = 0; i < n; ++i) {
      const double s = (i + 0.5) / n;
      const double N = u_N + s * (v_N - u_N), T = u_T + s * (v_T - u_T);
      const double d = std::sqrt(N * N + law.shear_weight() * T * T);
      sum += law.secant(d) *
             (N * (v_N - u_N) + law.stiffness_ratio() * T * (v_T - u_T));
    }
    return sum / n;
  }

  void beta_never_grows(const CohesiveLaw &law)
  {
    EXPECT_EQ(law.beta(0.), 1.);
    double last = 1.;
    for (const double d : samples(law)) {
      const double beta = law.beta(d);
      ASSERT_LE(beta, last) << "d = " << d;
      ASSERT_GE(beta, 0.) << "d = " << d;
      if (d <= law.elastic_limit()) {
        ASSERT_EQ(beta, 1.) << "d = " << d;
      }
      last = beta;
    }
  }

  void traction_and_beta_agree(const CohesiveLaw &law)
  {
    for (const double d : samples(law)) {
      const double T = law.traction(d);
      ASSERT_TRUE(std::isfinite(T)) << "d = " << d;
      ASSERT_GE(T, 0.) << "d = " << d;
      ASSERT_LE(T, law.strength() * (1. + 1e-12)) << "d = " << d;
      if (!law.extrinsic()) {
        ASSERT_NEAR(T, law.beta(d) * law.normal_stiffness() * d,
                    1e-13 * law.strength())
            << "d = " << d;
      }
      if (d > 0.) {
        ASSERT_NEAR(law.secant(d) * d, T, 1e-13 * law.strength())
            << "d = " << d;
      }
      if (d >= law.final_opening()) {
        ASSERT_EQ(T, 0.) << "d = " << d;
        ASSERT_EQ(law.beta(d), 0.) << "d = " << d;
      }
    }
    EXPECT_NEAR(law.traction(law.peak_opening()), law.strength(),
                1e-12 * law.strength());
    if (law.extrinsic()) {
      EXPECT_EQ(law.traction(0.), law.strength());
    } else {
      EXPECT_EQ(law.secant(0.), law.normal_stiffness());
    }
  }

  // Dissipated so far: I - beta C d^2 / 2, or I - T d / 2 with secant
  // unloading.
  void dissipation_never_falls(const CohesiveLaw &law)
  {
    double last = 0.;
    for (const double d : samples(law)) {
      const double psi =
          law.extrinsic() ? 0.5 * law.traction(d) * d
                          : 0.5 * law.beta(d) * law.normal_stiffness() * d * d;
      const double dissipated = law.energy(d) - psi;
      ASSERT_GE(dissipated, last - 1e-14 * law.toughness()) << "d = " << d;
      last = std::max(last, dissipated);
    }
    EXPECT_NEAR(last, law.toughness(), 1e-9 * law.toughness());
  }

  void energy_is_the_integral_of_the_traction(const CohesiveLaw &law)
  {
    EXPECT_EQ(law.energy(0.), 0.);
    const double end = end_of_softening(law), h = 1e-4 * end;
    for (const double d : samples(law)) {
      // differences of fourth order, also next to a root of T
      if (d <= 2. * h || d > 2. * end ||
          kink_between(law, d - 20. * h, d + 20. * h))
        continue;
      const double slope = (8. * (law.energy(d + h) - law.energy(d - h)) -
                            (law.energy(d + 2. * h) - law.energy(d - 2. * h))) /
                           (12. * h);
      ASSERT_NEAR(slope, law.traction(d), 1e-8 * law.strength()) << "d = " << d;
    }

    const auto openings = samples(law);
    for (std::size_t i = 0; i + 1 < openings.size(); ++i)
      for (const std::size_t j : {i + 1, (17 * i) % openings.size()})
        ASSERT_NEAR(law.energy_increment(openings[i], openings[j]),
                    law.energy(openings[j]) - law.energy(openings[i]),
                    1e-13 * law.toughness())
            << "from " << openings[i] << " to " << openings[j];

    EXPECT_NEAR(law.energy(1e9 * end), law.toughness(),
                1e-12 * law.toughness());
    if (std::isfinite(law.final_opening())) {
      EXPECT_NEAR(law.energy(law.final_opening()), law.toughness(),
                  1e-12 * law.toughness());
    }
  }

  /** Largest fall of T over a distance h, beyond the peak. */
  double largest_fall(const CohesiveLaw &law, const double h)
  {
    double result = 0.;
    for (const double d : samples(law))
      for (const double start : {d, d - h})
        if (start >= law.peak_opening() &&
            start + h <= 2. * end_of_softening(law))
          result =
              std::max(result, law.traction(start) - law.traction(start + h));
    return result;
  }

  // By the mean value theorem, no difference quotient exceeds max |T'|.
  void steepest_softening_is_attained(const CohesiveLaw &law)
  {
    const double end = end_of_softening(law);
    if (std::isinf(law.steepest_softening())) {
      // no bound: the quotient grows by half a power of the distance or more,
      // with a jump like 1 / h
      EXPECT_GT(largest_fall(law, 1e-8 * end) / 1e-8,
                5. * largest_fall(law, 1e-6 * end) / 1e-6);
      return;
    }
    const double h = 1e-6 * end;
    EXPECT_LE(largest_fall(law, h) / h, law.steepest_softening() * (1. + 1e-6));
    EXPECT_GE(largest_fall(law, h) / h, law.steepest_softening() * (1. - 1e-3));
  }

  // With a potential, opening first and slipping first take the same work;
  // without, they do not.
  void potential_means_independence_of_the_path(const CohesiveLaw &law)
  {
    if (law.mixed())
      return; // its own functions are those of pure opening
    const double end =
        std::min(end_of_softening(law), 3. * law.toughness() / law.strength());
    const double N = 0.4 * end, T = 0.4 * end / std::sqrt(law.shear_weight());
    const double opening_first =
        work(law, 0., 0., N, 0.) + work(law, N, 0., N, T);
    const double slip_first = work(law, 0., 0., 0., T) + work(law, 0., T, N, T);
    const double difference = std::abs(opening_first - slip_first);
    if (law.has_potential()) {
      EXPECT_LE(difference, 1e-6 * law.toughness());
      EXPECT_NEAR(opening_first, law.energy(std::sqrt(2.) * N),
                  1e-6 * law.toughness());
    } else
      EXPECT_GE(difference, 1e-4 * law.toughness());
  }

  /**
   * One interface point with steps, majorants and velocities at random, solved
   * as the solvers do and taken over as the stepper does.
   */
  class RandomPoint
  {
  public:
    OneStepProblem<2> problem;
    double beta = 1., dissipated = 0.;
    double toughness;          ///< of the law times the factor of the point
    PointEnergies<2> energies; ///< of the last step

    RandomPoint(const CohesiveLaw &law, const CohesionRule rule,
                std::mt19937 &random)
        : law_(law), random_(random)
    {
      problem.resize(1);
      problem.n_owned = 1;
      problem.time_step = 0.02;
      problem.theta = number(0.5, 1.);
      problem.rule = rule;
      problem.weight = {0.3};
      Interaction interaction;
      interaction.law = {std::shared_ptr<void>(), &law}; // not owned
      interaction.stiffness_ratio = law.stiffness_ratio();
      interaction.shear_weight = law.shear_weight();
      interaction.friction = number(0., 1.);
      problem.interactions = {interaction};
      const double a = number(0.6, 1.4), g = number(0.5, 1.5);
      problem.strength_factor = {a};
      problem.opening_factor = {a / g};
      toughness = g * law.toughness();
      problem.kind = {law.extrinsic() ? PointKind::rigid : PointKind::cohesive};
      problem.opening_max = {(1. - 1e-14) * law.elastic_limit() * g / a};
      if (law.mixed())
        problem.slip_max = {0.};
      if (number(0., 1.) < 0.3)
        problem.viscosity = {number(0., 0.2) * law.strength() /
                             end_of_softening(law)};
      two_sided_ = !law.extrinsic() && number(0., 1.) < 0.5;
      for (double *R : {&R_[0], &R_[1]})
        *R = std::pow(10., number(-5., -1.)) * end_of_softening(law) /
             (law.strength() * 0.3 * 0.02 * 0.02);
    }

    /** A velocity that would open the point by @p size in the step. */
    void step(const double size)
    {
      prepare();
      const double U = size / problem.time_step;
      std::array<double, 2> local{{U * number(-0.7, 1.3), U * number(-1., 1.)}};
      if (problem.kind[0] == PointKind::rigid)
        for (unsigned int c = 0; c < 2; ++c) // or hold it just so
          local[c] += R_[c] * 0.3 * 0.02 * law_.strength() * number(-1., 1.5);
      finish(local);
    }

    /** Pull it apart, at once. */
    void open(const double size)
    {
      prepare();
      problem.contact[0] = 0;
      finish({{size / problem.time_step, 0.3 * size / problem.time_step}});
    }

  private:
    const CohesiveLaw &law_;
    std::mt19937 &random_;
    double R_[2];
    std::array<double, 2> jump_{}, velocity_{};
    bool two_sided_;

    double number(const double lower, const double upper)
    {
      return std::uniform_real_distribution<double>(lower, upper)(random_);
    }

    Reach history() const
    {
      return {problem.opening_max[0], law_.mixed() ? problem.slip_max[0] : 0.};
    }

    void prepare()
    {
      const double theta = problem.theta;
      for (unsigned int c = 0; c < 2; ++c) {
        problem.jump_old[c] = jump_[c];
        problem.jump_free[c] =
            jump_[c] + problem.time_step * (1. - theta) * velocity_[c];
      }
      problem.compression_stiffness[0] =
          two_sided_ ? problem.strength_factor[0] * problem.opening_factor[0] *
                           law_.normal_stiffness()
                     : 0.;
      problem.contact[0] = !two_sided_ && jump_[0] <= 0.;
      problem.target[0] =
          velocity_[0] <= 0. ? 0. : -(1. - theta) / theta * velocity_[0];
    }

    void finish(const std::array<double, 2> &local)
    {
      const auto solution =
          solve_point<2>(problem, 0, local, R_[0], R_[1], history());
      energies =
          point_energies<2>(problem, 0, solution.velocity, solution.frozen);
      for (unsigned int c = 0; c < 2; ++c)
        ASSERT_TRUE(std::isfinite(solution.velocity[c]) &&
                    std::isfinite(solution.impulse[c]) &&
                    std::isfinite(energies.cohesive_traction[c]));
      ASSERT_TRUE(std::isfinite(energies.stored) &&
                  std::isfinite(energies.damage));
      ASSERT_GE(energies.damage, 0.);
      ASSERT_LE(energies.beta, beta);
      ASSERT_GE(energies.beta, 0.);
      check_work(solution);
      check_impulses(local, solution);
      beta = energies.beta;
      dissipated += energies.damage;
      for (unsigned int c = 0; c < 2; ++c)
        jump_[c] = problem.jump_free[c] +
                   problem.time_step * problem.theta * solution.velocity[c];
      velocity_ = solution.velocity;
      problem.opening_max[0] = energies.history.opening;
      if (law_.mixed())
        problem.slip_max[0] = energies.history.slip;
      if (problem.kind[0] == PointKind::rigid && solution.damages)
        problem.kind[0] = PointKind::cohesive;
      if (problem.kind[0] == PointKind::cohesive && beta < 1.)
        two_sided_ = false;
      if (problem.kind[0] == PointKind::cohesive && beta == 0.) {
        problem.kind[0] = PointKind::free;
        problem.viscosity.clear();
      }
    }

    /** They make the velocity, and are cohesion, contact and friction. */
    void check_impulses(const std::array<double, 2> &local,
                        const LocalSolution<2> &solution) const
    {
      const double wh = 0.3 * problem.time_step,
                   h_theta = problem.time_step * problem.theta;
      double size = 0., jump = 0.;
      std::array<double, 2> contact;
      for (unsigned int c = 0; c < 2; ++c) {
        size = std::max(
            {size, std::abs(local[c]), R_[c] * std::abs(solution.impulse[c])});
        jump = std::max(jump, std::abs(problem.jump_free[c]));
        contact[c] = solution.impulse[c] + wh * energies.cohesive_traction[c];
      }
      // velocities come from jumps, whose round-off is divided by h theta, and
      // so do impulses, multiplied by the stiffness against R
      const double stiffness =
          std::isfinite(solution.frozen.secant.normal)
              ? (R_[0] + R_[1]) * wh * solution.frozen.secant.normal * h_theta
              : 0.;
      const double tolerance =
          1e-12 * size + 1e-14 * jump / h_theta * (1. + stiffness);
      for (unsigned int c = 0; c < 2; ++c)
        ASSERT_NEAR(solution.velocity[c],
                    local[c] + R_[c] * solution.impulse[c], tolerance);
      if (problem.kind[0] == PointKind::rigid && !solution.damages)
        return;
      ASSERT_NEAR(R_[0] * contact[0], R_[0] * solution.contact_impulse,
                  tolerance);
      ASSERT_GE(solution.contact_impulse, 0.);
      ASSERT_LE(R_[1] * std::abs(contact[1]),
                R_[1] * problem.interactions[0].friction *
                        solution.contact_impulse * (1. + 1e-10) +
                    tolerance);
    }

    /** The exact rule takes from the motion what is stored and dissipated. */
    void check_work(const LocalSolution<2> &solution) const
    {
      if (problem.rule != CohesionRule::exact)
        return;
      double work = 0., size = energies.stored + energies.stored_old +
                               energies.damage + energies.overlap_released;
      for (unsigned int c = 0; c < 2; ++c) {
        const double change =
            problem.jump_free[c] +
            problem.time_step * problem.theta * solution.velocity[c] -
            problem.jump_old[c];
        work += energies.cohesive_traction[c] * change;
        // the change is a difference of jumps, known to 1e-15 of them
        size += std::abs(energies.cohesive_traction[c]) *
                (std::abs(change) + 1e-4 * std::abs(problem.jump_old[c]));
      }
      ASSERT_NEAR(work,
                  energies.stored + energies.overlap_released -
                      energies.stored_old + energies.damage + energies.viscous,
                  std::max(1e-11 * size, 1e-300)); // not of denormal numbers
    }
  };

  // Random steps, then a jump of 1e6 final openings in one: whatever came
  // before, the toughness is dissipated.
  void random_paths(const CohesiveLaw &law)
  {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0., 1.);
    const double end = end_of_softening(law);
    unsigned int damaged = 0;
    for (unsigned int path = 0; path < 10000; ++path) {
      const unsigned int rule = path % 3;
      RandomPoint point(law,
                        rule == 0   ? CohesionRule::end_point
                        : rule == 1 ? CohesionRule::end_velocity
                                    : CohesionRule::exact,
                        random);
      const unsigned int n_steps = path % 10;
      for (unsigned int step = 0; step < n_steps; ++step) {
        point.step(5. * end * std::pow(10., -4. * unit(random)));
        if (testing::Test::HasFailure())
          FAIL() << "path " << path << ", step " << step;
      }
      damaged += point.beta < 1. && point.beta > 0.;
      point.open(1e6 * end);
      if (testing::Test::HasFailure())
        FAIL() << "path " << path << ", the last step";
      if (std::isfinite(law.final_opening())) {
        ASSERT_EQ(point.beta, 0.) << "path " << path;
      }
      if (law.has_potential()) {
        ASSERT_NEAR(point.dissipated + point.energies.stored, point.toughness,
                    1e-11 * point.toughness)
            << "path " << path;
      }
    }
    if (!std::isinf(law.steepest_softening())) {
      EXPECT_GT(damaged, 1000u);
    }
  }

  /**
   * A point with a times the strength and g times the toughness, opened from
   * closed by @p opening in one step. The majorant is so small that nothing
   * changes the opening.
   */
  struct GradedPoint {
    double traction; ///< pulls back
    double work;     ///< of the traction
    double spent;    ///< stored and dissipated
  };
  GradedPoint open_graded_point(const CohesiveLaw &law, const CohesionRule rule,
                                const double a, const double g,
                                const double opening)
  {
    OneStepProblem<2> problem;
    problem.resize(1);
    problem.n_owned = 1;
    problem.time_step = 0.02;
    problem.theta = 1.;
    problem.rule = rule;
    problem.weight = {0.3};
    Interaction interaction;
    interaction.law = {std::shared_ptr<void>(), &law}; // not owned
    interaction.stiffness_ratio = law.stiffness_ratio();
    interaction.shear_weight = law.shear_weight();
    problem.interactions = {interaction};
    problem.kind = {law.extrinsic() ? PointKind::rigid : PointKind::cohesive};
    problem.strength_factor = {a};
    problem.opening_factor = {a / g};
    if (law.mixed())
      problem.slip_max = {0.};
    const double R = 1e-14 * opening / (law.strength() * 0.3 * 0.02 * 0.02);
    const auto solution = solve_point<2>(
        problem, 0, {{opening / problem.time_step, 0.}}, R, R, {});
    const auto energies =
        point_energies<2>(problem, 0, solution.velocity, solution.frozen);
    return {-solution.impulse[0] / (0.3 * 0.02),
            energies.cohesive_traction[0] * opening,
            energies.damage + energies.stored};
  }

  // Strength a R_max at the opening scaled by g / a, toughness g G: exact for
  // one point, to the 1e-14 that the majorant moves it.
  void factors_scale_strength_and_toughness(const CohesiveLaw &law)
  {
    if (law.rate_dependent())
      return; // its traction is that of the envelope at rest only
    const double end = end_of_softening(law), R_max = law.strength(),
                 G = law.toughness();
    for (const double a : {1., 0.3, 2.5})
      for (const double g : {1., 0.2, 3.}) {
        SCOPED_TRACE("a = " + std::to_string(a) + ", g = " + std::to_string(g));
        const double scale = g / a;
        const auto traction = [&](const double d) {
          return open_graded_point(law, CohesionRule::end_point, a, g,
                                   d * scale)
              .traction;
        };
        double largest = 0.;
        for (unsigned int i = 1; i <= 300; ++i) {
          const double d = 1.2 * end * i / 300.;
          const double T = traction(d);
          // next to a jump or an infinite slope round-off of d is amplified
          if (!kink_between(law, d * (1. - 1e-9), d * (1. + 1e-9))) {
            ASSERT_NEAR(T, a * law.traction(d), 1e-10 * a * R_max)
                << "d = " << d;
          }
          largest = std::max(largest, T);
        }
        EXPECT_LE(largest, a * R_max * (1. + 1e-12));
        // extrinsic laws have their peak at once
        const double peak =
            law.extrinsic() ? 1e-12 * end : law.peak_opening() * (1. - 1e-12);
        EXPECT_NEAR(traction(peak), a * R_max, 1e-10 * a * R_max);
        // the exact rule in one step: its work is the area under the curve
        const auto open = open_graded_point(law, CohesionRule::exact, a, g,
                                            1e9 * end * scale);
        EXPECT_NEAR(open.work, g * G, 1e-11 * g * G);
        if (law.has_potential()) {
          EXPECT_NEAR(open.spent, g * G, 1e-11 * g * G);
        }
      }
  }

  /** Every registered law, with each of the examples it registers. */
  void
  expect_for_all_laws(const std::function<void(const CohesiveLaw &)> &check)
  {
    for (const auto &[name, entry] : CohesiveLawRegistry::instance().entries())
      for (const std::string &example : entry.examples) {
        SCOPED_TRACE(name + ": " + example);
        check(*make_law(name, entries_of(example)));
      }
  }

  TEST(LawsContract, EveryLawHasExamples)
  {
    for (const auto &[name, entry] : CohesiveLawRegistry::instance().entries())
      EXPECT_FALSE(entry.examples.empty())
          << "the cohesive law '" << name
          << "' is not tested: add examples of its entries to NSFD_REGISTER";
  }

  TEST(LawsContract, BetaNeverGrows) { expect_for_all_laws(beta_never_grows); }

  TEST(LawsContract, TractionAndBetaAgree)
  {
    expect_for_all_laws(traction_and_beta_agree);
  }

  TEST(LawsContract, DissipationNeverFalls)
  {
    expect_for_all_laws(dissipation_never_falls);
  }

  TEST(LawsContract, EnergyIsTheIntegralOfTheTraction)
  {
    expect_for_all_laws(energy_is_the_integral_of_the_traction);
  }

  TEST(LawsContract, SteepestSofteningIsAttained)
  {
    expect_for_all_laws(steepest_softening_is_attained);
  }

  TEST(LawsContract, PotentialMeansIndependenceOfThePath)
  {
    expect_for_all_laws(potential_means_independence_of_the_path);
  }

  TEST(LawsContract, FactorsScaleStrengthAndToughness)
  {
    expect_for_all_laws(factors_scale_strength_and_toughness);
  }

  TEST(LawsContract, RandomPaths) { expect_for_all_laws(random_paths); }
} // namespace test_laws_contract
