#pragma once

#include "make_law.h"
#include "material_point/drive_point.h"
#include "nonsmooth/point_law.h"
#include "nsfd/scene/time_input.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

// One interface point, driven through the functions that the solvers call.
// Exact values are closed forms; a tolerance of 1e-12 is a few hundred
// round-offs of the local solve.

namespace point_law_test
{
  using namespace nsfd;
  using nsfd::interaction_of;
  using nsfd::test::LawEntries;
  using nsfd::test::make_law;

  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr CohesionRule rules[] = {
      CohesionRule::exact, CohesionRule::end_point, CohesionRule::end_velocity};

  inline Interaction contact_only(const double friction)
  {
    Interaction interaction;
    interaction.friction = friction;
    return interaction;
  }

  inline Interaction spring(const double normal_stiffness, const double ratio)
  {
    Interaction interaction;
    interaction.normal_stiffness = normal_stiffness;
    interaction.stiffness_ratio = ratio;
    interaction.shear_weight = ratio;
    return interaction;
  }

  /** Weight, step and majorant are not 1, so that none can be forgotten. */
  template <int dim>
  class OnePoint
  {
  public:
    OneStepProblem<dim> problem;
    std::array<double, dim> jump{}, old_velocity{};
    PointEnergies<dim> energies; ///< of the last step
    double majorant_normal = 0., majorant_tangential = 0.;
    bool two_sided = false;

    OnePoint(const Interaction &interaction, const PointKind kind,
             const CohesionRule rule, const double theta = 1.,
             const double strength_factor = 1.,
             const double toughness_factor = 1.)
    {
      resize(problem, 1);
      problem.n_owned = 1;
      problem.time_step = 0.02;
      problem.theta = theta;
      problem.rule = rule;
      problem.interactions = {interaction};
      problem.kind = {kind};
      problem.weight = {0.3};
      problem.strength_factor = {strength_factor};
      problem.opening_factor = {strength_factor / toughness_factor};
      if (interaction.law && !interaction.law->extrinsic())
        problem.opening_max = {interaction.law->elastic_limit() /
                               problem.opening_factor[0]};
      set_majorants(0.01, 0.02);
    }

    const Interaction &interaction() const { return problem.interactions[0]; }
    const CohesiveLaw &law() const { return *interaction().law; }
    double weight_step() const { return problem.weight[0] * problem.time_step; }
    double beta() const
    {
      return beta_of(interaction(), problem.kind[0], problem.opening_factor[0],
                     {problem.opening_max[0], 0.});
    }

    /** R in units of 1 / (w h^2 C), C a stiffness of the law. */
    void set_majorants(const double normal, const double tangential)
    {
      const auto &it = interaction();
      const double C = !it.law ? std::max(it.normal_stiffness, 1.)
                       : it.law->extrinsic()
                           ? it.law->strength() / it.law->final_opening()
                           : it.law->normal_stiffness();
      const double unit = 1. / (weight_step() * problem.time_step * C);
      majorant_normal = normal * unit;
      majorant_tangential = tangential * unit;
    }

    /** What the stepper writes before a solve. */
    void prepare()
    {
      for (unsigned int c = 0; c < dim; ++c) {
        problem.jump_old[c] = jump[c];
        problem.jump_free[c] = jump[c] + problem.time_step *
                                             (1. - problem.theta) *
                                             old_velocity[c];
      }
      problem.compression_stiffness[0] = !two_sided ? 0.
                                         : interaction().law
                                             ? problem.strength_factor[0] *
                                                   problem.opening_factor[0] *
                                                   law().normal_stiffness()
                                             : interaction().normal_stiffness;
    }

    LocalSolution<dim> solve(const std::array<double, dim> &local) const
    {
      return solve_point<dim>(problem, 0, local, majorant_normal,
                              majorant_tangential,
                              {problem.opening_max[0], 0.});
    }

