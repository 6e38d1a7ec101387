#include "bodies/row_geometry.h"
#include "contact_detection/facet_geometry.h"

#include "nsfd/scene/scene_input.h"

#include <gtest/gtest.h>

#include <random>

using namespace nsfd;

// Contacts of nodes with facets: how the distance changes with velocities.

namespace test_row_geometry
{
  namespace
  {
    template <int dim>
    using Vector = dealii::Tensor<1, dim>;

    template <int dim>
    struct Moving {
      std::vector<Vector<dim>> x, v;
    };

    template <int dim>
    std::vector<double> places(const Moving<dim> &nodes, const double time)
    {
      std::vector<double> result;
      for (std::size_t i = 0; i < nodes.x.size(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          result.push_back(nodes.x[i][d] + time * nodes.v[i][d]);
      return result;
    }

    /**
     * The node (the last one) is on the surface of the facet of the others, or
     * past its ends. The gap is measured along the mean normal m; with the
     * normal n of the surface there, m n dg/dt = n (v - sum of w v), whatever
     * slides and turns.
     */
    template <int dim>
    void expect_rate(const Moving<dim> &nodes, const double tolerance)
    {
      const unsigned int n = unsigned(nodes.x.size()) - 1;
      typename Surfaces<dim>::Facet facet;
      facet.n_vertices = n;
      for (unsigned int v = 0; v < n; ++v)
        facet.vertex[v] = v;
      const auto gap = [&](const double time) {
        const auto x = places(nodes, time);
        const auto plane = plane_of<dim>(facet, x.data());
        const auto y = place<dim>(x.data(), n);
        return dot(
            plane.normal,
            difference(y,
                       extended_place<dim>(facet, plane, x.data(), y).place));
      };
      const double step = 1e-5, rate = (gap(step) - gap(-step)) / (2. * step);

      const auto x = places(nodes, 0.);
      const auto plane = plane_of<dim>(facet, x.data());
      MovingRow<dim> row;
      row.partner = MovingRow<dim>::Partner::facet;
      row.node = n;
      row.n_facet = n;
      row.weights =
          extended_place<dim>(facet, plane, x.data(), place<dim>(x.data(), n))
              .weights;
      RowEnds<dim> ends;
      ends.of_2[0] = dealii::Point<dim>(nodes.x[n]);
      Vector<dim> away = nodes.v[n], mean;
      for (unsigned int v = 0; v < n; ++v) {
        ends.of_1[v] = dealii::Point<dim>(nodes.x[v]);
        away -= row.weights[v] * nodes.v[v];
      }
      for (unsigned int d = 0; d < dim; ++d)
        mean[d] = plane.normal[d];
      ASSERT_NEAR(gap(0.), 0., 1e-13);
      const auto normal = row_normal(SceneInput(), row, ends, {});
      EXPECT_NEAR(normal * mean * rate, normal * away, tolerance);
    }

    template <int dim>
    void set_velocities(Moving<dim> &nodes, std::mt19937 &dice)
    {
      std::uniform_real_distribution<double> between(-1., 1.);
      nodes.v.resize(nodes.x.size());
      for (auto &v : nodes.v)
        for (unsigned int d = 0; d < dim; ++d)
          v[d] = between(dice);
    }
  } // namespace

  // central differences of 1e-5 of lengths and velocities of 1: 1e-9
  TEST(RowGeometry, GapOfANodeFollowsItsRow)
  {
    std::mt19937 dice(7);
    for (const double s : {0.4, 1.02}) { // inside, and past the end
      Moving<2> line;
      line.x = {Vector<2>({2., 0.1}), Vector<2>({0., 0.}), Vector<2>()};
      line.x[2] = (1. - s) * line.x[0] + s * line.x[1];
      set_velocities(line, dice);
      expect_rate<2>(line, 1e-8);

      Moving<3> triangle;
      triangle.x = {Vector<3>({0., 0., 0.}), Vector<3>({2., 0.1, 0.3}),
                    Vector<3>({0.2, 1.5, -0.2}), Vector<3>()};
      triangle.x[3] = (1. - s) * triangle.x[0] + (s - 0.2) * triangle.x[1] +
                      0.2 * triangle.x[2];
      set_velocities(triangle, dice);
      expect_rate<3>(triangle, 1e-8);

      Moving<3> warped; // by a tenth of its sides
      warped.x = {Vector<3>({0., 0., 0.1}), Vector<3>({2., 0.2, -0.1}),
                  Vector<3>({1.7, 1.8, 0.12}), Vector<3>({0.1, 1.5, -0.1}),
                  Vector<3>()};
      const double t = 0.3;
      warped.x[4] = (1. - s) * (1. - t) * warped.x[0] +
                    s * (1. - t) * warped.x[1] + s * t * warped.x[2] +
                    (1. - s) * t * warped.x[3];
      set_velocities(warped, dice);
      expect_rate<3>(warped, 1e-8);
    }
  }
} // namespace test_row_geometry
