#include "hanging_nodes.h"

#include "discretization/body_frequency.h"

#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/lapack_full_matrix.h>
#include <deal.II/lac/vector.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

// Cells of two sizes that are joined: what follows what, masses, frequencies.

namespace nsfd::test_hanging_nodes
{
  namespace
  {
    using test::of_degree;
    template <int dim>
    using Parts = test::JoinedParts<dim>;

    /** Any linear displacement is kept to the last digits, without a force
        inside. */
    template <int dim>
    void expect_patch(const std::vector<std::string> &overrides)
    {
      Parts<dim> parts(overrides);
      auto &g = parts.groups;
      const double slope[3][3] = {
          {1e-3, 4e-4, -2e-4}, {-3e-4, 2e-3, 5e-4}, {7e-4, 1e-4, -1e-3}};
      const auto linear = [&](const std::size_t k, const unsigned int c) {
        double sum = 0.02 * (c + 1);
        for (unsigned int d = 0; d < dim; ++d)
          sum += slope[c][d] * parts.place[k][d];
        return sum;
      };
      for (std::size_t k = 0; k < g.size(); ++k)
        for (unsigned int c = 0; c < dim; ++c)
          g.displacement[k * dim + c] = parts.hangs[k] ? 1e3 : linear(k, c);
      parts.hanging.follow(g);
      for (std::size_t k = 0; k < g.size(); ++k)
        for (unsigned int c = 0; c < dim; ++c)
          ASSERT_NEAR(g.displacement[k * dim + c], linear(k, c), 1e-15);
      parts.forces->set_forces(g);
      double largest = 0.;
      for (std::size_t i = 0; i < parts.mesh.n_corners(); ++i)
        for (const double f : parts.forces->corner_force(i, g))
          largest = std::max(largest, std::abs(f));
      parts.hanging.collect(g, g.force, g.shares);
      const auto &scene = parts.scene;
      const auto lower = scene.groups->lower(), upper = scene.groups->upper();
      double worst = 0.;
      for (std::size_t k = 0; k < g.size(); ++k) {
        bool inside = true;
        for (unsigned int c = 0; c < dim; ++c)
          inside = inside && parts.place[k][c] > lower[c] + 1e-6 &&
                   parts.place[k][c] < upper[c] - 1e-6;
        for (unsigned int c = 0; inside && c < dim; ++c)
          worst = std::max(worst, std::abs(g.force[k * dim + c]));
      }
      EXPECT_LT(worst, 1e-12 * largest);
    }

    TEST(HangingNodes, KeepLinearFields)
    {
      for (unsigned int p = 1; p <= 4; ++p) {
        SCOPED_TRACE(p);
        expect_patch<2>(of_degree<2>(p));
        expect_patch<3>(of_degree<3>(p));
      }
      expect_patch<2>(
          of_degree<2>(3, {"Mesh/distortion=0.15", "Adaptivity/levels=2",
                           "Indicator: middle/cell size=0.2"}));
    }

    // Neither on lattices nor where three or five cells meet, at cells of four
    // sizes: it would be refused.
    TEST(HangingNodes, FollowNodesThatMove)
    {
      std::string ball = test::refined_plate;
      const auto corners = ball.find("  set lower corner"),
                 end = ball.find("end\nsubsection Adaptivity");
      ball.replace(corners, end - corners, "  set refinements = 1\n");
      const std::vector<std::string> finer = {
          "Mesh/type=hyper_ball", "Mesh/arguments=0, 0 : 1 : false",
          "Adaptivity/levels=3", "Indicator: middle/cell size=0.06",
          "Indicator: middle/region=(x - 0.3)^2 + (y - 0.25)^2 + (z - 0.1)^2 < "
          "0.04"};
      auto in_space = finer;
      in_space[1] = "Mesh/arguments=0, 0, 0 : 1 : false";
      in_space.push_back("dimension=3");
      EXPECT_NO_THROW((test::Scene<2>(ball, finer)));
      EXPECT_NO_THROW((test::Scene<3>(ball, in_space)));
    }

    /** Masses are positive; they, and forces of any kind, have the sum and the
        moment that they had. */
    template <int dim>
    void expect_sums(const std::vector<std::string> &overrides)
    {
      Parts<dim> parts(overrides);
      auto &g = parts.groups;
      std::array<double, 4> before{}, after{};
      const auto add = [&](const std::vector<double> &mass,
                           std::array<double, 4> &sums) {
        for (std::size_t k = 0; k < g.size(); ++k) {
          sums[0] += mass[k];
          for (unsigned int c = 0; c < dim; ++c)
            sums[1 + c] += mass[k] * parts.place[k][c];
        }
      };
      add(parts.bare, before);
      add(g.mass, after);
      for (unsigned int k = 0; k < dim + 1; ++k)
        EXPECT_NEAR(after[k], before[k], 1e-13 * before[k]);
      double least = 1e300, largest = 0.;
      for (std::size_t k = 0; k < g.size(); ++k) {
        EXPECT_EQ(g.mass[k] == 0., parts.hangs[k] != 0);
        if (!parts.hangs[k])
          least = std::min(least, g.mass[k] / parts.bare[k]);
        largest = std::max(largest, parts.bare[k]);
      }
      EXPECT_GE(least, 1. - 1e-13); // what is followed becomes heavier
      EXPECT_EQ(parts.hanging.mass_share(), 1.);

      std::mt19937 random(7);
      for (double &f : g.force)
        f = double(random()) / double(random.max()) - 0.5;
      const auto sums = [&] {
        std::array<double, 3> result{};
        for (std::size_t k = 0; k < g.size(); ++k) {
          result[0] += g.force[k * dim];
          result[1] += g.force[k * dim + 1];
          result[2] += parts.moment(g.force, k);
        }
        return result;
      };
      const auto free = sums();
      parts.hanging.collect(g, g.force, g.shares);
      const auto tied = sums();
      for (unsigned int k = 0; k < 3; ++k)
        EXPECT_NEAR(tied[k], free[k], 1e-13 * double(g.size()));
    }

