#include "make_scene.h"

#include "core/cost.h"
#include "core/stopwatch.h"
#include "delassus/delassus_cost.h"
#include "nsfd/records/cost_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

// Where time and memory of a run went: every moment and byte once.

using namespace nsfd;

namespace test_explained_cost
{
  void burn(const double seconds)
  {
    const double start = cpu_seconds();
    while (cpu_seconds() - start < seconds)
      ;
  }

  std::map<std::string, CostLine> lines_by_name()
  {
    std::map<std::string, CostLine> result;
    for (const auto &line : cost_lines())
      result[line.name] = line;
    return result;
  }

  TEST(ExplainedCost, InnerScopesDoNotCountTwice)
  {
    begin_costs();
    const double start = cpu_seconds();
    {
      const Charge outer(Cost::solver);
      burn(0.02);
      for (unsigned int k = 0; k < 3; ++k) {
        const Charge inner(Cost::delassus);
        burn(0.02);
      }
    }
    const double passed = cpu_seconds() - start;
    const auto lines = lines_by_name();
    const CostLine &outer = lines.at(cost_name(Cost::solver)),
                   &inner = lines.at(cost_name(Cost::delassus));
    EXPECT_EQ(outer.calls, 1u);
    EXPECT_EQ(inner.calls, 3u);
    EXPECT_EQ(lines.count(cost_name(Cost::laws)), 0u) << "never charged";
    double sum = 0.;
    for (const auto &line : lines)
      sum += line.second.seconds;
    // the lines share out the CPU time since begin_costs()
    EXPECT_GE(sum, passed);
    EXPECT_LE(sum, cpu_seconds() - start + 0.01);
    EXPECT_LT(outer.seconds + inner.seconds, 1.0001 * sum);
    // lengths of burns; how busy the machine is decides about their share
    EXPECT_GT(inner.seconds, 0.);
    EXPECT_GT(outer.seconds, 0.);
  }

  TEST(ExplainedCost, MemoryBelongsToWhoTakesIt)
  {
    begin_costs();
    const std::vector<double> first(1 << 20, 1.);
    charge_memory("first");
    {
      const std::vector<double> temporary(1 << 18, 1.);
      charge_memory("second");
    }
    charge_memory("third"); // has only seen memory go
    const auto &lines = memory_lines();
    ASSERT_EQ(lines.size(), 3u);
    const double bytes = sizeof(double) * double(1 << 20);
    EXPECT_EQ(lines[0].first, "first");
    // an allocator may add a page
    EXPECT_GE(lines[0].second, bytes);
    EXPECT_LT(lines[0].second, bytes + 65536.);
    EXPECT_GE(lines[1].second, bytes / 4.);
    EXPECT_LT(lines[1].second, bytes / 4. + 65536.);
    EXPECT_LT(lines[2].second, 65536.);
    charge_memory("first");
    EXPECT_EQ(memory_lines().size(), 3u);
  }

  /** Two squares, one face of two points: counted by hand. */
  TEST(ExplainedCost, OperationsOfAnApplication)
  {
    test::Scene<2> scene(R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 2, 1
  set cells        = 2, 1
end
subsection Material: solid
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
end
subsection Interface: springs
  set where            = all
  set law              = elastic
  set normal stiffness = 20
end
subsection Time
  set end  = 1
  set step = 0.1
end
)");
    const DelassusCost cost = count_delassus(*scene.delassus);
    // two points on each of four sides, two components
    EXPECT_EQ(cost.rows, 16u);
    // per point two rotations of 4 products and 2 sums, and the jump
    EXPECT_EQ(cost.flops, 2. * 2. * 16. * 16. + 2. * (2. * 6. + 2.));
    // at least what must be moved: block, impulses and velocities
    EXPECT_GE(cost.bytes, 8. * (16. * 16. + 2. * 4. + 2. * 4.));

    const MachineLimits limits = measure_machine(cost);
    EXPECT_GT(limits.copy_bytes_per_second, 0.);
    EXPECT_GT(limits.product_flops_per_second, 0.);
    EXPECT_TRUE(std::isfinite(limits.copy_bytes_per_second));
    EXPECT_TRUE(std::isfinite(limits.product_flops_per_second));
  }

  TEST(ExplainedCost, TheNearerLimit)
  {
    CostRecord cost;
    cost.applications = 10.;
    cost.seconds = 1e-3;
    cost.flops = 1e6;
    cost.bytes = 1e6;
    EXPECT_FALSE(cost.has_limits()) << "not measured";
    cost.copy_bytes_per_second = 1e10;   // allows 0.1 ms
    cost.product_flops_per_second = 2e9; // allows 0.5 ms
    ASSERT_TRUE(cost.has_limits());
    EXPECT_DOUBLE_EQ(cost.share_of_limit(), 0.5);
    EXPECT_FALSE(cost.limited_by_copy());
    cost.copy_bytes_per_second = 1.25e9; // 0.8 ms
    EXPECT_DOUBLE_EQ(cost.share_of_limit(), 0.8);
    EXPECT_TRUE(cost.limited_by_copy());
    const std::string text = cost_text(cost, 100.);
    EXPECT_NE(text.find("80 % of the nearer limit (copy)"), std::string::npos)
        << text;
  }
} // namespace test_explained_cost
