#include "nsfd/cohesive_laws/cohesive_law.h"

#include "gauss.h"
#include "nsfd/cohesive_laws/law_point.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /**
     * Openings closer than this share of the larger one are integrated. A
     * singularity of T at d = 0 (the tail of a law) is then 19 half widths
     * away from the middle of a panel, and the error of the rule below is
     * 38^-10 = 2e-16 of the integral. Farther apart, the difference of I
     * loses a digit or two at most.
     */
    constexpr double close_openings = 0.1;
  } // namespace

  bool CohesiveLaw::has_potential() const
  {
    return mixed() == nullptr &&
           nsfd::has_potential(stiffness_ratio(), shear_weight());
  }

  std::vector<double> CohesiveLaw::kinks() const
  {
    return {elastic_limit(), peak_opening(), final_opening()};
  }

  double CohesiveLaw::secant(const double d) const
  {
    return extrinsic() ? traction(d) / d : beta(d) * normal_stiffness();
  }

  double CohesiveLaw::healed_opening(const double d_m, double, double) const
  {
    return d_m;
  }

  double CohesiveLaw::delayed_opening(const double d_m, const double d,
                                      const double) const
  {
    return std::max(d_m, d);
  }

  double MixedLaw::beta(const double x, const double y) const
  {
    return std::max(normal_secant(x, y) / normal_secant(0., 0.),
                    tangential_secant(x, y) / tangential_secant(0., 0.));
  }

  double CohesiveLaw::energy_increment(const double d0, const double d1) const
  {
    const double lower = std::min(d0, d1), upper = std::max(d0, d1);
    if (lower < (1. - close_openings) * upper)
      return energy(d1) - energy(d0);

    // T is smooth between its kinks only
    std::vector<double> ends = {lower, upper};
    for (const double kink : kinks())
      ends.push_back(std::clamp(kink, lower, upper));
    std::sort(ends.begin(), ends.end());

    double sum = 0.;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i)
      if (ends[i] < ends[i + 1])
        sum += integrate([this](const double d) { return traction(d); },
                         ends[i], ends[i + 1]);
    return d1 < d0 ? -sum : sum;
  }
} // namespace nsfd
