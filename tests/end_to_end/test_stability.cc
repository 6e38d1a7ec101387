#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

// Stiff and extreme scenes of prm/stability: doc/stability.md is their table.

namespace end_to_end::test_stability
{
  namespace
  {
    std::filesystem::path stability_scene(const std::string &name)
    {
      return prm_folder() / "stability" / (name + ".prm");
    }

    Launch launch(const std::string &name,
                  const std::vector<std::string> &set = {},
                  const double energy_scale = 0.)
    {
      Launch what{stability_scene(name), set};
      what.energy_scale = energy_scale;
      return what;
    }

    double krylov_per_step(const Result &result)
    {
      return result.counter("krylov") / result.number("steps");
    }

    double mechanical_energy(const History &history, const std::size_t row)
    {
      return history["kinetic"][row] + history["elastic"][row] +
             history["cohesive"][row];
    }

    /** Mean traction in y over the last picture of the obstacles' points. */
    double floor_traction(const Result &result)
    {
      const auto pictures = snapshots(result.directory, "interfaces");
      if (pictures.empty())
        return std::nan("");
      const auto &traction = pictures.back().at("traction");
      const auto &obstacle = pictures.back().at("obstacle");
      double sum = 0., count = 0.;
      for (std::size_t i = 0; i < obstacle.size(); ++i)
        if (obstacle[i] > 0.5) {
          sum += traction[3 * i + 1];
          count += 1.;
        }
      return std::abs(sum / count);
    }

    /** All blocks stay where they are. */
    void expect_rest(const Result &result, const double mass, const double fall)
    {
      double kinetic = 0.;
      for (const double value : result.history["kinetic"])
        kinetic = std::max(kinetic, value);
      expect_below("largest speed over that of a fall in a step",
                   std::sqrt(2. * kinetic / mass) / fall, 1e-6,
                   "tolerance of the solver, step after step");
    }
  } // namespace

  // Springs add 1/ratio to the compliance, so errors fall like 1/ratio to that
  // of the mesh; the work does not grow.
  TEST(Stability, StiffInterface)
  {
    const Workspace workspace;
    const Result stiffest = good_run(
        workspace, "1e8", launch("stiff_interface", {"Constants/ratio=1e8"}));
    ASSERT_TRUE(stiffest.completed());
    const double of_mesh = stiffest.error("displacement_L2");
    double first = 0., krylov_at_1e2 = 0.;
    for (const char *ratio : {"1e2", "1e3", "1e4", "1e5", "1e6", "1e7"}) {
      const Result result = good_run(
          workspace, ratio,
          launch("stiff_interface", {std::string("Constants/ratio=") + ratio}));
      ASSERT_TRUE(result.completed());
      const double excess = result.error("displacement_L2") - of_mesh,
                   scale = std::stod(ratio);
      if (first == 0.) {
        first = excess * scale;
        krylov_at_1e2 = krylov_per_step(result);
        // a bar longer by the compliance of its joints, 1/100, in waves
        expect_below("ratio 1e2: excess error", excess, 0.02);
      } else
        expect_below(std::string("ratio ") + ratio + ": excess times ratio " +
                         "over that at 1e2",
                     excess * scale / first, scale < 1e6 ? 1.5 : 15.,
                     "1/C, down to the tolerance of the solver");
      expect_below(std::string("ratio ") + ratio + ": Krylov over that at 1e2",
                   krylov_per_step(result) / krylov_at_1e2,
                   1. + std::log10(scale / 100.), "log C");
    }
    expect_below("ratio 1e8: Krylov over that at 1e2",
                 krylov_per_step(stiffest) / krylov_at_1e2, 7., "log C");
  }

