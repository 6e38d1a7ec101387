#include "every_law.h"

namespace every_law::test_laws_random_paths
{
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
      resize(problem, 1);
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
      if (number(0., 1.) < 0.3 && !law.adds_openings())
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
      double held = 0., slack = tolerance;
      if (law_.adds_openings()) {
        // a slip that ends at 0 is held by both; one next to 0 is a difference
        // of jumps, and so is its direction; cohesion presses closed surfaces
        const double old = problem.jump_old[1], free = problem.jump_free[1],
                     U = solution.velocity[1];
        const double end = problem.rule == CohesionRule::end_velocity
                               ? old + problem.time_step * U
                               : free + h_theta * U;
        if (std::abs(end) <= 1e-14 * (std::abs(old) + std::abs(free)))
          return;
        const double slip = std::abs(old) + std::abs(end);
        slack += R_[1] * wh * std::abs(energies.cohesive_traction[1]) * 4e-15 *
                 std::abs(free) / slip;
        if (problem.contact[0])
          held = wh * problem.strength_factor[0] * law_.strength();
      }
      ASSERT_LE(R_[1] * std::abs(contact[1]),
                R_[1] * problem.interactions[0].friction *
                        (solution.contact_impulse + held) * (1. + 1e-10) +
                    slack);
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

  TEST(LawsContract, RandomPaths) { expect_for_all_laws(random_paths); }
} // namespace every_law::test_laws_random_paths
