#include "breaking_plate.h"
#include "make_scene.h"

#include "records/certificate.h"
#include "simulation/advice.h"
#include "simulation/zone_resolution.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

// What a run may say of itself.

namespace nsfd::test_certificate
{
  namespace
  {
    using Verdict = CertificateLine::Verdict;

    /** Of a run with contact and fracture in which all went well. */
    RunFacts good_facts()
    {
      RunFacts facts;
      facts.completed = true;
      facts.time = 1e-3;
      facts.steps = 100;
      facts.residual = 3e-9;
      facts.tolerance = 1e-8;
      facts.balance_residual = 2e-13;
      facts.given = {{"time scheme", 0., 1e-9, ""}};
      facts.penetration = 1e-7;
      facts.penetration_bound = 3e-7;
      facts.displacement = 1e-3;
      facts.softens = true;
      facts.zone = ZoneResolution{4e-3, 1e-3, "all"};
      facts.rejected = 2;
      facts.overshoots = 1;
      facts.extent = 1.;
      facts.limits.rotation = facts.limits.strain = facts.limits.stride =
          Peak{1e-3, 1e-4, {}};
      facts.limits.thickness = 0.1;
      facts.limits.joints = 1e-15;
      facts.limits.front =
          SharpFront{1e5, 0., 1e6, 1e-6, "Boundary: left", true, 1e10, 0.};
      return facts;
    }

    const CertificateLine &line(const Certificate &certificate,
                                const std::string &name)
    {
      for (const CertificateLine &line : certificate.lines)
        if (line.name == name)
          return line;
      throw std::out_of_range(name);
    }

    struct Fault {
      const char *name, *line;
      void (*make)(RunFacts &);
      Verdict verdict;
      const char *words;
    };
    constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

    const std::vector<Fault> faults = {
        {"Stopped", "end",
         [](RunFacts &f) {
           f.completed = false;
           f.failure = "stopped on request at t = 0.5\n  and so on";
         },
         Verdict::bad, "stopped on request at t = 0.5"},
        {"Residual", "residual", [](RunFacts &f) { f.residual = 1.1e-8; },
         Verdict::bad, "Solver/tolerance"},
        {"ResidualUnknown", "residual",
         [](RunFacts &f) { f.residual = nan_value; }, Verdict::bad, ""},
        {"Imbalance", "imbalance",
         [](RunFacts &f) {
           f.static_steps = 3;
           f.static_tolerance = 1e-11;
           f.imbalance = 1e-8;
         },
         Verdict::bad, ""},
        {"Penetration", "penetration",
         // below the largest bound, but above that of its point
         [](RunFacts &f) { f.penetration_excess = 1e-8; }, Verdict::bad,
         "10.0 nm deeper"},
        {"PenetrationOfAutomaticSteps", "penetration",
         [](RunFacts &f) {
           f.penetration_excess = 1e-8;
           f.automatic_steps = true;
         },
         Verdict::bad, "overlap at the start"},
        {"PenetrationBeyondRoundOff", "penetration",
         // positions of 1 m are known to some 1e-15 m, the tolerance is 1e-11 m
         [](RunFacts &f) { f.penetration_excess = 2e-11; }, Verdict::bad,
         "20.0 pm deeper"},
        {"Equilibria", "penetration",
         [](RunFacts &f) {
           f.static_steps = f.steps;
           f.steps = 0;
         },
         Verdict::not_measured, "equilibria"},
        {"Balance", "balance residual",
         [](RunFacts &f) { f.balance_residual = 1e-8; }, Verdict::bad,
         "balance is violated"},
        {"BalanceUnknown", "balance residual",
         [](RunFacts &f) { f.balance_residual = nan_value; }, Verdict::bad, ""},
        {"Given", "given by friction",
         [](RunFacts &f) {
           f.given = {{"friction", 2e-9, 1e-9, "set sliding = energy safe"}};
         },
         Verdict::bad, "energy created"},
        {"GivenUnknown", "given by friction",
         [](RunFacts &f) {
           f.given = {{"friction", nan_value, 1e-9, ""}};
         },
         Verdict::bad, ""},
        {"Uniqueness", "uniqueness", [](RunFacts &f) { f.beyond_unique = 7; },
         Verdict::bad, "in 7 of 100 steps"},
        {"UniquenessOfJumps", "uniqueness",
         [](RunFacts &f) {
           f.beyond_unique = 7;
           f.brittle = true;
         },
         Verdict::bad, "no step is short enough"},
        {"Jumps", "solution jumps",
         [](RunFacts &f) {
           f.static_steps = 3;
           f.solution_jumps = 1;
         },
         Verdict::bad, "set at solution jump = dynamic"},
        {"Zone", "cohesive zone",
         [](RunFacts &f) {
           f.zone = ZoneResolution{1e-3, 1e-3, "all"};
         },
         // a strength of sqrt(1 / 2.5)
         Verdict::bad, "points every 400 µm, or a strength 0.63 times"},
        {"Attempts", "rejected steps", [](RunFacts &f) { f.rejected = 99; },
         Verdict::bad, "shorten Time/step"},
        {"Rotation", "rotation",
         [](RunFacts &f) { f.limits.rotation->value = 3.; }, Verdict::bad,
         "motion = large"},
        {"Strain", "strain", [](RunFacts &f) { f.limits.strain->value = 2.; },
         Verdict::bad, "at t = 100 µs"},
        {"StrainUnknown", "strain",
         [](RunFacts &f) { f.limits.strain->value = nan_value; }, Verdict::bad,
         ""},
        {"StepLength", "way of a step",
         [](RunFacts &f) { f.limits.stride->value = 1.5; }, Verdict::bad,
         "take steps 3 times shorter"},
        {"Joints", "joints", [](RunFacts &f) { f.limits.joints = 1.; },
         Verdict::bad, "the same initial velocity"},
        {"Front", "front", [](RunFacts &f) { f.limits.front->stress = 2e7; },
         Verdict::bad, "Boundary: left brings 20.0 MPa"},
    };

