#include "make_law.h"
#include "make_scene.h"
#include "relaxation_scene.h"

#include "simulation/advice.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace nsfd;
using namespace nsfd::test;

// What --check computes, against closed forms of Acary and Monerie, 3.1-3.2,
// and of the moduli of regular meshes.

namespace test_advice
{
  std::string mesh_text(const std::string &type, const unsigned int dim,
                        const unsigned int p)
  {
    const std::string n = std::to_string(p);
    return "set dimension = " + std::to_string(dim) +
           "\nset plane = stress\nsubsection Mesh\n  set type = " + type +
           "\n  set upper corner = " + n + ", " + n +
           (dim == 3 ? ", " + n : "") + "\n  set cells = " + n + ", " + n +
           (dim == 3 ? ", " + n : "") + R"(
end
subsection Material: m
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
end
subsection Interface: all
  set law                  = elastic
  set normal stiffness     = 5
  set tangential stiffness = 2
end
subsection Time
  set end = 1 s
end
)";
  }

  template <int dim>
  FaceFamily family(const std::string &type, const unsigned int p)
  {
    std::string text = mesh_text(type, dim, p);
    if (dim == 3)
      text.erase(text.find("set plane"), 18);
    const Scene<dim> scene(text);
    return face_families(*scene.input, *scene.discretization,
                         std::pow(double(p), dim), scene.communicator)[0];
  }

  // Cells of side 1: Z per mesh, and the compliance that patch tests measure,
  // 1/E_eff = 1/E + (1 - 1/p)/C_N + k (1/C_N + 1/C_T), C_N = 5, C_T = 2. The
  // longest face between two cells.
  TEST(Advice, FacesOfRegularMeshes)
  {
    const double root = std::sqrt(2.);
    for (const unsigned int p : {1u, 2u, 4u}) {
      const double ends = 1. - 1. / p;
      const auto crossed = family<2>("crossed triangles", p);
      EXPECT_NEAR(crossed.density, 2. * root + 2. * ends, 1e-12);
      const auto diagonal = family<2>("diagonal triangles", p);
      EXPECT_NEAR(diagonal.density, root + 2. * ends, 1e-12);
      const auto squares = family<2>("rectangle", p);
      EXPECT_NEAR(squares.density, 2. * ends, 1e-12);
      EXPECT_NEAR(crossed.longest, p == 1 ? 1. / root : 1., 1e-12);
      EXPECT_NEAR(diagonal.longest, root, 1e-12);
      EXPECT_NEAR(squares.longest, p == 1 ? 0. : 1., 1e-12);
      for (const unsigned int axis : {0u, 1u}) {
        EXPECT_NEAR(crossed.compliance(axis, 5., 2.),
                    ends / 5. + root / 2. * .7, 1e-12);
        EXPECT_NEAR(diagonal.compliance(axis, 5., 2.),
                    ends / 5. + root / 4. * .7, 1e-12);
        EXPECT_NEAR(squares.compliance(axis, 5., 2.), ends / 5., 1e-12);
      }
      if (p == 4) {
        EXPECT_NEAR(1. + crossed.compliance(0, 5., 2.), 1.6449747, 1e-7);
        EXPECT_NEAR(1. + diagonal.compliance(0, 5., 2.), 1.3974874, 1e-7);
        continue;
      }
      const auto cubes = family<3>("brick", p);
      EXPECT_NEAR(cubes.density, 3. * ends, 1e-12);
      EXPECT_NEAR(cubes.longest, p == 1 ? 0. : 1., 1e-12);
      const auto tetrahedra = family<3>("tetrahedra", p);
      EXPECT_NEAR(tetrahedra.density, 3. + 3. * root - 3. / p, 1e-12);
      for (const unsigned int axis : {0u, 1u, 2u}) {
        EXPECT_NEAR(cubes.compliance(axis, 5., 2.), ends / 5., 1e-12);
        EXPECT_NEAR(1. + tetrahedra.compliance(axis, 5., 2.),
                    p == 1 ? 1.4949747 : 1.5949747, 1e-7);
      }
    }
  }

  // Crossed triangles, L the longest side, Z L = 2 (1 + sqrt 2), C_N = C_T
  TEST(Advice, StiffnessForATarget)
  {
    const double Z = 2. * (1. + std::sqrt(2.)), nu = 0.32;
    EXPECT_NEAR(smallest_stiffness(1., Z, 2, 1., 0.9), 21.73, 5e-3);
    EXPECT_NEAR(smallest_stiffness(1. / (1. - nu * nu), Z, 2, 1., 0.9), 24.21,
                5e-3);
    EXPECT_NEAR(smallest_stiffness(1., Z, 3, 1., 0.9), 14.49, 5e-3);
    // squares of side 1: 0.9 needs 9
    EXPECT_NEAR(smallest_stiffness(1., 2., 2, 1., 0.9), 9., 1e-12);
    // the share that is left is the target: E_eff/E = xi/(1 + xi), xi = 2C/(E
    // Z)
    for (const double eta : {0.5, 0.9, 0.99}) {
      const double xi = 2. * smallest_stiffness(3., Z, 2, 1., eta) / (3. * Z);
      EXPECT_NEAR(xi / (1. + xi), eta, 1e-12);
    }
    // <n1^4> + (<n1^2> - <n1^4>) C_N/C_T
    EXPECT_NEAR(smallest_stiffness(1., 1., 2, 0.5, 0.5), 0.625, 1e-12);
    EXPECT_NEAR(smallest_stiffness(1., 1., 3, 0.5, 0.5), 7. / 15., 1e-12);
  }

  TEST(Advice, CohesiveLength)
  {
    const LawEntries entries = entries_of("strength = 3; toughness = 4");
    const auto zeta = [&](const std::string &name) {
      return mean_traction_ratio(*make_law(name, entries));
    };
    EXPECT_NEAR(zeta("dugdale"), 1., 1e-12);
    EXPECT_NEAR(zeta("brittle"), 0.5, 1e-12);
    EXPECT_NEAR(zeta("camacho-ortiz"), 0.5, 1e-12);
    EXPECT_NEAR(zeta("tvergaard"), 27. / 48., 1e-12);
    EXPECT_NEAR(zeta("michel-suquet"), (9. - 4. * std::log(4.)) / 6., 1e-12);

    const auto brittle = make_law("brittle", entries);
    EXPECT_NEAR(cohesive_length(7., 0.25, *brittle),
                M_PI / 8. * 7. / 0.9375 * 4. / (1.5 * 1.5), 1e-10);
    // (54): pi / (4 r (1 - nu^2)), r = 2.5, at every stiffness and edge
    for (const double L : {1e-3, 2.}) {
      EXPECT_NEAR(stiffness_bounds(1., 7., 0., *brittle, L, 1, 2.5).upper,
                  0.314159, 1e-6);
      const auto three = stiffness_bounds(1., 7., 0.25, *brittle, L, 3, 2.5);
      EXPECT_NEAR(three.upper, 3. * M_PI / 10. / 0.9375, 1e-12);
      EXPECT_NEAR(three.lower, L / 7., 1e-12);
    }
    EXPECT_TRUE(
        stiffness_bounds(9. * 7., 7., 0., *brittle, 1., 1, 2.5).conflict());
    EXPECT_FALSE(
        stiffness_bounds(9. * 7., 7., 0., *brittle, 1., 30, 2.5).conflict());
  }

  // (42): max |R'| in units of R_max^2 / G
  TEST(Advice, SlopesOfTheLaws)
  {
    const auto slope = [](const std::string &name, const std::string &example) {
      const auto law = make_law(name, entries_of(example));
      return law->steepest_softening() * law->toughness() / law->strength() /
             law->strength();
    };
    const std::string RG = "strength = 3 MPa; toughness = 4 J/m^2";
    EXPECT_NEAR(slope("camacho-ortiz", RG), 0.5, 1e-12);
    EXPECT_NEAR(
        slope("geubelle-baylor", RG + "; initial strength parameter = 0.98"),
        0.5 / 0.98, 1e-12);
    EXPECT_NEAR(slope("tvergaard", RG), 1.265625, 1e-12);
    EXPECT_NEAR(slope("michel-suquet", RG), 1.2955585, 1e-7);
    EXPECT_NEAR(slope("trapezoid", RG + "; l1 = 0.15; l2 = 0.5"), 1.35, 1e-12);
    EXPECT_NEAR(slope("rcc", "stiffness = 2e12; adhesion energy = 8 J/m^2"), 3.,
                1e-12);
    EXPECT_TRUE(std::isinf(slope("brittle", RG)));
    EXPECT_TRUE(std::isinf(slope("dugdale", RG)));
  }

  // (48): M/(S theta h^2) > max |R'| = 1.29556e11 Pa/m with M/S = rho L/2
  TEST(Advice, RelaxationThreshold)
  {
    for (const bool exact : {false, true}) {
      Scene<2> scene(relaxation_scene,
                     exact
                         ? std::vector<std::string>{"Time/cohesion rule=exact"}
                         : std::vector<std::string>{});
      const State soft =
          all_softening(scene.state, *scene.discretization, *scene.input);
      const double threshold = (exact ? std::sqrt(2.) : 1.) * 3.1062e-6;
      EXPECT_NEAR(scene.stepper->unique_step(soft), threshold,
                  1e-4 * threshold);
      EXPECT_TRUE(std::isinf(scene.stepper->unique_step(scene.state)));
      // (38) is the square of the step over the threshold
      for (const double share : {0.5, 0.99, 1.01, 3.})
        EXPECT_NEAR(contraction_number(*scene.input, scene.stepper->problem(),
                                       soft, *scene.delassus,
                                       share * threshold),
                    share * share, 1e-3 * share * share);
    }
  }

  // A step that carries the mass past the peak is flagged above the threshold.
  TEST(Advice, StepsAboveTheThresholdAreFlagged)
  {
    for (const double share : {0.5, 0.98, 1.02, 1.5}) {
      Scene<2> scene(relaxation_scene,
                     {"Material: mass/initial velocity x=6 m/s"});
      bool flagged = false, softened = false;
      const auto &law = *scene.stepper->problem().interactions[0].law;
      while (scene.state.opening_max[0] < law.peak_opening()) {
        flagged = scene.advance(share * 3.1062e-6).beyond_unique;
        softened = scene.state.opening_max[0] > law.peak_opening();
      }
      EXPECT_TRUE(softened);
      EXPECT_EQ(flagged, share > 1.) << share;
    }
  }

  // The bound by bodies is never less strict than all faces at once.
  TEST(Advice, BoundByBodiesIsOnTheSafeSide)
  {
    for (const std::string type :
         {"rectangle", "crossed triangles", "diagonal triangles"})
      for (const unsigned int degree : {1u, 2u}) {
        std::string text = mesh_text(type, 2, 4);
        text.replace(text.find("elastic"), 7, "michel-suquet");
        text.replace(text.find("set normal stiffness     = 5"), 28,
                     "set stiffness = 21\n set toughness = 1e-6");
        const Scene<2> scene(
            text, {"Discretization/degree=" + std::to_string(degree)});
        const State soft =
            all_softening(scene.state, *scene.discretization, *scene.input);
        const double bound = scene.stepper->unique_step(soft);
        const double number =
            contraction_number(*scene.input, scene.stepper->problem(), soft,
                               *scene.delassus, bound);
        EXPECT_LE(number, 1. + 1e-9) << type << " " << degree;
        // and not far off: C_N L/E = 21 has to be felt at Courant numbers 0.05
        // to 0.2
        EXPECT_GE(number, 0.3) << type << " " << degree;
      }
  }
} // namespace test_advice
