#include "breaking_plate.h"
#include "make_scene.h"

#include "core/order_free_sum.h"
#include "postprocess/fragment_output.h"
#include "records/fragment_sizes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

// Mass, place, momentum, spin and energy of fragments whose motion is known.

namespace nsfd::test_fragment_sizes
{
  using namespace space;
  using test::Scene;

  // ------------------------------------------------------------------- sums

  TEST(OrderFreeSum, DoesNotKnowTheOrder)
  {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> mantissa(-1., 1.),
        power(-200., 200.);
    std::vector<double> terms;
    for (unsigned int k = 0; k < 2000; ++k)
      terms.push_back(std::ldexp(mantissa(random), int(power(random)) / 3));
    const auto sum_of = [](const std::vector<double> &all,
                           const std::size_t n_parts) {
      std::vector<OrderFreeSum> parts(n_parts);
      for (std::size_t k = 0; k < all.size(); ++k)
        parts[(k * k) % n_parts].add(all[k]);
      OrderFreeSum sum;
      for (const OrderFreeSum &part : parts)
        sum.add(part);
      return sum.value();
    };
    const double first = sum_of(terms, 1);
    for (unsigned int k = 0; k < 50; ++k) {
      std::shuffle(terms.begin(), terms.end(), random);
      EXPECT_EQ(first, sum_of(terms, 1 + k % 7));
    }
  }

  TEST(OrderFreeSum, IsExactWhereASumOfDoublesIs)
  {
    OrderFreeSum integers, cancelling, shares, tiny;
    for (unsigned int k = 1; k <= 1000; ++k)
      integers.add(k);
    EXPECT_EQ(integers.value(), 500500.);
    for (const double term : {1e16, 1., -1e16, 2., 0.})
      cancelling.add(term);
    EXPECT_EQ(cancelling.value(), 3.);
    for (unsigned int k = 0; k < 10; ++k)
      shares.add(0.1); // 0.1 as a double, ten times, rounded once
    EXPECT_EQ(shares.value(), 1.);
    tiny.add(1e-320);
    tiny.add(-3e-310);
    EXPECT_EQ(tiny.value(), 1e-320 - 3e-310);
    EXPECT_EQ(OrderFreeSum().value(), 0.);
    tiny.add(std::nan(""));
    EXPECT_TRUE(std::isnan(tiny.value()));
  }

  // ------------------------------------------------------------------ sizes

  TEST(FragmentSizes, OfAPowerLaw)
  {
    // masses at the quantiles of N(>=m) ~ m^-b: the estimate is b up to 1/n
    const double b = 1.5;
    const unsigned int n = 4000;
    std::vector<FragmentRecord> records(n);
    for (unsigned int k = 0; k < n; ++k) {
      records[k].mass = std::pow((k + 1.) / n, -1. / b);
      records[k].volume = records[k].mass;
    }
    const auto sizes = fragment_sizes(records, 3);
    ASSERT_TRUE(sizes && sizes->mass_exponent);
    EXPECT_NEAR(*sizes->mass_exponent, b, 5e-3);
    EXPECT_NEAR(sizes->sizes.front() / sizes->sizes.back(),
                std::pow(double(n), 1. / (3. * b)), 1e-9);
    unsigned int counted = 0;
    for (std::size_t k = 0; k < sizes->numbers.size(); ++k) {
      counted += sizes->numbers[k];
      EXPECT_NEAR(sizes->edges[k + 1] / sizes->edges[k], 2., 1e-15);
    }
    EXPECT_EQ(counted, n);
    EXPECT_EQ(sizes->edges.size(), sizes->numbers.size() + 1);
    // s ~ m^(1/3), N(>=2 s_0) = n 2^(-3 b)
    EXPECT_NEAR(sizes->numbers[0], n * (1. - std::pow(2., -3. * b)), 2.);
  }

  TEST(FragmentSizes, OfEqualPiecesAndOfNone)
  {
    EXPECT_FALSE(fragment_sizes({}, 2));
    std::vector<FragmentRecord> records(20);
    for (FragmentRecord &record : records) {
      record.mass = 3.;
      record.volume = M_PI / 4.;
    }
    const auto sizes = fragment_sizes(records, 2);
    ASSERT_TRUE(sizes);
    EXPECT_NEAR(sizes->mean_size, 1., 1e-14);
    EXPECT_NEAR(sizes->mean_size_by_mass, 1., 1e-14);
    EXPECT_FALSE(sizes->mass_exponent);
    EXPECT_EQ(sizes->numbers, std::vector<unsigned int>{20});
  }
} // namespace nsfd::test_fragment_sizes
