#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace nsfd
{
  /** Random numbers that are the same in every run and with every compiler. */
  class Dice
  {
  public:
    explicit Dice(const unsigned int seed) : engine_(seed) {}

    double operator()(const double low, const double high)
    {
      return low + (high - low) * double(engine_()) / double(engine_.max());
    }
    /** 0 to n - 1 in a random order. */
    std::vector<int> order(const std::size_t n)
    {
      std::vector<int> result(n);
      std::iota(result.begin(), result.end(), 0);
      for (std::size_t i = n; i > 1; --i)
        std::swap(result[i - 1], result[engine_() % i]);
      return result;
    }

  private:
    std::mt19937 engine_;
  };
} // namespace nsfd
