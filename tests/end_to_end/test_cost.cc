#include "compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <ostream>

// A scene does not pay for parts that it does not name.

namespace end_to_end::test_cost
{
  namespace
  {
    struct CostRow {
      std::string name;
      bool friction; ///< of its obstacle
    };

    void PrintTo(const CostRow &row, std::ostream *stream)
    {
      *stream << row.name;
    }

    const std::vector<CostRow> rows = {{"ball", false},
                                       {"incline", true},
                                       {"bar_wall", false},
                                       {"patch_crossed", false}};

    /** A block of the scene that owns no face. */
    std::vector<std::string> idle(const std::string &law)
    {
      return {
          "Interface: nowhere/where=x > 1e9", "Interface: nowhere/law=" + law,
          "Interface: nowhere/strength=1e6", "Interface: nowhere/toughness=1",
          "Interface: nowhere/friction=0.5"};
    }

    class CostTest : public testing::TestWithParam<CostRow>
    {
    };
  } // namespace

  TEST_P(CostTest, WhatIsNotNamedDoesNotRun)
  {
    const Workspace workspace;
    const Result result = good_run(
        workspace, "plain", {scene(GetParam().name), {"Output/fields=false"}});
    ASSERT_TRUE(result.completed());
    EXPECT_EQ(result.counter("cohesive_points"), 0.);
    EXPECT_EQ(result.counter("activation_rounds"), 0.);
    EXPECT_EQ(result.counter("steps_beyond_uniqueness"), 0.);
    EXPECT_EQ(result.counter("friction_points") > 0., GetParam().friction);
    EXPECT_FALSE(result.summary.contains("pressure_work"));
    EXPECT_FALSE(result.summary.contains("viscous_traction_max"));
    // constant loads and steps: assembled once, factorised once
    EXPECT_LE(result.counter("load_assemblies"), 1.);
    EXPECT_LE(result.counter("global_factorisations"), 1.);
    EXPECT_EQ(result.counter("block_factorisations"),
              result.counter("body_classes"));
  }

  // A law that owns no face changes nothing, to the last bit and the last call.
  TEST_P(CostTest, AnIdleLawCostsNothing)
  {
    const Workspace workspace;
    const Result plain = good_run(
        workspace, "plain", {scene(GetParam().name), {"Output/fields=false"}});
    ASSERT_TRUE(plain.completed());
    for (const std::string law : {"michel-suquet", "camacho-ortiz"}) {
      SCOPED_TRACE(law);
      auto set = idle(law);
      set.push_back("Output/fields=false");
      const Result named =
          good_run(workspace, law, {scene(GetParam().name), set});
      ASSERT_TRUE(named.completed());
      EXPECT_EQ(plain.history_text, named.history_text);
      EXPECT_EQ(plain.summary["counters"], named.summary["counters"]);
    }
  }

  // Short steps of many unknowns take conjugate gradients, no factor. A bar
  // without transverse strain, pushed by p from t = 0, moves with p / (rho c)
  // behind its front: the work of the load is A p^2 t / (rho c).
  TEST(ShortSteps, ManyCellsNeedNoFactor)
  {
    const Workspace workspace;
    const std::vector<std::string> block = {
        "Mesh/upper corner=50 mm, 50 mm, 50 mm",
        "Mesh/cells=20, 16, 16",
        "Material: concrete/Poisson ratio=0",
        "Boundary: left/traction x=1 MPa",
        "Boundary: right/velocity x=0",
        "Time/end=11 us",
        "Output/fields=false"};
    const double c = std::sqrt(30e9 / 2400.),
                 work = 2.5e-3 * 1e12 * 11e-6 / (2400. * c);
    for (const unsigned int ranks : {1u, 2u}) {
      SCOPED_TRACE(ranks);
      const Result result = good_run(workspace, std::to_string(ranks),
                                     {benchmark("spall_bar"), block, ranks});
      ASSERT_TRUE(result.completed());
      EXPECT_EQ(result.counter("global_factorisations"), 0.);
      EXPECT_GT(result.counter("inner_iterations"), 0.);
      EXPECT_NEAR(result.number("work"), work, 0.02 * work);
      EXPECT_LT(result.number("ledger_defect_max"), 1e-11);
    }
  }

  // Grains that come apart in short steps: no factor though points soften,
  // slide and close in every step, and nothing is given by it.
  TEST(ShortSteps, CracksInThePlaneNeedNoFactor)
  {
    const Workspace workspace;
    const Result result = good_run(
        workspace, "grains",
        {benchmark("alumina_grains"),
         {"Time/scheme=moreau-jean", "Time/end=20 ns", "Output/fields=false"}});
    ASSERT_TRUE(result.completed());
    EXPECT_EQ(result.counter("global_factorisations"), 0.);
    EXPECT_EQ(result.counter("rejected_steps"), 0.);
    EXPECT_GT(result.counter("switches_to_multipliers"), 0.)
        << "the method of multipliers is not in this scene";
    EXPECT_GT(result.dissipated("damage"), 0.);
    expect_below("Newton steps per step",
                 result.counter("newton") / result.number("steps"), 8.,
                 "twice the count, 3.7: chaos may change it");
    EXPECT_LT(result.number("ledger_defect_max"), 1e-11);
  }

  INSTANTIATE_TEST_SUITE_P(Table, CostTest, testing::ValuesIn(rows),
                           [](const auto &info) { return info.param.name; });
} // namespace end_to_end::test_cost
