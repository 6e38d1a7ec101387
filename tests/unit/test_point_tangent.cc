#include "one_point.h"

#include "nonsmooth/point_tangent.h"

#include <algorithm>

namespace point_law_test::test_point_tangent
{
  namespace
  {
    /** T of the point by central differences of solve_point(). */
    template <int dim>
    std::array<double, dim * dim>
    central_differences(const OnePoint<dim> &point,
                        const std::array<double, dim> &local)
    {
      std::array<double, dim * dim> T{};
      constexpr double h = 1e-5;
      for (unsigned int c = 0; c < dim; ++c) {
        std::array<double, dim> answers[2];
        for (unsigned int side = 0; side < 2; ++side) {
          auto moved = local;
          moved[c] += side == 0 ? -h : h;
          answers[side] =
              solve_point<dim>(point.problem, 0, moved, point.majorant_normal,
                               point.majorant_tangential, {})
                  .impulse;
        }
        for (unsigned int d = 0; d < dim; ++d)
          T[d * dim + c] = (answers[0][d] - answers[1][d]) / (2. * h);
      }
      return T;
    }

    /** A pressed point that slides, or sticks, with its sliding offset. */
    template <int dim>
    void compare(const Interaction &interaction, const PointKind kind,
                 const double along, const bool symmetric)
    {
      OnePoint<dim> point(interaction, kind, CohesionRule::end_point);
      point.set_majorants(0.4, 0.9);
      point.prepare();
      point.problem.contact = {1};
      point.problem.sliding_offset.assign(dim, 0.);
      point.problem.sliding_offset[dim - 1] = 0.3 * along;
      std::array<double, dim> local{};
      local[0] = -2.;
      local[1] = along;
      if (dim == 3)
        local[dim - 1] = -0.7 * along;
      const auto solution =
          solve_point<dim>(point.problem, 0, local, point.majorant_normal,
                           point.majorant_tangential, {});
      ASSERT_GT(solution.contact_impulse, 0.);
      ASSERT_EQ(solution.status,
                symmetric ? PointStatus::stick : PointStatus::slide);
      std::array<double, dim * dim> T{};
      EXPECT_FALSE(has_difference_quotients<dim>(point.problem, 0, solution));
      EXPECT_EQ(point_tangent<dim>(point.problem, 0, solution, local,
                                   point.majorant_normal,
                                   point.majorant_tangential, T.data()),
                symmetric);
      const auto expected = central_differences<dim>(point, local);
      // second differences of a sliding direction: h^2 = 1e-10
      for (unsigned int k = 0; k < dim * dim; ++k)
        EXPECT_NEAR(T[k], expected[k], 1e-8) << k;
    }

    template <int dim>
    void compare_all()
    {
      Interaction sprung = spring(5., 0.7);
      sprung.friction = 0.4;
      sprung.friction_exponent = 0.; // full friction on what is intact
      for (const double along : {2.5, 1e-3}) {
        const bool sticks = along < 1.;
        compare<dim>(contact_only(0.4), PointKind::free, along, sticks);
        compare<dim>(sprung, PointKind::elastic, along, sticks);
      }
    }
  } // namespace

  // Friction follows the contact impulse: the tangent has a column for it.
  TEST(PointTangent, OfSlidingFrictionInThePlane) { compare_all<2>(); }
  TEST(PointTangent, OfSlidingFrictionInSpace) { compare_all<3>(); }
} // namespace point_law_test::test_point_tangent
