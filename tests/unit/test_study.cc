#include "parameters/input_errors.h"
#include "study/case_result.h"
#include "study/convergence.h"
#include "study/study_input.h"
#include "study/study_results.h"
#include "study/variation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

// Studies: what varies, how errors fall, what they cost.

namespace nsfd::test_study
{
  namespace
  {
    using Values = std::vector<std::string>;

    Values expanded(const std::string &text)
    {
      std::string problem;
      const Values values = expand_values(text, problem);
      EXPECT_EQ(problem, "") << text;
      return values;
    }

    std::string problem_with(const std::string &text)
    {
      std::string problem;
      expand_values(text, problem);
      return problem;
    }

    std::vector<StudyPoint> power_law(const double order, const double factor,
                                      const unsigned int n,
                                      const double floor = 0.)
    {
      std::vector<StudyPoint> points;
      for (unsigned int i = 0; i < n; ++i) {
        const double size = std::pow(0.5, i);
        points.push_back({size, factor * std::pow(size, order) + floor,
                          0.01 / size / size, 10. / size});
      }
      return points;
    }

    /** A file in a folder of its own, gone with the object. */
    class TemporaryFile
    {
    public:
      explicit TemporaryFile(const std::string &text)
          : folder_(std::filesystem::temp_directory_path() /
                    ("nsfd_study_" +
                     std::to_string(reinterpret_cast<std::uintptr_t>(this))))
      {
        std::filesystem::create_directories(folder_);
        std::ofstream(name()) << text;
      }
      ~TemporaryFile() { std::filesystem::remove_all(folder_); }
      std::string name() const { return (folder_ / "study.prm").string(); }

    private:
      std::filesystem::path folder_;
    };
  } // namespace

  TEST(StudyVariation, ValuesAndRanges)
  {
    EXPECT_EQ(expanded("1, 2 ,4"), (Values{"1", "2", "4"}));
    EXPECT_EQ(expanded("dual newton, auto"), (Values{"dual newton", "auto"}));
    EXPECT_EQ(expanded("1 us, 0.5 us"), (Values{"1 us", "0.5 us"}));
    EXPECT_EQ(expanded("1..4"), (Values{"1", "2", "3", "4"}));
    EXPECT_EQ(expanded("3..1"), (Values{"3", "2", "1"}));
    EXPECT_EQ(expanded("10..50 by 20"), (Values{"10", "30", "50"}));
    EXPECT_EQ(expanded("10*2^0..3"), (Values{"10", "20", "40", "80"}));
    EXPECT_EQ(expanded("0.4/2^0..2 us"),
              (Values{"0.4 us", "0.2 us", "0.1 us"}));
    EXPECT_EQ(expanded("1e-3*10^-1..1"), (Values{"0.0001", "0.001", "0.01"}));
    EXPECT_EQ(expanded("1, 3..4, 9"), (Values{"1", "3", "4", "9"}));
  }

  TEST(StudyVariation, ListsAsValues)
  {
    EXPECT_EQ(expanded("[8, 1], [16, 1]"), (Values{"8, 1", "16, 1"}));
    EXPECT_EQ(expanded("8, 1; 16, 1"), (Values{"8, 1", "16, 1"}));
    EXPECT_EQ(expanded("[8*2^0..1, 1]"), (Values{"8, 1", "16, 1"}));
    EXPECT_EQ(expanded("[8*2^0..1, 2*2^0..1]"), (Values{"8, 2", "16, 4"}));
    EXPECT_EQ(expanded("max(x, y), between materials [a, b]"),
              (Values{"max(x, y)", "between materials [a, b]"}));
    EXPECT_EQ(expanded("../a.msh, ../b.msh"), (Values{"../a.msh", "../b.msh"}));
  }

