#include "nsfd/cohesive_laws/law_point.h"

#include "core/bracketed_root.h"

#include <boost/math/tools/minima.hpp>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /**
     * Largest traction of a law with two damage scalars in the direction
     * (@p c, @p s) of opening and shear, while both grow from 0. With the
     * gradient of a potential H its Hessian, dT = H du, the traction has its
     * largest size in a direction where H becomes singular, so before the peak
     * of either direction alone: the search stays within the two peaks.
     */
    double largest_traction(const CohesiveLaw &law, const double c,
                            const double s)
    {
      const MixedLaw &mixed = *law.mixed();
      const double peak = law.peak_opening(), peak_slip = mixed.peak_slip();
      // on the edges x = share peak and y = share peak_slip, one behind the
      // other, T_N falls and T_T rises: one place has the direction
      const auto size = [&](const double share) {
        double x = 0., y = 0., K_N = 0., K_T = 0.;
        const auto excess = [&](const double place) {
          x = share * peak * std::min(1., 2. - place);
          y = share * peak_slip * std::min(1., place);
          K_N = mixed.normal_secant(x, y);
          K_T = mixed.tangential_secant(x, y);
          return K_N * x * s - K_T * y * c;
        };
        const double first = excess(0.), last = excess(2.);
        excess(bracketed_root(excess, 0., 2., first, last));
        return K_N * x * c + K_T * y * s;
      };
      const auto [share, negative] = boost::math::tools::brent_find_minima(
          [&](const double x) { return -size(x); }, 0., 1., 26);
      (void)share;
      return std::max(-negative, size(1.));
    }
  } // namespace

  double LawPoint::reduced_traction(const double normal, const double shear,
                                    const double friction) const
  {
    const double pull = std::max(0., normal),
                 left = std::max(0., shear + friction * std::min(0., normal));
    if (adds_)
      return std::max(pull, left / std::sqrt(strength_weight()));
    if (!mixed_)
      return strength_weight() > 0.
                 ? std::sqrt(pull * pull + left * left / strength_weight())
                 : pull;
    if (left == 0.)
      return pull;
    if (pull == 0.) {
      const double slip = mixed_->peak_slip();
      return left *
             (law_.strength() / (mixed_->tangential_secant(0., slip) * slip));
    }
    const double size = std::hypot(pull, left);
    return size *
           (law_.strength() / largest_traction(law_, pull / size, left / size));
  }
} // namespace nsfd
