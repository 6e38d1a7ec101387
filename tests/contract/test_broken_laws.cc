#include "every_law.h"

// Laws that break one promise each: it is named, with the place.

namespace every_law::test_broken_laws
{
  /** Linear softening, T = 1 - d / 2, G = 1, with something wrong. */
  struct Broken : public CohesiveLaw {
    bool extrinsic() const override { return true; }
    double normal_stiffness() const override
    {
      return std::numeric_limits<double>::infinity();
    }
    double stiffness_ratio() const override { return 1.; }
    double shear_weight() const override { return 1.; }
    double beta(const double d) const override { return traction(d); }
    double traction(const double d) const override
    {
      return std::max(0., 1. - d / 2.);
    }
    double energy(const double d) const override
    {
      return d < 2. ? d * (1. - d / 4.) : 1.;
    }
    double elastic_limit() const override { return 0.; }
    double peak_opening() const override { return 0.; }
    double final_opening() const override { return 2.; }
    double strength() const override { return 1.; }
    double toughness() const override { return 1.; }
    double steepest_softening() const override { return 0.5; }
  };

  /** The promises that are not kept. */
  std::vector<std::string> broken(const CohesiveLaw &law)
  {
    std::vector<std::string> texts;
    for (const auto &promise : law_contract::promises(law))
      if (!promise.failure.empty())
        texts.push_back(promise.text + ": " + promise.failure);
    return texts;
  }

  void expect_first(const CohesiveLaw &law, const std::string &text)
  {
    const auto found = broken(law);
    ASSERT_FALSE(found.empty()) << text;
    EXPECT_NE(found.front().find(text), std::string::npos) << found.front();
  }

  TEST(BrokenLaws, AreNamed)
  {
    EXPECT_EQ(broken(Broken()), std::vector<std::string>());

    struct Heals : Broken {
      double beta(const double d) const override
      {
        return d < 1. ? 1. - d / 2. : d < 2. ? 0.6 : 0.;
      }
    };
    expect_first(Heals(), "never grows: beta grows to 0.59");

    struct Stronger : Broken {
      double strength() const override { return 0.9; }
    };
    expect_first(Stronger(), "agree: the traction is 1 Pa at d = 0 m");

    struct Tougher : Broken {
      double toughness() const override { return 1.1; }
    };
    expect_first(Tougher(), "what is dissipated in the end is 1, expected 1.1");

    // the same at both ends, and never less dissipated
    struct OtherEnergy : Broken {
      double energy(const double d) const override
      {
        return Broken::energy(d) + (d < 2. ? 1e-3 * d * d * (2. - d) : 0.);
      }
    };
    expect_first(OtherEnergy(), "the slope of energy(d) against traction(d)");

    struct WrongIncrement : Broken {
      double energy_increment(const double d0, const double d1) const override
      {
        return (1. + 1e-6) * (energy(d1) - energy(d0));
      }
    };
    expect_first(WrongIncrement(),
                 "integral of the traction: energy_increment");

    struct Steeper : Broken {
      double steepest_softening() const override { return 0.6; }
    };
    expect_first(Steeper(), "falls by 0.5 Pa/m, steepest_softening() is 0.6");

    // C_T / C_N = r^2 to round-off claims a potential
    struct NotANumber : Broken {
      double traction(const double d) const override
      {
        return d > 1. && d < 1.01 ? std::numeric_limits<double>::quiet_NaN()
                                  : Broken::traction(d);
      }
      double beta(const double d) const override { return Broken::traction(d); }
    };
    expect_first(NotANumber(), "the traction is nan Pa at d = 1.0");
  }
} // namespace every_law::test_broken_laws
