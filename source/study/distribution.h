#pragma once

#include <optional>
#include <vector>

namespace nsfd
{
  /** P(X > x) = exp(-(x / scale)^shape). */
  struct WeibullFit {
    double shape = 0., scale = 0.;
  };

  /**
   * The most likely one: 1/k = sum x^k ln x / sum x^k - mean ln x, scale^k =
   * mean x^k. Nothing for fewer than three values, for some that are not
   * positive, and for equal ones.
   */
  std::optional<WeibullFit> weibull_fit(const std::vector<double> &values);

  /**
   * Median ranks (i - 0.3) / (n + 0.4) of sorted values, i = 1, 2, ... (Benard
   * and Bos-Levenbach, 1953).
   */
  std::vector<double> median_ranks(std::size_t n);

  /**
   * How many of the values are in each of some intervals of equal length; their
   * number is that of Freedman and Diaconis (1981), at most 50.
   */
  struct Histogram {
    std::vector<double> edges; ///< one more than there are counts
    std::vector<double> counts;
  };
  Histogram histogram_of(std::vector<double> values);
} // namespace nsfd
