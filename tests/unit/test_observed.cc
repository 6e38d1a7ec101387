#include "study/distribution.h"
#include "study/observed.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>

namespace test_observed
{
  using namespace nsfd;
  namespace fs = std::filesystem;

  /** The quantiles of a Weibull distribution at equal distances. */
  std::vector<double> quantiles(const double shape, const double scale,
                                const std::size_t n)
  {
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i)
      values.push_back(
          scale *
          std::pow(-std::log1p(-(double(i) + 0.5) / double(n)), 1. / shape));
    return values;
  }

  // What the fit is made of comes back; the tails of n quantiles are cut off,
  // which costs a few 1/n.
  TEST(WeibullFit, FindsItsOwnQuantiles)
  {
    for (const double shape : {0.5, 1., 3.5, 40.})
      for (const double scale : {1e-6, 1., 3e8}) {
        const auto fit = weibull_fit(quantiles(shape, scale, 2000));
        ASSERT_TRUE(fit);
        EXPECT_NEAR(fit->shape / shape, 1., 5e-3);
        EXPECT_NEAR(fit->scale / scale, 1., 5e-3);
      }
  }

  // Its two conditions, to round-off.
  TEST(WeibullFit, IsTheMostLikelyOne)
  {
    const std::vector<double> x = {3., 5., 5.5, 9., 14., 14.5, 30.};
    const auto fit = weibull_fit(x);
    ASSERT_TRUE(fit);
    double sum = 0., weighted = 0., mean = 0.;
    for (const double value : x) {
      const double power = std::pow(value / fit->scale, fit->shape);
      sum += power;
      weighted += power * std::log(value);
      mean += std::log(value) / double(x.size());
    }
    EXPECT_NEAR(sum / double(x.size()), 1., 1e-12);
    EXPECT_NEAR(weighted / sum - mean, 1. / fit->shape, 1e-12);
  }

  TEST(WeibullFit, HasNoneWhereThereIsNone)
  {
    EXPECT_FALSE(weibull_fit({1., 2.}));
    EXPECT_FALSE(weibull_fit({1., 2., 0.}));
    EXPECT_FALSE(weibull_fit({1., -2., 3.}));
    EXPECT_FALSE(weibull_fit({2., 2., 2.}));
  }

  TEST(Histogram, CountsEveryValueOnce)
  {
    const std::vector<double> values = quantiles(2., 5., 200);
    const Histogram histogram = histogram_of(values);
    ASSERT_EQ(histogram.edges.size(), histogram.counts.size() + 1);
    EXPECT_EQ(
        std::accumulate(histogram.counts.begin(), histogram.counts.end(), 0.),
        200.);
    EXPECT_GT(histogram.counts.size(), 5u);
    EXPECT_EQ(histogram.edges.front(), values.front());
    EXPECT_EQ(histogram.edges.back(), values.back());
    EXPECT_EQ(histogram_of({3., 3.}).counts, std::vector<double>{2.});
    EXPECT_TRUE(histogram_of({}).counts.empty());
  }

  // symmetric about one half
  TEST(MedianRanks, AreThoseOfBenard)
  {
    const std::vector<double> ranks = median_ranks(5);
    EXPECT_NEAR(ranks[0], 0.7 / 5.4, 1e-15);
    EXPECT_NEAR(ranks[2], 0.5, 1e-15);
    EXPECT_NEAR(ranks[0] + ranks[4], 1., 1e-15);
  }

  TEST(Observed, ReadsSummariesAndColumns)
  {
    const fs::path folder = fs::temp_directory_path() /
                            ("nsfd_observed_" + std::to_string(getpid()));
    fs::create_directories(folder / "observables");
    std::ofstream(folder / "summary.json")
        << R"({"fragments": 7, "dissipated": {"damage": 2.5}, "verdict": "x"})";
    std::ofstream(folder / "history.csv")
        << "step,force\n0,0\n1,-4\n2,3\n3,nan\n";
    std::ofstream(folder / "observables/tip.csv")
        << "step,length\n0,1\n1,1.5\n2,1.25\n";
    std::string problem;
    const auto quantities = parse_observed(
        "fragments, dissipated/damage, verdict, absent, max force, min force, "
        "range force, final tip/length, max tip/absent, max other/length",
        problem);
    EXPECT_EQ(problem, "");
    std::map<std::string, double> values;
    observe(quantities, folder.string(), values);
    const std::map<std::string, double> expected = {
        {"fragments", 7.},   {"dissipated/damage", 2.5},
        {"max_force", 3.},   {"min_force", -4.},
        {"range_force", 7.}, {"final_tip/length", 1.25}};
    EXPECT_EQ(values, expected);
    fs::remove_all(folder);
  }

  TEST(Observed, SaysWhatIsWrong)
  {
    for (const char *text : {"largest force", "", " , "}) {
      std::string problem;
      parse_observed(text, problem);
      EXPECT_NE(problem, "") << text;
    }
  }
} // namespace test_observed
