#include "leapfrog_steps.h"

#include "discretization/loads.h"
#include "input/read_scene.h"
#include "simulation/stress_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Bodies and faces that carry a stress before they are strained.

namespace nsfd::test_initial_stress
{
  namespace
  {
    using test::Scene;
    using test::Steps;
    using Overrides = std::vector<std::string>;

    // sigma_0 = (-30 + y 1e9/m, -20, 8) MPa has no divergence
    const std::string plate = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 20 mm, 10 mm
  set cells        = 8, 4
end
subsection Material: rock
  set Young modulus     = 70 GPa
  set Poisson ratio     = 0.2
  set density           = 2500 kg/m^3
  set initial stress xx = -30 MPa + 1 GPa/m * y
  set initial stress yy = -20 MPa
  set initial stress xy = 8 MPa
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 60 MPa
  set toughness = 20 J/m^2
  set friction  = 0.6
end
subsection Boundary: left
  set traction x = 30 MPa - 1 GPa/m * y
  set traction y = -8 MPa
end
subsection Boundary: right
  set traction x = -30 MPa + 1 GPa/m * y
  set traction y = 8 MPa
end
subsection Boundary: bottom
  set traction x = -8 MPa
  set traction y = 20 MPa
end
subsection Boundary: top
  set traction x = 8 MPa
  set traction y = -20 MPa
end
subsection Time
  set end    = 1
  set step   = 0.5 courant
end
)";

    Overrides operator+(Overrides a, const Overrides &b)
    {
      a.insert(a.end(), b.begin(), b.end());
      return a;
    }

    const Overrides explicit_steps = {"Time/scheme=explicit", "Time/step=auto"};
    const Overrides springs = {"Interface: all/law=geubelle-baylor",
                               "Interface: all/initial strength parameter=0.9",
                               "Solver/tolerance=1e-11"};
    const Overrides uniform = {"Material: rock/initial stress xx=-30 MPa",
                               "Boundary: left/traction x=30 MPa",
                               "Boundary: right/traction x=-30 MPa"};

    /** What the initial stress would store in the plate if it came from
        strains, about. */
    constexpr double size = 30e6 * 30e6 / (2. * 70e9) * 20e-3 * 10e-3;

    /**
     * It stays for @p n steps; returns how far it has not: the kinetic energy
     * over `size`, all of it round-off.
     */
    template <typename Run, typename Step>
    void expect_rest(Run &run, const unsigned int n, const Step &step)
    {
      double kinetic = run.state.energy.kinetic;
      for (unsigned int k = 0; k < n; ++k) {
        step();
        kinetic = std::max(kinetic, run.state.energy.kinetic);
      }
      // speeds of 1e-9 of those that the stress would give: some hundred
      // steps of round-off, and what solvers of nodes leave, 1e-10
      EXPECT_LT(kinetic, 1e-18 * size);
      EXPECT_LT(std::abs(run.state.energy.work), 1e-9 * size);
      EXPECT_EQ(run.state.energy.damage, 0.);
    }

    template <int dim>
    void expect_explicit_rest(const std::string &text,
                              const Overrides &overrides)
    {
      Steps<dim> run(text, explicit_steps + overrides);
      expect_rest(run, 200, [&] { run.step(); });
    }

    TEST(InitialStress, IsAtRestInExplicitSteps)
    {
      expect_explicit_rest<2>(plate, {});
      expect_explicit_rest<2>(plate, {"Discretization/degree=3"});
      expect_explicit_rest<2>(plate, {"Mesh/type=crossed triangles"});
      expect_explicit_rest<2>(
          plate, {"Mesh/type=crossed triangles", "Mesh/distortion=0.3"});
      // points at the nodes have the traction there, not its mean with the
      // polynomials of the nodes: the same where it is uniform
      expect_explicit_rest<2>(plate, springs + uniform);
    }

