#include "leapfrog_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// Explicit steps of small motions with materials that have a history: without
// flow the steps of linear bodies, against implicit steps, and their balance.

using namespace nsfd;
using nsfd::test::Steps;

namespace test_explicit_flow
{
  using Overrides = std::vector<std::string>;

  const std::string block = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 2, 1
  set cells        = 8, 4
end
subsection Material: soft
  set model                       = j2 plastic
  set Young modulus               = 100
  set Poisson ratio               = 0.3
  set density                     = 1
  set yield stress                = 2
  set isotropic hardening modulus = 5
  set kinematic hardening modulus = 10
  set initial velocity x          = sin(3 * (x - 1))
  set initial velocity y          = 0.4 * (x - 1)^2
end
subsection Interface: all
  set law = joined
end
subsection Time
  set end    = 1000
  set scheme = explicit
  set step   = 0.002
end
subsection Solver
  set tolerance = 1e-12
end
)";

  const Overrides slowly = {"Material: soft/model=viscoplastic",
                            "Material: soft/viscosity=1"};
  const Overrides triangles = {"Mesh/type=crossed triangles"};
  const Overrides quadratic = {"Discretization/degree=2"};
  const Overrides in_space = {"dimension=3", "Mesh/type=brick",
                              "Mesh/upper corner=2, 1, 1",
                              "Mesh/cells=4, 2, 2"};
  const Overrides tetrahedra = {"dimension=3", "Mesh/type=tetrahedra",
                                "Mesh/upper corner=2, 1, 1",
                                "Mesh/cells=4, 2, 2"};
  const Overrides stress = {"plane=stress"};

  Overrides with(Overrides overrides, const Overrides &more)
  {
    overrides.insert(overrides.end(), more.begin(), more.end());
    return overrides;
  }

  double difference(const std::vector<double> &a, const std::vector<double> &b)
  {
    double result = 0., largest = 0.;
    EXPECT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      result = std::max(result, std::abs(a[i] - b[i]));
      largest = std::max(largest, std::abs(b[i]));
    }
    return result / largest;
  }

  template <int dim>
  void without_flow(const Overrides &kind)
  {
    Steps<dim> flowing(block, with(kind, {"Material: soft/yield stress=1e9"}));
    std::string plain = block;
    const auto drop = [&plain](const std::string &line) {
      const std::size_t begin = plain.find("  set " + line);
      plain.erase(begin, plain.find('\n', begin) + 1 - begin);
    };
    for (const char *line : {"model ", "yield ", "isotropic ", "kinematic "})
      drop(line);
    Steps<dim> linear(plain, kind);
    for (unsigned int k = 0; k < 60; ++k) {
      flowing.step();
      linear.step();
    }
    flowing.show();
    linear.show();
    EXPECT_LT(difference(flowing.state.displacement, linear.state.displacement),
              1e-12);
    EXPECT_NEAR(flowing.state.energy.elastic, linear.state.energy.elastic,
                1e-12 * linear.state.largest_energy);
    EXPECT_NEAR(flowing.state.energy.kinetic, linear.state.energy.kinetic,
                1e-12 * linear.state.largest_energy);
    EXPECT_EQ(flowing.state.energy.plastic, 0.);
  }

  TEST(ExplicitFlow, WithoutFlowItIsTheLinearStep)
  {
    without_flow<2>(quadratic);
    without_flow<2>(triangles);
    without_flow<2>(stress);
    without_flow<3>(with(in_space, quadratic));
    without_flow<3>(tetrahedra);
  }

  // u_x = e x y in two squares of side 2 around (0, 0) and (2, 0): tr(H) = e y,
  // which has no mean, so that the energy is that of the shear modulus alone,
  // mu e^2 times the integral of (x^2 + y^2)/2; e^2 K y^2/2 would be added by
  // cells whose dilatation differs from place to place.
  TEST(ExplicitFlow, BilinearCellsHaveOneDilatation)
  {
    for (const double poisson : {0.3, 0.4999}) {
      Steps<2> scene(block,
                     {"Mesh/lower corner=-1, -1", "Mesh/upper corner=3, 1",
                      "Mesh/cells=2, 1", "Material: soft/yield stress=1e9",
                      "Material: soft/Poisson ratio=" + std::to_string(poisson),
                      "Material: soft/initial displacement x=1e-3*x*y",
                      "Material: soft/initial velocity x=0",
                      "Material: soft/initial velocity y=0"});
      scene.show();
      const double mu = 100. / (2. * (1. + poisson));
      EXPECT_NEAR(scene.state.energy.elastic, 32. / 3. * mu * 1e-6,
                  1e-12 * mu * 1e-6);
    }
  }

  template <int dim>
  void balance_closes(const Overrides &kind)
  {
    Steps<dim> scene(block, kind);
    double plastic = 0., viscous = 0.;
    for (unsigned int k = 0; k < 300; ++k) {
      ASSERT_LT(scene.step().balance_residual, 1e-11) << k;
      const EnergyLines &e = scene.state.energy;
      ASSERT_GE(e.plastic, plastic);
      ASSERT_GE(e.viscous, viscous);
      plastic = e.plastic;
      viscous = e.viscous;
    }
    EXPECT_GT(plastic, 0.02 * scene.state.initial_energy);
    // the trapezoidal rule along a way that flows, of second order
    EXPECT_LT(std::abs(scene.state.energy.numerical),
              1e-3 * scene.state.initial_energy);
  }

  TEST(ExplicitFlow, BalanceClosesAndTakesWhatFlows)
  {
    for (const Overrides &flow : {Overrides(), slowly}) {
      balance_closes<2>(flow);
      balance_closes<2>(with(triangles, flow));
      balance_closes<2>(with(quadratic, flow));
      balance_closes<2>(with(stress, flow));
      balance_closes<3>(with(in_space, flow));
      balance_closes<3>(with(tetrahedra, flow));
    }
  }

  // Implicit steps have other masses and joints of their own: the error of
  // lumping falls with the square of the cells.
  TEST(ExplicitFlow, ImplicitStepsFlowAsMuch)
  {
    for (const Overrides &flow : {Overrides(), slowly}) {
      const auto run = [&flow](const Overrides &scheme, const double step) {
        Steps<2> scene(block, with(with(scheme, flow), {"Mesh/cells=24, 12"}));
        while (scene.state.time < 0.3)
          scene.step(step / scene.time_step);
        return std::array<double, 2>{
            {scene.state.energy.plastic, scene.state.energy.elastic}};
      };
      const auto one = run({}, 1e-3), other = run({"Time/scheme=moreau-jean",
                                                   "Interface: all/law=rigid"},
                                                  5e-3);
      EXPECT_GT(other[0], 0.);
      for (unsigned int k = 0; k < 2; ++k)
        EXPECT_NEAR(one[k], other[k], 0.02 * other[k]);
    }
  }

  // Ductile bodies that break, and others that are viscous, in one scene.
  TEST(ExplicitFlow, CracksAndViscousBodies)
  {
    std::string text = block;
    text.replace(text.find("  set law = joined"), 18,
                 "  set law = camacho-ortiz\n  set strength = 3\n"
                 "  set toughness = 0.02");
    text.insert(text.find("subsection Interface"),
                "subsection Material: other\n  set Young modulus = 100\n"
                "  set Poisson ratio = 0.3\n  set density = 1\n"
                "  set shear viscosity = 0.05\nend\n");
    text.insert(text.find("  set model "), "  set where = x < 1\n");
    for (const Overrides &kind : {Overrides(), triangles}) {
      Steps<2> scene(text, with(kind, {"Time/step=auto"}));
      for (unsigned int k = 0; k < 400; ++k)
        ASSERT_LT(scene.step().balance_residual, 1e-10) << k;
      const EnergyLines &e = scene.state.energy;
      EXPECT_GT(e.plastic, 0.);
      EXPECT_GT(e.viscous, 0.);
      EXPECT_GT(e.damage, 0.);
    }
  }
} // namespace test_explicit_flow