  TEST(Stability, DensityRatioImpact)
  {
    const Workspace workspace;
    for (const double e : {0., 0.5, 1.}) {
      const Result result = good_run(
          workspace, "e = " + std::to_string(e),
          launch("density_ratio", {"Constants/e=" + std::to_string(e)}));
      ASSERT_TRUE(result.completed());
      const double m1 = 1., m2 = 1e6, u1 = 3., u2 = -1.;
      const double v1 = u1 - (1. + e) * m2 / (m1 + m2) * (u1 - u2),
                   v2 = u2 + (1. + e) * m1 / (m1 + m2) * (u1 - u2),
                   lost = 0.5 * (1. - e * e) * m1 * m2 / (m1 + m2) * (u1 - u2) *
                          (u1 - u2);
      const auto fields = snapshots(result.directory, "fields");
      ASSERT_GE(fields.size(), 2u);
      double low = 1e9, high = -1e9; // the light block moves back at v_1
      const auto &velocity = fields.back().at("velocity");
      for (std::size_t i = 0; i < velocity.size(); i += 3) {
        low = std::min(low, velocity[i]);
        high = std::max(high, velocity[i]);
      }
      expect_below("impulse", std::abs((u1 - low) / (u1 - v1) - 1.), 1e-8);
      expect_below("velocity of the heavy block", std::abs(high - v2), 1e-8);
      expect_below("energy lost, over that of the light block",
                   std::abs(result.dissipated("impact") - lost) / 4.5, 1e-8);
    }
  }

  // With friction up to 1e4 only: beyond, see doc/stability.md.
  TEST(Stability, HeavyOnLightStandsStill)
  {
    const Workspace workspace;
    for (const auto &[ratio, mu] :
         std::map<std::string, std::string>{{"1e4", "0.5"}, {"1e6", "0"}}) {
      const double heavy = std::stod(ratio);
      const Result result =
          good_run(workspace, ratio,
                   launch("heavy_on_light",
                          {"Constants/ratio=" + ratio, "Constants/mu=" + mu},
                          0.5 * heavy)); // m g^2 h^2 / 2
      ASSERT_TRUE(result.completed());
      expect_rest(result, heavy, 0.1);
      // what the solver leaves is that of the light block, over its inertia
      expect_below("ratio " + ratio + ", force of the floor",
                   std::abs(floor_traction(result) / (heavy + 1.) / 10. - 1.),
                   heavy * result.number("residual_max"));
    }
  }

  TEST(Stability, HugeFrictionOnTheIncline)
  {
    const Workspace workspace;
    for (const char *mu : {"10", "1e3"}) {
      const Result result =
          good_run(workspace, mu,
                   {scene("incline"),
                    {std::string("Obstacle: plane/friction=") + mu},
                    1,
                    false,
                    120.,
                    1.});
      ASSERT_TRUE(result.completed());
      for (const char *key : {"velocity", "position", "normal_reaction"})
        expect_below(std::string("mu = ") + mu + ", " + key, result.error(key),
                     1e-10, "sticks");
    }
  }

  // An elastic block: every point that touches sticks, and lifts off in the
  // vibrations. The sliding of the whole step makes friction take energy.
  TEST(Stability, HugeFrictionOfAnElasticBlock)
  {
    const Workspace workspace;
    for (const char *mu : {"10", "1e3"}) {
      const Result result =
          good_run(workspace, mu,
                   launch("mu_huge", {std::string("Constants/mu=") + mu,
                                      "Time/sliding=increment"}));
      ASSERT_TRUE(result.completed());
      const double scale = result.history.largest_energy();
      for (const double friction : result.history["friction"])
        EXPECT_GE(friction, -1e-9 * scale);
      expect_below(
          std::string("mu = ") + mu + ", energy over work",
          mechanical_energy(result.history, result.history.size() - 1) /
              result.history["work"].back(),
          1., "nothing is created");
    }
  }

