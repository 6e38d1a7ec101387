#include "peak_rule.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** Openings along a ray; a smooth peak is seen to 1e-3 of it. */
    constexpr unsigned int samples = 200;

    /**
     * The largest traction on the envelope between two openings. T has one
     * maximum between two kinks at most, and that is a kink.
     */
    double largest(const PointEnvelope &point, const double from,
                   const double to)
    {
      const CohesiveLaw &law = point.law;
      const double x = point.l * from, y = point.l * to;
      double result = std::max(law.traction(x), law.traction(y));
      for (const double kink : law.kinks())
        if (kink > x && kink < y)
          result = std::max(result, law.traction(kink));
      return point.a * result;
    }

    double length(const Reach &reach)
    {
      return std::hypot(reach.opening, reach.slip);
    }

    /** Traction at @p reach along it, unloaded from @p history. */
    double traction_along(const PointEnvelope &point, const Reach &history,
                          const Reach &reach)
    {
      const double size = length(reach);
      if (size == 0.)
        return 0.;
      const double x = point.l * std::max(history.opening, reach.opening),
                   y = point.l * std::max(history.slip, reach.slip);
      const MixedLaw &law = *point.law.mixed();
      return point.a * point.l *
             (law.normal_secant(x, y) * reach.opening * reach.opening +
              law.tangential_secant(x, y) * reach.slip * reach.slip) /
             size;
    }

    /** The largest of that on the way from 0 to @p reach, and on to @p end. */
    double largest_along(const PointEnvelope &point, const Reach &history,
                         const Reach &reach, const double end)
    {
      const double size = length(reach);
      if (size == 0.)
        return 0.;
      const double peak =
          std::min(point.law.peak_opening(), point.law.mixed()->peak_slip()) /
          point.l;
      const double last = end / size;
      const double first = std::min(last, 0.1 * peak / size);
      double result = traction_along(point, history, reach);
      for (unsigned int k = 0; k <= samples; ++k) {
        const double s = first * std::pow(last / first, double(k) / samples);
        result = std::max(result,
                          traction_along(point, history,
                                         {s * reach.opening, s * reach.slip}));
      }
      return result;
    }

    /** On the envelope. */
    double envelope_secant(const PointEnvelope &point, const double opening)
    {
      return point.a * point.l * point.law.secant(point.l * opening);
    }
  } // namespace

  double PointEnvelope::load(const Reach &history, const Reach &reach) const
  {
    if (law.mixed()) {
      const double far = 20. * std::max({length(reach), length(history),
                                         law.peak_opening() / l,
                                         law.mixed()->peak_slip() / l});
      const double carries = largest_along(*this, history, reach, far);
      const double x = l * history.opening, y = l * history.slip;
      const double size = length(reach);
      return carries > 0. ? a * l *
                                (law.mixed()->normal_secant(x, y) *
                                     reach.opening * reach.opening +
                                 law.mixed()->tangential_secant(x, y) *
                                     reach.slip * reach.slip) /
                                size / carries
                          : 0.;
    }
    if (history.opening == 0. && law.extrinsic())
      return 0.; // a joint, with loads of its own
    // any hump of a table is before its end; others have but one
    const double beyond = std::isfinite(law.final_opening())
                              ? law.final_opening() / l
                              : 2. * law.peak_opening() / l;
    const double carries =
        largest(*this, history.opening, std::max(history.opening, beyond));
    return carries > 0. ? envelope_secant(*this, history.opening) *
                              reach.opening / carries
                        : 0.;
  }

  bool PointEnvelope::is_elastic_to_the_peak(const Reach &history) const
  {
    if (law.mixed())
      return false;
    if (law.extrinsic()) // held together next to no opening
      return history.opening > 0. &&
             law.traction(l * history.opening) >= (1. - 1e-6) * law.strength();
    return law.traction(law.elastic_limit()) >= (1. - 1e-9) * law.strength() &&
           l * history.opening <= law.elastic_limit();
  }

  double largest_on_the_way(const PointEnvelope &point, const Reach &history,
                            const Reach &end)
  {
    return point.law.mixed() ? largest_along(point, history, end, length(end))
                             : largest(point, history.opening, end.opening);
  }

  Passage passage(const PointEnvelope &point, const Reach &history,
                  const Reach &start, const Reach &end)
  {
    if (end.opening <= history.opening && end.slip <= history.slip)
      return {};
    const double carries = largest_on_the_way(point, history, end);
    if (!(carries > 0.))
      return {};
    if (point.law.mixed())
      // the direction may turn: what counts is its own ray, too
      return {std::max(traction_along(point, history, start) / carries,
                       std::min(1., point.load(history, start))),
              traction_along(point, history, end) / carries};
    const double before =
        history.opening == 0. && point.law.extrinsic()
            ? 0.
            : envelope_secant(point, history.opening) * start.opening;
    return {before / carries,
            point.a * point.law.traction(point.l * end.opening) / carries};
  }
} // namespace nsfd
