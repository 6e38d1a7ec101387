#include "discretization/cells.h"
#include "make_scene.h"
#include "momenta.h"
#include "separating_axes.h"
#include "time_integration/large_motion_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

// Whole steps of scenes with large motions. Energies and momenta are computed
// here from states and masses, not taken from the energy balance.

using namespace nsfd;
using namespace nsfd::test;

namespace test_edge_contacts
{
  // --- edges that cross in space

  /** What turns a displacement (u, v, w) of (x, y, z) by 170 degrees about x,
      and of a velocity. */
  std::vector<std::string> turned_about_x(const std::string &material,
                                          const std::array<std::string, 3> &u,
                                          const std::array<std::string, 3> &v)
  {
    const std::string name = "Material: " + material + "/initial ";
    const auto y = "(y + " + u[1] + ")", z = "(z + " + u[2] + ")";
    return {name + "displacement x=" + u[0],
            name + "displacement y=co * " + y + " - si * " + z + " - y",
            name + "displacement z=si * " + y + " + co * " + z + " - z",
            name + "velocity x=" + v[0],
            name + "velocity y=co * (" + v[1] + ") - si * (" + v[2] + ")",
            name + "velocity z=si * (" + v[1] + ") + co * (" + v[2] + ")"};
  }

  /**
   * Two bricks, turned by 45 degrees about their axes: the lower edge of the
   * upper one, along y, falls on the upper edge of the lower one, along x. No
   * corner comes near the other brick.
   */
  struct CrossedBricks {
    std::array<std::string, 3> low_u = {"0", "r * (y - z) - y",
                                        "r * (y + z) - z"},
                               high_u = {"aside + r * (x - (z - 1)) - x", "0",
                                         "r * (x + (z - 1)) - (z - 1) + "
                                         "0.5 * sqrt(2) + gap - 1"},
                               low_v = {"0", "0", "0.5"},
                               high_v = {"0", "0", "-1.5"};
    std::string gap = "0.015", aside = "0", more;

