#include "law_contract.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd::law_contract
{
  namespace
  {
    /** Keeps the first demand that does not hold. */
    class Trial
    {
    public:
      template <typename... Values>
      void demand(const bool holds, const char *sentence,
                  const Values &...values)
      {
        if (!holds && failure_.empty())
          failure_ = fmt::format(fmt::runtime(sentence), values...);
      }

      /** |value - expected| <= tolerance; not a number is not near. */
      void near(const double value, const double expected,
                const double tolerance, const std::string &what)
      {
        demand(std::abs(value - expected) <= tolerance,
               "{} is {:.9g}, expected {:.9g}", what, value, expected);
      }

      const std::string &failure() const { return failure_; }

    private:
      std::string failure_;
    };

    std::string at(const char *what, const double d)
    {
      return fmt::format("{} at d = {:.9g} m", what, d);
    }

    void beta_never_grows(const CohesiveLaw &law, Trial &trial)
    {
      trial.near(law.beta(0.), 1., 0., "beta(0)");
      double last = 1.;
      for (const double d : samples(law)) {
        const double beta = law.beta(d);
        trial.demand(beta <= last, "beta grows to {:.17g} at d = {:.9g} m",
                     beta, d);
        trial.demand(beta >= 0., "beta is {:.9g} at d = {:.9g} m", beta, d);
        trial.demand(d > law.elastic_limit() || beta == 1.,
                     "beta is {:.17g} at d = {:.9g} m, below elastic_limit()",
                     beta, d);
        last = beta;
      }
    }

    void traction_and_beta_agree(const CohesiveLaw &law, Trial &trial)
    {
      const double R_max = law.strength();
      for (const double d : samples(law)) {
        const double T = law.traction(d);
        trial.demand(T >= 0. && T <= R_max * (1. + 1e-12),
                     "the traction is {:.9g} Pa at d = {:.9g} m, strength() "
                     "{:.9g} Pa",
                     T, d, R_max);
        if (!law.extrinsic())
          trial.near(T, law.beta(d) * law.normal_stiffness() * d, 1e-13 * R_max,
                     at("traction(d) against beta(d) C_N d", d));
        if (d > 0.)
          trial.near(law.secant(d) * d, T, 1e-13 * R_max,
                     at("secant(d) d against traction(d)", d));
        trial.demand(d < law.final_opening() || (T == 0. && law.beta(d) == 0.),
                     "beyond final_opening(), at d = {:.9g} m, the traction is "
                     "{:.9g} Pa and beta {:.9g}",
                     d, T, law.beta(d));
      }
      trial.near(law.traction(law.peak_opening()), R_max, 1e-12 * R_max,
                 "the traction at peak_opening()");
      if (law.extrinsic())
        trial.near(law.traction(0.), R_max, 0., "the traction at 0");
      else
        trial.near(law.secant(0.), law.normal_stiffness(), 0.,
                   "the secant at 0");
    }

    // Dissipated so far: I - beta C d^2 / 2, or I - T d / 2 with secant
    // unloading.
    void dissipation_never_falls(const CohesiveLaw &law, Trial &trial)
    {
      const double G = law.toughness();
      double last = 0.;
      for (const double d : samples(law)) {
        const double stored =
            law.extrinsic()
                ? 0.5 * law.traction(d) * d
                : 0.5 * law.beta(d) * law.normal_stiffness() * d * d;
        const double dissipated = law.energy(d) - stored;
        trial.demand(dissipated >= last - 1e-14 * G,
                     "from {:.9g} it falls to {:.9g} J/m^2 at d = {:.9g} m",
                     last, dissipated, d);
        last = std::max(last, dissipated);
      }
      trial.near(last, G, 1e-9 * G, "what is dissipated in the end");
    }

    void energy_is_the_integral(const CohesiveLaw &law, Trial &trial)
    {
      const double G = law.toughness(), end = end_of_softening(law),
                   h = 1e-4 * end;
      trial.near(law.energy(0.), 0., 0., "energy(0)");
      for (const double d : samples(law)) {
        // differences of fourth order, also next to a root of T
        if (d <= 2. * h || d > 2. * end ||
            kink_between(law, d - 20. * h, d + 20. * h))
          continue;
        const double slope =
            (8. * (law.energy(d + h) - law.energy(d - h)) -
             (law.energy(d + 2. * h) - law.energy(d - 2. * h))) /
            (12. * h);
        trial.near(slope, law.traction(d), 1e-8 * law.strength(),
                   at("the slope of energy(d) against traction(d)", d));
      }
      const std::vector<double> openings = samples(law);
      for (std::size_t i = 0; i + 1 < openings.size(); ++i)
        for (const std::size_t j : {i + 1, (17 * i) % openings.size()})
          trial.near(law.energy_increment(openings[i], openings[j]),
                     law.energy(openings[j]) - law.energy(openings[i]),
                     1e-13 * G,
                     fmt::format("energy_increment({:.9g}, {:.9g})",
                                 openings[i], openings[j]));
      trial.near(law.energy(1e9 * end), G, 1e-12 * G,
                 "the energy far beyond separation");
      if (std::isfinite(law.final_opening()))
        trial.near(law.energy(law.final_opening()), G, 1e-12 * G,
                   "the energy at final_opening()");
    }

    /** Largest fall of T over a distance h, beyond the peak. */
    double largest_fall(const CohesiveLaw &law, const double h)
    {
      double result = 0.;
      for (const double d : samples(law))
        for (const double start : {d, d - h})
          if (start >= law.peak_opening() &&
              start + h <= 2. * end_of_softening(law))
            result =
                std::max(result, law.traction(start) - law.traction(start + h));
      return result;
    }

    // By the mean value theorem, no difference quotient exceeds max |T'|.
    void steepest_softening_is_attained(const CohesiveLaw &law, Trial &trial)
    {
      const double end = end_of_softening(law),
                   steepest = law.steepest_softening();
      if (std::isinf(steepest)) {
        // no bound: the quotient grows by half a power of the distance or more,
        // with a jump like 1 / h
        trial.demand(largest_fall(law, 1e-8 * end) / 1e-8 >
                         5. * largest_fall(law, 1e-6 * end) / 1e-6,
                     "it is infinite, but the traction does not jump");
        return;
      }
      const double h = 1e-6 * end, found = largest_fall(law, h) / h;
      trial.demand(found <= steepest * (1. + 1e-6) &&
                       found >= steepest * (1. - 1e-3),
                   "the traction falls by {:.9g} Pa/m, steepest_softening() is "
                   "{:.9g} Pa/m",
                   found, steepest);
    }

    /** Work of the traction on the straight way from (u_N, u_T) to (v_N, v_T).
     */
    double work(const CohesiveLaw &law, const double u_N, const double u_T,
                const double v_N, const double v_T)
    {
      const unsigned int n = 20000;
      double sum = 0.;
      for (unsigned int i = 0; i < n; ++i) {
        const double s = (i + 0.5) / n;
        const double N = u_N + s * (v_N - u_N), T = u_T + s * (v_T - u_T);
        if (law.adds_openings()) { // none of them falls on these ways
          const double r = std::sqrt(law.shear_weight());
          sum += law.traction(N + r * T) * (v_N - u_N + r * (v_T - u_T));
          continue;
        }
        const double d = std::sqrt(N * N + law.shear_weight() * T * T);
        sum += law.secant(d) *
               (N * (v_N - u_N) + law.stiffness_ratio() * T * (v_T - u_T));
      }
      return sum / n;
    }

    // With a potential, opening first and slipping first take the same work;
    // without, they do not.
    void potential_means_one_work(const CohesiveLaw &law, Trial &trial)
    {
      const double G = law.toughness();
      const double end =
          std::min(end_of_softening(law), 3. * G / law.strength());
      const double N = 0.4 * end, T = 0.4 * end / std::sqrt(law.shear_weight());
      const double opening_first =
          work(law, 0., 0., N, 0.) + work(law, N, 0., N, T);
      const double slip_first =
          work(law, 0., 0., 0., T) + work(law, 0., T, N, T);
      const double difference = std::abs(opening_first - slip_first);
      if (!law.has_potential()) {
        trial.demand(difference >= 1e-4 * G,
                     "has_potential() is false, and both ways take {:.9g} "
                     "J/m^2",
                     opening_first);
        return;
      }
      trial.demand(difference <= 1e-6 * G,
                   "opening first takes {:.9g} J/m^2, slipping first {:.9g}",
                   opening_first, slip_first);
      const double both = law.adds_openings() ? 2. * N : std::sqrt(2.) * N;
      trial.near(opening_first, law.energy(both), 1e-6 * G,
                 "the work of opening and slip");
    }

    void secants_never_grow(const CohesiveLaw &law, Trial &trial)
    {
      const MixedLaw &mixed = *law.mixed();
      const double a = law.toughness() / law.strength(),
                   b = a / std::sqrt(law.shear_weight());
      for (double x = 0.; x < 3. * a; x += 0.1 * a)
        for (double y = 0.; y < 3. * b; y += 0.1 * b)
          for (const double share : {1e-3, 0.05, 1., 1e6})
            for (const bool opens : {true, false}) {
              const double X = x + (opens ? share * a : 0.),
                           Y = y + (opens ? 0. : share * b);
              trial.demand(mixed.normal_secant(X, Y) <=
                                   mixed.normal_secant(x, y) &&
                               mixed.tangential_secant(X, Y) <=
                                   mixed.tangential_secant(x, y) &&
                               std::isfinite(mixed.normal_secant(x, y)) &&
                               std::isfinite(mixed.tangential_secant(x, y)),
                           "from x = {:.9g} m, y = {:.9g} m to {:.9g}, {:.9g}",
                           x, y, X, Y);
            }
    }
  } // namespace

  std::vector<double> kinks(const CohesiveLaw &law)
  {
    std::vector<double> result = law.kinks();
    result.insert(result.end(), {0., law.elastic_limit(), law.peak_opening(),
                                 law.final_opening()});
    result.erase(std::remove_if(result.begin(), result.end(),
                                [](const double d) { return std::isinf(d); }),
                 result.end());
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  bool kink_between(const CohesiveLaw &law, const double lower,
                    const double upper)
  {
    for (const double kink : kinks(law))
      if (lower < kink && kink < upper)
        return true;
    return false;
  }

  double end_of_softening(const CohesiveLaw &law)
  {
    return std::isfinite(law.final_opening())
               ? law.final_opening()
               : law.peak_opening() + 30. * law.toughness() / law.strength();
  }

  std::vector<double> samples(const CohesiveLaw &law)
  {
    const double end = end_of_softening(law);
    std::vector<double> result;
    for (unsigned int i = 0; i <= 4000; ++i)
      result.push_back(1.5 * end * i / 4000.);
    for (const double kink : kinks(law))
      for (const double offset : {-1e-4, -1e-9, 0., 1e-9, 1e-4})
        result.push_back(std::max(0., kink + offset * end));
    for (const double factor : {1e1, 1e2, 1e4, 1e6, 1e9})
      result.push_back(factor * end);
    std::sort(result.begin(), result.end());
    return result;
  }

  namespace
  {
    // What heals closes down to the elastic limit, in any parts of the time.
    void healing_adds_up(const CohesiveLaw &law, Trial &trial)
    {
      const auto after = [&](const double d, const double time) {
        return law.healed_opening(d, law.strength(), time);
      };
      double time = 1.; // s, in which some of it heals
      for (unsigned int k = 0;
           k < 200 && after(std::numeric_limits<double>::infinity(), time) <=
                          1.01 * law.elastic_limit();
           ++k)
        time /= 2.;
      for (const double d : samples(law)) {
        const double once = after(d, time),
                     twice = after(after(d, time / 3.), 2. / 3. * time);
        trial.demand(once <= d && (once == d || once >= law.elastic_limit()),
                     "an opening of {:.9g} m heals to {:.9g} m", d, once);
        trial.near(twice, once, 1e-6 * once,
                   at("healing in two parts of the time", d));
        trial.demand(law.healed_opening(d, law.strength() / 2., time) >=
                         once * (1. - 1e-12),
                     "half of the pressure heals more at d = {:.9g} m", d);
      }
    }
  } // namespace

  std::vector<Promise> promises(const CohesiveLaw &law)
  {
    using Try = void (*)(const CohesiveLaw &, Trial &);
    std::vector<std::pair<const char *, Try>> all = {
        {"beta is 1 at first and never grows", beta_never_grows},
        {"traction, secant, beta and strength agree", traction_and_beta_agree},
        {"dissipation never falls and ends at the toughness",
         dissipation_never_falls},
        {"the energy is the integral of the traction", energy_is_the_integral},
        {"the steepest softening is attained", steepest_softening_is_attained}};
    if (law.mixed()) // its own functions are those of pure opening
      all.emplace_back("neither of the two secants grows", secants_never_grow);
    else
      all.emplace_back("a potential means one work on all ways",
                       potential_means_one_work);
    if (law.heals())
      all.emplace_back("healing adds up over time", healing_adds_up);
    std::vector<Promise> result;
    for (const auto &[text, attempt] : all) {
      Trial trial;
      attempt(law, trial);
      result.push_back({text, trial.failure()});
    }
    return result;
  }
} // namespace nsfd::law_contract