    void PrintTo(const Fault &fault, std::ostream *stream)
    {
      *stream << fault.name;
    }

    class CertificateTest : public testing::TestWithParam<Fault>
    {
    };
  } // namespace

  TEST(Certificate, OfAGoodRunIsOk)
  {
    const Certificate certificate = certify(good_facts());
    EXPECT_TRUE(certificate.is_ok());
    EXPECT_EQ(certificate.verdict(), "ok");
    for (const CertificateLine &one : certificate.lines)
      EXPECT_EQ(one.verdict, Verdict::ok) << one.name;
    EXPECT_EQ(line(certificate, "cohesive zone").number, 4.);
    EXPECT_EQ(line(certificate, "rejected steps").number, 3.);
  }

  // No digits tell apart what is equal.
  TEST(Certificate, PrintsEqualNumbersShortly)
  {
    RunFacts facts = good_facts();
    facts.rejected = facts.steps;
    facts.overshoots = 0;
    const Certificate certificate = certify(facts);
    EXPECT_EQ(line(certificate, "rejected steps").verdict, Verdict::bad);
    EXPECT_EQ(line(certificate, "rejected steps").value, "100 steps");
    EXPECT_EQ(line(certificate, "rejected steps").bound, "less than 100 steps");
  }

  TEST_P(CertificateTest, NamesWhatIsNot)
  {
    const Fault &fault = GetParam();
    RunFacts facts = good_facts();
    fault.make(facts);
    const Certificate certificate = certify(facts);
    EXPECT_FALSE(certificate.is_ok());
    const CertificateLine &found = line(certificate, fault.line);
    EXPECT_EQ(found.verdict, fault.verdict);
    EXPECT_NE(found.remark.find(fault.words), std::string::npos)
        << found.remark;
    EXPECT_EQ(found.remark.find('\n'), std::string::npos);
    for (const CertificateLine &other : certificate.lines)
      EXPECT_TRUE(other.name == found.name || other.verdict == Verdict::ok)
          << other.name;
  }

  INSTANTIATE_TEST_SUITE_P(Faults, CertificateTest, testing::ValuesIn(faults),
                           [](const auto &info) {
                             return std::string(info.param.name);
                           });