    std::string text() const
    {
      std::string result = R"(
set dimension = 3
set motion    = large
subsection Constants
  set r     = sqrt(0.5)
  set co    = cos(170 / 180 * pi)
  set si    = sin(170 / 180 * pi)
  set gap   = )" + gap +
                           "\n  set aside = " + aside + R"(
end
subsection Mesh
  set type = bodies
end
subsection Body: low
  set type         = brick
  set lower corner = -1, -0.25, -0.25
  set upper corner = 1, 0.25, 0.25
  set cells        = 1, 1, 1
end
subsection Body: high
  set type         = brick
  set lower corner = -0.25, -1, 0.75
  set upper corner = 0.25, 1, 1.25
  set cells        = 1, 1, 1
end
)";
      for (const bool high : {false, true}) {
        const auto &u = high ? high_u : low_u, &v = high ? high_v : low_v;
        result += std::string("subsection Material: ") +
                  (high ? "high\n  set where = high\n  set density = 3\n"
                        : "low\n  set where = low\n  set density = 1\n") +
                  "  set model = rigid\n";
        for (unsigned int d = 0; d < 3; ++d)
          result += std::string("  set initial displacement ") + "xyz"[d] +
                    " = " + u[d] + "\n  set initial velocity " + "xyz"[d] +
                    " = " + v[d] + "\n";
        result += "end\n";
      }
      return result + R"(
subsection Interface: none
  set law = rigid
end
subsection Contact: all
  set between     = all
  set restitution = 0.5
end
subsection Time
  set end   = 1000
  set step  = 0.002
  set theta = 0.5
end
subsection Solver
  set tolerance = 1e-13
end
)" + more;
    }

    std::vector<std::string> turned() const
    {
      auto result = turned_about_x("low", low_u, low_v);
      const auto high = turned_about_x("high", high_u, high_v);
      result.insert(result.end(), high.begin(), high.end());
      return result;
    }
  };

  std::vector<std::string> deformable()
  {
    std::vector<std::string> result;
    for (const std::string name : {"low", "high"})
      for (const std::string entry :
           {"model=neo-hookean", "Young modulus=1000", "Poisson ratio=0.3"})
        result.push_back("Material: " + name + "/" + entry);
    return result;
  }

  std::vector<std::string> both(std::vector<std::string> a,
                                const std::vector<std::string> &b)
  {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }

  /** Of the cell as it is now, as if its sides were flat. */
  test::Convex convex(const Scene<3> &scene, const unsigned int b,
                      const std::vector<double> &nodal)
  {
    test::Convex result;
    const auto &d = *scene.discretization;
    const auto at_rest = d.cells().corners[b];
    const auto u = d.cells().at_corners(b, nodal);
    for (unsigned int k = 0; k < 8; ++k) {
      result.corners.emplace_back();
      for (unsigned int c = 0; c < 3; ++c)
        result.corners.back()[c] = at_rest[k][c] + u[k * 3 + c];
    }
    const auto &x = result.corners;
    for (unsigned int k = 0; k < 3; ++k)
      result.edges.push_back(difference(x[1u << k], x[0]));
    for (unsigned int k = 0; k < 3; ++k) {
      test::Vector3 n =
          test::cross(result.edges[(k + 1) % 3], result.edges[(k + 2) % 3]);
      result.normals.push_back(n);
      result.normals.push_back({-n[0], -n[1], -n[2]});
    }
    return result;
  }

  /** Of all pairs of two bodies. */
  template <typename Visit>
  void for_pairs(const Scene<3> &scene, const Visit &visit)
  {
    const auto nodal = scene.discretization->to_nodal(scene.state.displacement);
    std::vector<test::Convex> all;
    for (unsigned int b = 0; b < scene.discretization->bodies().size(); ++b)
      all.push_back(convex(scene, b, nodal));
    for (std::size_t a = 0; a < all.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        visit(a, b, test::separation(all[a], all[b]).distance);
  }

  /** The largest overlap of two bodies; 0 if all are apart. */
  double deepest_overlap(const Scene<3> &scene)
  {
    double result = 0.;
    for_pairs(scene, [&](std::size_t, std::size_t, const double distance) {
      result = std::max(result, -distance);
    });
    return result;
  }

  TEST(LargeMotion, CentralImpactOfTwoEdges)
  {
    for (const double e : {0., 0.5, 1.}) {
      Scene<3> scene(CrossedBricks().text(),
                     {"Contact: all/restitution=" + std::to_string(e)});
      double deepest = 0.;
      for (unsigned int k = 0; k < 20; ++k) {
        EXPECT_LT(scene.advance().balance_residual, 1e-12);
        deepest = std::max(deepest, deepest_overlap(scene));
      }
      // masses 1 : 3, v_1 - v_2 = 2
      const double change = (1. + e) * 2.;
      const std::array<double, 2> v = {0.5 - change * 0.75,
                                       -1.5 + change * 0.25};
      for (unsigned int b = 0; b < 2; ++b)
        for (unsigned int c = 0; c < 3; ++c) {
          EXPECT_NEAR(scene.state.rigid[13 * b + 3 + c], c == 2 ? v[b] : 0.,
                      1e-12);
          EXPECT_NEAR(scene.state.rigid[13 * b + 10 + c], 0., 1e-12);
        }
      EXPECT_LE(deepest, 2. * scene.time_step + 1e-12);
    }
  }

  /** How far the two edges of CrossedBricks have passed through each other. */
  double overlap_of_edges(const Scene<3> &scene)
  {
    const auto nodal = scene.discretization->to_nodal(scene.state.displacement);
    const auto low = convex(scene, 0, nodal).corners,
               high = convex(scene, 1, nodal).corners;
    const test::Vector3 n =
        test::cross(difference(low[7], low[6]), difference(high[2], high[0]));
    return -test::dot(n, difference(high[0], low[6])) / norm(n);
  }

  const SurfaceContacts<3>::Counters &contact_counters(const Scene<3> &scene)
  {
    const auto &stepper =
        dynamic_cast<const NewtonMoreauJean<3> &>(*scene.stepper);
    return dynamic_cast<const LargeMotionModel<3> &>(stepper.bodies())
        .contacts()
        ->counters();
  }

  /** Checks momenta and energy of bricks that meet off centre; the deepest
      overlap of the edges over the length of the step, m/s. */
  void falls_edge_on_edge(const CrossedBricks &bricks,
                          const std::vector<std::string> &overrides,
                          const unsigned int n_steps, double &overlap)
  {
    Scene<3> scene(bricks.text(), overrides);
    const auto start = momenta(scene);
    double energy = scene.energy(), deepest = 0.;
    const double first = energy;
    const bool rubs = scene.input->contacts[0].friction > 0.;
    for (unsigned int k = 0; k < n_steps; ++k) {
      EXPECT_LT(scene.advance().balance_residual, 1e-9);
      // what sticks while it turns may give some of its friction back
      ASSERT_LE(scene.energy(), (rubs ? first : energy) + 1e-9 * first)
          << "step " << k;
      energy = scene.energy();
      deepest = std::max(deepest, overlap_of_edges(scene));
    }
    EXPECT_GT(contact_counters(scene).edge_rows, 0u);
    EXPECT_LT(energy, 0.999 * first);
    const auto end = momenta(scene);
    EXPECT_LT(norm(difference(end[0], start[0])), 1e-9 * norm(start[0]));
    EXPECT_LT(norm(difference(end[1], start[1])), 1e-9 * norm(start[1]));
    overlap = deepest / scene.time_step;
  }

  CrossedBricks off_centre()
  {
    CrossedBricks bricks;
    bricks.aside = "0.3";
    bricks.low_v = {"0.2 - 0.1 * y", "0.1 * x", "0.5"};
    bricks.high_v = {"-0.3", "0.1 - 0.2 * (z - 1)", "-1.5 + 0.2 * y"};
    return bricks;
  }

  constexpr double approach = 2.5; // at most, where they meet

  TEST(LargeMotion, EdgesOfRigidBricksKeepMomenta)
  {
    for (const std::string mu : {"0", "0.3"}) {
      double overlap = 0.;
      falls_edge_on_edge(off_centre(), {"Contact: all/friction=" + mu}, 200,
                         overlap);
      EXPECT_GT(overlap, 0.);
      EXPECT_LE(overlap, approach);
    }
  }

  TEST(LargeMotion, EdgesOfDeformableBricksKeepMomenta)
  {
    for (const std::string mu : {"0", "0.3"}) {
      const auto soft = both(deformable(), {"Contact: all/friction=" + mu,
                                            "Contact: all/restitution=0"});
      double overlap = 0.;
      falls_edge_on_edge(off_centre(), soft, 60, overlap);
      EXPECT_GT(overlap, 0.);
      EXPECT_LE(overlap, approach);
      // curved edges, with a node in the middle
      falls_edge_on_edge(off_centre(), both(soft, {"Discretization/degree=2"}),
                         40, overlap);
    }
  }

  TEST(LargeMotion, TurnedEdgesAreTheSame)
  {
    for (const bool soft : {false, true}) {
      const auto bricks = off_centre();
      const auto model = both(soft ? deformable() : std::vector<std::string>(),
                              {"Contact: all/friction=0.3"});
      Scene<3> one(bricks.text(), model),
          other(bricks.text(), both(model, bricks.turned()));
      ASSERT_NEAR(other.energy(), one.energy(), 1e-12 * one.energy());
      for (unsigned int k = 0; k < 60; ++k) {
        one.advance();
        other.advance();
      }
      EXPECT_LT(one.energy(), 0.999 * one.state.initial_energy);
      EXPECT_NEAR(one.state.energy.elastic, other.state.energy.elastic,
                  1e-8 * one.energy());
      EXPECT_NEAR(one.state.energy.kinetic, other.state.energy.kinetic,
                  1e-8 * one.energy());
      EXPECT_NEAR(one.state.energy.friction, other.state.energy.friction,
                  1e-8 * one.energy());
      const double co = std::cos(170. / 180. * std::acos(-1.)),
                   si = std::sin(170. / 180. * std::acos(-1.));
      const auto &v = one.state.velocity, &w = other.state.velocity;
      for (std::size_t i = 0; i < v.size(); i += 3) {
        EXPECT_NEAR(w[i], v[i], 1e-8);
        EXPECT_NEAR(w[i + 1], co * v[i + 1] - si * v[i + 2], 1e-8);
        EXPECT_NEAR(w[i + 2], si * v[i + 1] + co * v[i + 2], 1e-8);
      }
    }
  }

  /** Bricks turned at random, over a plane. */
  std::string heap_of_bricks(const unsigned int n)
  {
    std::string text = R"(
set dimension = 3
set motion    = large
subsection Mesh
  set type = bodies
end
)";
    for (unsigned int k = 0; k < n; ++k) {
      const auto corner = [&](const double x, const double y, const double z) {
        return std::to_string(2. * (k % 2) + x) + ", " +
               std::to_string(2. * (k / 2 % 2) + y) + ", " +
               std::to_string(2. * (k / 4) + z) + "\n";
      };
      text += "subsection Body: " + std::to_string(k) +
              "\n  set type = brick\n  set cells = 1, 1, 1\n"
              "  set lower corner = " +
              corner(0.5, 0.75, 0.8) +
              "  set upper corner = " + corner(1.5, 1.25, 1.2) + "end\n";
    }
    // about the centre of each, first by a, then by b about another axis
    const std::string X = "(mod(x, 2) - 1)", Y = "(mod(y, 2) - 1)",
                      Z = "(mod(z, 2) - 1)",
                      which = "floor(x / 2) + 2 * floor(y / 2) + "
                              "4 * floor(z / 2)",
                      a = "(6 * random(" + which + "))",
                      b = "(6 * random(" + which + ", 1))",
                      x_1 = "(cos(" + a + ") * " + X + " - sin(" + a + ") * " +
                            Y + ")",
                      y_1 = "(sin(" + a + ") * " + X + " + cos(" + a + ") * " +
                            Y + ")";
    return text + R"(
subsection Material: bricks
  set model   = rigid
  set density = 1
  set initial displacement x = )" +
           x_1 + " - " + X + "- 0.7 * floor(x / 2)" + R"(
  set initial displacement y = cos()" +
           b + ") * " + y_1 + " - sin(" + b + ") * " + Z + " - " + Y +
           " - 0.7 * floor(y / 2)" + R"(
  set initial displacement z = sin()" +
           b + ") * " + y_1 + " + cos(" + b + ") * " + Z + " - " + Z +
           " - 0.7 * floor(z / 2)" + R"(
  set initial velocity z = -2