    TEST(InitialStress, IsAtRestInImplicitSteps)
    {
      for (const Overrides &more :
           {Overrides(), Overrides{"Discretization/degree=2"},
            Overrides{"Mesh/type=crossed triangles"}, springs,
            springs + Overrides{"Time/theta=0.7"}}) {
        Scene<2> run(plate, more);
        expect_rest(run, 20, [&] { run.advance(); });
      }
    }

    // All faces press and stick: contact finds what holds the cells.
    TEST(InitialStress, IsAtRestInContact)
    {
      const std::string contact =
          plate.substr(0, plate.find("  set law       = camacho")) +
          "  set law = contact\n  set friction = 0.6\n" +
          plate.substr(plate.find("end\nsubsection Boundary: left"));
      Scene<2> run(contact, {"Solver/tolerance=1e-12"});
      for (unsigned int k = 0; k < 10; ++k)
        run.advance();
      // what the solver leaves of the impulses
      EXPECT_LT(run.state.energy.kinetic, 1e-18 * size);
    }

    /** The largest difference of the jumps from R_0 over the stiffness. */
    template <int dim>
    double distance_from_springs(const Scene<dim> &run, const double C_N,
                                 const double C_T)
    {
      const auto &initial = *run.discretization->loads().initial_stress();
      double off = 0., largest = 0.;
      for (std::size_t i = 0; i < run.discretization->points().n_points; ++i) {
        if (run.discretization->origins()[i].kind !=
            PointOrigin::Kind::interface)
          continue;
        for (unsigned int c = 0; c < dim; ++c) {
          const double u = initial.local_traction(i)[c] / (c == 0 ? C_N : C_T);
          largest = std::max(largest, std::abs(u));
          off = std::max(off, std::abs(run.state.jump[i * dim + c] - u));
        }
      }
      return off / largest;
    }

    // Springs are open or closed by what carries it, and store the energy.
    TEST(InitialStress, IsCarriedBySprings)
    {
      const std::string joints =
          plate.substr(0, plate.find("  set law       = camacho")) +
          "  set law = elastic\n  set normal stiffness = 1e14 Pa/m\n"
          "  set tangential stiffness = 5e13 Pa/m\n" +
          plate.substr(plate.find("end\nsubsection Boundary: left"));
      Scene<2> run(joints, uniform + Overrides{"Solver/tolerance=1e-11"});
      EXPECT_LT(distance_from_springs(run, 1e14, 5e13), 1e-15);
      // 7 upright and 3 flat rows of faces
      const double upright = 7. * 10e-3, flat = 3. * 20e-3;
      const double stored =
          upright * (30e6 * 30e6 / 1e14 + 8e6 * 8e6 / 5e13) / 2. +
          flat * (20e6 * 20e6 / 1e14 + 8e6 * 8e6 / 5e13) / 2.;
      EXPECT_NEAR(run.state.energy.cohesive, stored, 1e-13 * stored);
      expect_rest(run, 20, [&] { run.advance(); });
    }

    // A curved law is open by its secant: T(d) is the traction.
    TEST(InitialStress, IsCarriedByACurvedLaw)
    {
      const Overrides pulled = {"Material: rock/initial stress xx=40 MPa",
                                "Material: rock/initial stress yy=0",
                                "Material: rock/initial stress xy=0",
                                "Boundary: left/traction x=-40 MPa",
                                "Boundary: left/traction y=0",
                                "Boundary: right/traction x=40 MPa",
                                "Boundary: right/traction y=0",
                                "Boundary: bottom/traction x=0",
                                "Boundary: bottom/traction y=0",
                                "Boundary: top/traction x=0",
                                "Boundary: top/traction y=0"};
      const std::string curved =
          plate.substr(0, plate.find("  set law       = camacho")) +
          "  set law = tvergaard\n  set strength = 60 MPa\n  set critical "
          "opening = 1 um\n" +
          plate.substr(plate.find("end\nsubsection Boundary: left"));
      Scene<2> run(curved, pulled);
      const auto &law = *run.input->interfaces[0].law;
      unsigned int n = 0;
      for (std::size_t i = 0; i < run.discretization->points().n_points; ++i)
        if (std::abs(run.discretization->points().axes(i)[0]) > 0.5) {
          EXPECT_NEAR(law.traction(run.state.jump[2 * i]), 40e6, 1e-12 * 40e6);
          ++n;
        }
      EXPECT_GT(n, 0u);
      run.advance();
      EXPECT_LT(run.state.energy.kinetic, 1e-20 * size);
      EXPECT_THROW(
          Scene<2>(curved, pulled + Overrides{"Material: rock/initial stress "
                                              "xx=61 MPa"}),
          std::exception);
    }

