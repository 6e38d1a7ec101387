#include "stiffened_law.h"

#include <boost/math/tools/toms748_solve.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nsfd
{
  StiffenedLaw::StiffenedLaw(std::shared_ptr<const CohesiveLaw> law,
                             const double compliance)
      : law_(std::move(law)), stiffness_(law_->normal_stiffness() / compliance),
        removed_((1. - compliance) / law_->normal_stiffness()),
        elastic_limit_(law_->elastic_limit() * compliance)
  {
  }

  double StiffenedLaw::opening(const double d) const
  {
    if (d <= law_->elastic_limit())
      return law_->normal_stiffness() / stiffness_ * d;
    return d - removed_ * law_->traction(d);
  }

  StiffenedLaw::Place StiffenedLaw::place(const double x) const
  {
    if (x <= elastic_limit_)
      return {x * (stiffness_ / law_->normal_stiffness()), stiffness_ * x};
    if (x >= law_->final_opening())
      return {x, 0.};
    const auto excess = [&](const double d) { return opening(d) - x; };
    double low = x, high = std::min(x * (stiffness_ / law_->normal_stiffness()),
                                    x + removed_ * law_->strength()) *
                           (1. + 1e-15);
    const double at_low = excess(low), at_high = excess(high);
    if (at_low < 0. && at_high > 0.) {
      boost::uintmax_t n = 200;
      const auto bracket = boost::math::tools::toms748_solve(
          excess, low, high, at_low, at_high,
          [](const double a, const double b) {
            return b - a <= 2. * (std::nextafter(b, 2. * b) - b);
          },
          n);
      low = bracket.first;
      high = bracket.second;
    } else if (at_low >= 0.)
      high = low;
    else
      low = high;
    // the traction jumps inside the bracket or is the same at both ends
    const double T_low = law_->traction(low), T_high = law_->traction(high);
    return {high, std::clamp((high - x) / removed_, std::min(T_low, T_high),
                             std::max(T_low, T_high))};
  }

  double StiffenedLaw::law_opening(const double x) const
  {
    return place(x).opening;
  }

  double StiffenedLaw::beta(const double x) const
  {
    if (x <= elastic_limit_)
      return 1.;
    return std::min(1., place(x).traction / (stiffness_ * x));
  }

  double StiffenedLaw::traction(const double x) const
  {
    return place(x).traction;
  }

  double StiffenedLaw::energy(const double x) const
  {
    if (x <= elastic_limit_)
      return 0.5 * stiffness_ * x * x;
    const auto [d, T] = place(x);
    return law_->energy(d) - 0.5 * removed_ * T * T;
  }

  std::vector<double> StiffenedLaw::kinks() const
  {
    std::vector<double> result = law_->kinks();
    for (double &kink : result)
      if (std::isfinite(kink))
        kink = opening(kink);
    return result;
  }

  double StiffenedLaw::final_opening() const { return law_->final_opening(); }

  double StiffenedLaw::steepest_softening() const
  {
    const double slope = law_->steepest_softening();
    return std::isinf(slope) ? 1. / removed_ : slope / (1. + removed_ * slope);
  }

  std::string not_stiffened(const CohesiveLaw &law)
  {
    if (law.mixed() != nullptr)
      return "has two damage scalars";
    if (law.rate_dependent())
      return "has a damage that takes time";
    if (law.heals())
      return "heals";
    if (std::isinf(law.steepest_softening()) &&
        law.final_opening() > law.peak_opening() * (1. + 1e-12))
      return "has a traction that jumps while it softens";
    return "";
  }

  std::shared_ptr<const CohesiveLaw>
  with_compliance(const std::shared_ptr<const CohesiveLaw> &law,
                  const double compliance)
  {
    if (compliance == 1.)
      return law;
    return std::make_shared<StiffenedLaw>(law, compliance);
  }

  double opening_at_compliance(const std::shared_ptr<const CohesiveLaw> &law,
                               const double opening, const double from,
                               const double to)
  {
    double d = opening;
    if (from == to)
      return d;
    if (from < 1.)
      d = StiffenedLaw(law, from).law_opening(d);
    return to < 1. ? StiffenedLaw(law, to).opening(d) : d;
  }
} // namespace nsfd