    /** What the stepper does after a solve. */
    void accept(const LocalSolution<dim> &solution)
    {
      energies =
          point_energies<dim>(problem, 0, solution.velocity, solution.frozen);
      for (unsigned int c = 0; c < dim; ++c)
        jump[c] = problem.jump_free[c] +
                  problem.time_step * problem.theta * solution.velocity[c];
      old_velocity = solution.velocity;
      problem.opening_max[0] = energies.history.opening;
      if (problem.kind[0] == PointKind::rigid && solution.damages)
        problem.kind[0] = PointKind::cohesive;
      if (problem.kind[0] == PointKind::cohesive) {
        two_sided = two_sided && energies.beta == 1.;
        if (energies.beta <= 0.) {
          problem.kind[0] = PointKind::free;
          problem.viscosity.clear();
        }
      }
    }

    /** -P over w h: the traction that pulls body 2 back. */
    std::array<double, dim> pull(const LocalSolution<dim> &solution) const
    {
      std::array<double, dim> result;
      for (unsigned int c = 0; c < dim; ++c)
        result[c] = -solution.impulse[c] / weight_step();
      return result;
    }

    /**
     * One step to the jump @p target. The local velocity is corrected until
     * the point arrives, with the velocity that the target asks for. With a
     * contact traction @p reaction > 0, the normal jump is left to the contact.
     */
    LocalSolution<dim> drive(const std::array<double, dim> &target,
                             const double reaction = 0.)
    {
      prepare();
      const bool pressed = reaction > 0.;
      problem.contact[0] = pressed;
      problem.target[0] = 0.;
      std::array<double, dim> wanted, local;
      double size = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        wanted[c] = (target[c] - problem.jump_free[c]) /
                    (problem.time_step * problem.theta);
        local[c] = wanted[c];
        size = std::max(size, std::abs(wanted[c]));
      }
      if (pressed)
        local[0] = -majorant_normal * weight_step() * reaction;
      LocalSolution<dim> solution;
      // one of these for every unit of the slip that friction still holds
      for (unsigned int k = 0; k < 10000; ++k) {
        solution = solve(local);
        double error = 0.;
        for (unsigned int c = pressed ? 1 : 0; c < dim; ++c) {
          const double d = wanted[c] - solution.velocity[c];
          local[c] += d;
          error = std::max(error, std::abs(d));
        }
        if (error <= 1e-13 * size)
          break;
      }
      accept(solution);
      return solution;
    }