  TEST(StudyVariation, WhatIsNoListOfValues)
  {
    EXPECT_NE(problem_with("1, , 2").find("empty"), std::string::npos);
    EXPECT_NE(problem_with("0.5..1").find("integers"), std::string::npos);
    EXPECT_NE(problem_with("[1..2, 1..3]").find("2 and 3"), std::string::npos);
    std::string problem;
    EXPECT_FALSE(parse_variation("Time/theta", problem));
    EXPECT_FALSE(parse_variation("A/a=1,2 & B/b=1,2,3", problem));
    EXPECT_NE(problem.find("2 values and B/b has 3"), std::string::npos)
        << problem;
    EXPECT_FALSE(parse_variation("A/a=1,1", problem));
    EXPECT_NE(problem.find("twice"), std::string::npos) << problem;
    // the same value twice with different others
    EXPECT_TRUE(parse_variation("A/a=1,1,2 & B/b=1,2,2", problem)) << problem;
  }

  TEST(StudyVariation, WhatGoesTogether)
  {
    std::string problem;
    const auto variation = parse_variation(
        "Mesh/refinements=0..2 & Time/step=4/2^0..2 us & Time/theta=0.5",
        problem);
    ASSERT_TRUE(variation) << problem;
    EXPECT_EQ(variation->name, "refinements");
    EXPECT_EQ(variation->size(), 3u);
    ASSERT_EQ(variation->parameters.size(), 3u);
    EXPECT_EQ(Variation::value(variation->parameters[1], 2), "1 us");
    EXPECT_EQ(Variation::value(variation->parameters[2], 2), "0.5");
    // a condition with && is one value
    const auto condition =
        parse_variation("Interface: a/where=x < 1 && y < 1, all", problem);
    ASSERT_TRUE(condition) << problem;
    EXPECT_EQ(condition->parameters.size(), 1u);
    EXPECT_EQ(condition->parameters[0].values[0], "x < 1 && y < 1");
  }

  TEST(StudyVariation, CombinationsAndTheirFolders)
  {
    std::string problem;
    const auto make = [&problem](const char *text) {
      return *parse_variation(text, problem);
    };
    const auto all =
        combine({make("Discretization/degree=1,2"),
                 make("Mesh/cells=[8, 1],[16, 1]"), make("Time/theta=0.5")});
    ASSERT_EQ(all.size(), 4u);
    EXPECT_EQ(all[0].name, "degree=1_cells=8-1");
    EXPECT_EQ(all[3].name, "degree=2_cells=16-1");
    EXPECT_EQ(all[1].index, (std::vector<std::size_t>{0, 1, 0}));
    ASSERT_EQ(all[1].parameters.size(), 3u);
    EXPECT_EQ(all[1].parameters[1].second, "16, 1");
    EXPECT_EQ(all[1].parameters[2].first, "Time/theta");
    // nothing that a shell or a file system reads, no two alike
    const auto odd = combine({make("Loads/gravity=[0, -1],[0. -1]; ../x $y")});
    for (const Combination &one : odd)
      EXPECT_EQ(one.name.find_first_of("/ $\\'\"*?"), std::string::npos)
          << one.name;
    const auto alike = combine({make("Solver/method=a b,a  b,a/b")});
    EXPECT_NE(alike[0].name, alike[1].name);
    EXPECT_NE(alike[1].name, alike[2].name);
  }

  TEST(StudyConvergence, OrderOfAPowerLaw)
  {
    const OrderFit fit = fit_order(power_law(2.5, 3., 6));
    ASSERT_TRUE(fit.order);
    EXPECT_NEAR(*fit.order, 2.5, 1e-12);
    EXPECT_EQ(fit.n_fitted, 6u);
    EXPECT_FALSE(fit.level);
    ASSERT_EQ(fit.rates.size(), 5u);
    EXPECT_NEAR(fit.rates[4], 2.5, 1e-12);
    // two points have a rate, not an order
    EXPECT_FALSE(fit_order(power_law(1., 1., 2)).order);
    // zeros and NaN are no points
    auto points = power_law(1., 1., 4);
    points.push_back({0.01, 0., 1., 1.});
    points.push_back({0.01, std::nan(""), 1., 1.});
    EXPECT_NEAR(*fit_order(points).order, 1., 1e-12);
  }

