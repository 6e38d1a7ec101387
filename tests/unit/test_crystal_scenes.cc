#include "materials/anisotropy.h"

#include "leapfrog_steps.h"
#include "materials/elasticity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <random>
#include <string>

// Scenes with crystals: what they may say, where the orientations of grains
// come from, patches, balances, and the paths of explicit steps against each
// other.

using namespace nsfd;
using nsfd::test::make_input;
using nsfd::test::Scene;
using nsfd::test::Steps;

namespace test_crystal_scenes
{
  EulerAngles some_angles(const unsigned int k)
  {
    std::mt19937 engine(4711 + k);
    std::uniform_real_distribution<double> uniform(0., 1.);
    return {{360. * uniform(engine), 180. * uniform(engine),
             360. * uniform(engine)}};
  }

  // --- what scenes may say

  const std::string plate = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 4, 4
  set cells        = 4, 4
end
subsection Material: m
MATERIAL
  set density = 1
end
subsection Interface: all
  set law = bonded
end
subsection Time
  set end  = 1000
  set step = 0.5 courant
end
subsection Solver
  set tolerance = 1e-10
end
)";

  const std::string cube = "  set model = cubic\n  set C11 = 1.684\n"
                           "  set C12 = 1.214\n  set C44 = 0.754\n";
  const std::string wood =
      "  set model = orthotropic\n  set E1 = 12\n  set E2 = 0.8\n"
      "  set E3 = 0.5\n  set nu12 = 0.4\n  set nu13 = 0.3\n  set nu23 = 0.5\n"
      "  set G12 = 0.7\n  set G13 = 0.6\n  set G23 = 0.05\n";

  std::string text(const std::string &material)
  {
    std::string result = plate;
    return result.replace(result.find("MATERIAL\n"), 9, material);
  }

  std::string complaints(const std::string &material,
                         const std::vector<std::string> &overrides = {})
  {
    InputErrors errors;
    const auto input =
        read_scene_text(text(material), "test.prm", overrides, errors);
    return input ? "" : errors.report();
  }

  void expect_words(const std::string &report,
                    const std::vector<std::string> &words)
  {
    for (const std::string &word : words)
      EXPECT_NE(report.find(word), std::string::npos) << word << "\n" << report;
  }

  TEST(AnisotropyInput, EngineeringConstantsOfWood)
  {
    const auto input = make_input(text(wood));
    const HookeMatrix S =
        compliance_of(input->materials[0].anisotropic->stiffness);
    EXPECT_NEAR(1. / S[0][0], 12., 1e-12);
    EXPECT_NEAR(1. / S[1][1], 0.8, 1e-13);
    EXPECT_NEAR(1. / S[2][2], 0.5, 1e-13);
    EXPECT_NEAR(-S[0][1] / S[0][0], 0.4, 1e-13);
    EXPECT_NEAR(-S[0][2] / S[0][0], 0.3, 1e-13);
    EXPECT_NEAR(-S[1][2] / S[1][1], 0.5, 1e-13);
    const auto &C = input->materials[0].anisotropic->stiffness;
    EXPECT_EQ(C[3][3], 0.7); // 12, 13, 23
    EXPECT_EQ(C[4][4], 0.6);
    EXPECT_EQ(C[5][5], 0.05);
  }

  TEST(AnisotropyInput, CubeByModuli)
  {
    const auto input = make_input(
        text("  set model = cubic\n  set Young modulus = 2\n"
             "  set Poisson ratio = 0.4\n  set shear modulus = 3\n"));
    const auto &C = input->materials[0].anisotropic->stiffness;
    const HookeMatrix S = compliance_of(C);
    EXPECT_NEAR(1. / S[0][0], 2., 1e-13);
    EXPECT_NEAR(-S[0][1] / S[0][0], 0.4, 1e-13);
    EXPECT_EQ(C[3][3], 3.);
  }

  TEST(AnisotropyInput, IndefiniteConstantsAreRefused)
  {
    expect_words(complaints(cube, {"Material: m/C12=1.7"}),
                 {"C12 = 1.7", "negative energy", "below 1.684"});
    expect_words(complaints(cube, {"Material: m/C12=-0.85"}), {"above -0.842"});
    EXPECT_EQ(complaints(cube, {"Material: m/C12=-0.84"}), "");
    expect_words(complaints(cube, {"Material: m/C44=0"}),
                 {"C44 = 0 must be positive"});
    // sqrt(12 / 0.8) = 3.873
    expect_words(complaints(wood, {"Material: m/nu12=3.9"}),
                 {"nu12 = 3.9", "E1/E2", "3.873"});
    expect_words(complaints(wood, {"Material: m/nu12=3", "Material: m/nu13=3"}),
                 {"nu12, nu13 and nu23 together", "must be positive"});
  }

  TEST(AnisotropyInput, WhatDoesNotBelongIsRefused)
  {
    expect_words(complaints(cube + "  set Young modulus = 1\n"),
                 {"Young modulus", "C11, C12 and C44"});
    expect_words(complaints(cube + "  set E1 = 1\n"),
                 {"it needs model = orthotropic"});
    expect_words(complaints(wood + "  set axis = 1, 0, 0\n"),
                 {"it needs model = transversely isotropic"});
    expect_words(complaints("  set Young modulus = 1\n  set Poisson ratio = "
                            "0.3\n  set Euler angles = 1, 2, 3\n"),
                 {"it needs model = cubic or orthotropic"});
    expect_words(complaints(cube, {"motion=large"}),
                 {"motion = large", "saint-venant kirchhoff"});
    expect_words(complaints("  set model = cubic\n"),
                 {"C11", "C12", "C44"}); // all of them at once
    expect_words(complaints(cube + "  set orientation seed = 2\n"),
                 {"orientation = Euler angles"});
    expect_words(complaints(cube + "  set Euler angles = 1, 2\n"),
                 {"has 2 values, 3 are needed"});
    expect_words(complaints(cube + "  set Euler angles = 1, 2, t\n"),
                 {"depends on t"});
    expect_words(complaints(cube + "  set orientation = axes\n  set axis 1 = "
                                   "1, 1, 0\n  set axis 2 = 0, 1, 0\n"),
                 {"45 degrees apart", "set axis 2 = -0.5, 0.5, 0"});
    expect_words(complaints(cube + "  set orientation = cell data\n"),
                 {"the mesh has no data of cells", "$ElementData"});
  }

  TEST(AnisotropyInput, Table)
  {
    const std::string file = "test_crystal_grains.ori";
    const auto with = [&](const std::string &content) {
      std::ofstream(file) << content;
      return complaints(cube +
                        "  set orientation = table\n"
                        "  set orientation file = " +
                        file + "\n");
    };
    EXPECT_EQ(with("# phi1 Phi phi2\n10 20 30\n\n40, 50, 60 # second\n"), "");
    EXPECT_EQ(with("7 10 20 30\n3 40 50 60\n"), "");
    expect_words(with("10 20\n"), {"line 1", "there are 2 numbers"});
    expect_words(with("10 20 30\n1 2 3 4\n"), {"line 2", "there are 4"});
    expect_words(with("10 20 x\n"), {"line 1", "`x` is not a number"});
    expect_words(with("7 1 2 3\n7 1 2 3\n"), {"grain 7 has a line already"});
    expect_words(with("# nothing\n"), {"has no line of numbers"});
    std::ofstream(file) << "7 10 20 30\n";
    try {
      Scene<2> scene(text(cube +
                          "  set orientation = table\n"
                          "  set orientation file = " +
                          file + "\n"),
                     {"Mesh/grains=2"});
      ADD_FAILURE();
    } catch (const std::exception &error) {
      expect_words(error.what(), {"grain 1 has cells but no line", file});
    }
    std::remove(file.c_str());
  }

  // Haar's measure: axes point anywhere, and have no favourite.
  TEST(AnisotropyInput, RandomOrientationsAreUniform)
  {
    OrientationInput orientation;
    orientation.kind = OrientationInput::Kind::random;
    const unsigned int n = 10000;
    double mean[9] = {}, square[9] = {}, trace = 0.;
    for (unsigned int grain = 0; grain < n; ++grain) {
      const auto axes =
          crystal_axes(orientation_at(orientation, {{0., 0., 0.}}, grain));
      for (unsigned int k = 0; k < 9; ++k) {
        mean[k] += axes[k / 3][k % 3] / n;
        square[k] += axes[k / 3][k % 3] * axes[k / 3][k % 3] / n;
      }
      trace += (axes[0][0] + axes[1][1] + axes[2][2]) / n;
    }
    // components are uniform in [-1, 1]: variances 1/3 and 4/45; of the
    // trace 1; five standard deviations
    for (unsigned int k = 0; k < 9; ++k) {
      EXPECT_NEAR(mean[k], 0., 5. * std::sqrt(1. / 3. / n));
      EXPECT_NEAR(square[k], 1. / 3., 5. * std::sqrt(4. / 45. / n));
    }
    EXPECT_NEAR(trace, 0., 5. / std::sqrt(double(n)));
    const auto one = orientation_at(orientation, {{0., 0., 0.}}, 3);
    orientation.seed = 2;
    EXPECT_NE(one, orientation_at(orientation, {{0., 0., 0.}}, 3));
  }

  // Two squares of Gmsh, each with angles of its own; one group.
  TEST(AnisotropyInput, DataOfCells)
  {
    const std::string file = "test_crystal_data.msh";
    std::ofstream(file) << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
                           "$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n"
                           "4 0 1 0\n5 1 1 0\n6 2 1 0\n$EndNodes\n"
                           "$Elements\n2\n7 3 2 4 1 1 2 5 4\n"
                           "9 3 2 4 1 2 3 6 5\n$EndElements\n"
                           "$ElementData\n1\n\"axes\"\n1\n0.0\n3\n0\n3\n2\n"
                           "7 10 20 30\n9 40 50 60\n$EndElementData\n";
    const std::string with_data = "  set orientation = cell data\n"
                                  "  set orientation data = axes\n";
    const auto scene_of = [&](const std::string &material,
                              const std::vector<std::string> &more = {}) {
      std::string result = text(cube + material);
      const std::size_t begin = result.find("  set type"),
                        end = result.find("end\n", begin);
      result.replace(begin, end - begin,
                     "  set type = file\n  set file = " + file + "\n");
      return std::pair(result, more);
    };
    {
      const auto [scene_text, more] = scene_of(with_data);
      const Scene<2> scene(scene_text, more);
      const auto &cells = scene.discretization->cells();
      ASSERT_EQ(cells.bodies.size(), 2u);
      for (std::size_t b = 0; b < 2; ++b) {
        const auto &angles = cells.class_shape(b).moduli[0].orientation;
        const EulerAngles expected = cells.centre(b)[0] < 1.
                                         ? EulerAngles{{10., 20., 30.}}
                                         : EulerAngles{{40., 50., 60.}};
        EXPECT_EQ(angles, expected);
      }
    }
    { // the cells are of one group: no face is between two
      auto [scene_text, more] = scene_of(with_data);
      scene_text.replace(
          scene_text.find("subsection Interface"), 0,
          "subsection Interface: seam\n  set where = between groups\n"
          "  set law = camacho-ortiz\n  set strength = 1\n"
          "  set toughness = 1\nend\n");
      const Scene<2> scene(scene_text, more);
      for (const auto &origin : scene.discretization->origins())
        if (origin.kind == PointOrigin::Kind::interface) {
          EXPECT_EQ(origin.block, 1u);
        }
    }
    const auto [wrong, none] = scene_of("  set orientation = cell data\n");
    InputErrors errors;
    EXPECT_FALSE(read_scene_text(wrong, "test.prm", none, errors));
    expect_words(errors.report(), {"`orientation`", "it has axes"});
    std::remove(file.c_str());
  }

  // --- whole scenes

  // Grains share the blocks of their orientation.
  TEST(AnisotropyScene, GrainsAreOneClassEach)
  {
    const auto n_classes = [](const std::string &orientation,
                              const std::vector<std::string> &more) {
      return Scene<2>(text(cube + orientation), more)
          .discretization->bodies()
          .classes.size();
    };
    EXPECT_EQ(n_classes("", {}), 1u);
    EXPECT_EQ(n_classes("  set orientation = random\n", {}), 1u);
    EXPECT_EQ(n_classes("  set orientation = random\n", {"Mesh/grains=5"}), 5u);
    EXPECT_EQ(
        n_classes("  set orientation = random in plane\n", {"Mesh/grains=5"}),
        5u);
    EXPECT_EQ(n_classes("  set Euler angles = 30 * (x < 2), 0, 0\n", {}), 2u);
  }

  /** The largest |K u| at inner nodes of a linear motion, over the largest. */
  template <int dim>
  void patch(const std::string &scene_text,
             const std::vector<std::string> &overrides)
  {
    std::string cells_alone = scene_text; // each has its forces
    cells_alone.replace(cells_alone.find("bonded"), 6, "rigid");
    const Scene<dim> scene(cells_alone, overrides);
    const auto u = scene.discretization->interpolate(
        [](const auto &x, unsigned int, double *v) {
          for (unsigned int c = 0; c < dim; ++c) {
            v[c] = 0.1 * (c + 1.);
            for (unsigned int d = 0; d < dim; ++d)
              v[c] += (c == d ? 1. : 0.3 * (c + 2. * d)) * x[d];
          }
        });
    std::vector<double> force(u.size());
    scene.delassus->apply(DelassusOperator<dim>::Operator::stiffness, u.data(),
                          force.data());
    // the forces of cells on a node that is not on the boundary add up to zero
    std::map<std::array<long, dim>, std::array<double, dim>> sums;
    const auto &cells = scene.discretization->cells();
    double largest = 0.;
    const auto inside = [](const dealii::Point<dim> &x) {
      for (unsigned int d = 0; d < dim; ++d)
        if (x[d] < 1e-9 || x[d] > (dim == 2 ? 4. : 2.) - 1e-9)
          return false;
      return true;
    };
    for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
      const auto shape = cells.shape(b);
      for (unsigned int i = 0; i < shape->n_nodes; ++i) {
        const auto x = cells.place(b, shape->nodes[i]);
        if (!inside(x))
          continue;
        std::array<long, dim> key;
        for (unsigned int d = 0; d < dim; ++d)
          key[d] = std::lround(x[d] * 1e6);
        for (unsigned int c = 0; c < dim; ++c) {
          const double f = force[cells.bodies.first_dof[b] + i * dim + c];
          largest = std::max(largest, std::abs(f));
          sums[key][c] += f;
        }
      }
    }
    EXPECT_GT(sums.size(), 0u);
    for (const auto &[key, sum] : sums)
      for (const double f : sum)
        EXPECT_LT(std::abs(f), 1e-12 * largest);
  }

  TEST(AnisotropyScene, PatchAtAnyOrientation)
  {
    for (unsigned int k = 0; k < 3; ++k) {
      const EulerAngles a = some_angles(k);
      const std::string angles =
          fmt::format("  set Euler angles = {}, {}, {}\n", a[0], a[1], a[2]);
      for (const std::string &material : {cube, wood}) {
        for (const std::string plane : {"strain", "stress"})
          patch<2>(text(material + angles),
                   {"Mesh/distortion=0.3", "plane=" + plane,
                    "Discretization/degree=" + std::to_string(1 + k % 2)});
        patch<3>(text(material + angles),
                 {"dimension=3", "Mesh/type=brick", "Mesh/upper corner=2, 2, 2",
                  "Mesh/cells=2, 2, 2", "Mesh/distortion=0.3"});
        patch<3>(text(material + angles),
                 {"dimension=3", "Mesh/type=tetrahedra",
                  "Mesh/upper corner=2, 2, 2", "Mesh/cells=2, 2, 2",
                  "Mesh/distortion=0.3"});
      }
    }
  }

  /** How far the energies are from adding up, over the largest of them. */
  template <int dim>
  double defect(const Scene<dim> &scene)
  {
    const EnergyLines &e = scene.state.energy;
    return std::abs(e.kinetic + e.elastic + e.cohesive + e.damage + e.friction +
                    e.viscous + e.impact + e.numerical - e.work -
                    scene.state.initial_energy) /
           scene.state.largest_energy;
  }

  // A polycrystal that vibrates and breaks, on all paths.
  TEST(AnisotropyScene, BalancesClose)
  {
    const std::string motion = "  set orientation = random\n"
                               "  set initial velocity x = 0.3 * sin(x)\n";
    const std::string springs =
        "michel-suquet\n  set stiffness = 21\n  set strength = 0.02\n";
    const std::string cohesive =
        "camacho-ortiz\n  set strength = 0.02\n  set toughness = 1e-4\n";
    const auto with_law = [&](std::string scene, const std::string &law) {
      return scene.replace(scene.find("bonded\n"), 7, law);
    };
    using Overrides = std::vector<std::string>;
    for (const Overrides &more :
         {Overrides{"Solver/path=local"}, Overrides{"Solver/path=assembled"},
          Overrides{"Time/scheme=symplectic", "Time/step=0.1 courant"},
          Overrides{"Time/scheme=explicit", "Time/step=auto"},
          Overrides{"Time/scheme=explicit", "Time/step=auto",
                    "Mesh/type=crossed triangles"}})
      for (const std::string plane : {"strain", "stress"}) {
        SCOPED_TRACE(more.front() + more.back() + plane);
        auto all = more;
        all.insert(all.end(), {"Mesh/grains=5", "plane=" + plane});
        const bool is_explicit = more.front() == "Time/scheme=explicit";
        Steps<2> scene(
            with_law(text(cube + motion), is_explicit ? cohesive : springs),
            all);
        for (unsigned int k = 0; k < 30; ++k) {
          if (is_explicit)
            scene.step();
          else
            scene.advance_bisecting();
          EXPECT_LT(defect(scene), 1e-9);
        }
        EXPECT_GT(scene.state.energy.damage, 0.);
      }
  }

  // The kernel of constant strain and the blocks of cells are one law: a
  // formula that is the same all over takes the blocks.
  TEST(AnisotropyScene, ExplicitPathsAgree)
  {
    const auto run = [](auto dimension, const std::string &material,
                        const std::string &angles, const std::string &type) {
      constexpr int dim = decltype(dimension)::value;
      std::vector<std::string> overrides = {
          "Time/scheme=explicit", "Time/step=0.05", "Mesh/type=" + type};
      if (dim == 3)
        overrides.insert(
            overrides.end(),
            {"dimension=3", "Mesh/upper corner=2, 2, 2", "Mesh/cells=2, 2, 2"});
      Steps<dim> scene(text(material + "  set Euler angles = " + angles +
                            "\n  set initial velocity x = sin(x + 2 * y)\n"),
                       overrides);
      for (unsigned int k = 0; k < 40; ++k)
        scene.step();
      scene.show();
      return std::pair(scene.state.displacement, scene.state.energy.elastic);
    };
    const auto compare = [&](auto dimension, const std::string &type) {
      for (const std::string &material : {cube, wood}) {
        const auto [fast, energy] =
            run(dimension, material, "20, 50, 10", type);
        const auto [slow, other] =
            run(dimension, material, "20 + 1e-30 * x, 50, 10", type);
        ASSERT_EQ(fast.size(), slow.size());
        double difference = 0., size = 0.;
        for (std::size_t i = 0; i < fast.size(); ++i) {
          difference = std::max(difference, std::abs(fast[i] - slow[i]));
          size = std::max(size, std::abs(slow[i]));
        }
        EXPECT_LT(difference, 1e-12 * size);
        EXPECT_NEAR(energy, other, 1e-12 * other);
        EXPECT_GT(energy, 0.);
      }
    };
    compare(std::integral_constant<int, 2>(), "crossed triangles");
    compare(std::integral_constant<int, 3>(), "tetrahedra");
  }
} // namespace test_crystal_scenes
