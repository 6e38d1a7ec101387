#include "breaking_plate.h"
#include "leapfrog_steps.h"
#include "make_scene.h"

#include "core/order_free_sum.h"
#include "discretization/cells.h"
#include "postprocess/fragment_output.h"
#include "records/fragment_sizes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

// Mass, place, momentum, spin and energy of fragments whose motion is known.

namespace nsfd::test_fragment_motion
{
  using namespace space;
  using test::Scene;

  namespace
  {
    template <int dim>
    std::vector<FragmentRecord> measure(const Scene<dim> &scene)
    {
      Fragments<dim> fragments(*scene.discretization, scene.communicator);
      fragments.update(scene.state);
      const FragmentMotion<dim> motion(*scene.discretization,
                                       scene.communicator, scene.moving.get(),
                                       scene.stepper->initial_state());
      return motion.measure(scene.state, fragments);
    }

    /** A brick: its place and turn, and how it flies. */
    struct Flight {
      Vec3 middle; ///< at rest
      Vec3 shift, velocity, spin;
      Mat3 turn;
    };

    template <int dim>
    Vec3 from_point(const dealii::Point<dim> &x)
    {
      Vec3 result{};
      for (unsigned int c = 0; c < dim; ++c)
        result[c] = x[c];
      return result;
    }

    /** Two blocks, left and right of x = 1, in rigid motions of any size. */
    template <int dim>
    void fly(Scene<dim> &scene, const std::array<Flight, 2> &flights)
    {
      const auto &mesh = *scene.discretization;
      const auto flight = [&](const unsigned int body) -> const Flight & {
        return flights[mesh.cells().centre(body)[0] < 1. ? 0 : 1];
      };
      scene.state.displacement = mesh.interpolate(
          [&](const dealii::Point<dim> &x, const unsigned int body, double *u) {
            const Flight &one = flight(body);
            const Vec3 r = from_point(x) - one.middle,
                       moved = one.turn * r - r + one.shift;
            std::copy_n(moved.begin(), dim, u);
          });
      scene.state.velocity = mesh.interpolate(
          [&](const dealii::Point<dim> &x, const unsigned int body, double *v) {
            const Flight &one = flight(body);
            const Vec3 r = one.turn * (from_point(x) - one.middle),
                       speed = one.velocity + cross(one.spin, r);
            std::copy_n(speed.begin(), dim, v);
          });
    }

    void expect_near(const Vec3 &a, const Vec3 &b, const double tolerance)
    {
      for (unsigned int c = 0; c < 3; ++c)
        EXPECT_NEAR(a[c], b[c], tolerance) << "component " << c;
    }

    // lengths are multiples of 1/4: shapes are rounded to 2^-42 of their size
    const std::string elastic = "set Young modulus = 1\n"
                                "  set Poisson ratio = 0.3";

    const std::string plane_blocks = R"(# blocks - two blocks of several cells.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 2.5, 1
  set cells        = 5, 2
end
subsection Material: block
  )" + elastic + R"(
  set density       = 3
end
subsection Interface: cut
  set where = abs(x - 1) < 1e-9
  set law   = contact
end
subsection Interface: rest
  set law = rigid
end
subsection Time
  set end  = 1
  set step = 0.1
end
)";

