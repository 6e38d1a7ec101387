#include "make_scene.h"

#include "discretization/cells.h"
#include "joined/constant_strain.h"
#include "joined/joined_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

// Simplices of explicit steps: shapes that are made when they are asked for,
// forces from gradients and volumes, and the strengths that are looked at.

namespace nsfd::test_constant_strain
{
  namespace
  {
    const std::string body = R"(
subsection Material: bulk
  set Young modulus = 135 GPa
  set Poisson ratio = 0.32
  set density       = 7800 kg/m^3
end
subsection Discretization
  set interface quadrature = gauss lobatto
  set interface points     = 2
  set mass                 = lumped
end
subsection Interface: all
  set law       = brittle
  set stiffness = 1e17 Pa/m
  set toughness = 0.5 J/m^2
end
subsection Time
  set end  = 1 ns
  set step = 0.01 ns
end
)";

    std::vector<std::string> mesh(const unsigned int dim)
    {
      if (dim == 2)
        return {"dimension=2", "Mesh/type=crossed triangles",
                "Mesh/upper corner=10 um, 8 um", "Mesh/cells=3, 3",
                "Mesh/distortion=0.3"};
      return {"dimension=3", "Mesh/type=tetrahedra",
              "Mesh/upper corner=10 um, 8 um, 8 um", "Mesh/cells=2, 2, 2",
              "Mesh/distortion=0.3"};
    }

    std::vector<std::string> with(std::vector<std::string> overrides,
                                  const std::string &one)
    {
      overrides.push_back(one);
      return overrides;
    }

    /** The same mesh twice: with a shape and blocks per class, and without. */
    template <int dim>
    struct Both {
      Both()
          : kept(body, mesh(dim)),
            made(body, with(mesh(dim), "Time/scheme=explicit")),
            joined(*made.discretization),
            groups(joined, std::vector<std::uint8_t>(
                               made.discretization->points().n_points, 1)),
            forces(*made.discretization, FrontViscosity())
      {
        std::mt19937 random(7);
        std::uniform_real_distribution<double> between(-1e-9, 1e-9);
        for (double &value : groups.displacement)
          value = between(random);
        forces.set_forces(groups);
      }

      test::Scene<dim> kept, made;
      JoinedMesh<dim> joined;
      CornerGroups<dim> groups;
      ConstantStrainForces<dim> forces;
    };

    template <typename T>
    void expect_near(const std::vector<T> &a, const std::vector<T> &b,
                     const char *what)
    {
      ASSERT_EQ(a.size(), b.size()) << what;
      double size = 0.;
      for (const T &value : b)
        size = std::max(size, value.norm());
      for (std::size_t i = 0; i < a.size(); ++i)
        EXPECT_LT((a[i] - b[i]).norm(), 1e-14 * size) << what << " " << i;
    }

    template <int dim>
    void compare_shapes()
    {
      const Both<dim> both;
      const auto &kept = both.kept.discretization->cells(),
                 &made = both.made.discretization->cells();
      ASSERT_FALSE(kept.differ());
      ASSERT_TRUE(made.differ());
      ASSERT_EQ(made.bodies.classes.size(), 1u);
      ASSERT_GT(kept.bodies.classes.size(), made.bodies.size() / 2);
      for (std::size_t b = 0; b < made.bodies.size(); ++b) {
        const auto mine = made.shape(b), other = kept.shape(b);
        expect_near(mine->nodes, other->nodes, "nodes");
        expect_near(mine->positions, other->positions, "positions");
        expect_near(mine->gradients, other->gradients, "gradients");
        expect_near(mine->slot_positions, other->slot_positions, "slots");
        expect_near(mine->slot_normals, other->slot_normals, "normals");
        EXPECT_EQ(mine->slot_faces, other->slot_faces);
        EXPECT_EQ(mine->values, other->values);
        EXPECT_EQ(mine->corner_values, other->corner_values);
        for (std::size_t q = 0; q < mine->JxW.size(); ++q)
          EXPECT_NEAR(mine->JxW[q], other->JxW[q], 1e-14 * other->volume);
        EXPECT_NEAR(mine->height, other->height, 1e-14 * other->height);
        // shapes are of corners rounded to 2^-42 of their size, these are not
        EXPECT_NEAR(made.volume(b), kept.volume(b), 0x1p-38 * other->volume);
        EXPECT_LT(made.centre(b).distance(kept.centre(b)),
                  0x1p-38 * made.centre(b).norm());
      }
    }

