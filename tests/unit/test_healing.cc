#include "leapfrog_steps.h"
#include "material_point/drive_point.h"
#include "nonsmooth/healing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// Faces that grow together under pressure: a driven point against the formula
// of its law, what it dissipates, and bars that are torn, pressed and torn
// again.

using namespace nsfd;
using namespace nsfd::test;

namespace test_healing
{
  // --- a point

  constexpr double C = 2e12, w = 8., d_0 = 2e-6; // d_0 = sqrt(w / C)
  constexpr double strength = C * d_0;

  std::shared_ptr<const CohesiveLaw> law_of(const std::string &law,
                                            const std::string &more = "")
  {
    const auto input = make_input(R"(
set dimension = 2
subsection Mesh
  set upper corner = 2, 1
  set cells        = 2, 1
end
subsection Material: m
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: all
  set law              = )" + law +
                                  R"(
  set stiffness        = 2e12
  set adhesion energy  = 8 J/m^2
  set healing time     = 10 s
  set healing pressure = 1 MPa
)" + more + R"(
end
subsection Time
  set end  = 1
  set step = 1
end
)");
    return input->interfaces.front().law;
  }

  PathPoint at(const double opening, const double slip, const double reaction,
               const double time)
  {
    return {0., {opening, slip, reaction, time}};
  }

  /** Tear to 3 d_0, close, press for a time, and tear to the end. */
  std::vector<PathPoint> torn_again(const double pressure, const double time,
                                    const double peak)
  {
    std::vector<PathPoint> points = {at(0., 0., 0., 0.)};
    const auto to = [&](const double opening, const unsigned int n) {
      const PathMark start = points.back().at;
      for (unsigned int k = 1; k <= n; ++k)
        points.push_back(at(start.opening + (opening - start.opening) * k / n,
                            0., 0., start.time));
    };
    to(d_0, 1);
    to(3. * d_0, 40);
    to(0., 4);
    points.push_back(at(0., 0., pressure, 0.));
    for (unsigned int k = 1; k <= 5; ++k)
      points.push_back(at(0., 0., pressure, time * k / 5.));
    points.push_back(at(0., 0., 0., time));
    to(peak, 4);
    to(20. * d_0, 100);
    return points;
  }

  /** The traction rises to its largest value at the last but 100 points. */
  void test_torn_again(const std::string &law, const double pressure,
                       const double time, const double intensity)
  {
    SCOPED_TRACE(law);
    const double peak = d_0 / std::sqrt(intensity);
    const auto points = torn_again(pressure, time, peak);
    const auto rows =
        drive_point(interaction_of(law_of(law)), points, CohesionRule::exact);
    double damage = 0.;
    for (const CurveRow &row : rows) {
      EXPECT_GE(row.damage, damage); // dissipation is never negative
      damage = row.damage;
      EXPECT_NEAR(row.numerical(), 0., 1e-12 * w);
    }
    // T = R_max b^(3/2) at d_0 / sqrt(b)
    const auto end = drive_point(interaction_of(law_of(law)), points,
                                 CohesionRule::end_point);
    double largest = 0.;
    for (std::size_t k = end.size() - 104; k < end.size(); ++k)
      largest = std::max(largest, end[k].cohesive_normal);
    EXPECT_NEAR(largest, strength * std::pow(intensity, 1.5), 1e-9 * strength);
  }

  TEST(Healing, StrengthComesBackWithTheTime)
  {
    // torn to b = 1/9; a tenth of the intensity per second
    for (const std::string law : {"rcc", "fremond"}) {
      test_torn_again(law, 2e6, 3., 1. / 9. + 0.3);
      test_torn_again(law, 0.5e6, 3., 1. / 9. + 0.15); // half of the pressure
      test_torn_again(law, 1e6, 50., 1.);              // all of it
    }
  }

  // Bonds that form while the face has slipped: the traction goes on, and what
  // is stored falls.
  TEST(Healing, NewBondsHoldWhereTheFaceIs)
  {
    const double p = 1e6;
    std::vector<PathPoint> points = {at(0., 0., p, 0.)};
    for (unsigned int k = 1; k <= 40; ++k)
      points.push_back(at(0., 3. * d_0 * k / 40., p, 0.));
    const std::size_t torn = points.size() - 1;
    points.push_back(at(0., 3. * d_0, p, 4.));
    points.push_back(at(0., 3.001 * d_0, p, 4.));
    const auto rows =
        drive_point(interaction_of(law_of("rcc")), points, CohesionRule::exact);
    ASSERT_EQ(rows.size(), points.size());
    const double b = 1. / 9., healed = b + 0.4;
    const double T = strength * std::pow(b, 1.5);
    // of the secant b^2 C: T^2 / (2 k) before and after
    EXPECT_NEAR(rows[torn].stored, T * T / (2. * b * b * C), 1e-9 * w);
    EXPECT_NEAR(rows[torn + 1].stored, T * T / (2. * healed * healed * C),
                1e-9 * w);
    EXPECT_NEAR(rows[torn + 1].damage - rows[torn].damage,
                rows[torn].stored - rows[torn + 1].stored, 1e-12 * w);
    EXPECT_NEAR(rows.back().cohesive_tangential,
                T + healed * healed * C * 0.001 * d_0 / 2., 1e-6 * strength);
  }

  TEST(Healing, ABrokenPointBeginsAnew)
  {
    OneStepProblem<2> problem;
    resize(problem, 1);
    problem.interactions = {interaction_of(law_of("rcc"))};
    const double jump[] = {0., 7. * d_0};
    const Healing healing = healing_of<2>(problem, 0, 0., 0., jump, 2e6, 2.5);
    EXPECT_TRUE(healing.heals);
    EXPECT_NEAR(healing.opening_max, d_0 / std::sqrt(0.25), 1e-12 * d_0);
    EXPECT_NEAR(healing.beta, 0.25 * 0.25, 1e-12);
    EXPECT_EQ(healing.slip_share, 0.);
    EXPECT_EQ(healing.dissipated, 0.);
    const double open[] = {1e-3 * d_0, 0.};
    EXPECT_FALSE((healing_of<2>(problem, 0, 0., 0., open, 2e6, 2.5).heals));
    EXPECT_FALSE((healing_of<2>(problem, 0, 0., 0., jump, 0., 2.5).heals));
  }

  // --- scenes

  const std::string bar = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 4, 1
  set cells        = 4, 1