    const std::string space_blocks = R"(# blocks - two blocks of several cells.
set dimension = 3
subsection Mesh
  set type         = brick
  set lower corner = 0, 0, 0
  set upper corner = 2.5, 1, 0.5
  set cells        = 5, 2, 1
end
subsection Material: block
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 3
end
subsection Interface: cut
  set where = abs(x - 1) < 1e-9
  set law   = contact
end
subsection Interface: rest
  set law = rigid
end
subsection Time
  set end  = 1
  set step = 0.1
end
)";

    Mat3 turn_about_z(const double angle)
    {
      return {{{std::cos(angle), -std::sin(angle), 0.},
               {std::sin(angle), std::cos(angle), 0.},
               {0., 0., 1.}}};
    }

    /** Principal moments of a brick with these edges. */
    Vec3 brick_inertia(const double mass, const Vec3 &a)
    {
      return {mass * (a[1] * a[1] + a[2] * a[2]) / 12.,
              mass * (a[0] * a[0] + a[2] * a[2]) / 12.,
              mass * (a[0] * a[0] + a[1] * a[1]) / 12.};
    }

    class BlocksTest : public testing::TestWithParam<std::string>
    {
    };
  } // namespace

  // ---------------------------------------------------------- rigid motions

  // elastic cells of any shape and degree, and rigid ones of small motions
  TEST_P(BlocksTest, InThePlane)
  {
    std::string text = plane_blocks;
    const bool is_small = GetParam().find("rigid") != std::string::npos;
    if (is_small)
      text.erase(text.find(elastic), elastic.size());
    Scene<2> scene(text, {GetParam()});
    const std::array<double, 2> length = {{1., 1.5}};
    std::array<Flight, 2> flights;
    flights[0] = {{0.5, 0.5, 0.},
                  {-30., 4., 0.},
                  {2., -1., 0.},
                  {0., 0., 7.},
                  turn_about_z(is_small ? 0. : 2.)};
    flights[1] = {{1.75, 0.5, 0.},
                  {5., 0., 0.},
                  {-3., 0.5, 0.},
                  {0., 0., -0.4},
                  turn_about_z(is_small ? 0. : -0.3)};
    fly(scene, flights);
    const auto records = measure(scene);
    if (!scene.communicator.is_root())
      return;
    ASSERT_EQ(records.size(), 2u);
    for (unsigned int k = 0; k < 2; ++k) {
      const FragmentRecord &record = records[k];
      const Flight &flight = flights[k];
      const double area = length[k], mass = 3. * area;
      EXPECT_EQ(record.number, k);
      EXPECT_NEAR(record.mass, mass, 1e-13);
      EXPECT_NEAR(record.size(2), std::sqrt(4. * area / M_PI), 1e-13);
      expect_near(record.centre, flight.middle + flight.shift, 1e-12);
      expect_near(record.velocity, flight.velocity, 1e-13);
      expect_near(record.spin, flight.spin, 1e-11);
      const double J = brick_inertia(mass, {length[k], 1., 0.})[2];
      EXPECT_NEAR(record.inertia[2][2], J, 1e-12);
      const double translation =
          0.5 * mass * dot(flight.velocity, flight.velocity);
      const double spin = 0.5 * J * flight.spin[2] * flight.spin[2];
      EXPECT_NEAR(record.kinetic_translation, translation, 1e-12);
      EXPECT_NEAR(record.kinetic_spin, spin, 1e-11);
      EXPECT_NEAR(record.kinetic, translation + spin, 1e-11) << "no vibration";
      EXPECT_EQ(record.surface, 0.) << "they were apart from the start";
    }
  }

  INSTANTIATE_TEST_SUITE_P(Cells, BlocksTest,
                           testing::Values("Discretization/degree=1",
                                           "Discretization/degree=2",
                                           "Discretization/degree=3",
                                           "Mesh/type=crossed triangles",
                                           "Material: block/model=rigid"));

  TEST(FragmentMotion, OfBlocksInSpace)
  {
    Scene<3> scene(space_blocks);
    const Mat3 turn = rotation(normalized(Quaternion{{0.3, -0.5, 0.7, 0.2}}));
    std::array<Flight, 2> flights;
    flights[0] = {
        {0.5, 0.5, 0.25}, {-3., 4., 2.}, {2., -1., 5.}, {0.5, -3., 7.}, turn};
    flights[1] = {{1.75, 0.5, 0.25},
                  {5., 0., 1.},
                  {-3., 0.5, 0.},
                  {1., 2., -0.4},
                  turn_about_z(0.)};
    fly(scene, flights);
    const auto records = measure(scene);
    if (!scene.communicator.is_root())
      return;
    ASSERT_EQ(records.size(), 2u);
    for (unsigned int k = 0; k < 2; ++k) {
      const FragmentRecord &record = records[k];
      const Flight &flight = flights[k];
      const Vec3 edges = {k == 0 ? 1. : 1.5, 1., 0.5};
      const double volume = edges[0] * edges[1] * edges[2], mass = 3. * volume;
      EXPECT_NEAR(record.mass, mass, 1e-13);
      EXPECT_NEAR(record.size(3), std::cbrt(6. * volume / M_PI), 1e-13);
      expect_near(record.centre, flight.middle + flight.shift, 1e-12);
      expect_near(record.velocity, flight.velocity, 1e-13);
      expect_near(record.spin, flight.spin, 1e-11);
      const Vec3 J = brick_inertia(mass, edges);
      const Mat3 principal = {{{J[0], 0., 0.}, {0., J[1], 0.}, {0., 0., J[2]}}};
      const Mat3 expected = flight.turn * principal * transposed(flight.turn);
      for (unsigned int row = 0; row < 3; ++row)
        expect_near(record.inertia[row], expected[row], 1e-12);
      const double spin = 0.5 * dot(flight.spin, expected * flight.spin);
      EXPECT_NEAR(record.kinetic_spin, spin, 1e-11);
      EXPECT_NEAR(record.kinetic,
                  0.5 * mass * dot(flight.velocity, flight.velocity) + spin,
                  1e-10);
    }
  }

  TEST(FragmentMotion, OfARigidBodyIsWhatWasGiven)
  {
    Scene<3> scene(R"(# top - a rigid body with a given inertia.
set dimension = 3
set motion    = large
subsection Mesh
  set type         = brick
  set lower corner = -0.5, -0.5, -0.5
  set upper corner = 0.5, 0.5, 0.5
  set cells        = 2, 1, 1
end
subsection Material: body
  set model              = rigid
  set bodies             = connected
  set density            = 1
  set mass               = 5
  set principal inertia  = 1, 2, 2.5
  set initial velocity x = 7 + z - 3 * y
  set initial velocity y = 3 * x - 0.5 * z
  set initial velocity z = 0.5 * y - x
end
subsection Interface: none
  set law = rigid
end
subsection Time
  set end  = 1
  set step = 0.05
end
)");
    for (unsigned int k = 0; k < 20; ++k)
      scene.advance();
    const auto records = measure(scene);
    ASSERT_EQ(records.size(), 1u);
    const FragmentRecord &record = records[0];
    EXPECT_EQ(record.cells, 2u);
    EXPECT_EQ(record.mass, 5.);
    expect_near(record.centre, {7., 0., 0.}, 1e-12);
    expect_near(record.velocity, {7., 0., 0.}, 1e-13);
    // free of moments: L = J omega and the energy stay, the axes have turned
    expect_near(record.inertia * record.spin, {0.5, 2., 7.5}, 1e-11);
    EXPECT_NEAR(record.kinetic_spin, 0.5 * (0.25 + 2. + 22.5), 1e-11);
    EXPECT_GT(std::abs(record.inertia[0][1]), 0.01);
    EXPECT_NEAR(record.inertia[0][0] + record.inertia[1][1] +
                    record.inertia[2][2],
                5.5, 1e-12);
    EXPECT_NEAR(record.kinetic, record.kinetic_spin + 0.5 * 5. * 49., 1e-11);
  }

  // --------------------------------------------------------- anything moves

  TEST(FragmentMotion, AddsUpToTheScene)
  {
    Scene<2> scene(test::breaking_plate, {"Time/step=0.4 courant"});
    for (unsigned int k = 0; k < 60; ++k)
      scene.advance_bisecting();
    const auto records = measure(scene);
    // H^T nothing: momentum by the mass matrix and rigid translations
    const auto &mesh = *scene.discretization;
    std::vector<double> Mv(scene.state.velocity.size());
    scene.delassus->apply(DelassusOperator<2>::Operator::mass,
                          scene.state.velocity.data(), Mv.data());
    Vec3 momentum{}, sum{};
    for (unsigned int c = 0; c < 2; ++c) {
      const auto unit =
          mesh.interpolate([c](const dealii::Point<2> &, unsigned int,
                               double *v) { v[c] = 1.; });
      momentum[c] = scene.communicator.dot(unit.data(), Mv.data(), unit.size());
    }
    if (!scene.communicator.is_root())
      return;
    EXPECT_GT(records.size(), 3u);
    double kinetic = 0., parts = 0., size = 0., surface = 0.;
    for (const FragmentRecord &record : records) {
      sum = sum + record.mass * record.velocity;
      size += norm(record.mass * record.velocity);
      kinetic += record.kinetic;
      parts += record.kinetic_translation + record.kinetic_spin;
      surface += record.surface;
      EXPECT_LE(record.kinetic_translation + record.kinetic_spin,
                record.kinetic * (1. + 1e-12));
    }
    expect_near(sum, momentum, 1e-12 * size);
    EXPECT_NEAR(kinetic, scene.state.energy.kinetic,
                1e-12 * scene.state.energy.kinetic);
    EXPECT_LT(parts, kinetic) << "they vibrate";
    EXPECT_NEAR(surface, 2. * scene.state.broken_area,
                1e-12 * scene.state.broken_area);
  }

  TEST(FragmentMotion, OfABarInPieces)
  {
    // pieces of 1, 3, 2 and 4 cells, each 0.5 x 0.25
    Scene<2> scene(R"(# bar - broken at three places.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 5, 0.25
  set cells        = 10, 1
end
subsection Material: bar
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 2
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 1
  set toughness = 1
  set broken    = abs(x - 0.5) < 0.1 || abs(x - 2) < 0.1 || abs(x - 3) < 0.1
end
subsection Time
  set end  = 1
  set step = 0.1
end
)");
    const auto records = measure(scene);
    if (!scene.communicator.is_root())
      return;
    ASSERT_EQ(records.size(), 4u);
    const std::array<double, 4> lengths = {{0.5, 1.5, 1., 2.}},
                                middles = {{0.25, 1.25, 2.5, 4.}};
    for (unsigned int k = 0; k < 4; ++k) {
      EXPECT_EQ(records[k].cells, unsigned(2. * lengths[k] + 0.5));
      EXPECT_NEAR(records[k].mass, 0.5 * lengths[k], 1e-14);
      EXPECT_NEAR(records[k].centre[0], middles[k], 1e-13);
      EXPECT_EQ(records[k].surface, 0.) << "broken before";
    }
    const auto sizes = fragment_sizes(records, 2);
    ASSERT_TRUE(sizes);
    EXPECT_NEAR(sizes->total_mass, 2.5, 1e-14);
    EXPECT_NEAR(sizes->largest_mass, 1., 1e-14);
    EXPECT_NEAR(sizes->mean_mass, 0.625, 1e-14);
    EXPECT_NEAR(sizes->median_mass, 0.625, 1e-14);
    EXPECT_FALSE(sizes->mass_exponent) << "four are too few";
  }

  // ------------------------------------------------------------------- file

  TEST(FragmentOutput, RowsFitTheHeader)
  {
    const auto n = [](const std::string &text) {
      return std::count(text.begin(), text.end(), ',');
    };
    FragmentRecord record;
    record.number = 3;
    record.inertia[2][2] = 0.1;
    EXPECT_EQ(n(FragmentOutput<2>::header()),
              n(FragmentOutput<2>::line(7, 0.5, record)));
    EXPECT_EQ(n(FragmentOutput<3>::header()),
              n(FragmentOutput<3>::line(7, 0.5, record)));
    EXPECT_EQ(FragmentOutput<2>::line(7, 0.5, record),
              "7,0.5,3,0,0,0,0,0,0,0,0.1,0,0,0,0,0");
  }

  TEST(FragmentOutput, IsOfScenesThatMayBreak)
  {
    const auto wanted = [](const std::string &text,
                           const std::vector<std::string> &set) {
      const Scene<2> scene(text, set);
      Fragments<2> fragments(*scene.discretization, scene.communicator);
      fragments.update(scene.state);
      return has_fragments(*scene.input, *scene.discretization, fragments,
                           scene.communicator);
    };
    EXPECT_TRUE(wanted(plane_blocks, {})) << "two bodies";
    EXPECT_FALSE(wanted(plane_blocks, {"Interface: cut/law=rigid"}));
    EXPECT_TRUE(wanted(plane_blocks, {"Interface: cut/law=camacho-ortiz",
                                      "Interface: cut/strength=1",
                                      "Interface: cut/toughness=1"}));
  }

  /** Explicit steps: a disc has the mass of the disc, not of its cells, and a
      body the mass that the scene gives. */
  TEST(FragmentMotion, RigidBodiesOfExplicitStepsHaveTheirOwnMass)
  {
    test::Steps<2> scene(R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type = bodies
end
subsection Body: disc
  set type      = hyper_ball
  set arguments = 0, 0 : 0.5 : true
end
subsection Body: block
  set type         = rectangle
  set lower corner = 2, 0
  set upper corner = 3, 1
  set cells        = 2, 1
end
subsection Material: disc
  set where   = disc
  set model   = rigid
  set bodies  = connected
  set surface = ball
  set density = 1000 kg/m^3
  set initial velocity x = 3
end
subsection Material: block
  set where   = block
  set model   = rigid
  set bodies  = connected
  set density = 1000 kg/m^3
  set mass    = 50 kg/m
  set principal inertia = 7 kg*m
  set initial velocity y = -2
end
subsection Interface: inside
  set law = joined
end
subsection Contact: any
  set between = all
end
subsection Time
  set scheme = explicit
  set step   = 1 ms
  set end    = 10 ms
end
)");
    for (unsigned int k = 0; k < 3; ++k)
      scene.step();
    scene.leapfrog->show(scene.state);
    Fragments<2> found(*scene.discretization, scene.communicator);
    found.update(scene.state);
    const FragmentMotion<2> motion(*scene.discretization, scene.communicator,
                                   nullptr, scene.leapfrog->initial_state());
    const auto fragments = motion.measure(scene.state, found);
    ASSERT_EQ(fragments.size(), 2u);
    const double mass = 1000. * M_PI / 4.;
    EXPECT_NEAR(fragments[0].mass, mass, 1e-9 * mass);
    EXPECT_NEAR(fragments[0].velocity[0], 3., 1e-12);
    EXPECT_NEAR(fragments[0].inertia[2][2], mass / 8., 1e-9 * mass);
    EXPECT_NEAR(fragments[1].mass, 50., 1e-9);
    EXPECT_NEAR(fragments[1].inertia[2][2], 7., 1e-9);
    EXPECT_NEAR(fragments[1].velocity[1], -2., 1e-12);
    EXPECT_NEAR(fragments[0].kinetic + fragments[1].kinetic,
                scene.state.energy.kinetic, 1e-9 * mass);
  }
} // namespace nsfd::test_fragment_motion
