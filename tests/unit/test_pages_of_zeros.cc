#include "core/pages_of_zeros.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <unistd.h>

namespace nsfd::test_pages_of_zeros
{
  namespace
  {
    /** Of this process, in bytes. */
    double resident()
    {
      std::ifstream file("/proc/self/statm");
      double all = 0., here = 0.;
      file >> all >> here;
      return here * double(sysconf(_SC_PAGESIZE));
    }

    constexpr std::size_t n = std::size_t(1) << 23; // 64 MiB of numbers

    TEST(PagesOfZeros, AreGivenBack)
    {
      std::vector<double> values(n, 0.);
      const double before = resident();
      release_pages_of_zeros(values);
      // all but its ends
      EXPECT_LT(resident(), before - 0.95 * 8. * n);
      // and come back one by one
      for (std::size_t i = 0; i < n; i += n / 16)
        values[i] = 1.;
      EXPECT_LT(resident(), before - 0.9 * 8. * n);
      double sum = 0.;
      for (const double value : values)
        sum += value;
      EXPECT_EQ(sum, 16.);
    }

    TEST(PagesOfZeros, NothingElseChanges)
    {
      std::vector<double> values(n, 0.);
      for (std::size_t i = 12345; i < n; i += 98765)
        values[i] = i % 2 == 0 ? double(i) : -0.;
      const std::vector<double> before = values;
      release_pages_of_zeros(values);
      for (std::size_t i = 0; i < n; ++i) {
        ASSERT_EQ(values[i], before[i]);
        ASSERT_EQ(std::signbit(values[i]), std::signbit(before[i]));
      }
      std::vector<std::uint8_t> flags(1000, 1), none;
      release_pages_of_zeros(flags);
      release_pages_of_zeros(none);
      EXPECT_EQ(flags, std::vector<std::uint8_t>(1000, 1));
    }
  } // namespace
} // namespace nsfd::test_pages_of_zeros
