#include "bar.h"
#include "drive_point.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/scene/time_input.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /** The grip U(u) = u + T(u) / k of an equilibrium (39), (40). */
    class Equilibria
    {
    public:
      Equilibria(const CohesiveLaw &law, const double stiffness)
          : law_(law), k_(stiffness), scale_(opening_scale(law))
      {
      }

      double grip(const double u) const { return u + law_.traction(u) / k_; }

      /**
       * Openings at which it is sampled: kinks and many in between, closest
       * next to the kinks, where a law may fall steeply for a short way.
       */
      std::vector<double> places() const
      {
        std::vector<double> kinks = {0., scale_,
                                     2. * scale_ + law_.strength() / k_};
        for (const double d :
             {law_.elastic_limit(), law_.peak_opening(), law_.final_opening()})
          if (d > 0. && std::isfinite(d))
            kinks.push_back(d);
        std::sort(kinks.begin(), kinks.end());
        kinks.erase(std::unique(kinks.begin(), kinks.end()), kinks.end());
        std::vector<double> result = {0.};
        constexpr unsigned int n = 5000;
        for (std::size_t i = 1; i < kinks.size(); ++i) {
          const double width = kinks[i] - kinks[i - 1];
          for (unsigned int j = 1; j < n; ++j) {
            const double x = double(j) / n;
            result.push_back(kinks[i - 1] + x * x * (3. - 2. * x) * width);
          }
          result.push_back(kinks[i]);
        }
        return result;
      }

      /** The largest grip of (low, high), which holds one maximum. */
      double maximum(double low, double high) const
      {
        const double ratio = 0.5 * (std::sqrt(5.) - 1.);
        for (unsigned int i = 0; i < 90; ++i) {
          const double a = high - ratio * (high - low),
                       b = low + ratio * (high - low);
          (grip(a) < grip(b) ? low : high) = grip(a) < grip(b) ? a : b;
        }
        const double u = grip(low) < grip(high) ? high : low;
        const double smooth = refined(u);
        // a corner is found to round-off by its values, a smooth maximum only
        // to the root of it
        return grip(smooth) >= grip(u) * (1. - 4e-16) ? smooth : u;
      }

      /** The first opening of (low, high] with grip @p U, below it at low. */
      double reaching(const double U, double low, double high) const
      {
        for (unsigned int i = 0; i < 200; ++i) {
          const double middle = 0.5 * (low + high);
          if (!(middle > low && middle < high))
            break;
          (grip(middle) < U ? low : high) = middle;
        }
        return high;
      }

    private:
      const CohesiveLaw &law_;
      double k_, scale_;

      /** dU/du by central differences of fourth order. */
      double slope(const double u, const double e) const
      {
        return (8. * (grip(u + e) - grip(u - e)) -
                (grip(u + 2. * e) - grip(u - 2. * e))) /
               (12. * e);
      }

      /** The root of the slope next to a smooth maximum. */
      double refined(const double u) const
      {
        const double width = 1e-6 * scale_, e = 5e-4 * scale_;
        if (u < width + 2. * e)
          return u;
        double low = u - width, high = u + width;
        if (!(slope(low, e) > 0. && slope(high, e) < 0.))
          return u;
        for (unsigned int i = 0; i < 60; ++i) {
          const double middle = 0.5 * (low + high);
          (slope(middle, e) > 0. ? low : high) = middle;
        }
        return low;
      }
    };
  } // namespace

  double slope_ratio(const CohesiveLaw &law, const double stiffness)
  {
    return law.steepest_softening() / stiffness;
  }

  std::vector<BarJump> bar_jumps(const CohesiveLaw &law, const double stiffness)
  {
    std::vector<BarJump> jumps;
    // the slope of the law decides, not round-off where the two are equal
    if (slope_ratio(law, stiffness) <= 1.)
      return jumps;
    const Equilibria equilibria(law, stiffness);
    const std::vector<double> places = equilibria.places();
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      const double here = equilibria.grip(places[i]);
      if (equilibria.grip(places[i + 1]) >= here * (1. - 1e-14))
        continue;
      BarJump jump;
      jump.opening_from =
          i == 0 && law.extrinsic() && equilibria.grip(places[1] * 1e-6) < here
              ? 0.
              : equilibria.maximum(places[i > 0 ? i - 1 : 0], places[i + 1]);
      jump.grip = equilibria.grip(jump.opening_from);
      std::size_t j = i + 1;
      while (j + 1 < places.size() && equilibria.grip(places[j]) < jump.grip)
        ++j;
      jump.opening_to =
          equilibria.reaching(jump.grip, places[j - 1], places[j]);
      jump.traction_from = law.traction(jump.opening_from);
      jump.traction_to = law.traction(jump.opening_to);
      // without cancellation: the bar unloads along its line
      jump.excess = 0.5 * (jump.traction_from + jump.traction_to) *
                        (jump.opening_to - jump.opening_from) -
                    law.energy_increment(jump.opening_from, jump.opening_to);
      jumps.push_back(jump);
      i = j - 1;
    }
    return jumps;
  }

  double dynamic_slope(const Bar &bar, const double step)
  {
    return bar.mass / (bar.theta * step * step) + bar.theta * bar.stiffness;
  }

  double unique_step(const CohesiveLaw &law, const Bar &bar)
  {
    const double chi = bar.rule == CohesionRule::exact ? 0.5 : 1.;
    const double needed =
        chi * law.steepest_softening() - bar.theta * bar.stiffness;
    return needed > 0. ? std::sqrt(bar.mass / (bar.theta * needed))
                       : std::numeric_limits<double>::infinity();
  }

  double default_end(const CohesiveLaw &law, const double stiffness)
  {
    double end = std::max(opening_scale(law),
                          law.peak_opening() + law.strength() / stiffness);
    for (const BarJump &jump : bar_jumps(law, stiffness))
      end = std::max(end, jump.grip);
    return 1.2 * end;
  }
} // namespace nsfd