  // theta = 1, Courant number 1000: equilibrium; theta = 1/2, of 100: the
  // energy stays bounded (the energy balance of longer ones: doc/stability.md).
  TEST(Stability, LargeSteps)
  {
    const Workspace workspace;
    const Result one = good_run(workspace, "theta = 1", launch("large_step"));
    ASSERT_TRUE(one.completed());
    // sigma = 1 MPa, S = 0.05 m^2, a = 1 m, 19 springs of 1e4 E/L, L = a/20
    const double elastic = 0.5 * 1e12 / 1e9 * 0.05,
                 cohesive = elastic * 1e-4 * 19. / 20.;
    const auto &history = one.history;
    expect_below("theta = 1, elastic energy",
                 std::abs(history["elastic"].back() / elastic - 1.), 1e-8);
    expect_below("theta = 1, energy of the springs, over the elastic one",
                 std::abs(history["cohesive"].back() - cohesive) / elastic,
                 2e-6, "round-off times the square of the steps");
    expect_below(
        "theta = 1, force of the support",
        std::abs(std::abs(history["reaction_left_x"].back()) / 5e4 - 1.), 1e-8);
    expect_below("theta = 1, kinetic energy",
                 history["kinetic"].back() / elastic, 1e-9);

    const Result half = good_run(
        workspace, "theta = 1/2",
        launch("large_step", {"Constants/theta=0.5", "Constants/steps=100",
                              "Time/cohesion rule=exact"}));
    ASSERT_TRUE(half.completed());
    double largest = 0.;
    for (std::size_t i = 0; i < half.history.size(); ++i)
      largest = std::max(largest, mechanical_energy(half.history, i));
    // every mode starts at rest under its share of the load
    expect_below("theta = 1/2, energy over its bound",
                 largest / (4. * (elastic + cohesive)), 1. + 1e-6,
                 "a load at once: at most twice the static displacement");
  }

  // A beam in shear and bending: degree 3 is exact for any Poisson ratio, and
  // the stiffness of degree 2 does not depend on it.
  TEST(Stability, Incompressible)
  {
    const Workspace workspace;
    const auto too_stiff = [&](const std::string &degree,
                               const std::string &nu) {
      const Result result =
          run(workspace, degree + "_" + nu,
              launch("incompressible", {"Discretization/degree=" + degree,
                                        "Constants/nu=" + nu}));
      EXPECT_TRUE(result.completed());
      const double n = std::stod(nu);
      // forces of the volume that cancel are lambda/mu times those of the shape
      expect_below("degree " + degree + ", nu = " + nu + ": ledger",
                   result.number("ledger_defect_max"),
                   1e-9 + 1e-12 * 2. * n / (1. - 2. * n), "round-off");
      const double E = 1e6, P = 1e3, l = 4., c = 0.5, I = 2. * c * c * c / 3.;
      const double exact = P * P * l * l * l * (1. - n * n) / (6. * E * I) +
                           0.6 * (1. + n) * P * P * l / (c * E);
      return 1. - result.history["elastic"].back() / exact;
    };
    const double compressible = too_stiff("2", "0.3");
    for (const std::string nu : {"0.4999", "0.499999"}) {
      expect_below("degree 3, nu = " + nu + ": energy",
                   std::abs(too_stiff("3", nu)), 1e-7,
                   "round-off grows with the bulk modulus");
      expect_below("degree 2, nu = " + nu + ": energy missing, over nu = 0.3",
                   too_stiff("2", nu) / compressible, 1.1, "no locking");
    }
    // what the page says of degree 1
    EXPECT_GT(too_stiff("1", "0.4999"), 0.5);
  }

  // The stress of the patch test is uniform: exact on any cells.
  TEST(Stability, IncompressiblePatch)
  {
    const Workspace workspace;
    for (const char *nu : {"0.4999", "0.499999"})
      for (const char *degree : {"1", "2"})
        expect_below(
            std::string("nu = ") + nu + ", degree " + degree,
            good_run(workspace, std::string(nu) + "_" + degree,
                     {scene("patch_crossed"),
                      {"plane=strain",
                       std::string("Material: triangle/Poisson ratio=") + nu,
                       std::string("Discretization/degree=") + degree}})
                .error("modulus"),
            5e-9, "tolerance of the solver on single steps");
  }

  // Edges from 1e-6 to 1, angles of 0.06 degrees, and steps as long as the
  // whole body needs them: a Courant number of 5e7.
  TEST(Stability, Slivers)
  {
    const Workspace workspace;
    const double exact = 0.5 * 1.001 * 1e12 * (1. - 0.09) / 1e9;
    struct Row {
      const char *degree, *split;
    };
    for (const Row &row :
         {Row{"1", "false"}, Row{"2", "false"}, Row{"3", "true"}}) {
      const Result result =
          good_run(workspace, row.degree,
                   launch("slivers",
                          {std::string("Discretization/degree=") + row.degree,
                           std::string("Mesh/split simplices=") + row.split}));
      ASSERT_TRUE(result.completed());
      EXPECT_EQ(result.number("steps"), 20.);
      expect_below(std::string("degree ") + row.degree + ": elastic energy",
                   std::abs(result.history["elastic"].back() / exact - 1.),
                   1e-10);
    }
    for (const char *type : {"crossed triangles", "diagonal triangles"})
      expect_below(std::string(type) + " of aspect 1e3: modulus",
                   good_run(workspace, type,
                            {scene("patch_crossed"),
                             {std::string("Mesh/type=") + type,
                              "Mesh/upper corner=4, 4e-3"}})
                       .error("modulus"),
                   5e-9, "tolerance of the solver on single steps");
  }