    // -E eps = sigma_0 where nothing else pulls: the work of the initial stress
    // is twice what is stored.
    TEST(InitialStress, ReleasesItselfInStatics)
    {
      const std::string bar =
          plate.substr(0, plate.find("subsection Boundary: left")) + R"(
subsection Boundary: left
  set displacement x = 0
end
subsection Time
  set scheme = quasi-static
  set end    = 1
  set step   = 0.5 s
end
)";
      Scene<2> scene(bar, {"Material: rock/initial stress xx=-30 MPa",
                           "Material: rock/initial stress yy=0",
                           "Material: rock/initial stress xy=0",
                           "Material: rock/Poisson ratio=0"});
      auto &statics = scene.equilibria->search();
      State state = statics.start(scene.state), next = state;
      const auto report = statics.advance(state, 0.5, next);
      EXPECT_LT(report.step.balance_residual, 1e-12);
      const double u = 30e6 / 70e9 * 20e-3;
      EXPECT_NEAR(
          *std::max_element(next.displacement.begin(), next.displacement.end()),
          u, 1e-9 * u);
      EXPECT_NEAR(next.energy.elastic, size, 1e-9 * size);
    }

    /** Rings after its tractions are gone; the largest balance residual. */
    template <typename Run, typename Step>
    double ringing(Run &run, const unsigned int n, const Step &step)
    {
      double residual = 0., moved = 0.;
      for (unsigned int k = 0; k < n; ++k) {
        residual = std::max(residual, step().balance_residual);
        moved = std::max(moved, run.state.energy.kinetic);
      }
      EXPECT_GT(moved, 0.1 * size);
      EXPECT_GT(run.state.energy.work, 0.);
      return residual;
    }

    TEST(InitialStress, ClosesTheBalance)
    {
      const std::string free_plate =
          plate.substr(0, plate.find("subsection Boundary: left")) +
          plate.substr(plate.find("subsection Time"));
      const Overrides strong = {"Interface: all/strength=10 GPa"};
      {
        Steps<2> run(free_plate, explicit_steps + strong);
        EXPECT_LT(ringing(run, 300, [&] { return run.step(); }), 1e-12);
      }
      {
        Scene<2> run(free_plate, strong);
        EXPECT_LT(ringing(run, 100, [&] { return run.advance(); }), 1e-12);
      }
      { // it breaks where stresses add up
        Steps<2> run(free_plate, explicit_steps);
        for (unsigned int k = 0; k < 300; ++k)
          EXPECT_LT(run.step().balance_residual, 1e-12);
      }
    }

    // In tension beyond the strength the faces open, below they do not.
    TEST(InitialStress, IsComparedWithTheStrength)
    {
      for (const bool is_explicit : {true, false})
        for (const double sigma : {59., 61.}) {
          const Overrides pulled =
              Overrides{
                  "Interface: all/strength=60 MPa",
                  fmt::format("Material: rock/initial stress xx={} MPa", sigma),
                  "Material: rock/initial stress yy=0",
                  "Material: rock/initial stress xy=0",
                  fmt::format("Boundary: left/traction x=-{} MPa", sigma),
                  "Boundary: left/traction y=0",
                  fmt::format("Boundary: right/traction x={} MPa", sigma),
                  "Boundary: right/traction y=0",
                  "Boundary: bottom/traction x=0",
                  "Boundary: bottom/traction y=0",
                  "Boundary: top/traction x=0",
                  "Boundary: top/traction y=0"} +
              (is_explicit ? explicit_steps : Overrides());
          double damage;
          if (is_explicit) {
            Steps<2> run(plate, pulled);
            for (unsigned int k = 0; k < 50; ++k)
              run.step();
            damage = run.state.energy.damage;
          } else {
            Scene<2> run(plate, pulled);
            for (unsigned int k = 0; k < 20; ++k)
              run.advance_bisecting();
            damage = run.state.energy.damage;
          }
          if (sigma > 60.) {
            EXPECT_GT(damage, 0.);
          } else {
            EXPECT_EQ(damage, 0.);
          }
        }
    }

    const std::string block = R"(