    /** Friction traction of a solution: what cohesion leaves over. */
    double friction_traction(const LocalSolution<dim> &solution) const
    {
      return pull(solution)[1] - energies.cohesive_traction[1];
    }
  };

  /** C = 5, d_c = 0.4, so R_max = 2 and Delta = 1.2. */
  inline std::shared_ptr<const CohesiveLaw> michel_suquet()
  {
    return make_law("michel-suquet", {{"stiffness", "5"}, {"strength", "2"}});
  }

  /** R_max = 2, Delta = 0.6 in both directions. */
  inline std::shared_ptr<const CohesiveLaw> tvergaard()
  {
    return make_law("tvergaard",
                    {{"strength", "2"}, {"critical opening", "0.6"}});
  }

  /** R_max = 2, d_c = 0.6. */
  inline std::shared_ptr<const CohesiveLaw> camacho_ortiz()
  {
    return make_law("camacho-ortiz",
                    {{"strength", "2"}, {"critical opening", "0.6"}});
  }

  struct NamedLaw {
    std::string name;
    LawEntries entries;
  };

  /** Laws with a potential, with unequal stiffness in shear as well. */
  const std::vector<NamedLaw> potentials = {
      {"michel-suquet", {{"stiffness", "5"}, {"strength", "2"}}},
      {"michel-suquet",
       {{"stiffness", "5"}, {"strength", "2"}, {"tangential stiffness", "3"}}},
      {"tvergaard", {{"strength", "2"}, {"critical opening", "0.6"}}},
      {"tvergaard",
       {{"strength", "2"},
        {"critical opening", "0.6"},
        {"tangential critical opening", "0.9"}}},
      {"camacho-ortiz", {{"strength", "2"}, {"critical opening", "0.6"}}},
      {"camacho-ortiz",
       {{"strength", "2"},
        {"critical opening", "0.6"},
        {"mode mixity", "1.7"}}},
      {"rcc", {{"stiffness", "5"}, {"adhesion energy", "0.8"}}},
      {"rcc",
       {{"stiffness", "5"},
        {"adhesion energy", "0.8"},
        {"tangential stiffness", "9"}}},
      {"geubelle-baylor",
       {{"strength", "2"},
        {"critical opening", "0.6"},
        {"initial strength parameter", "0.9"}}},
      {"trapezoid",
       {{"strength", "2"},
        {"critical opening", "0.6"},
        {"tangential critical opening", "0.9"}}},
      {"ppr-extrinsic",
       {{"strength", "2"}, {"critical opening", "0.6"}, {"alpha", "3.5"}}},
      {"brittle",
       {{"stiffness", "5"}, {"strength", "2"}, {"tangential stiffness", "3"}}},
      {"dugdale",
       {{"strength", "2"},
        {"critical opening", "0.6"},
        {"mode mixity", "1.7"}}},
  };

  inline PointKind initial_kind(const CohesiveLaw &law)
  {
    return law.extrinsic() ? PointKind::rigid : PointKind::cohesive;
  }

  /** An opening at which the law is nearly or fully spent. */
  inline double range_of(const CohesiveLaw &law)
  {
    return std::isfinite(law.final_opening()) ? law.final_opening()
                                              : 5. * law.peak_opening();
  }

  /** Composite Simpson rule over equally spaced samples, an odd number. */
  inline double simpson(const std::vector<double> &samples,
                        const double spacing)
  {
    double sum = 0.;
    for (std::size_t i = 0; i + 2 < samples.size(); i += 2)
      sum += samples[i] + 4. * samples[i + 1] + samples[i + 2];
    return sum * spacing / 3.;
  }

  /** Random steps of one point; @p check sees each of them. */
  template <int dim, typename Check>
  void random_paths(const NamedLaw &entry, const CohesionRule rule,
                    const double theta, const double friction,
                    const Check &check)
  {
    std::shared_ptr<const CohesiveLaw> law =
        make_law(entry.name, entry.entries);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0., 1.);
    const double range = range_of(*law);
    for (unsigned int path = 0; path < 60; ++path) {
      if (testing::Test::HasFailure())
        return;
      OnePoint<dim> point(interaction_of(law, friction, path % 3),
                          initial_kind(*law), rule, theta,
                          0.6 + 0.8 * unit(random), 0.5 + unit(random));
      point.two_sided = !law->extrinsic() && path % 2 == 0;
      if (path % 5 == 4) // against the spring in a step of 0.02
        point.problem.viscosity = {0.2 * unit(random) * law->strength() /
                                   range};
      point.set_majorants(std::pow(10., -3. * unit(random)),
                          std::pow(10., -3. * unit(random)));
      for (unsigned int step = 0; step < 25; ++step) {
        point.prepare();
        const double U_N = point.old_velocity[0];
        point.problem.contact[0] =
            !point.two_sided && point.jump[0] <= 0. && path % 4 != 3;
        point.problem.target[0] = U_N <= 0. ? 0. : -(1. - theta) / theta * U_N;
        // steps from a millionth of the range to its double
        const double size = range * 2. * std::pow(10., -6. * unit(random)) /
                            point.problem.time_step;
        std::array<double, dim> local;
        for (unsigned int c = 0; c < dim; ++c)
          local[c] = size * (2. * unit(random) - (c == 0 ? 0.7 : 1.));
        // extrinsic: hold it by impulses around the strength at first
        if (point.problem.kind[0] == PointKind::rigid)
          for (unsigned int c = 0; c < dim; ++c)
            local[c] =
                1.5 * (2. * unit(random) - (c == 0 ? 0.7 : 1.)) *
                law->strength() * point.weight_step() *
                (c == 0 ? point.majorant_normal : point.majorant_tangential);
        const auto solution = point.solve(local);
        check(point, local, solution);
        if (testing::Test::HasFailure())
          FAIL() << entry.name << ", path " << path << ", step " << step;
        point.accept(solution);
      }
    }
  }
} // namespace point_law_test
