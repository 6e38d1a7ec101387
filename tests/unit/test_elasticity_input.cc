#include "materials/elasticity.h"

#include "make_scene.h"

#include "nsfd/scene/scene_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

// Linear elastic materials at one place, against their compliance, other
// coordinates, and the dimensions among each other.

using namespace nsfd;
using namespace nsfd::test;

namespace test_elasticity_input
{
  // --- what scenes may say

  const std::string plate = R"(
set dimension = DIM
subsection Mesh
  set type         = BOX
  set lower corner = ZERO
  set upper corner = ONE
  set cells        = CELLS
end
subsection Material: m
MATERIAL
  set density = 2
end
subsection Interface: all
  set law = rigid
end
subsection Time
  set end  = 1
  set step = 0.1 courant
end
)";

  std::string replaced(std::string text, const std::string &what,
                       const std::string &by)
  {
    text.replace(text.find(what), what.size(), by);
    return text;
  }

  std::string scene_of(const std::string &material, const unsigned int dim = 2)
  {
    std::string text = replaced(plate, "MATERIAL", material);
    text = replaced(text, "DIM", dim == 2 ? "2" : "3");
    text = replaced(text, "BOX", dim == 2 ? "rectangle" : "brick");
    text = replaced(text, "ZERO", dim == 2 ? "0, 0" : "0, 0, 0");
    text = replaced(text, "ONE", dim == 2 ? "1, 1" : "1, 1, 1");
    return replaced(text, "CELLS", dim == 2 ? "2, 2" : "1, 1, 1");
  }

  std::string transverse(const std::string &axis,
                         const std::string &nu_A = "0.3",
                         const std::string &nu_T = "0.45")
  {
    return "  set model = transversely isotropic\n  set axis = " + axis +
           "\n  set axial Young modulus = 14\n"
           "  set transverse Young modulus = 1\n"
           "  set axial Poisson ratio = " +
           nu_A + "\n  set transverse Poisson ratio = " + nu_T +
           "\n  set axial shear modulus = 0.5";
  }

  /** All that is wrong, or nothing. */
  std::string complaints(const std::string &text,
                         const std::vector<std::string> &overrides = {})
  {
    InputErrors errors;
    const auto input = read_scene_text(text, "test.prm", overrides, errors);
    return input ? "" : errors.report();
  }

  void expect_words(const std::string &text,
                    const std::vector<std::string> &words)
  {
    for (const std::string &word : words)
      EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
  }

  TEST(ElasticityInput, AxisOfAnyLength)
  {
    const auto input = make_input(scene_of(transverse("3, -4, 0")));
    const auto &axis = input->materials[0].transverse->axis;
    EXPECT_DOUBLE_EQ(axis[0], 0.6);
    EXPECT_DOUBLE_EQ(axis[1], -0.8);
    EXPECT_EQ(make_input(scene_of(transverse("0, 0, -7")))
                  ->materials[0]
                  .transverse->axis[2],
              1.);
    EXPECT_DOUBLE_EQ(make_input(scene_of(transverse("1, 2, -2"), 3))
                         ->materials[0]
                         .transverse->axis[2],
                     -2. / 3.);
  }

  TEST(ElasticityInput, AxisOutOfThePlaneIsRefused)
  {
    expect_words(complaints(scene_of(transverse("1, 0, 1"))),
                 {"neither in the plane nor normal to it", "set axis = 1, 0, 0",
                  "dimension = 3"});
    EXPECT_EQ(complaints(scene_of(transverse("1, 0, 1"), 3)), "");
    expect_words(complaints(scene_of(transverse("0, 0, 0"))),
                 {"no direction", "set axis = 1, 0, 0"});
  }

  TEST(ElasticityInput, IndefiniteConstantsAreRefused)
  {
    // sqrt(0.55 * 14 / 2) = 1.962
    expect_words(complaints(scene_of(transverse("1, 0, 0", "1.97"))),
                 {"axial Poisson ratio = 1.97", "negative energy", "1.962"});
    EXPECT_EQ(complaints(scene_of(transverse("1, 0, 0", "1.96"))), "");
    expect_words(complaints(scene_of(transverse("1, 0, 0", "0", "1"))),
                 {"transverse Poisson ratio = 1", "less than 1"});
    expect_words(complaints(scene_of(transverse("1, 0, 0"), 2),
                            {"Material: m/axial shear modulus=0"}),
                 {"axial shear modulus = 0 must be positive"});
  }

  TEST(ElasticityInput, ConstantsOfOtherModelsAreRefused)
  {
    expect_words(complaints(scene_of(transverse("1, 0, 0") +
                                     "\n  set Young modulus = 1")),
                 {"Young modulus", "transversely isotropic"});
    expect_words(complaints(scene_of("  set Young modulus = 1\n"
                                     "  set Poisson ratio = 0.3\n"
                                     "  set axis = 1, 0, 0")),
                 {"it needs model = transversely isotropic"});
    expect_words(complaints(scene_of(transverse("1, 0, 0")), {"motion=large"}),
                 {"motion = large", "saint-venant kirchhoff"});
  }

  TEST(ElasticityInput, ViscosityWhereItIsNotThere)
  {
    const std::string viscous = "  set Young modulus = 1\n"
                                "  set Poisson ratio = 0.3\n"
                                "  set shear viscosity = 0.1";
    EXPECT_EQ(complaints(scene_of(viscous)), "");
    expect_words(complaints(scene_of(viscous), {"plane=stress"}),
                 {"plane = stress", "write plane = strain"});
    expect_words(complaints(scene_of(viscous), {"Time/scheme=arkode"}),
                 {"arkode knows no viscosity", "moreau-jean"});
    expect_words(
        complaints(scene_of(viscous), {"Material: m/shear viscosity=-1"}),
        {"must not be negative"});
    expect_words(complaints(scene_of("  set model = rigid\n"
                                     "  set shear viscosity = 1")),
                 {"the material is rigid"});
  }

  TEST(ElasticityInput, GradedConstantsAreCheckedInTheCells)
  {
    const auto trouble = [](const std::string &young,
                            const std::string &poisson = "0.3") {
      try {
        Scene<2> scene(scene_of("  set Young modulus = " + young +
                                "\n  set Poisson ratio = " + poisson));
      } catch (const std::exception &error) {
        return std::string(error.what());
      }
      return std::string();
    };
    EXPECT_EQ(trouble("1 + x"), "");
    expect_words(trouble("1 - 2 * x"),
                 {"Material: m/Young modulus = 1 - 2 * x", "must be positive",
                  "falls to -0.7887"});
    expect_words(trouble("1 / (x - x)"), {"not a number"});
    expect_words(
        trouble("1", "x"),
        {"Poisson ratio = x", "above -1 and below 0.5", "rises to 0.8943"});
    expect_words(complaints(scene_of("  set Young modulus = 1 + t\n"
                                     "  set Poisson ratio = 0.3")),
                 {"depends on t"});
  }
} // namespace test_elasticity_input