  // A block at rest far from the origin, or one that has come a long way: its
  // overlap is that of its positions.
  TEST(Certificate, TakesRoundOffForWhatItIs)
  {
    constexpr double unit = std::numeric_limits<double>::epsilon();
    for (const double extent : {1e-6, 1., 1e4}) {
      RunFacts facts = good_facts();
      facts.displacement = facts.penetration_bound = 0.;
      facts.extent = extent;
      facts.penetration = facts.penetration_excess = 4. * unit * extent;
      EXPECT_EQ(line(certify(facts), "penetration").verdict, Verdict::ok);
      facts.penetration = facts.penetration_excess = 40. * unit * extent;
      EXPECT_EQ(line(certify(facts), "penetration").verdict, Verdict::bad);
    }
  }

  TEST(Certificate, NamesNoSettingThatIsSet)
  {
    RunFacts facts = good_facts();
    facts.automatic_steps = facts.follows_jumps = true;
    facts.static_steps = 3;
    facts.solution_jumps = 1;
    facts.penetration_excess = 1e-3;
    facts.rejected = 1000;
    facts.limits.stride->value = 2.;
    const Certificate certificate = certify(facts);
    EXPECT_EQ(line(certificate, "solution jumps").remark.find("set at"),
              std::string::npos);
    for (const char *name : {"penetration", "rejected steps"}) {
      const std::string &remark = line(certificate, name).remark;
      EXPECT_EQ(line(certificate, name).verdict, Verdict::bad);
      EXPECT_EQ(remark.find("shorten Time/step"), std::string::npos) << remark;
      EXPECT_EQ(remark.find("moreau-jean"), std::string::npos) << remark;
    }
  }

  // 0.016 / viscosity of 20 strengths
  TEST(Certificate, NamesWhatTakesAFrontToItsBound)
  {
    RunFacts facts = good_facts();
    SharpFront &front = *facts.limits.front;
    front.stress = 2e7;
    const std::string remark = line(certify(facts), "front").remark;
    EXPECT_NE(remark.find("rise over 80 µs"), std::string::npos) << remark;
    front.viscosity =
        1.01 * front.enough_viscosity() / (front.modulus * front.crossing);
    EXPECT_NEAR(front.viscosity, 1.01 * 1.28, 1e-12);
    EXPECT_EQ(line(certify(facts), "front").verdict, Verdict::ok);
    front.can_rise = false;
    front.viscosity = 0.;
    EXPECT_EQ(line(certify(facts), "front").remark.find("rise"),
              std::string::npos);
  }

  TEST(Certificate, HasNoFrontToFearWhereNothingSoftens)
  {
    RunFacts facts = good_facts();
    facts.limits.front->stress = 2e7;
    facts.zone.reset();
    EXPECT_EQ(line(certify(facts), "front").verdict, Verdict::ok);
  }

  TEST(Certificate, SaysOkToNothingThatWasNotMeasured)
  {
    RunFacts no_steps;
    no_steps.given = {{"friction", 0., 1e-9, ""}};
    const Certificate nothing = certify(no_steps);
    EXPECT_FALSE(nothing.is_ok());
    for (const CertificateLine &one : nothing.lines)
      EXPECT_NE(one.verdict, Verdict::ok) << one.name;

    RunFacts smooth;
    smooth.completed = true;
    smooth.smooth_steps = 10;
    smooth.given = {{"time scheme", 0., 1e-9, ""}};
    const Certificate integrated = certify(smooth);
    EXPECT_EQ(line(integrated, "residual").verdict, Verdict::not_measured);
    EXPECT_EQ(line(integrated, "penetration").verdict, Verdict::none);
    EXPECT_EQ(integrated.verdict(),
              "ok as far as measured, 1 of 8 lines are not");
  }

  TEST(Certificate, OfARunWithoutCohesionIsOk)
  {
    RunFacts facts = good_facts();
    facts.softens = false;
    facts.zone.reset();
    const Certificate certificate = certify(facts);
    EXPECT_EQ(line(certificate, "cohesive zone").verdict, Verdict::none);
    EXPECT_TRUE(certificate.is_ok());
  }