    TEST(ConstantStrain, ShapesAreThoseOfClasses)
    {
      compare_shapes<2>();
      compare_shapes<3>();
    }

    template <int dim>
    void compare_forces()
    {
      const Both<dim> both;
      const Bodies &bodies = both.kept.discretization->bodies();
      std::vector<double> expected(both.groups.force.size(), 0.);
      double largest = 0.;
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        const BodyClass &of_class = bodies.classes[bodies.class_of[b]];
        const auto first = unsigned(bodies.first_dof[b]);
        const auto place = [&](const unsigned int j) {
          return both.groups.of((first + j) / dim) * dim + j % dim;
        };
        for (unsigned int i = 0; i < of_class.n_dofs; ++i)
          for (unsigned int j = 0; j < of_class.n_dofs; ++j)
            expected[place(i)] -=
                of_class.stiffness(i, j) * both.groups.displacement[place(j)];
      }
      for (const double value : expected)
        largest = std::max(largest, std::abs(value));
      for (std::size_t k = 0; k < expected.size(); ++k)
        EXPECT_NEAR(both.groups.force[k], expected[k], 1e-13 * largest) << k;
    }

    TEST(ConstantStrain, ForcesAreThoseOfBlocks)
    {
      compare_forces<2>();
      compare_forces<3>();
    }

    /** A site is left out only where it is far below its strength. */
    template <int dim>
    void look_at_strengths()
    {
      const Both<dim> both;
      constexpr double weight = 1.5;
      const auto &points = both.made.discretization->points();
      const auto sites_of = [&](const double limit) {
        StrengthSites<dim> sites(points);
        for (const auto &face : points.faces)
          if (!face.boundary)
            sites.add({face.first,
                       face.count,
                       {{unsigned(face.bodies[0]), unsigned(face.bodies[1])}},
                       weight,
                       limit,
                       limit / weight});
        sites.finish(both.made.discretization->bodies().size());
        return sites;
      };
      const auto all = sites_of(0.);
      std::vector<double> expected;
      for (std::size_t k = 0; k < all.size(); ++k)
        expected.push_back(all.square(k, both.forces.traction(all, k)));
      const double most = *std::max_element(expected.begin(), expected.end());
      std::size_t left_out = 0;
      for (const double share : {0., 0.1, 1., 10., 1e10}) {
        const double limit = share * most;
        auto sites = sites_of(limit);
        typename StrengthSites<dim>::Near near;
        both.forces.squared_tractions(sites, near);
        EXPECT_TRUE(std::is_sorted(near.site.begin(), near.site.end()));
        std::vector<double> squares(sites.size(), 0.);
        for (std::size_t n = 0; n < near.site.size(); ++n)
          squares[near.site[n]] = near.square[n];
        for (std::size_t k = 0; k < sites.size(); ++k) {
          const double looked_at = StrengthSites<dim>::looked_at *
                                   StrengthSites<dim>::looked_at * limit;
          if (squares[k] != 0. || expected[k] >= looked_at) {
            EXPECT_NEAR(squares[k], expected[k], 1e-13 * most) << k;
          }
        }
        left_out += sites.size() - near.site.size();
        EXPECT_EQ(*std::max_element(squares.begin(), squares.end()) > 0.,
                  share < 1e10);
        // what is released is not looked at, whatever its traction
        const auto before = near.site;
        for (std::size_t k = 0; k < sites.size(); k += 2)
          sites.release(k);
        both.forces.squared_tractions(sites, near);
        std::vector<unsigned int> odd;
        std::copy_if(before.begin(), before.end(), std::back_inserter(odd),
                     [](const unsigned int k) { return k % 2 == 1; });
        EXPECT_EQ(near.site, odd);
      }
      EXPECT_GT(left_out, all.size()); // of the last round, and others
    }

    TEST(ConstantStrain, StrengthsWithinReachAreLookedAt)
    {
      look_at_strengths<2>();
      look_at_strengths<3>();
    }
  } // namespace
} // namespace nsfd::test_constant_strain