end
subsection Material: bar
  set Young modulus = 100
  set Poisson ratio = 0.2
  set density       = 1
end
subsection Interface: seam
  set where           = abs(x - 2) < 0.1
  set law             = LAW
  set stiffness       = 20
  set adhesion energy = 0.1
  set healing time    = 30
  set friction        = 0.3
end
subsection Interface: others
  set law = joined
end
subsection Boundary: left
  set displacement x = 0
  set displacement y = 0
end
subsection Boundary: right
  set displacement x = PULL
  set displacement y = SHEAR
end
subsection Time
  set end  = 1000
  set step = auto
end
subsection Solver
  set tolerance = 1e-10
end
)";

  std::string text(const std::string &law, const std::string &pull,
                   const std::string &shear = "0")
  {
    std::string result = bar;
    for (const auto &[what, by] :
         {std::pair("LAW", law), {"PULL", pull}, {"SHEAR", shear}})
      result.replace(result.find(what), std::string(what).size(), by);
    return result;
  }

  template <int dim>
  double defect(const Scene<dim> &scene)
  {
    const EnergyLines &e = scene.state.energy;
    return std::abs(e.kinetic + e.elastic + e.cohesive + e.damage + e.friction +
                    e.viscous + e.impact + e.numerical - e.work -
                    scene.state.initial_energy) /
           scene.state.largest_energy;
  }

  // Torn until t = 10, pressed from 20 to 30, torn again: the intensity grows
  // by h / 30 in each step in which the seam is pressed, and in no other.
  TEST(Healing, BarsInImplicitAndExplicitSteps)
  {
    const std::string pull =
        "if(t < 20, 0.3, if(t < 40, 0.1, 0.3)) * sin(pi * t / 20)";
    using Overrides = std::vector<std::string>;
    for (const std::string law : {"rcc", "fremond"})
      for (const Overrides &scheme :
           {Overrides{"Time/scheme=moreau-jean", "Time/step=0.02"},
            Overrides{"Time/scheme=explicit"}}) {
        SCOPED_TRACE(law + " " + scheme.front());
        Steps<2> scene(text(law, pull), scheme);
        const auto &points = scene.discretization->points();
        std::size_t seam = 0;
        while (seam < points.n_points &&
               std::abs(points.position[2 * seam] - 2.) > 0.1)
          ++seam;
        ASSERT_LT(seam, points.n_points);
        double damage = 0., healed = 0., grown = 0., torn_to = 1.;
        // b of the last two steps: two chains of explicit steps take turns
        double before[2] = {1., 1.};
        while (scene.state.time < 38.) {
          const double h = scene.time_step;
          scene.step();
          scene.show();
          const State &state = scene.state;
          ASSERT_LT(defect(scene), 1e-9) << state.time;
          ASSERT_GE(state.energy.damage, damage - 1e-14 * state.largest_energy);
          damage = state.energy.damage;
          const double b = std::sqrt(state.beta[seam]);
          if (state.contact[seam] && b > before[0])
            healed += h;
          grown += std::max(0., b - before[0]) / 2.; // of the mean of both
          before[0] = before[1];
          before[1] = b;
          if (state.time < 20.)
            torn_to = b;
        }
        EXPECT_LT(torn_to, 0.1);
        EXPECT_GT(healed, 5.);
        // the contact of a step may be that of its begin or of its end
        const double one_step = 1.01 * scene.time_step / 30.;
        EXPECT_NEAR(grown, healed / 30., one_step);
        const double recovered = before[1];
        EXPECT_NEAR(recovered, torn_to + healed / 30., one_step);
        // torn again, it takes what the surface takes
        const double spent = scene.state.energy.damage;
        while (scene.state.time < 55.) {
          scene.step();
          ASSERT_LT(defect(scene), 1e-9) << scene.state.time;
        }
        scene.show();
        EXPECT_LT(std::sqrt(scene.state.beta[seam]), 0.2 * recovered);
        EXPECT_GT(scene.state.energy.damage, spent);
      }
  }

  // Pressed and sheared at once: bonds form and break while the seam slides.
  TEST(Healing, SlidingSeamsCloseTheBalance)
  {
    using Overrides = std::vector<std::string>;
    for (const Overrides &scheme :
         {Overrides{"Time/scheme=moreau-jean", "Time/step=0.05"},
          Overrides{"Time/scheme=explicit"}}) {
      SCOPED_TRACE(scheme.front());
      Steps<2> scene(
          text("rcc", "-0.05 * min(1, t / 5)", "0.8 * sin(pi * t / 20)"),
          scheme);
      double damage = 0.;
      while (scene.state.time < 40.) {
        scene.step();
        ASSERT_LT(defect(scene), 1e-9) << scene.state.time;
        ASSERT_GE(scene.state.energy.damage,
                  damage - 1e-14 * scene.state.largest_energy);
        // what chains store is summed up: it would miss what they gain alone
        ASSERT_GE(scene.state.energy.cohesive,
                  -1e-13 * scene.state.largest_energy);
        damage = scene.state.energy.damage;
      }
      EXPECT_GT(damage, 0.1); // more than one separation takes
      EXPECT_GT(scene.state.energy.friction, 0.);
    }
  }

  TEST(Healing, WhatItCannotGoWithIsRefused)
  {
    const auto complaints = [](const std::vector<std::string> &overrides) {
      InputErrors errors;
      read_scene_text(text("rcc", "0"), "test.prm", overrides, errors);
      return errors.report();
    };
    const auto expect = [](const std::string &report, const std::string &word) {
      EXPECT_NE(report.find(word), std::string::npos) << report;
    };
    expect(complaints({"Time/scheme=quasi-static"}), "could heal");
    expect(complaints({"Interface: seam/dilatancy=0.1"}),
           "dilatancy or wear do not heal");
    expect(complaints({"Interface: seam/healing time=0"}), "must be positive");
    expect(complaints({"Interface: seam/healing pressure=-1"}),
           "must not be negative");
  }
} // namespace test_healing