  TEST(Certificate, IsALinePerNumberAndAligned)
  {
    RunFacts facts = good_facts();
    facts.penetration_excess = 1e-3; // a remark of several lines
    std::istringstream text(certificate_text(certify(facts)));
    std::string first, row;
    std::getline(text, first);
    EXPECT_EQ(first, "certificate: 1 of 13 lines not ok");
    std::size_t n = 0, place = 0;
    while (std::getline(text, row)) {
      EXPECT_LE(row.size(), 82u) << row; // two bytes of a micro sign
      EXPECT_NE(row.back(), ' ');
      if (row.substr(0, 3) == "   ")
        continue; // of a remark
      if (row.find("not ok") != std::string::npos) {
        ++n;
        continue;
      }
      const std::size_t ok = row.find("  ok");
      ASSERT_NE(ok, std::string::npos) << row;
      if (row.find("µ") == std::string::npos) {
        EXPECT_TRUE(place == 0 || ok == place) << row;
        place = ok;
      }
      ++n;
    }
    EXPECT_EQ(n, 13u);
  }

  // just beyond its bound: as many digits as show it
  TEST(Certificate, TellsWhatIsBadFromItsBound)
  {
    RunFacts facts = good_facts();
    facts.residual = 1.001e-8;
    facts.given[0].share = 1.04e-9;
    facts.balance_residual = 1e-9 * (1. + 1e-12);
    facts.limits.strain->value = 0.05001;
    facts.penetration = facts.penetration_bound = 1.38e-6;
    facts.penetration_excess = 1.38e-6;
    const Certificate certificate = certify(facts);
    const auto texts = [&](const char *name) {
      const auto &it = line(certificate, name);
      EXPECT_EQ(it.verdict, Verdict::bad) << name;
      return it.value + " " + it.bound;
    };
    EXPECT_EQ(texts("residual"), "1.001e-08 at most 1.000e-08");
    EXPECT_EQ(texts("given by time scheme"), "1.04e-09 at most 1.00e-09");
    EXPECT_EQ(texts("balance residual"),
              "1.000000000001e-09 at most 1.000000000000e-09");
    EXPECT_EQ(texts("strain"), "5.001 % at most 5 %");
    // of a point beyond its own bound, not of that of all
    EXPECT_EQ(texts("penetration"), "1.38 µm at most 10.0 pm");
    facts = good_facts();
    facts.penetration_excess = 1.0001 * *line(certificate, "penetration").limit;
    const auto near = line(certify(facts), "penetration");
    EXPECT_NE(near.value, near.bound.substr(8));
  }

  TEST(Certificate, BreaksNoLineBehindANumber)
  {
    EXPECT_EQ(wrapped("it is 12 m away", 2, 10), "  it is\n  12 m\n  away\n");
    EXPECT_EQ(wrapped("of 1 2 3 m", 0, 4), "of\n1 2 3 m\n");
    EXPECT_EQ(wrapped("", 2), "");
  }

  // ------------------------------------------------------------ cohesive zone

  // L_czm is that of (50) times toughness / strength^2 of the point
  TEST(ZoneResolution, IsThatOfTheWorstPointThatSoftens)
  {
    test::Scene<2> scene(test::breaking_plate,
                         {"Mesh/distortion=0",
                          "Interface: all/strength scatter=0",
                          "Interface: all/strength factor=x > 1.2 ? 1.5 : 1"});
    const auto &points = scene.discretization->points();
    const auto worst = [&] {
      return zone_resolution(*scene.input, *scene.discretization,
                             scene.stepper->problem(), scene.state,
                             scene.communicator);
    };
    const auto soften = [&](const bool right) {
      for (std::size_t i = 0; i < points.n_points; ++i)
        if (points.position[2 * i] < 1.1 || right)
          scene.state.beta[i] = 0.9;
    };
    const double length =
        cohesive_length(100., 0.3, *scene.input->interfaces[0].law);
    EXPECT_FALSE(worst()) << "nothing has softened";
    soften(false);
    const auto left = worst();
    ASSERT_TRUE(left);
    EXPECT_NEAR(left->length, length, 1e-12 * length);
    EXPECT_NEAR(left->spacing, 1. / 6., 1e-12) << "two points on 1/3 m";
    EXPECT_EQ(left->interface, "all");
    soften(true);
    const auto both = worst();
    ASSERT_TRUE(both);
    EXPECT_NEAR(both->length, length / (1.5 * 1.5), 1e-12 * length);
  }
} // namespace nsfd::test_certificate