  // Errors fall with each degree up to 8, and more points on the faces than
  // the degree + 1 of the default change nothing.
  TEST(Stability, HighDegrees)
  {
    const Workspace workspace;
    const auto error = [&](const int degree) {
      const Result result =
          good_run(workspace, std::to_string(degree),
                   {scene("manufactured"),
                    {"Discretization/degree=" + std::to_string(degree),
                     "Constants/n=2", "Time/scheme=arkode", "Time/end=0.05 ms",
                     "Time/integration tolerance=1e-12", "Time/step=0.05 ms",
                     "Output/fields=false"}});
      return result.error("displacement_L2");
    };
    double last = 1.;
    for (int degree = 1; degree <= 8; ++degree) {
      const double now = error(degree);
      expect_below("degree " + std::to_string(degree) + ": error over the last",
                   now / last, 0.1);
      last = now;
    }
    expect_below("degree 8", last, 1e-12);
  }

  // theta = 1/2 <= 1 / (1 + e): no impact creates energy.
  TEST(Stability, HalfImpact)
  {
    const Workspace workspace;
    for (const char *e : {"0", "0.5", "1"}) {
      const Result result = good_run(
          workspace, std::string("e = ") + e,
          launch("half_impact", {std::string("Obstacle: wall/restitution=") + e,
                                 "Output/fields=false"}));
      ASSERT_TRUE(result.completed());
      double rise = 0.;
      for (std::size_t i = 0; i < result.history.size(); ++i)
        rise = std::max(rise, mechanical_energy(result.history, i) / 50. - 1.);
      expect_below(std::string("e = ") + e + ", energy gained", rise, 1e-9,
                   "tolerance of the solver");
      expect_below(std::string("e = ") + e + ", impulse",
                   result.error("impulse"), 0.01, "half a cell length over L");
    }
  }

  TEST(Stability, AllIntact)
  {
    const Workspace workspace;
    Launch rigid = launch("all_intact",
                          {"Interface: faces/where=x > 9",
                           "Interface: z/where=all", "Interface: z/law=rigid"});
    const auto intact = [&](const std::string &ratio) {
      return good_run(workspace, ratio,
                      launch("all_intact", {"Constants/ratio=" + ratio}));
    };
    const Result conforming = good_run(workspace, "rigid", rigid),
                 soft = intact("1e2"), stiff = intact("1e4"),
                 stiffest = intact("1e6");
    ASSERT_TRUE(conforming.completed() && soft.completed() &&
                stiff.completed() && stiffest.completed());
    for (const Result *result : {&soft, &stiff, &stiffest})
      for (const char *line : {"damage", "friction", "impact"})
        EXPECT_EQ(result->dissipated(line), 0.) << line;
    const double at_1e2 = energy_difference(conforming.history, soft.history),
                 at_1e4 = energy_difference(conforming.history, stiff.history),
                 at_1e6 =
                     energy_difference(conforming.history, stiffest.history);
    expect_below("ratio 1e2: energies against rigid faces", at_1e2, 0.1);
    expect_below("ratio 1e4: over a hundredth of that", 100. * at_1e4 / at_1e2,
                 1.5, "1/C");
    expect_below("ratio 1e6: over a hundredth of that", 100. * at_1e6 / at_1e4,
                 1.5, "1/C");
  }

