#include "convergence.h"

#include "case_result.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    bool is_positive(const double value)
    {
      return std::isfinite(value) && value > 0.;
    }

    constexpr std::size_t fewest_points = 3;
    /// errors nearer than this to a level are partly that level
    constexpr double above_level = 5.;
  } // namespace

  std::string text_of(const OrderVerdict verdict)
  {
    switch (verdict) {
    case OrderVerdict::too_few:
      return "too few points";
    case OrderVerdict::below:
      return "below the expected order";
    case OrderVerdict::reached:
      return "as expected";
    case OrderVerdict::above:
      return "above the expected order";
    default:
      return "";
    }
  }

  Line least_squares(const std::vector<double> &x, const std::vector<double> &y)
  {
    const double n = double(x.size());
    double mean_x = 0., mean_y = 0., xx = 0., xy = 0.;
    for (std::size_t i = 0; i < x.size(); ++i) {
      mean_x += x[i] / n;
      mean_y += y[i] / n;
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      xx += (x[i] - mean_x) * (x[i] - mean_x);
      xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    const double slope = xx > 0. ? xy / xx : 0.;
    return {slope, mean_y - slope * mean_x};
  }

  OrderFit fit_order(const std::vector<StudyPoint> &points)
  {
    std::vector<double> x, y;
    for (const StudyPoint &point : points)
      if (is_positive(point.size) && is_positive(point.error)) {
        x.push_back(std::log(point.size));
        y.push_back(std::log(point.error));
      }
    OrderFit fit;
    for (std::size_t i = 1; i < x.size(); ++i)
      fit.rates.push_back(
          x[i] < x[i - 1] ? (y[i] - y[i - 1]) / (x[i] - x[i - 1]) : 0.);
    fit.round_off = !y.empty() &&
                    *std::max_element(y.begin(), y.end()) <
                        std::log(1e3 * std::numeric_limits<double>::epsilon());
    if (fit.round_off)
      return fit;
    std::size_t end = x.size();
    for (std::size_t k = 2; k < fit.rates.size() + 1 && k < x.size(); ++k) {
      const double before =
          median({fit.rates.begin(), fit.rates.begin() + long(k - 1)});
      if (before > 0. &&
          std::all_of(fit.rates.begin() + long(k - 1), fit.rates.end(),
                      [before](const double r) { return r < 0.5 * before; })) {
        fit.level = std::exp(y.back());
        for (end = 0; end < k && std::exp(y[end]) > above_level * *fit.level;)
          ++end;
        break;
      }
    }
    x.resize(end);
    y.resize(end);
    fit.n_fitted = end;
    if (end >= fewest_points)
      fit.order = least_squares(x, y).slope;
    return fit;
  }

  OrderVerdict judge(const OrderFit &fit, const std::optional<double> &expected,
                     const double tolerance)
  {
    if (!expected)
      return OrderVerdict::none;
    if (!fit.order)
      return OrderVerdict::too_few;
    const double miss = *fit.order - *expected;
    return miss < -tolerance  ? OrderVerdict::below
           : miss > tolerance ? OrderVerdict::above
                              : OrderVerdict::reached;
  }

  std::vector<StudyPoint> lower_envelope(std::vector<StudyPoint> points)
  {
    points.erase(std::remove_if(points.begin(), points.end(),
                                [](const StudyPoint &p) {
                                  return !is_positive(p.error) ||
                                         !is_positive(p.seconds);
                                }),
                 points.end());
    std::sort(points.begin(), points.end(),
              [](const StudyPoint &a, const StudyPoint &b) {
                return a.seconds < b.seconds ||
                       (a.seconds == b.seconds && a.error < b.error);
              });
    std::vector<StudyPoint> envelope;
    for (const StudyPoint &point : points)
      if (envelope.empty() || point.error < envelope.back().error)
        envelope.push_back(point);
    return envelope;
  }

  CostOfError cost_of_error(const std::vector<StudyPoint> &points,
                            const double error)
  {
    const std::vector<StudyPoint> envelope = lower_envelope(points);
    CostOfError cost;
    for (std::size_t i = 0; i < envelope.size() && !cost.reached; ++i) {
      const StudyPoint &here = envelope[i];
      if (here.error > error)
        continue;
      cost.reached = true;
      cost.at_most = i == 0 && here.error < error;
      cost.seconds = here.seconds;
      if (i == 0)
        break;
      const StudyPoint &last = envelope[i - 1];
      const double share =
          std::log(last.error / error) / std::log(last.error / here.error);
      cost.seconds =
          last.seconds * std::pow(here.seconds / last.seconds, share);
    }
    return cost;
  }
} // namespace nsfd
