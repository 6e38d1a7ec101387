#include "nonsmooth/node/point_slopes.h"
#include "one_point.h"

// Derivatives of the local problem of a point, against differences of its
// solutions.

namespace test_point_slopes
{
  using namespace point_law_test;

  /** Largest difference over the largest slope of central differences. */
  double error_of(const OnePoint<3> &point, const std::array<double, 3> &local,
                  const double R, const LocalSolution<3> &solution)
  {
    std::array<double, 9> slopes;
    point_slopes<3>(point.problem, 0, local, R, solution, slopes);
    double largest = 0., error = 0., size = 0.;
    for (const double U : local)
      size = std::max(size, std::abs(U));
    for (unsigned int c = 0; c < 3; ++c) {
      std::array<double, 3> P[2];
      for (unsigned int side = 0; side < 2; ++side) {
        auto moved = local;
        moved[c] += (side == 0 ? -1e-5 : 1e-5) * size;
        P[side] = solve_point<3>(point.problem, 0, moved, R, R, solution.reach)
                      .impulse;
      }
      for (unsigned int r = 0; r < 3; ++r) {
        const double exact = (P[0][r] - P[1][r]) / (2e-5 * size);
        largest = std::max(largest, std::abs(exact));
        error = std::max(error, std::abs(slopes[r * 3 + c] - exact));
      }
    }
    return error / largest;
  }

  // Opening and slip with a damage scalar each: both grow, one of them, none.
  TEST(PointSlopes, OfTwoDamageScalars)
  {
    const std::vector<NamedLaw> laws = {
        {"xu-needleman", {{"strength", "2"}, {"toughness", "1"}}},
        {"ppr", {{"strength", "2"}, {"toughness", "1"}}}};
    for (const auto &entry : laws) {
      SCOPED_TRACE(entry.name);
      std::shared_ptr<const CohesiveLaw> law =
          make_law(entry.name, entry.entries);
      OnePoint<3> point(interaction_of(law, 0.3), PointKind::cohesive,
                        CohesionRule::exact, 0.5);
      point.set_majorants(0.01, 0.01);
      const double R = point.majorant_normal,
                   d = law->toughness() / law->strength(),
                   speed = d / (0.5 * point.problem.time_step);
      for (const double closing : {0., 1.})
        for (const double x_m : {0.05 * d, 0.6 * d})
          for (const double y_m : {0.05 * d, 0.6 * d}) {
            point.problem.opening_max = {x_m};
            point.problem.slip_max = {y_m};
            point.jump = {{0.02 * d, 0.01 * d, -0.02 * d}};
            point.prepare();
            point.problem.contact[0] = 1;
            point.problem.target[0] = -point.jump[0] / (0.01);
            const std::array<double, 3> local = {
                {(closing > 0. ? -0.5 : 0.3) * speed, 0.2 * speed,
                 0.15 * speed}};
            const auto solution =
                solve_point<3>(point.problem, 0, local, R, R, {});
            SCOPED_TRACE(testing::Message()
                         << closing << ", " << x_m / d << ", " << y_m / d);
            EXPECT_EQ(solution.damages,
                      y_m < 0.1 * d || (closing == 0. && x_m < 0.1 * d));
            EXPECT_LT(error_of(point, local, R, solution), 1e-5);
          }
    }
  }
} // namespace test_point_slopes
