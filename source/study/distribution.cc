#include "distribution.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  std::optional<WeibullFit> weibull_fit(const std::vector<double> &values)
  {
    const double n = double(values.size());
    if (values.size() < 3)
      return {};
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    if (!(*low > 0.) || !(*high > *low) || !std::isfinite(*high))
      return {};
    double mean = 0.; // of ln (x / largest)
    for (const double x : values)
      mean += std::log(x / *high) / n;
    // rises with k from below zero
    const auto excess = [&](const double k) {
      double sum = 0., weighted = 0.;
      for (const double x : values) {
        const double power = std::exp(k * std::log(x / *high));
        sum += power;
        weighted += power * std::log(x / *high);
      }
      return weighted / sum - mean - 1. / k;
    };
    double lower = 1e-3, upper = 1.;
    while (excess(upper) < 0. && upper < 1e9)
      upper *= 2.;
    for (unsigned int i = 0; i < 200; ++i) {
      const double middle = std::sqrt(lower * upper);
      (excess(middle) < 0. ? lower : upper) = middle;
    }
    const double k = std::sqrt(lower * upper);
    double sum = 0.;
    for (const double x : values)
      sum += std::pow(x / *high, k) / n;
    return WeibullFit{k, *high * std::pow(sum, 1. / k)};
  }

  std::vector<double> median_ranks(const std::size_t n)
  {
    std::vector<double> ranks;
    for (std::size_t i = 0; i < n; ++i)
      ranks.push_back((double(i) + 0.7) / (double(n) + 0.4));
    return ranks;
  }

  Histogram histogram_of(std::vector<double> values)
  {
    Histogram histogram;
    if (values.empty())
      return histogram;
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    const double range = values.back() - values.front(),
                 quartiles = values[3 * n / 4] - values[n / 4],
                 width = 2. * quartiles / std::cbrt(double(n));
    const double wanted =
        width > 0. ? std::ceil(range / width) : std::sqrt(double(n));
    const std::size_t bins =
        range > 0. ? std::size_t(std::clamp(wanted, 1., 50.)) : 1;
    for (std::size_t i = 0; i <= bins; ++i)
      histogram.edges.push_back(values.front() +
                                range * double(i) / double(bins));
    histogram.counts.assign(bins, 0.);
    for (const double value : values) {
      const double place =
          range > 0. ? (value - values.front()) / range * double(bins) : 0.;
      ++histogram.counts[std::min(bins - 1, std::size_t(place))];
    }
    return histogram;
  }
} // namespace nsfd