  // 2^-2i + 2^-13: the last rates are 0.4 and less of order 2.
  TEST(StudyConvergence, WhereAnErrorLevelsOff)
  {
    const auto points = power_law(2., 1., 10, std::pow(2., -13));
    const OrderFit fit = fit_order(points);
    ASSERT_TRUE(fit.level);
    EXPECT_DOUBLE_EQ(*fit.level, points.back().error);
    EXPECT_LT(fit.n_fitted, 9u);
    EXPECT_GE(fit.n_fitted, 6u);
    EXPECT_NEAR(*fit.order, 2., 0.15);
    // a constant error has order 0 and no level: it never fell
    const OrderFit constant = fit_order(power_law(0., 1., 5));
    EXPECT_FALSE(constant.level);
    EXPECT_NEAR(*constant.order, 0., 1e-12);
    const OrderFit exact = fit_order(power_law(0., 1e-14, 5));
    EXPECT_TRUE(exact.round_off);
    EXPECT_FALSE(exact.order);
  }

  TEST(StudyConvergence, Verdicts)
  {
    const OrderFit second = fit_order(power_law(2., 1., 5));
    EXPECT_EQ(judge(second, {}, 0.15), OrderVerdict::none);
    EXPECT_EQ(judge(second, 2.1, 0.15), OrderVerdict::reached);
    EXPECT_EQ(judge(second, 2.2, 0.15), OrderVerdict::below);
    EXPECT_EQ(judge(second, 1.8, 0.15), OrderVerdict::above);
    EXPECT_EQ(judge(fit_order(power_law(2., 1., 2)), 2., 0.15),
              OrderVerdict::too_few);
  }

  TEST(StudyConvergence, LeastSquaresByHand)
  {
    // y = 1, 2, 4 over 0, 1, 2: slope 3/2, offset 5/6
    const Line line = least_squares({0., 1., 2.}, {1., 2., 4.});
    EXPECT_DOUBLE_EQ(line.slope, 1.5);
    EXPECT_NEAR(line.offset, 5. / 6., 1e-15);
  }

  TEST(StudyConvergence, EnvelopeAndCosts)
  {
    const std::vector<StudyPoint> points = {{1., 1e-1, 1., 0.},
                                            {1., 2e-1, 2., 0.}, // beaten
                                            {1., 1e-3, 100., 0.},
                                            {1., 1e-3, 300., 0.}, // beaten
                                            {1., 0., 1., 0.}};    // no error
    const auto envelope = lower_envelope(points);
    ASSERT_EQ(envelope.size(), 2u);
    EXPECT_EQ(envelope[0].seconds, 1.);
    EXPECT_EQ(envelope[1].seconds, 100.);
    // half of the way from 1e-1 to 1e-3 in log, hence from 1 s to 100 s
    const CostOfError half = cost_of_error(points, 1e-2);
    EXPECT_TRUE(half.reached);
    EXPECT_FALSE(half.at_most);
    EXPECT_NEAR(half.seconds, 10., 1e-9);
    EXPECT_NEAR(cost_of_error(points, 1e-3).seconds, 100., 1e-9);
    EXPECT_FALSE(cost_of_error(points, 1e-4).reached);
    EXPECT_TRUE(cost_of_error(points, 0.5).at_most);
    EXPECT_FALSE(cost_of_error(points, 0.1).at_most);
    EXPECT_EQ(cost_of_error(points, 0.1).seconds, 1.);
  }

  TEST(StudyConvergence, MedianAndSpread)
  {
    EXPECT_EQ(median({}), 0.);
    EXPECT_EQ(median({3., 1., 2.}), 2.);
    EXPECT_EQ(median({4., 1., 2., 3.}), 2.5);
    CaseResult result;
    result.solve = {2., 1., 3.};
    EXPECT_EQ(solve_spread(result), 1.);
  }

  TEST(StudyFormula, NamesAndProblems)
  {
    std::string problem;
    EXPECT_EQ(evaluate("degree + 1", {{"degree", 3.}}, problem), 4.);
    EXPECT_EQ(evaluate("2^(-refinements)", {{"refinements", 2.}}, problem),
              0.25);
    EXPECT_FALSE(evaluate("degre + 1", {{"degree", 3.}}, problem));
    EXPECT_NE(problem.find("known are degree"), std::string::npos) << problem;
    EXPECT_FALSE(evaluate("1/degree", {{"degree", 0.}}, problem));
  }

