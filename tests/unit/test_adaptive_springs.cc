#include "changing_mesh.h"

#include "discretization/cells.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

// Springs that become stiffer with smaller cells, so that the modulus of a body
// stays: states of uniform stress by hand, and damage over changes by chance.

namespace nsfd::test_adaptive_springs
{
  using namespace test;

  namespace
  {
    constexpr double C_N = 50., C_T = 20.;

    /** Asks for the same size everywhere, another one in every round. */
    class Everywhere final : public Indicator
    {
    public:
      explicit Everywhere(SectionReader &) {}

      void limit(const MeshView &view, std::vector<double> &size) const override
      {
        ++round;
        for (std::size_t b = 0; b < size.size(); ++b)
          size[b] = std::ldexp(view.bodies()[b].largest, -int(round % 5 % 3));
      }

      static inline unsigned int round = 0;
    };
    NSFD_REGISTER(IndicatorRegistry, Everywhere, "everywhere", "For tests");

    std::string text(const unsigned int dim, const unsigned int degree,
                     const std::string &law, const std::string &more = "",
                     const std::string &indicator = "chance",
                     const bool one_row = false)
    {
      const std::string cells = one_row ? (dim == 3 ? "5, 1, 1" : "6, 1")
                                        : (dim == 3 ? "3, 2, 2" : "4, 3");
      const bool space = dim == 3;
      return "set dimension = " + std::to_string(dim) +
             "\nsubsection Mesh\n  set type = " +
             (space ? "brick" : "rectangle") +
             "\n  set upper corner = " + cells + "\n  set cells = " + cells +
             "\nend\nsubsection Discretization\n  set degree = " +
             std::to_string(degree) + R"(
end
subsection Material: block
  set Young modulus = 10
  set Poisson ratio = 0.3
  set density       = 2
end
subsection Interface: all
)" + law + R"(
end
subsection Time
  set end  = 1
  set step = 0.5 courant
end
subsection Adaptivity
  set levels              = 2
  set coarsen every steps = 1
)" + more + R"(end
subsection Indicator: any
  set type = )" +
             indicator + "\nend\n";
    }

    const std::string elastic = "  set law = elastic\n  set normal stiffness = "
                                "50\n  set tangential stiffness = 20\n";
    const std::string michel =
        "  set law = michel-suquet\n  set stiffness = 50\n  set tangential "
        "stiffness = 20\n  set strength = 1\n";

    /** A strain of the bulk, and in every cell the translation that opens the
     * springs around it to the stress of that strain. */
    template <int dim>
    void set_uniform_stress(Changing<dim> &mesh, const bool uniaxial)
    {
      double strain[3][3] = {
          {4e-3, 1e-3, -2e-3}, {1e-3, -3e-3, 5e-4}, {-2e-3, 5e-4, 2e-3}};
      const double nu = 0.3, E = 10., mu = E / 2. / (1. + nu),
                   lambda = E * nu / (1. + nu) / (1. - 2. * nu);
      if (uniaxial) // along x: what the others contract by, in plane strain too
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            strain[i][j] = i != j   ? 0.
                           : i == 0 ? 4e-3
                                    : -4e-3 * (dim == 3 ? nu : nu / (1. - nu));
      double stress[3][3] = {}, trace = 0.;
      for (unsigned int i = 0; i < dim; ++i)
        trace += strain[i][i];
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          stress[i][j] =
              2. * mu * strain[i][j] + (i == j ? lambda * trace : 0.);
      const auto &discretization = *mesh.model.discretization;
      mesh.state.displacement = discretization.interpolate(
          [&](const dealii::Point<dim> &x, const unsigned int b, double *u) {
            const auto centre = discretization.cells().centre(b);
            for (unsigned int i = 0; i < dim; ++i) {
              u[i] = 0.;
              for (unsigned int j = 0; j < dim; ++j)
                u[i] += strain[i][j] * x[j] + std::floor(centre[j]) *
                                                  stress[i][j] /
                                                  (i == j ? C_N : C_T);
            }
          });
      mesh.state.velocity.assign(mesh.state.displacement.size(), 0.);
      mesh.set_jumps(std::vector<double>(mesh.state.jump.size(), 0.));
    }

