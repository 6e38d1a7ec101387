#include "nsfd/interface/cohesive_law.h"

#include <algorithm>
#include <array>
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

    /** Gauss-Legendre rule with 5 points, exact up to degree 9. */
    double integrate_envelope(const CohesiveLaw &law, const double lower,
                              const double upper)
    {
      constexpr double x1 = 0.53846931010568309104;
      constexpr double x2 = 0.90617984593866399280;
      constexpr double w0 = 0.56888888888888888889;
      constexpr double w1 = 0.47862867049936646804;
      constexpr double w2 = 0.23692688505618908751;

      const double middle = lower + 0.5 * (upper - lower);
      const double half = 0.5 * (upper - lower);
      const auto T = [&law, middle, half](const double x) {
        return law.traction(middle + x * half);
      };
      return half *
             (w0 * T(0.) + w1 * (T(-x1) + T(x1)) + w2 * (T(-x2) + T(x2)));
    }
  } // namespace

  bool CohesiveLaw::has_potential() const
  {
    // equal up to the round-off of reading the two from the input
    return std::abs(stiffness_ratio() - shear_weight()) <=
           1e-12 * shear_weight();
  }

  double CohesiveLaw::secant(const double d) const
  {
    return extrinsic() ? traction(d) / d : beta(d) * normal_stiffness();
  }

  double CohesiveLaw::energy_increment(const double d0, const double d1) const
  {
    const double lower = std::min(d0, d1), upper = std::max(d0, d1);
    if (lower < (1. - close_openings) * upper)
      return energy(d1) - energy(d0);

    // T is smooth between its kinks only
    std::array<double, 5> ends{
        {lower, std::clamp(elastic_limit(), lower, upper),
         std::clamp(peak_opening(), lower, upper),
         std::clamp(final_opening(), lower, upper), upper}};
    std::sort(ends.begin(), ends.end());

    double sum = 0.;
    for (unsigned int i = 0; i + 1 < ends.size(); ++i)
      if (ends[i] < ends[i + 1])
        sum += integrate_envelope(*this, ends[i], ends[i + 1]);
    return d1 < d0 ? -sum : sum;
  }
} // namespace nsfd
