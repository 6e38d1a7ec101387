#include "leapfrog_steps.h"
#include "standing_bar.h"

#include "discretization/body_frequency.h"
#include "joined/corner_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nsfd::test_leapfrog
{
  namespace
  {
    const std::string square = R"(
set dimension = 2
subsection Mesh
  set type         = crossed triangles
  set upper corner = 10 um, 10 um
  set cells        = 6, 6
end
subsection Material: bulk
  set Young modulus = 135 GPa
  set Poisson ratio = 0.32
  set density       = 7800 kg/m^3
end
subsection Interface: all
  set law              = camacho-ortiz
  set strength         = 300 MPa
  set toughness        = 0.5 J/m^2
  set strength scatter = 0.1
  set friction         = 0.3
end
subsection Boundary: left
  set velocity x = if(t < 12 ns, -2 m/s, 2 m/s)
end
subsection Boundary: right
  set velocity x = if(t < 12 ns, 2 m/s, -2 m/s)
end
subsection Time
  set end    = 24 ns
  set step   = auto
  set scheme = explicit
end
)";

    const std::vector<std::string> quads = {"Mesh/type=rectangle"};
    const std::vector<std::string> hexes = {
        "dimension=3", "Mesh/type=brick", "Mesh/lower corner=0, 0, 0",
        "Mesh/upper corner=10 um, 10 um, 10 um", "Mesh/cells=3, 3, 3"};
    const std::vector<std::string> tetrahedra = {
        "dimension=3", "Mesh/type=tetrahedra", "Mesh/lower corner=0, 0, 0",
        "Mesh/upper corner=10 um, 10 um, 10 um", "Mesh/cells=2, 2, 2"};

    using test::Steps;

    /** Every line of the balance, step by step, until everything has broken and
        been pushed together again. */
    template <int dim>
    void expect_balance(const std::vector<std::string> &overrides)
    {
      Steps<dim> run(square, overrides);
      double residual = 0., worst_gift = 0.;
      while (run.state.time < run.input->time.end) {
        const EnergyLines before = run.state.energy;
        const StepReport report = run.step();
        const EnergyLines &after = run.state.energy;
        residual = std::max(residual, report.balance_residual);
        for (const auto line : {&EnergyLines::damage, &EnergyLines::friction,
                                &EnergyLines::impact})
          worst_gift = std::max(worst_gift, before.*line - after.*line);
        // what the certificate watches is what the line did
        EXPECT_EQ(report.changes.taken[std::size_t(WatchedLine::viscous)],
                  after.viscous - before.viscous);
        ASSERT_GE(after.kinetic, 0.);
        ASSERT_GE(after.elastic, 0.);
      }
      const EnergyLines &e = run.state.energy;
      EXPECT_GT(e.damage, 0.05 * e.work); // it did break, rub and collide
      EXPECT_GT(e.friction, 0.);
      EXPECT_LT(residual, 1e-12);
      EXPECT_LT(worst_gift, 1e-13 * e.work);
      EXPECT_LT(std::abs(e.numerical), 1e-3 * e.damage);
      EXPECT_LT(run.state.penetration, 1e-18); // m, of 10 um
    }

    TEST(Leapfrog, BalanceClosesLineByLineOnTriangles)
    {
      expect_balance<2>({});
    }
    TEST(Leapfrog, BalanceClosesLineByLineOnQuads) { expect_balance<2>(quads); }
    TEST(Leapfrog, BalanceClosesLineByLineOnTetrahedra)
    {
      expect_balance<3>(tetrahedra);
    }

    // `broken` is asked at every point: of one face the upper or the lower one.
    // What is left of it breaks at the strength, and takes half of the energy.
    TEST(Leapfrog, HalfBrokenFaceReleasesItsOtherHalf)
    {
      std::vector<double> times, damages;
      for (const std::string broken : {"y > 5 um", "y < 5 um"}) {
        SCOPED_TRACE(broken);
        Steps<2> run(square,
                     {"Mesh/type=rectangle", "Mesh/cells=2, 1",
                      "Interface: all/strength scatter=0",
                      "Interface: all/broken=" + broken,
                      "Boundary: left/velocity x=-2 m/s",
                      "Boundary: right/velocity x=2 m/s", "Time/end=24 ns"});
        EXPECT_EQ(run.state.energy.damage, 0.);
        double released = 0., residual = 0.;
        while (run.state.time < run.input->time.end) {
          residual = std::max(residual, run.step().balance_residual);
          if (released == 0. && run.state.energy.damage > 0.)
            released = run.state.time;
        }
        EXPECT_LT(residual, 1e-12);
        EXPECT_GT(released, 0.);
        EXPECT_NEAR(run.state.energy.damage, 0.5 * 10e-6 / 2.,
                    1e-9 * 0.5 * 10e-6);
        times.push_back(released);
        damages.push_back(run.state.energy.damage);
      }
      EXPECT_NEAR(times[0], times[1], 1e-9 * times[0]);
      EXPECT_NEAR(damages[0], damages[1], 1e-12 * damages[0]);
    }

    // The rim of a disc goes through faces; what is on it is pulled apart.
    TEST(Leapfrog, BalanceClosesWhereADiscIsBroken)
    {
      expect_balance<2>(
          {"Interface: all/broken=sqrt((x - 5 um)^2 + (y - 5 um)^2) < "
           "1.7 um"});
      expect_balance<2>({"Interface: all/broken=x + 0.3 * y < 4.1 um && "
                         "x + 0.3 * y > 3 um"});
    }

    // Pieces of all shapes that rub against each other: no problem of a node is
    // left above 1e-12, so that no step is shortened.
    TEST(Leapfrog, SolvesEveryNodeWhereTetrahedraRub)
    {
      auto overrides = tetrahedra;
      overrides.back() = "Mesh/cells=3, 3, 3";
      overrides.insert(overrides.end(),
                       {"Mesh/distortion=0.2", "Interface: all/friction=0.5",
                        "Time/end=36 ns"});
      Steps<3> run(square, overrides);
      while (run.state.time < run.input->time.end) {
        StepReport report;
        ASSERT_NO_THROW(report = run.leapfrog->advance(run.state, run.time_step,
                                                       run.next, 2))
            << run.state.time;
        std::swap(run.state, run.next);
        ASSERT_LT(report.solver.residual, 1e-12) << run.state.time;
      }
      const EnergyLines &e = run.state.energy;
      EXPECT_GT(e.friction, 0.01 * e.work);
      EXPECT_LT(std::abs(e.numerical), 1e-12 * e.work);
    }

    // A free body that breaks by its own motion.
    template <int dim>
    void expect_momentum(std::vector<std::string> overrides)
    {
      const std::string held = "subsection Boundary";
      const std::string free_body =
          square.substr(0, square.find(held)) +
          square.substr(square.find("subsection Time"));
      overrides.insert(
          overrides.end(),
          {"Material: bulk/initial velocity x=4e6 1/s * (x - 5 um) + 3 m/s",
           "Material: bulk/initial velocity y=2 m/s"});
      Steps<dim> run(free_body, overrides);
      const auto before = run.momentum();
      while (run.state.time < run.input->time.end)
        run.step();
      const auto after = run.momentum();
      EXPECT_GT(run.state.energy.damage, 0.);
      for (unsigned int c = 0; c < dim; ++c)
        EXPECT_NEAR(after[c], before[c], 1e-12 * std::abs(before[0])) << c;
    }

    TEST(Leapfrog, KeepsMomentum)
    {
      expect_momentum<2>({});
      expect_momentum<2>(quads);
      expect_momentum<3>(hexes);
      expect_momentum<3>(tetrahedra);
    }

    // One plane breaks: toughness times its area, whatever the step.
    TEST(Leapfrog, TakesTheToughnessAtAnyStep)
    {
      const std::string plane =
          square + "subsection Interface: others\n  set law = rigid\nend\n";
      for (const double share : {1., 0.5, 0.25}) {
        Steps<2> run(plane,
                     {"Interface: all/where=abs(x - 5 um) < 1 nm",
                      "Interface: all/strength scatter=0", "Mesh/cells=10, 10",
                      "Mesh/type=rectangle", "Time/end=9 ns"});
        while (run.state.time < run.input->time.end)
          run.step(share);
        // the second chain of a point starts at 1e-9 of its law
        EXPECT_NEAR(run.state.energy.damage, 0.5 * 10e-6, 1e-9 * 0.5 * 10e-6)
            << share;
      }
    }

    // The energy that is kept depends on the length.
    TEST(Leapfrog, StepsHaveOneLength)
    {
      Steps<2> run(square);
      run.step(0.5);
      EXPECT_THROW(run.step(0.25), std::logic_error);
      EXPECT_THROW(run.step(1.), std::logic_error);
      EXPECT_NO_THROW(run.step(0.5));
    }

    // Free vibration, from steps of any length: what the first one takes is all
    // that is numerical.
    TEST(Leapfrog, FreeVibrationKeepsItsEnergy)
    {
      for (const double share : {1., 0.37}) {
        Steps<2> run(test::standing_bar,
                     {"Mesh/upper corner=1, 0.1", "Mesh/cells=10, 1",
                      "Time/front viscosity=0"});
        run.step(share);
        const EnergyLines first = run.state.energy;
        EXPECT_GE(first.numerical, 0.);
        const double energy = first.kinetic + first.elastic;
        for (unsigned int k = 0; k < 500; ++k) {
          run.step(share);
          const EnergyLines &e = run.state.energy;
          ASSERT_NEAR(e.kinetic + e.elastic, energy, 1e-12 * energy);
          ASSERT_EQ(e.numerical, first.numerical);
        }
      }
    }

    // A standing wave, n cells to its wavelength; quads, order 2 in space.
    double frequency_error(const unsigned int n, const char *viscosity)
    {
      const std::string cells = std::to_string(n / 2);
      Steps<2> run(test::standing_bar,
                   {"Mesh/upper corner=1, 0.1", "Mesh/cells=" + cells + ", 1",
                    std::string("Time/front viscosity=") + viscosity});
      double last = 0., zero = 0.;
      while (zero == 0.) {
        const double t = run.state.time;
        run.step();
        run.leapfrog->show(run.state);
        const double u = run.state.displacement[0];
        if (t > 0.5 && last > 0. && u <= 0.)
          zero = t + run.state.last_step * last / (last - u);
        last = u;
      }
      return std::abs(zero - 1.); // half a period
    }

    TEST(Leapfrog, WavesAreOfSecondOrder)
    {
      const double coarse = frequency_error(16, "0"),
                   fine = frequency_error(32, "0");
      EXPECT_LT(fine, 2e-3);
      EXPECT_GT(std::log2(coarse / fine), 1.8);
    }

    // 20 cells per wavelength: less than 0.1 % of the energy in a period.
    TEST(Leapfrog, FrontViscosityLeavesSmoothWavesAlone)
    {
      const double period = 2.;
      Steps<2> run(test::standing_bar,
                   {"Mesh/upper corner=1, 0.1", "Mesh/cells=10, 1",
                    "Time/end=2", "Time/front viscosity=0.2"});
      while (run.state.time < period)
        run.step();
      const EnergyLines &e = run.state.energy;
      EXPECT_GT(e.viscous, 0.);
      EXPECT_LT(e.viscous, 1e-3 * run.state.initial_energy);
    }

    // A bar pushed at one end: the largest tension behind the front over its
    // amplitude.
    double tension_behind_front(const char *viscosity)
    {
      Steps<2> run(R"(
set dimension = 2
subsection Mesh
  set upper corner = 1, 0.01
  set cells        = 100, 1
end
subsection Material: bar
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 1e9
  set toughness = 1e9
end
subsection Boundary: left
  set velocity x = if(t < 0.2, 1e-3, 0)
end
subsection Time
  set end    = 0.9
  set step   = auto
  set scheme = explicit
end
)",
                   {std::string("Time/front viscosity=") + viscosity});
      double tension = 0.;
      while (run.state.time < 0.9) {
        run.step();
        run.leapfrog->show(run.state);
        const auto &t = run.state.bond_traction;
        for (std::size_t i = 0; i < t.size(); i += 2)
          tension = std::max(tension, t[i]);
      }
      return tension / 1e-3;
    }

    TEST(Leapfrog, FrontsLeaveLittleTension)
    {
      EXPECT_GT(tension_behind_front("0"), 0.15);
      EXPECT_LT(tension_behind_front("auto"), 0.05);
    }

    // Exact where a step may be among the shortest, a bound of others.
    TEST(Leapfrog, KnowsTheCellsThatDecideTheStep)
    {
      auto overrides = tetrahedra;
      overrides.back() = "Mesh/cells=5, 5, 5";
      overrides.push_back("Mesh/distortion=0.25");
      const Steps<3> run(square, overrides);
      const auto &cells = run.discretization->cells();
      ASSERT_TRUE(cells.differ());
      const auto all = longest_steps(cells, 0.2);
      constexpr std::size_t n = 10;
      const auto found = shortest_steps(cells, 0.2, n, 1.1);
      auto sorted = all;
      std::sort(sorted.begin(), sorted.end());
      const double known = std::max(sorted[n - 1], 1.1 * sorted[0]);
      std::size_t n_bounds = 0;
      for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_LE(found[i], all[i]);
        EXPECT_EQ(found[i] <= known, all[i] <= known);
        if (all[i] <= known) {
          EXPECT_EQ(found[i], all[i]);
        }
        n_bounds += found[i] < all[i];
      }
      EXPECT_GT(n_bounds, all.size() / 2);
    }

    // Two quads side by side: eight corners at six nodes.
    TEST(CornerGroups, SplitWhereLinksLetGo)
    {
      const test::Scene<2> scene(square,
                                 {"Mesh/type=rectangle", "Mesh/cells=2, 1"});
      const JoinedMesh<2> mesh(*scene.discretization);
      EXPECT_EQ(mesh.n_corners(), 8u);
      EXPECT_EQ(mesh.n_nodes(), 6u);
      std::vector<std::uint8_t> intact(scene.discretization->points().n_points);
      const auto &origins = scene.discretization->origins();
      for (std::size_t i = 0; i < intact.size(); ++i)
        intact[i] = origins[i].kind == PointOrigin::Kind::interface;
      CornerGroups<2> groups(mesh, intact);
      EXPECT_EQ(groups.size(), 6u);
      const double total = 7800. * 10e-6 * 10e-6;
      const auto sum = [&] {
        double mass = 0.;
        for (const double m : groups.mass)
          mass += m;
        return mass;
      };
      EXPECT_NEAR(sum(), total, 1e-11 * total);
      unsigned int n_groups = 6;
      for (std::size_t i = 0; i < intact.size(); ++i) {
        if (!intact[i])
          continue;
        intact[i] = 0;
        EXPECT_TRUE(groups.split(mesh.node_of_point(i), intact));
        EXPECT_FALSE(groups.split(mesh.node_of_point(i), intact));
        EXPECT_EQ(groups.size(), ++n_groups);
        EXPECT_NEAR(sum(), total, 1e-11 * total);
      }
      EXPECT_EQ(n_groups, 8u);
    }
  } // namespace
} // namespace nsfd::test_leapfrog
