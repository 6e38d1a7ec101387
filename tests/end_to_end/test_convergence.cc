#include "compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

// Errors of verification scenes fall with mesh and step as they should.

namespace end_to_end::test_convergence
{
  namespace
  {
    /** Mean order over resolutions that are four times as fine each. */
    double order(const std::vector<double> &errors)
    {
      return std::log2(errors.front() / errors.back()) /
             (2. * double(errors.size() - 1));
    }

    struct LawOfStep {
      std::string law;
      double order;
    };

    void PrintTo(const LawOfStep &row, std::ostream *stream)
    {
      *stream << row.law;
    }

    class InterfaceLawConvergenceTest : public testing::TestWithParam<LawOfStep>
    {
    };
  } // namespace

  // Mesh and step together. A law with a stiffness averages over the passage
  // of the front: the break inside a step decides, order 1. An extrinsic face
  // opens once the front, of order 2/3 for a scheme of order 2, has come.
  TEST_P(InterfaceLawConvergenceTest, BreakTimeAndImpulse)
  {
    const Workspace workspace;
    std::vector<double> time, impulse;
    for (const unsigned int n : {20u, 80u, 320u}) {
      const std::string cells = std::to_string(n);
      const Result result =
          good_run(workspace, cells,
                   {scene("interface_law"),
                    {"Interface: middle/law=" + GetParam().law,
                     "Mesh/cells=" + cells + ", 1", "Output/fields=false"}});
      ASSERT_TRUE(result.completed());
      time.push_back(result.error("break_time"));
      impulse.push_back(result.error("impulse"));
      expect_below(cells + " cells: damage", result.error("damage"), 1e-9);
    }
    for (const auto &[name, errors] :
         {std::pair("break time", time), {"impulse", impulse}}) {
      std::printf("  %-12s %.2e %.2e %.2e, order %.2f\n", name, errors[0],
                  errors[1], errors[2], order(errors));
      EXPECT_GT(order(errors), GetParam().order) << name;
    }
  }

  INSTANTIATE_TEST_SUITE_P(Laws, InterfaceLawConvergenceTest,
                           testing::Values(LawOfStep{"michel-suquet", 1.},
                                           LawOfStep{"camacho-ortiz", 0.66}),
                           [](const auto &info) {
                             std::string name = info.param.law;
                             for (char &c : name)
                               c = c == '-' ? '_' : c;
                             return name;
                           });
} // namespace end_to_end::test_convergence