  TEST(StudyInputTest, SectionsOfAFile)
  {
    const TemporaryFile file("# study - a test.\n"
                             "subsection Vary: mesh\n"
                             "  set Mesh/cells = [4*2^0..2, 1]\n"
                             "end\n"
                             "subsection Study\n"
                             "  set repeats = 3\n"
                             "  set expected orders = energy: 1, "
                             "displacement_L2: degree + 1\n"
                             "end\n");
    EXPECT_TRUE(is_study(file.name(), {}));
    InputErrors errors;
    const auto study = read_study(file.name(), {"Study/jobs=2"},
                                  {"Discretization/degree=1,2"}, errors);
    ASSERT_TRUE(study) << errors.report();
    EXPECT_EQ(study->repeats, 3u);
    EXPECT_EQ(study->jobs, 2u);
    EXPECT_EQ(study->directory, "output/study");
    ASSERT_EQ(study->variations.size(), 2u);
    EXPECT_EQ(study->abscissa, 0);
    EXPECT_EQ(study->expected_orders.at("displacement_L2"), "degree + 1");
    EXPECT_EQ(study->targets.size(), 3u);
  }

  TEST(StudyInputTest, MistakesAtTheirPlaces)
  {
    const TemporaryFile file("subsection Vary: mesh\n"
                             "  set Mesh/cells = 1, 2, 2\n"
                             "end\n"
                             "subsection Study\n"
                             "  set repeat = 3\n"
                             "  set expected orders = energy\n"
                             "  set abscissa = mush\n"
                             "end\n");
    InputErrors errors;
    EXPECT_FALSE(read_study(file.name(), {}, {"Time/theta"}, errors));
    const std::string report = errors.report();
    for (const char *message :
         {"study.prm:1: error: the value `2` of Mesh/cells stands twice",
          "study.prm:5: error", "did you mean `repeats`?",
          "study.prm:6: error: `energy` has no `:`",
          "study.prm:7: error: nothing called `mush` varies",
          "`Time/theta` assigns nothing"})
      EXPECT_NE(report.find(message), std::string::npos) << message << "\n"
                                                         << report;
  }

  TEST(StudyInputTest, EveryCombinationIsChecked)
  {
    const TemporaryFile file("# bar - two cells.\n"
                             "subsection Mesh\n"
                             "  set lower corner = 0, 0\n"
                             "  set upper corner = 2, 1\n"
                             "  set cells        = 2, 1\n"
                             "end\n"
                             "subsection Material: bar\n"
                             "  set Young modulus = 1\n"
                             "  set Poisson ratio = 0\n"
                             "  set density       = 1\n"
                             "end\n"
                             "subsection Interface: all\n"
                             "  set law = rigid\n"
                             "end\n"
                             "subsection Time\n"
                             "  set end  = 1\n"
                             "  set step = 0.5 courant\n"
                             "end\n");
    InputErrors errors;
    auto study = read_study(file.name(), {},
                            {"Time/theta=0.5,1,3", "Mesh/cells=[2,1],[4,1]",
                             "Discretization/degree=1,x"},
                            errors);
    ASSERT_TRUE(study) << errors.report();
    read_cases(*study, {}, errors);
    // each mistake once, though it is in several combinations
    EXPECT_EQ(errors.n_errors(), 2u) << errors.report();

    InputErrors none;
    study = read_study(file.name(), {},
                       {"Time/theta=0.5,1", "Mesh/cells=[2,1],[4,1]"}, none);
    const auto cases = read_cases(*study, {"Time/end=2"}, none);
    EXPECT_FALSE(none.has_errors()) << none.report();
    ASSERT_EQ(cases.size(), 4u);
    EXPECT_EQ(cases[1].numbers.at("cells"), 4.);
    EXPECT_EQ(cases[2].numbers.at("theta"), 1.);
    EXPECT_EQ(cases[0].half_step, "0.25 courant");
    // complete scenes without pictures, each with its folder
    EXPECT_NE(cases[0].scene.find("set end"), std::string::npos);
    EXPECT_EQ(cases[0].scene.find("Vary"), std::string::npos);
    EXPECT_NE(cases[3].scene.find("output/study/theta=1_cells=4-1"),
              std::string::npos);
  }
} // namespace nsfd::test_study