    /** Traction of the spring of a point in axes of space, Pa. */
    template <int dim>
    std::array<double, dim> spring_traction(const Changing<dim> &mesh,
                                            const std::size_t i)
    {
      const auto &problem = mesh.model.stepper->problem();
      const auto &interaction = problem.interactions[problem.interaction[i]];
      const double C = interaction.law ? interaction.law->normal_stiffness()
                                       : interaction.normal_stiffness;
      const double *frame = mesh.model.discretization->points().axes(i);
      std::array<double, dim> t{};
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int c = 0; c < dim; ++c)
          t[c] += frame[k * dim + c] * mesh.state.jump[i * dim + k] * C *
                  (k == 0 ? 1. : interaction.stiffness_ratio);
      return t;
    }

    /** Tractions of the springs on faces with a normal along each axis. */
    template <int dim>
    struct Tractions {
      double mean[dim][dim] = {}, area[dim] = {}, low[dim][dim] = {},
             high[dim][dim] = {};

      explicit Tractions(const Changing<dim> &mesh)
      {
        const auto &points = mesh.model.discretization->points();
        for (std::size_t i = 0; i < points.n_points; ++i) {
          const double *n = points.axes(i);
          const auto t = spring_traction(mesh, i);
          for (unsigned int d = 0; d < dim; ++d)
            for (unsigned int c = 0; std::abs(n[d]) > 0.5 && c < dim; ++c) {
              const double value = t[c] * (n[d] > 0. ? 1. : -1.);
              if (area[d] == 0. || value < low[d][c])
                low[d][c] = value;
              if (area[d] == 0. || value > high[d][c])
                high[d][c] = value;
              mean[d][c] += points.weight[i] * value;
              if (c + 1 == dim)
                area[d] += points.weight[i];
            }
        }
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int c = 0; c < dim; ++c)
            mean[d][c] /= area[d] > 0. ? area[d] : 1.;
      }
    };

    /** @p exact at every point, not only in the mean over each direction. */
    template <int dim>
    void keeps_uniform_stress(Changing<dim> &mesh, const unsigned int rounds,
                              const bool uniaxial, const bool exact)
    {
      Chance::round = Everywhere::round = 0;
      set_uniform_stress(mesh, uniaxial);
      const Tractions<dim> before(mesh);
      const EnergyLines start = mesh.state.energy;
      ASSERT_GT(start.cohesive, 0.);
      const double tolerance = 1e-12 * std::abs(before.mean[0][0]);
      unsigned int changes = 0, smaller = 0, larger = 0;
      std::size_t cells = mesh.model.discretization->bodies().size();
      for (unsigned int k = 0; k < rounds; ++k) {
        if (!mesh.change())
          continue;
        ++changes;
        const std::size_t now = mesh.model.discretization->bodies().size();
        smaller += now > cells;
        larger += now < cells;
        cells = now;
        const Tractions<dim> after(mesh);
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int c = 0; before.area[d] > 0. && c < dim; ++c) {
            ASSERT_NEAR(after.mean[d][c], before.mean[d][c], tolerance) << k;
            if (exact) {
              ASSERT_NEAR(after.low[d][c], before.mean[d][c], tolerance) << k;
              ASSERT_NEAR(after.high[d][c], before.mean[d][c], tolerance) << k;
            }
          }
        ASSERT_NEAR(mesh.state.energy.elastic, start.elastic,
                    1e-12 * start.elastic);
        ASSERT_LT(mesh.jump_of_motion(), 1e-13);
        ASSERT_NEAR(closed(mesh.state.energy), closed(start),
                    1e-12 * start.elastic);
      }
      EXPECT_GE(changes, rounds / 2);
      EXPECT_GT(smaller, 0u);
      EXPECT_GT(larger, 0u);
    }

    /** Of the law as it is written: beta where springs have their compliance.
     */
    std::set<long> damages(const Changing<2> &mesh)
    {
      std::set<long> values;
      for (std::size_t i = 0; i < mesh.state.beta.size(); ++i) {
        const double c = mesh.model.discretization->origins()[i].compliance,
                     beta = mesh.state.beta[i];
        values.insert(std::lround(1e7 * beta / (c + (1. - c) * beta)));
      }
      values.insert(long(1e7));
      return values;
    }

    double area_of_beta(const Changing<2> &mesh)
    {
      double sum = 0.;
      for (std::size_t i = 0; i < mesh.state.beta.size(); ++i)
        if (mesh.state.beta[i] < 1.)
          sum += mesh.model.discretization->points().weight[i] *
                 mesh.state.beta[i];
      return sum;
    }
  } // namespace

  // Smaller and larger again: every spring carries what the bulk next to it
  // does, to round-off, the new ones and those that became stiffer.
  TEST(AdaptiveSprings, UniformStressPassesChangesOfAllCells)
  {
    Changing<2> plane(text(2, 1, elastic, "", "everywhere")),
        quadratic(text(2, 2, michel, "", "everywhere"));
    keeps_uniform_stress(plane, 10, false, true);
    keeps_uniform_stress(quadratic, 10, false, true);
    Changing<3> bricks(text(3, 1, michel, "", "everywhere"));
    keeps_uniform_stress(bricks, 6, false, true);
  }

  TEST(AdaptiveSprings, TensionOfARowOfCellsPassesHangingFaces)
  {
    Changing<2> plane(text(2, 1, michel, "", "chance", true));
    keeps_uniform_stress(plane, 40, true, true);
    Changing<3> bricks(text(3, 1, elastic, "", "chance", true));
    keeps_uniform_stress(bricks, 8, true, true);
  }

  // Next to a larger cell the smaller ones have openings along the face that it
  // does not have: what this changes at a point cancels along the face.
  TEST(AdaptiveSprings, MeanTractionsPassAllChanges)
  {
    Changing<2> plane(text(2, 1, elastic));
    keeps_uniform_stress(plane, 40, false, false);
    Changing<3> bricks(text(3, 1, michel));
    keeps_uniform_stress(bricks, 6, false, false);
  }

  // The compliance of the springs per length, along rows of faces: sum over the
  // faces of area times compliance is half the volume of all cells times the
  // directions, but for the halves next to the boundary.
  TEST(AdaptiveSprings, SharesAddUp)
  {
    Chance::round = 0;
    Changing<2> mesh(text(2, 1, elastic));
    unsigned int changes = 0;
    for (unsigned int k = 0; k < 20; ++k) {
      changes += mesh.change();
      const auto &discretization = *mesh.model.discretization;
      const auto &points = discretization.points();
      double sum = 0.;
      for (std::size_t i = 0; i < points.n_points; ++i)
        sum += points.weight[i] * discretization.origins()[i].compliance;
      double halves = 0.; // cells are squares of the size 2^-level
      for (unsigned int b = 0; b < discretization.bodies().size(); ++b) {
        const auto corners = discretization.cells().corners[b];
        const double size = corners[1][0] - corners[0][0];
        for (unsigned int d = 0; d < 2; ++d) {
          halves += size * size;
          const double end = d == 0 ? 4. : 3.;
          if (corners[0][d] < 1e-9 || corners[3][d] > end - 1e-9)
            halves -= 0.5 * size * size;
        }
      }
      ASSERT_NEAR(sum, halves, 1e-12 * halves) << k;
    }
    EXPECT_GT(changes, 10u);
  }

  // Damage in terms of the law as written is that of before, beta never rises,
  // what has been dissipated neither, and damaged points keep their traction.
  TEST(AdaptiveSprings, DamageOverChangesByChance)
  {
    Chance::round = 0;
    Changing<2> mesh(text(2, 1, michel));
    mesh.damage();
    const auto before = damages(mesh);
    double area = area_of_beta(mesh);
    const auto momenta = mesh.momenta();
    unsigned int changes = 0;
    for (unsigned int k = 0; k < 200; ++k) {
      const EnergyLines old = mesh.state.energy;
      if (!mesh.change())
        continue;
      ++changes;
      ASSERT_EQ(damages(mesh), before) << k;
      ASSERT_LE(area_of_beta(mesh), area * (1. + 1e-12));
      area = area_of_beta(mesh);
      // the toughness is 1.7 R^2 / C on 17 m of faces
      ASSERT_NEAR(mesh.state.energy.damage, 0., 1e-12);
      ASSERT_NEAR(closed(mesh.state.energy), closed(old), 1e-12 * old.kinetic);
      const auto now = mesh.momenta();
      for (unsigned int d = 0; d + 1 < now.size(); ++d)
        ASSERT_NEAR(now[d], momenta[d], 1e-12 * momenta.back()) << d;
    }
    EXPECT_GT(changes, 100u);
  }

  TEST(AdaptiveSprings, StayAsTheLawSaysByChoice)
  {
    Chance::round = 0;
    Changing<2> mesh(
        text(2, 1, elastic, "  set springs = constant stiffness\n"));
    EXPECT_TRUE(mesh.change());
    for (const PointOrigin &origin : mesh.model.discretization->origins())
      EXPECT_EQ(origin.compliance, 1.);
  }

  // A weak plane between bonded cells has no new faces behind one another.
  TEST(AdaptiveSprings, APlaneKeepsItsStiffness)
  {
    Chance::round = 0;
    Changing<2> mesh(text(2, 1,
                          "  set where = abs(x - 2) < 1e-6\n" + michel +
                              "end\nsubsection Interface: rest\n  set law = "
                              "rigid"));
    for (unsigned int k = 0; k < 5; ++k) {
      mesh.change();
      for (const PointOrigin &origin : mesh.model.discretization->origins())
        ASSERT_EQ(origin.compliance, 1.);
    }
    EXPECT_GT(mesh.model.discretization->bodies().size(), 12u);
  }

  TEST(AdaptiveSprings, LawsThatCannotAreRefused)
  {
    for (const char *law : {"  set law = ppr\n  set strength = 1\n  set "
                            "toughness = 1\n",
                            "  set law = xu-needleman\n  set strength = 1\n  "
                            "set toughness = 1\n"}) {
      try {
        make_input(text(2, 1, law));
        ADD_FAILURE() << law;
      } catch (const std::invalid_argument &error) {
        EXPECT_NE(
            std::string(error.what()).find("springs = constant stiffness"),
            std::string::npos)
            << error.what();
      }
      EXPECT_NO_THROW(
          make_input(text(2, 1, law, "  set springs = constant stiffness\n")));
    }
  }
} // namespace nsfd::test_adaptive_springs