set dimension = 3
subsection Mesh
  set type         = brick
  set upper corner = 4 mm, 4 mm, 4 mm
  set cells        = 3, 3, 3
end
subsection Material: rock
  set Young modulus     = 70 GPa
  set Poisson ratio     = 0.2
  set density           = 2500 kg/m^3
  set initial stress xx = -30 MPa
  set initial stress yz = 8 MPa
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 60 MPa
  set toughness = 20 J/m^2
end
subsection Boundary: left
  set traction x = 30 MPa
end
subsection Boundary: right
  set traction x = -30 MPa
end
subsection Boundary: bottom
  set traction z = -8 MPa
end
subsection Boundary: top
  set traction z = 8 MPa
end
subsection Boundary: back
  set traction y = -8 MPa
end
subsection Boundary: front
  set traction y = 8 MPa
end
subsection Time
  set end  = 1
  set step = 0.5 courant
end
)";

    TEST(InitialStress, InSpace)
    {
      Scene<3> probe(block);
      // which side is which does not matter: back and front are along z here
      const std::string report = initial_stress_report<3>(
          *probe.input, *probe.discretization, probe.communicator);
      EXPECT_NE(report.find("in equilibrium"), std::string::npos) << report;
      expect_rest(probe, 10, [&] { probe.advance(); });
      expect_explicit_rest<3>(block, {});
      expect_explicit_rest<3>(block, {"Mesh/type=tetrahedra"});
      Scene<3> on_springs(block, springs);
      expect_rest(on_springs, 10, [&] { on_springs.advance(); });
    }

    TEST(InitialStress, ResidualIsReported)
    {
      Scene<2> rest(plate);
      const auto report = [](const Scene<2> &run) {
        return initial_stress_report<2>(*run.input, *run.discretization,
                                        run.communicator);
      };
      EXPECT_NE(report(rest).find("in equilibrium"), std::string::npos);
      Scene<2> moves(plate, {"Boundary: right/traction x=0"});
      EXPECT_NE(report(moves).find("residual force"), std::string::npos);
      Scene<2> held(plate.substr(0, plate.find("  set traction x = -30")) +
                    "  set velocity x = 0\n" +
                    plate.substr(plate.find("  set traction y = 8")));
      EXPECT_NE(report(held).find("in equilibrium"), std::string::npos)
          << report(held);
    }

    TEST(InitialStress, IsRefusedWhereItIsUnknown)
    {
      const auto refused = [](const Overrides &overrides,
                              const std::string &reason) {
        InputErrors errors;
        EXPECT_FALSE(read_scene_text(plate, "test.prm", overrides, errors));
        EXPECT_NE(errors.report().find(reason), std::string::npos)
            << errors.report();
      };
      refused({"motion=large"}, "without stress where they start");
      refused({"Material: rock/model=rigid"}, "have no stress without strain");
      refused({"Material: rock/initial stress xz=1 MPa"},
              "no shear stress along z");
      refused({"plane=stress", "Material: rock/initial stress zz=1 MPa"},
              "in plane stress it is 0");
      refused({"Material: rock/initial stress xx=1 MPa * t"}, "t");
      refused({"Time/scheme=arkode", "Interface: all/law=joined"},
              "knows no initial stress");
    }
  } // namespace
} // namespace nsfd::test_initial_stress