end
subsection Interface: none
  set law = rigid
end
subsection Contact: any
  set friction = 0.3
end
subsection Obstacle: ground
  set point    = 0, 0, 0
  set normal   = 0, 0, 1
  set friction = 0.3
end
subsection Loads
  set gravity = 0, 0, -9.81
end
subsection Time
  set end   = 1000
  set step  = 0.002
  set theta = 0.5
end
)";
  }

  TEST(LargeMotion, NothingOverlapsInAHeapOfBricks)
  {
    Scene<3> scene(heap_of_bricks(12));
    ASSERT_EQ(deepest_overlap(scene), 0.);
    // at most: rigid bodies a and b, with corners at `radius`
    const double radius = std::sqrt(0.5 * 0.5 + 0.25 * 0.25 + 0.2 * 0.2);
    const auto approach = [&](const std::size_t a, const std::size_t b) {
      const double *x = &scene.state.rigid[13 * a],
                   *y = &scene.state.rigid[13 * b];
      return norm({x[3] - y[3], x[4] - y[4], x[5] - y[5]}) +
             radius *
                 (norm({x[10], x[11], x[12]}) + norm({y[10], y[11], y[12]}));
    };
    double deepest = 0., fastest = 0.;
    for (unsigned int k = 0; k < 800; ++k) {
      for_pairs(scene, [&](const std::size_t a, const std::size_t b,
                           const double distance) {
        deepest = std::max(deepest, -distance);
        const double speed = approach(a, b);
        if (distance < scene.time_step * speed)
          fastest = std::max(fastest, speed);
      });
      scene.advance_bisecting();
    }
    EXPECT_GT(contact_counters(scene).edge_rows, 100u);
    EXPECT_GT(deepest, 0.);
    EXPECT_LE(deepest, fastest * scene.time_step);
    RecordProperty("deepest", std::to_string(deepest));
    RecordProperty("bound", std::to_string(fastest * scene.time_step));
  }
} // namespace test_edge_contacts