  // More impulses than equations of equilibrium: their sum is exact.
  TEST(Stability, Hyperstatic)
  {
    struct Row {
      const char *name;
      double mass, area;
    };
    for (const Row &row : {Row{"four_points", 2000., 1.}, Row{"tower", 1e4, 1.},
                           Row{"wall", 1e4, 10.}}) {
      SCOPED_TRACE(row.name);
      const Workspace workspace;
      const Result result = good_run(
          workspace, row.name,
          launch(row.name, {}, 0.5 * row.mass * 0.01)); // m g^2 h^2 / 2
      ASSERT_TRUE(result.completed());
      expect_rest(result, row.mass, 0.1);
      expect_below(
          std::string(row.name) + ", sum of the reactions",
          std::abs(floor_traction(result) * row.area / (row.mass * 10.) - 1.),
          1e-8);
    }
  }

  // 1e4 revolutions, ten steps each: what the rule conserves, it conserves.
  TEST(Stability, HugeRotation)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "huge_rotation", launch("huge_rotation"));
    ASSERT_TRUE(result.completed());
    expect_below("energy", result.error("energy"), 1e-12, "exact");
    expect_below("angular momentum", result.error("momentum"), 1e-12, "exact");
    expect_below("axis to angular momentum, radians", result.error("tilt"),
                 1e-10, "from both");
    expect_below("length of the quaternion", result.error("orthogonality"),
                 1e-14, "normalised");
  }

  // Where no smooth motion exists the rod is caught by an impact; where two
  // do, either is an answer.
  TEST(Stability, Painleve)
  {
    const Workspace workspace;
    for (const char *step : {"0.1 ms", "1 us"}) {
      const Result caught =
          good_run(workspace, std::string("caught, ") + step,
                   launch("painleve", {std::string("Constants/step=") + step}));
      ASSERT_TRUE(caught.completed());
      expect_below("p", std::abs(caught.error("exact_p") + 0.1258827), 1e-7);
      expect_below("spin of the impact without a collision",
                   caught.error("caught") / (step[0] == '1' ? 1e-6 : 1e-4), 1.,
                   "g h over the speed, of order h");
      expect_below("energy gained", caught.error("energy_gained"), 1e-12,
                   "friction takes energy");
    }
    const Result either = good_run(
        workspace, "either", launch("painleve", {"Constants/spin=5 1/s"}));
    ASSERT_TRUE(either.completed());
    expect_below("b over g", std::abs(either.error("exact_b_over_g") - 1.37523),
                 1e-5, "omega^2 l sin a / g - 1");
    expect_below("spin, to the nearer of both solutions",
                 std::min(either.error("caught"), either.error("flies")), 1e-4,
                 "of order h");
    expect_below("energy gained", either.error("energy_gained"), 1e-12,
                 "friction takes energy");
  }

  TEST(Stability, HugeFrictionOfAnObliqueImpact)
  {
    const Workspace workspace;
    for (const char *mu : {"10", "1e3"}) {
      const Result result = good_run(
          workspace, mu,
          {scene("oblique"), {std::string("Obstacle: wall/friction=") + mu}});
      ASSERT_TRUE(result.completed());
      for (const char *key : {"normal", "tangential", "energy"})
        expect_below(std::string("mu = ") + mu + ", " + key, result.error(key),
                     1e-12, "sticks");
    }
  }

  // Infinitely many impacts in finite time. All of the work is lost in them:
  // disc k falls by k gaps, and by what the contacts below it overlap.
  TEST(Stability, Zeno)
  {
    const Workspace workspace;
    const Result result = good_run(workspace, "zeno", launch("zeno"));
    ASSERT_TRUE(result.completed());
    const auto &kinetic = result.history["kinetic"];
    expect_below("kinetic energy at the end, over its largest",
                 kinetic.back() /
                     *std::max_element(kinetic.begin(), kinetic.end()),
                 1e-18, "rest");
    const double mass = std::acos(-1.) * 0.5, gap = 0.1, n = 50.;
    const double work = mass * 9.81 * gap * n * (n + 1.) / 2.;
    expect_below("energy lost over that of the gaps, less 1, in overlaps",
                 (result.dissipated("impact") / work - 1.) * gap /
                     result.number("penetration_max"),
                 1.);
    EXPECT_GT(result.dissipated("impact") / work, 1. - 1e-9);
    expect_below("largest overlap over the way of a step",
                 result.number("penetration_max") /
                     (2e-3 * std::sqrt(2. * 9.81 * n * gap)),
                 1., "seen within the last half of a step");
  }
} // namespace end_to_end::test_stability
