#include "make_scene.h"
#include "standing_bar.h"

#include "discretization/cells.h"
#include "joined/block_forces.h"
#include "joined/tensor_forces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace nsfd::test_tensor_forces
{
  namespace
  {
    const std::string body = R"(
subsection Material: bulk
  set Young modulus = 135 GPa
  set Poisson ratio = 0.32
  set density       = 7800 kg/m^3
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 300 MPa
  set toughness = 0.5 J/m^2
end
subsection Time
  set end    = 1 ns
  set step   = auto
  set scheme = explicit
end
)";
    constexpr double size = 10e-6; // m

    /** A square or a cube of that size. */
    std::vector<std::string> mesh(const unsigned int dim,
                                  const std::string &cells,
                                  const unsigned int degree,
                                  const bool distorted)
    {
      std::vector<std::string> set = {
          "Mesh/cells=" + cells,
          "Discretization/degree=" + std::to_string(degree),
          std::string("Mesh/distortion=") + (distorted ? "0.2" : "0")};
      if (dim == 2)
        set.insert(set.end(), {"dimension=2", "Mesh/upper corner=10 um, 10 um",
                               "Mesh/type=rectangle"});
      else
        set.insert(set.end(), {"dimension=3", "Mesh/type=brick",
                               "Mesh/upper corner=10 um, 10 um, 10 um"});
      return set;
    }

    /** Cells that are all joined, and both kinds of forces on them. */
    template <int dim>
    struct Pair : test::Scene<dim> {
      Pair(const std::vector<std::string> &overrides, const double viscosity)
          : test::Scene<dim>(body, overrides), mesh(*this->discretization),
            groups(mesh, all_intact(*this->discretization)),
            front(*this->discretization, viscosity),
            blocks(*this->discretization, mesh, front),
            tensors(*this->discretization, mesh, front)
      {
        EXPECT_TRUE(TensorForces<dim>::fits(*this->discretization));
      }

      static std::vector<std::uint8_t>
      all_intact(const Discretization<dim> &discretization)
      {
        std::vector<std::uint8_t> intact;
        for (const auto &origin : discretization.origins())
          intact.push_back(origin.kind == PointOrigin::Kind::interface);
        return intact;
      }

      /** A face of cells of degree 1, else a point. */
      StrengthSites<dim> sites(const double limit) const
      {
        const auto &points = this->discretization->points();
        const bool whole = this->input->discretization.degree == 1;
        StrengthSites<dim> result(points);
        for (const auto &face : points.faces) {
          if (face.bodies[0] < 0 || face.bodies[1] < 0)
            continue;
          for (unsigned int k = 0; k < (whole ? 1 : face.count); ++k)
            result.add({face.first + k,
                        whole ? face.count : 1,
                        {{unsigned(face.bodies[0]), unsigned(face.bodies[1])}},
                        1.5,
                        limit,
                        limit / 1.5});
        }
        result.finish(this->discretization->bodies().size());
        return result;
      }

      dealii::Point<dim> node(const std::size_t b, const unsigned int i) const
      {
        const auto &cells = this->discretization->cells();
        return cells.place(b, cells.shape(b)->nodes[i]);
      }

      JoinedMesh<dim> mesh;
      CornerGroups<dim> groups;
      FrontViscosity front;
      BlockForces<dim> blocks;
      TensorForces<dim> tensors;
    };

    /** Of all sites, 0 where they are not near. */
    template <int dim>
    std::vector<double> squares_of(const CellForces<dim> &forces,
                                   const StrengthSites<dim> &sites)
    {
      typename StrengthSites<dim>::Near near;
      forces.squared_tractions(sites, near);
      std::vector<double> all(sites.size(), 0.);
      for (std::size_t n = 0; n < near.site.size(); ++n)
        all[near.site[n]] = near.square[n];
      return all;
    }

    double largest(const std::vector<double> &x)
    {
      double result = 0.;
      for (const double value : x)
        result = std::max(result, std::abs(value));
      return result;
    }

    template <int dim>
    void expect_equal(const std::string &cells, const unsigned int degree,
                      const bool distorted)
    {
      SCOPED_TRACE("degree " + std::to_string(degree) +
                   (distorted ? ", distorted" : ""));
      Pair<dim> pair(mesh(dim, cells, degree, distorted), 0.2);
      std::mt19937 random(degree);
      std::uniform_real_distribution<double> between(-1e-9, 1e-9);
      auto &groups = pair.groups;
      std::vector<double> force, expected;
      for (unsigned int step = 0; step < 3;
           ++step) { // tensions from the second
        for (double &value : groups.displacement)
          value = between(random);
        const double h = step == 0 ? 0. : pair.time_step;
        pair.tensors.front().begin_step(h, h);
        pair.tensors.set_forces(groups);
        pair.tensors.front().finish(pair.communicator);
        force = groups.force;
        pair.blocks.front().begin_step(h, h);
        pair.blocks.set_forces(groups);
        pair.blocks.front().finish(pair.communicator);
        expected = groups.force;
        for (std::size_t k = 0; k < force.size(); ++k)
          ASSERT_NEAR(force[k], expected[k], 1e-12 * largest(expected)) << k;
      }
      EXPECT_GT(largest(pair.tensors.front().tension), 0.);
      for (std::size_t i = 0; i < pair.mesh.n_corners(); ++i) {
        const auto mine = pair.tensors.corner_force(i, groups),
                   others = pair.blocks.corner_force(i, groups);
        for (unsigned int c = 0; c < dim; ++c)
          ASSERT_NEAR(mine[c], others[c], 1e-12 * largest(expected));
      }
      const auto all = pair.sites(0.);
      const auto expected_squares = squares_of(pair.blocks, all);
      const double most = largest(expected_squares);
      for (std::size_t k = 0; k < all.size(); ++k) {
        const auto mine = pair.tensors.traction(all, k),
                   others = pair.blocks.traction(all, k);
        for (unsigned int c = 0; c < dim; ++c)
          ASSERT_NEAR(mine[c], others[c], 1e-12 * std::sqrt(most)) << k;
      }
      // what is near a limit is not missed, what is far from it left out
      for (const double share : {0., 0.1, 0.5, 0.99, 1e10}) {
        pair.tensors.set_forces(groups); // nothing is known yet
        const auto squares = squares_of(pair.tensors, pair.sites(share * most));
        ASSERT_EQ(squares.size(), expected_squares.size());
        for (std::size_t k = 0; k < squares.size(); ++k) {
          if (squares[k] != 0. || expected_squares[k] >= share * most) {
            ASSERT_NEAR(squares[k], expected_squares[k], 2e-12 * most);
          }
        }
        EXPECT_EQ(largest(squares) > 0., share < 1e10);
      }
    }

    TEST(TensorForces, EqualThoseOfBlocksOnQuads)
    {
      for (const unsigned int degree : {1u, 2u, 3u, 4u, 5u, 6u, 8u})
        for (const bool distorted : {false, true})
          expect_equal<2>("4, 3", degree, distorted);
    }

    TEST(TensorForces, EqualThoseOfBlocksOnHexes)
    {
      for (const bool distorted : {false, true}) {
        expect_equal<3>("3, 3, 2", 1, distorted);
        expect_equal<3>("2, 3, 2", 2, distorted);
        expect_equal<3>("2, 2, 1", 3, distorted);
        expect_equal<3>("2, 1, 1", 4, distorted);
      }
    }

    // A linear displacement: no force inside, the same stress everywhere.
    template <int dim>
    void expect_patch(const std::string &cells, const unsigned int degree)
    {
      SCOPED_TRACE("degree " + std::to_string(degree));
      Pair<dim> pair(mesh(dim, cells, degree, true), 0.);
      const double H[3][3] = {
          {1e-4, 3e-4, -2e-4}, {-1e-4, 2e-4, 4e-4}, {5e-4, 1e-4, -3e-4}};
      const auto &shapes = pair.discretization->cells();
      std::vector<char> inside(pair.groups.size(), 1);
      for (std::size_t b = 0; b < shapes.bodies.size(); ++b)
        for (unsigned int i = 0; i < shapes.class_shape(b).n_nodes; ++i) {
          const auto x = pair.node(b, i);
          const auto group = pair.groups.of(unsigned(shapes.first_node[b]) + i);
          for (unsigned int c = 0; c < dim; ++c) {
            double u = 0.;
            for (unsigned int d = 0; d < dim; ++d)
              u += H[c][d] * x[d];
            pair.groups.displacement[group * dim + c] = u;
            if (x[c] < 1e-6 * size || x[c] > (1. - 1e-6) * size)
              inside[group] = 0;
          }
        }
      pair.tensors.set_forces(pair.groups);
      const auto &force = pair.groups.force;
      EXPECT_GT(std::count(inside.begin(), inside.end(), 1), 0);
      for (std::size_t k = 0; k < force.size(); ++k)
        if (inside[k / dim]) { // round-off grows with degree^2
          ASSERT_LT(std::abs(force[k]), 1e-11 * largest(force)) << k;
        }
      const double E = 135e9, nu = 0.32, mu = E / (2. * (1. + nu)),
                   lambda = E * nu / ((1. + nu) * (1. - 2. * nu));
      double trace = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        trace += H[c][c];
      const auto sites = pair.sites(0.);
      for (std::size_t k = 0; k < sites.size() && degree > 1; ++k) {
        const double *n = sites.normal(k);
        const auto t = pair.tensors.traction(sites, k);
        for (unsigned int c = 0; c < dim; ++c) {
          double expected = lambda * trace * n[c];
          for (unsigned int d = 0; d < dim; ++d)
            expected += mu * (H[c][d] + H[d][c]) * n[d];
          ASSERT_NEAR(t[c], expected, 1e-11 * E * 5e-4) << k;
        }
      }
    }

    TEST(TensorForces, PassThePatchTest)
    {
      for (const unsigned int degree : {1u, 2u, 3u, 4u, 7u})
        expect_patch<2>("3, 3", degree);
      expect_patch<3>("3, 2, 2", 1);
      expect_patch<3>("2, 2, 2", 2);
      expect_patch<3>("2, 2, 2", 3);
    }

    /**
     * L2 error of a standing wave u = sin(pi t) cos(pi x) / pi, n cells to its
     * half length, against what the leapfrog makes of its exact shape:
     * A sin(w t), sin(w h/2) = pi h/2, A sin(w h) = h.
     */
    template <int dim>
    double wave_error(const unsigned int n, const unsigned int degree)
    {
      const std::string cells =
          std::to_string(n) + (dim == 2 ? ", 1" : ", 1, 1");
      test::Scene<dim> scene(
          test::standing_bar,
          {"Time/end=1", "Time/front viscosity=0",
           "dimension=" + std::to_string(dim), "Mesh/cells=" + cells,
           dim == 2 ? "Mesh/upper corner=1, 0.2"
                    : "Mesh/upper corner=1, 0.2, 0.2",
           dim == 2 ? "Mesh/type=rectangle" : "Mesh/type=brick",
           "Discretization/degree=" + std::to_string(degree)});
      State state = scene.leapfrog->start_from(scene.state), next = state;
      const auto n_steps = unsigned(std::ceil(0.4 / scene.time_step));
      const double h = 0.4 / n_steps;
      for (unsigned int k = 0; k < n_steps; ++k) {
        scene.leapfrog->advance(state, h, next, 2);
        std::swap(state, next);
      }
      scene.leapfrog->show(state);
      const double w = 2. / h * std::asin(M_PI * h / 2.),
                   amplitude = h / std::sin(w * h) * std::sin(w * 0.4);
      const auto &of_cells = scene.discretization->cells();
      double error = 0., norm = 0.;
      for (std::size_t b = 0; b < of_cells.bodies.size(); ++b) {
        const auto of_body = of_cells.shape(b);
        const BodyShape<dim> &shape = *of_body;
        const double *u = &state.displacement[of_cells.bodies.first_dof[b]];
        for (std::size_t q = 0; q < shape.JxW.size(); ++q) {
          double value = 0.;
          for (unsigned int i = 0; i < shape.n_nodes; ++i)
            value += shape.values[q * shape.n_nodes + i] * u[i * dim];
          const double exact =
              amplitude *
              std::cos(M_PI * of_cells.place(b, shape.positions[q])[0]);
          error += shape.JxW[q] * (value - exact) * (value - exact);
          norm += shape.JxW[q] * exact * exact;
        }
      }
      return std::sqrt(error / norm);
    }

    template <int dim>
    void expect_order(const unsigned int degree, const unsigned int n)
    {
      SCOPED_TRACE("degree " + std::to_string(degree));
      const double coarse = wave_error<dim>(n, degree),
                   fine = wave_error<dim>(2 * n, degree);
      EXPECT_GT(std::log2(coarse / fine), degree + 0.85);
      EXPECT_LT(std::log2(coarse / fine), degree + 1.6);
      EXPECT_LT(fine, std::pow(0.5, 4. * degree)); // of the amplitude
    }

    TEST(TensorForces, WavesAreOfOrderDegreePlusOne)
    {
      for (const unsigned int degree : {1u, 2u, 3u, 4u})
        expect_order<2>(degree, 4);
      for (const unsigned int degree : {1u, 2u, 3u, 4u})
        expect_order<3>(degree, 4);
    }
  } // namespace
} // namespace nsfd::test_tensor_forces
