#include "drive_point.h"

#include "core/bracketed_root.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** Openings that a step should end at: kinks, both sides of drops. */
    std::vector<double> remarkable_openings(const CohesiveLaw &law)
    {
      std::vector<double> result;
      for (const double d : law.kinks()) {
        if (!(d > 0.) || !std::isfinite(d))
          continue;
        const double below = d * (1. - 1e-9), above = d * (1. + 1e-9);
        const bool drops = std::abs(law.traction(below) - law.traction(above)) >
                           1e-3 * law.strength();
        if (drops)
          result.insert(result.end(), {below, above});
        else
          result.push_back(d);
      }
      std::sort(result.begin(), result.end());
      result.erase(std::unique(result.begin(), result.end()), result.end());
      return result;
    }

    PathPoint between(const PathPoint &a, const PathPoint &b, const double x)
    {
      const auto mean = [x](const double from, const double to) {
        return from + x * (to - from);
      };
      return {mean(a.path, b.path),
              {mean(a.at.opening, b.at.opening), mean(a.at.slip, b.at.slip),
               mean(a.at.reaction, b.at.reaction), mean(a.at.time, b.at.time)}};
    }

    /**
     * Where the way from a to b reaches the effective opening d from below, as
     * a share of the way: the larger root of |u_a + x (u_b - u_a)|^2 = d^2.
     */
    double crossing(const PathMark &a, const PathMark &b, const double r2,
                    const double d)
    {
      const double n = b.opening - a.opening, s = b.slip - a.slip;
      const double p = n * n + r2 * s * s, q = a.opening * n + r2 * a.slip * s,
                   r = a.opening * a.opening + r2 * a.slip * a.slip - d * d;
      return (std::sqrt(std::max(0., q * q - p * r)) - q) / p;
    }

    /** The same where @p opening is a sum: convex along the way. */
    template <typename Opening>
    double crossing_of_sum(const PathPoint &a, const PathPoint &b,
                           const Opening &opening, const double d)
    {
      const auto excess = [&](const double share) {
        return opening(between(a, b, share)) - d;
      };
      return bracketed_root(excess, 0., 1., excess(0.), excess(1.));
    }
  } // namespace

  std::vector<PathPoint> with_kinks(const std::vector<PathPoint> &points,
                                    const CohesiveLaw &law)
  {
    const std::vector<double> remarkable = remarkable_openings(law);
    const double r2 = law.shear_weight();
    const bool adds = law.adds_openings();
    const auto opening = [r2, adds](const PathPoint &point) {
      if (adds)
        return point.at.opening + std::sqrt(r2) * std::abs(point.at.slip);
      return std::sqrt(point.at.opening * point.at.opening +
                       r2 * point.at.slip * point.at.slip);
    };
    std::vector<PathPoint> result = {points.front()};
    double reached = opening(points.front());
    for (std::size_t i = 1; i < points.size(); ++i) {
      const PathPoint &a = points[i - 1], &b = points[i];
      for (const double d : remarkable)
        if (reached < d * (1. - 1e-12) && opening(b) > d * (1. + 1e-12))
          result.push_back(between(a, b,
                                   adds ? crossing_of_sum(a, b, opening, d)
                                        : crossing(a.at, b.at, r2, d)));
      result.push_back(b);
      reached = std::max(reached, opening(b));
    }
    return result;
  }
} // namespace nsfd
