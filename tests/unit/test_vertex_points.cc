#include "make_scene.h"
#include "named_mesh_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// `gauss lobatto` on the triangular faces of tetrahedra: points at vertices.

namespace nsfd::test_vertex_points
{
  namespace
  {
    const std::string block = R"(
set dimension = 3
subsection Mesh
  set type         = tetrahedra
  set upper corner = 3, 2, 2
  set cells        = 2, 2, 1
  set distortion   = 0.25
end
subsection Discretization
  set interface quadrature = gauss lobatto
end
subsection Material: solid
  set Young modulus      = 1
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = exp(-((x - 2)^2 + (y - 1)^2))
end
subsection Interface: all
  set law                  = elastic
  set normal stiffness     = 21
  set tangential stiffness = 7
end
subsection Boundary: bottom
  set velocity y = 0
end
subsection Obstacle: floor
  set where  = bottom
  set point  = 0, 0, 0
  set normal = 0, 1, 0
end
subsection Time
  set end   = 1000
  set step  = 0.5 courant
  set theta = 0.5
end
)";

    using Vector = dealii::Tensor<1, 3>;

    Vector at(const std::vector<double> &values, const std::size_t place)
    {
      Vector v;
      for (unsigned int c = 0; c < 3; ++c)
        v[c] = values[place + c];
      return v;
    }
  } // namespace

  TEST(VertexPoints, AreTheVerticesWithThirdsOfTheArea)
  {
    const test::Scene<3> scene(block);
    const auto &points = scene.discretization->points();
    const auto &cells = scene.discretization->cells();
    ASSERT_FALSE(points.faces.empty());
    for (const auto &face : points.faces) {
      ASSERT_EQ(face.count, 3u);
      const unsigned int f = face.first;
      const Vector a = at(points.position, 3 * f),
                   b = at(points.position, 3 * f + 3),
                   c = at(points.position, 3 * f + 6);
      const double area = .5 * cross_product_3d(b - a, c - a).norm();
      EXPECT_GT(area, 0.);
      for (unsigned int i = f; i < f + 3; ++i) {
        EXPECT_NEAR(points.weight[i], area / 3., 1e-14 * area);
        for (const int body : face.bodies) {
          if (body < 0)
            continue;
          // the bits of the mesh, so that faces at a vertex agree
          const auto &corners = cells.corners[body];
          EXPECT_TRUE(std::any_of(
              corners.begin(), corners.end(), [&](const auto &corner) {
                return Vector(corner) == at(points.position, 3 * i);
              }));
        }
      }
    }
  }

  // Three faces of a cell meet at a vertex: a point must not take the place of
  // another face, whose normal and area are others.
  TEST(VertexPoints, BothSidesTakeThemOnTheirOwnFace)
  {
    const test::Scene<3> scene(block);
    const auto &points = scene.discretization->points();
    const auto &cells = scene.discretization->cells();
    const auto &bodies = scene.discretization->bodies();
    unsigned int n_found = 0;
    for (std::size_t b = 0; b + 1 < bodies.first_slot.size(); ++b)
      for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
           ++s) {
        const unsigned int i = bodies.slot_point[s];
        if (i >= points.n_points)
          continue;
        ++n_found;
        const auto of_body = cells.shape(b);
        const BodyShape<3> &shape = *of_body;
        const std::size_t local = s - bodies.first_slot[b];
        const Vector x =
            Vector(cells.corners[b][0]) + Vector(shape.slot_positions[local]);
        EXPECT_LT((x - at(points.position, 3 * i)).norm(), 1e-12);
        const Vector normal = shape.slot_normals[local];
        EXPECT_NEAR(normal.norm(), points.weight[i], 1e-12);
        if (points.faces[points.face_of[i]].boundary)
          continue;
        EXPECT_NEAR(
            normal *
                Vector(dealii::ArrayView<const double>(points.axes(i), 3)) /
                normal.norm(),
            -bodies.slot_sign[s], 1e-12);
      }
    unsigned int n_sides = 0;
    for (const auto &face : points.faces)
      n_sides += face.count * ((face.bodies[0] >= 0) + (face.bodies[1] >= 0));
    EXPECT_EQ(n_found + bodies.extra_points.size(), n_sides);
  }

  // Elastic springs and a floor that is not reached keep the energy.
  TEST(VertexPoints, KeepTheEnergy)
  {
    test::Scene<3> scene(block, {"Obstacle: floor/point=0, -1, 0"});
    const double energy = scene.energy();
    for (unsigned int step = 0; step < 20; ++step)
      scene.advance();
    EXPECT_NEAR(scene.energy(), energy, 1e-10 * energy);
  }

  TEST(VertexPoints, OtherRulesAreRefused)
  {
    const auto errors = [](const std::string &mesh, const std::string &more) {
      return test::errors_of(test::mesh_scene(
          3, mesh, "subsection Discretization\n" + more + "end\n"));
    };
    const std::string tetrahedra = "set type = tetrahedra\n"
                                   "set upper corner = 1, 1, 1\n"
                                   "set cells = 1, 1, 1\n",
                      lobatto = "set interface quadrature = gauss lobatto\n";
    EXPECT_EQ(errors(tetrahedra, lobatto), "");
    EXPECT_EQ(errors(tetrahedra + "set split simplices = true\n",
                     lobatto + "set interface points = 3\n"),
              "");
    for (const std::string entry :
         {"set interface points = 1\n", "set interface points = 3\n",
          "set degree = 2\n"}) {
      const std::string text = errors(tetrahedra, lobatto + entry);
      EXPECT_NE(text.find("on the faces of tetrahedra the rule `gauss "
                          "lobatto` has 2 per direction, the three vertices"),
                std::string::npos)
          << text;
    }
    EXPECT_EQ(errors(tetrahedra, lobatto + "set degree = 2\n"
                                           "set interface points = 2\n"),
              "");
    EXPECT_NE(errors(tetrahedra, "set interface quadrature = quarter points\n")
                  .find("no points on the triangular faces"),
              std::string::npos);
  }
} // namespace nsfd::test_vertex_points