    TEST(HangingNodes, KeepMassesAndMomenta)
    {
      for (unsigned int p = 1; p <= 4; ++p) {
        SCOPED_TRACE(p);
        expect_sums<2>(of_degree<2>(p));
        expect_sums<3>(of_degree<3>(p));
        expect_sums<2>(of_degree<2>(
            p, {"Adaptivity/levels=3", "Indicator: middle/cell size=0.1"}));
      }
    }

    // Where the density changes along a large face, or the cells are not alike,
    // masses may lie a little differently: the bound of the step knows.
    TEST(HangingNodes, BoundTheStepOfUnequalCells)
    {
      Parts<2> parts(of_degree<2>(
          3, {"Mesh/distortion=0.2", "Material: bulk/density=1 + 3 * y^2"}));
      const double share = parts.hanging.mass_share();
      RecordProperty("unequal", std::to_string(share));
      EXPECT_LT(share, 1.1);
      EXPECT_GT(*std::min_element(parts.bare.begin(), parts.bare.end()), 0.);
    }

    /** omega_max of all that moves, over that of the worst cell. */
    template <int dim>
    double frequency(const std::vector<std::string> &overrides)
    {
      Parts<dim> parts(overrides);
      auto &g = parts.groups;
      std::vector<std::size_t> moving;
      for (std::size_t k = 0; k < g.size(); ++k)
        for (unsigned int c = 0; c < dim && !parts.hangs[k]; ++c)
          moving.push_back(k * dim + c);
      const std::size_t n = moving.size();
      dealii::LAPACKFullMatrix<double> A(n, n);
      for (std::size_t j = 0; j < n; ++j) {
        std::fill(g.displacement.begin(), g.displacement.end(), 0.);
        g.displacement[moving[j]] = 1.;
        parts.hanging.follow(g);
        parts.forces->set_forces(g);
        parts.hanging.collect(g, g.force, g.shares);
        for (std::size_t i = 0; i < n; ++i)
          A(i, j) = -g.force[moving[i]] / std::sqrt(g.mass[moving[i] / dim] *
                                                    g.mass[moving[j] / dim]);
      }
      double asymmetric = 0., size = 0.;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < i; ++j) {
          asymmetric = std::max(asymmetric, std::abs(A(i, j) - A(j, i)));
          size = std::max(size, std::abs(A(i, j)));
          A(i, j) = A(j, i) = (A(i, j) + A(j, i)) / 2.;
        }
      EXPECT_LT(asymmetric, 1e-12 * size);
      const double worst =
          highest_frequency(parts.scene.discretization->cells());
      dealii::FullMatrix<double> vectors;
      dealii::Vector<double> values;
      A.compute_eigenvalues_symmetric(0.2 * worst * worst, 4. * worst * worst,
                                      0., values, vectors);
      return std::sqrt(values[values.size() - 1]) / worst;
    }

    TEST(HangingNodes, AreNoFasterThanTheWorstCell)
    {
      const std::vector<std::string> small = {
          "Mesh/upper corner=2, 2", "Mesh/cells=2, 2",
          "Indicator: middle/region=x < 1 && y < 1"};
      const std::vector<std::string> two = {"dimension=3",
                                            "Mesh/type=brick",
                                            "Mesh/lower corner=0, 0, 0",
                                            "Mesh/upper corner=2, 1, 1",
                                            "Mesh/cells=2, 1, 1",
                                            "Indicator: middle/region=x < 1"};
      for (unsigned int p = 1; p <= 4; ++p) {
        auto of_plane = small, of_space = two;
        const auto degree = "Discretization/degree=" + std::to_string(p);
        of_plane.push_back(degree);
        of_space.push_back(degree);
        const double plane = frequency<2>(of_plane);
        RecordProperty("plane" + std::to_string(p), std::to_string(plane));
        EXPECT_LT(plane, 1.) << p;
        EXPECT_GT(plane, 0.5) << p;
        const double space = frequency<3>(of_space);
        RecordProperty("space" + std::to_string(p), std::to_string(space));
        EXPECT_LT(space, 1.) << p;
        EXPECT_GT(space, 0.5) << p;
      }
    }

  } // namespace
} // namespace nsfd::test_hanging_nodes
