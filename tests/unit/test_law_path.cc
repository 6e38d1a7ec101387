#include "material_point/drive_point.h"
#include "material_point/read_law.h"
#include "nsfd/cohesive_laws/cohesive_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

// `nsfd law`: what a point does along a path. Exact values are closed forms;
// tractions at the end of a step are evaluated there, so 1e-12 is a few hundred
// round-offs.

using namespace nsfd;

namespace test_law_path
{
  using Curve = std::vector<CurveRow>;

  std::unique_ptr<LawInput> read(const std::string &what,
                                 const std::vector<std::string> &overrides = {})
  {
    InputErrors errors;
    auto input = read_law(what, overrides, errors);
    EXPECT_EQ(errors.report(), "");
    return input;
  }

  std::string errors_of(const std::string &what,
                        const std::vector<std::string> &overrides)
  {
    InputErrors errors;
    EXPECT_EQ(read_law(what, overrides, errors), nullptr);
    return errors.report();
  }

  Curve drive(const LawInput &input, const std::size_t i = 0)
  {
    return drive_point(input.curves.at(i).interaction,
                       input.curves.at(i).points, input.cohesion_rule);
  }

  Curve drive(const std::string &what,
              const std::vector<std::string> &overrides = {})
  {
    const auto input = read(what, overrides);
    return input ? drive(*input) : Curve(1);
  }

  /** The row in which the point has reached a mark. */
  const CurveRow &at(const Curve &curve, const double mark)
  {
    for (const CurveRow &row : curve)
      if (row.path == mark)
        return row;
    ADD_FAILURE() << "no mark " << mark;
    return curve.back();
  }

  /** The row in which it is about to leave the mark. */
  const CurveRow &leaving(const Curve &curve, const double mark)
  {
    for (auto row = curve.rbegin(); row != curve.rend(); ++row)
      if (row->path == mark)
        return *row;
    ADD_FAILURE() << "no mark " << mark;
    return curve.back();
  }

  /** C = 5, R_max = 2, so d_c = 0.4 and Delta = 1.2. */
  std::vector<std::string> michel_suquet(std::vector<std::string> more)
  {
    more.insert(more.begin(), {"stiffness=5", "strength=2"});
    return more;
  }
  constexpr double d_c = 0.4, R_max = 2.;

  /** The effective opening. */
  double opening_of(const CohesiveLaw &law, const CurveRow &row)
  {
    return std::sqrt(row.opening * row.opening +
                     law.shear_weight() * row.slip * row.slip);
  }

  std::vector<std::string> law_names()
  {
    return CohesiveLawRegistry::instance().names();
  }

  // Figure 5, left: marks of [AM06], in units of d_c and R_max.
  TEST(LawPath, NormalCycle)
  {
    const double F = 1.4;
    const Curve curve =
        drive("michel-suquet",
              michel_suquet(
                  {"Path/type=points",
                   "Path/opening=0, 0.6, 0, 0, 0, 0.6, 0.8, 0.2, 1.2, 0, 0, "
                   "0, 0.4",
                   "Path/reaction=0, 0, 0, 1.4, 0, 0, 0, 0, 0, 0, 1.4, 0, "
                   "0"}));
    const double expected[] = {0.,      0.9, 0., 0., 0., 0.9, 2. / 3.,
                               1. / 6., 0.,  0., 0., 0., 0.};
    const double damaged[] = {1.,      0.6, 0.6, 0.6, 0.6, 0.6, 1. / 3.,
                              1. / 3., 0.,  0.,  0.,  0.,  0.};
    for (unsigned int i = 0; i < 13; ++i) {
      const CurveRow &row = at(curve, i);
      EXPECT_NEAR(row.cohesive_normal, expected[i] * R_max, 1e-12) << i;
      EXPECT_NEAR(row.beta, damaged[i], 1e-12) << i;
      const bool pressed = i == 3 || i == 10;
      EXPECT_EQ(row.contact, pressed ? F : 0.) << i;
      if (pressed) {
        EXPECT_EQ(row.opening, 0.) << i;
      }
    }
    EXPECT_NEAR(curve.back().damage, (4.5 - 4. * std::log(2.)) * R_max * d_c,
                1e-12);
  }

  // Figure 5, right: cohesion and friction of both signs; s = 3.
  TEST(LawPath, ShearCycle)
  {
    const double N = 3., mu = 0.4;
    const auto run = [&](const std::string &steps) {
      return drive("michel-suquet",
                   michel_suquet({"friction=0.4", "friction exponent=3",
                                  "Path/type=points",
                                  "Path/slip=0, 0.6, 0, -0.6, -0.8, 0.8, 1.2, "
                                  "1.6",
                                  "Path/reaction=3", "Path/steps=" + steps}));
    };
    const Curve curve = run("1000");
    const double k_2 = 8. / 27.;
    const double arrives[][2] = {
        {0., 0.},         {0.9, 0.064},   {0., -0.064}, {-0.9, -0.064},
        {-2. / 3., -k_2}, {2. / 3., k_2}, {0., 1.},     {0., 1.}};
    for (unsigned int i = 0; i < 8; ++i)
      EXPECT_NEAR(at(curve, i).tangential(),
                  arrives[i][0] * R_max + arrives[i][1] * mu * N, 1e-12)
          << i;
    EXPECT_NEAR(leaving(curve, 1).tangential(), 0.9 * R_max - 0.064 * mu * N,
                1e-12);
    EXPECT_NEAR(leaving(curve, 4).tangential(), -2. / 3. * R_max + k_2 * mu * N,
                1e-12);
    for (const CurveRow &row : curve)
      EXPECT_EQ(row.opening, 0.);
    EXPECT_NEAR(curve.back().damage, (4.5 - 4. * std::log(2.)) * R_max * d_c,
                1e-12);

    // friction work: mu N d_c times the integral of kappa over the way
    const auto primitive = [](const double x) {
      return 8. * x - 48. * std::log(1. + x) - 96. / (1. + x) +
             32. / ((1. + x) * (1. + x));
    };
    const double exact =
        mu * N * d_c *
        (primitive(3.) - primitive(1.) + 3. * 0.064 + 4. * k_2 + 1.);
    // Friction of the end of a step acts over all of it: first order, from
    // above, by half a step times the growth of kappa from 0 to 1.
    const double coarse = curve.back().friction_work - exact,
                 fine = run("2000").back().friction_work - exact;
    const double step = 11. * d_c / 1000;
    EXPECT_NEAR(coarse / (mu * N * step), 0.5, 0.02);
    EXPECT_NEAR(coarse / fine, 2., 0.05);
  }

  // Figures 3 and 4: tangential traction and friction work up to separation.
  TEST(LawPath, ShearMonotone)
  {
    struct Row {
      std::string law;
      std::vector<std::string> entries;
      double unit, final_slip; ///< of the friction work, of the slip
      double exact[3];
    };
    const double ln2 = std::log(2.);
    const Row rows[] = {{"tvergaard",
                         {"strength=2", "critical opening=0.6"},
                         0.6,
                         0.6,
                         {2. / 3., 8. / 15., 16. / 35.}},
                        {"michel-suquet",
                         {"stiffness=5", "strength=2"},
                         d_c,
                         3. * d_c,
                         {4. - 4. * ln2, 12. - 16. * ln2, 34. - 48. * ln2}}};
    for (const Row &row : rows)
      for (unsigned int s = 1; s <= 3; ++s) {
        const auto run = [&](const unsigned int steps) {
          std::vector<std::string> entries = row.entries;
          entries.insert(entries.end(),
                         {"friction=0.4",
                          "friction exponent=" + std::to_string(s),
                          "Path/type=shear", "Path/reaction=3",
                          "Path/steps=" + std::to_string(steps)});
          const Curve curve = drive(row.law, entries);
          const CurveRow &end = at(curve, 1);
          EXPECT_NEAR(end.slip, row.final_slip, 1e-14);
          EXPECT_NEAR(end.tangential(), 0.4 * 3., 1e-12);
          return end.friction_work / (0.4 * 3. * row.unit);
        };
        const double coarse = run(600), fine = run(1200);
        const double exact = row.exact[s - 1];
        EXPECT_NEAR((coarse - exact) / (fine - exact), 2., 0.05)
            << row.law << ", s = " << s << ": first order";
        // extrapolated: second order, kappa'' below 10 in these units
        EXPECT_NEAR(2. * fine - coarse, exact, 2e-5)
            << row.law << ", s = " << s;
      }
  }

  TEST(LawPath, TractionsAreOnTheEnvelope)
  {
    for (const std::string &name : law_names()) {
      const auto input = read(name);
      ASSERT_TRUE(input);
      const CohesiveLaw &law = *input->curves[0].interaction.law;
      double reached = law.elastic_limit();
      for (const CurveRow &row : drive(*input)) {
        reached = std::max(reached, row.opening);
        if (row.opening == 0.)
          continue;
        const double share = law.adds_openings() ? reached : row.opening;
        const double expected = law.traction(reached) * share / reached;
        EXPECT_NEAR(row.cohesive_normal, expected, 1e-12 * law.strength())
            << name << " at " << row.opening;
        EXPECT_EQ(row.beta, law.mixed() ? law.mixed()->beta(reached, 0.)
                                        : law.beta(reached))
            << name << " at " << row.opening;
      }
    }
  }

  // However a point gets there: separation takes the toughness.
  TEST(LawPath, EveryLawLosesItsToughness)
  {
    for (const std::string &name : law_names())
      for (const NamedPath &path : named_paths())
        for (const char *rule : {"end point", "exact"}) {
          const auto input = read(
              name, {"friction=0.3", "Path/type=" + path.name, "Path/steps=200",
                     std::string("Path/cohesion rule=") + rule});
          ASSERT_TRUE(input);
          const CohesiveLaw &law = *input->curves[0].interaction.law;
          if (law.mixed() && path.name != "opening")
            continue; // other ways take other energies
          const double G = law.toughness();
          const Curve curve = drive(*input);
          const CurveRow &end = curve.back();
          const std::string where = name + ", " + path.name + ", " + rule;
          ASSERT_TRUE(law.has_potential() || law.mixed()) << where;
          if (std::isfinite(law.final_opening())) {
            EXPECT_NEAR(end.damage, G, 1e-10 * G) << where;
            EXPECT_EQ(end.stored, 0.) << where;
          } else {
            // an endless tail: the path ends where 99 % or more have been spent
            double reached = 0.;
            for (const CurveRow &row : curve)
              reached = std::max(reached, opening_of(law, row));
            EXPECT_NEAR(law.energy(opening_scale(law)), 0.99 * G, 1e-9 * G);
            EXPECT_GE(reached, 0.999999 * opening_scale(law)) << where;
            const double d = opening_of(law, end);
            EXPECT_NEAR(end.stored, 0.5 * law.secant(reached) * d * d,
                        1e-10 * G)
                << where;
            EXPECT_NEAR(end.damage,
                        law.energy(reached) -
                            0.5 * law.traction(reached) * reached,
                        1e-10 * G)
                << where;
          }
          for (const CurveRow &row : curve)
            EXPECT_TRUE(std::string(rule) != "exact" ||
                        std::abs(row.numerical()) <= 1e-10 * G)
                << where << " at " << row.path << ": " << row.numerical();
          for (std::size_t i = 1; i < curve.size(); ++i) {
            EXPECT_LE(curve[i].beta, curve[i - 1].beta) << where;
            EXPECT_GE(curve[i].damage, curve[i - 1].damage) << where;
            EXPECT_GE(curve[i].friction_work, curve[i - 1].friction_work)
                << where;
          }
        }
  }

  TEST(LawPath, OneStepIsEnough)
  {
    for (const std::string &name : law_names()) {
      const auto input = read(name, {"Path/steps=0"});
      ASSERT_TRUE(input);
      const CohesiveLaw &law = *input->curves[0].interaction.law;
      if (!std::isfinite(law.final_opening()))
        continue;
      EXPECT_NEAR(drive(*input).back().damage, law.toughness(),
                  1e-10 * law.toughness())
          << name;
    }
  }

  // No law loses its way, whatever the step; what is dissipated stays so.
  TEST(LawPath, RandomPaths)
  {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0., 1.);
    for (const std::string &name : law_names())
      for (const char *rule : {"end point", "end velocity", "exact"})
        for (const char *exponent : {"0", "1", "3"}) {
          auto input = read(name, {"friction=0.6",
                                   std::string("friction exponent=") + exponent,
                                   std::string("Path/cohesion rule=") + rule});
          const CohesiveLaw &law = *input->curves[0].interaction.law;
          for (unsigned int k = 0; k < 20; ++k) {
            auto &points = input->curves[0].points;
            points.assign(1, {});
            for (unsigned int i = 1; i <= 60; ++i) {
              const double size = 1.2 * i / 60.;
              const bool pressed = uniform(random) < 0.4;
              const double slip = (2. * uniform(random) - 1.) * slip_scale(law);
              PathMark mark = {
                  pressed ? 0. : size * uniform(random) * opening_scale(law),
                  size * slip, pressed ? uniform(random) * law.strength() : 0.};
              if (uniform(random) < 0.2)
                mark.opening = points.back().at.opening * !pressed;
              if (uniform(random) < 0.2)
                mark.slip = points.back().at.slip;
              points.push_back({double(i), mark});
            }
            const Curve curve = drive(*input);
            const std::string where = name + ", " + rule + ", " + exponent;
            for (std::size_t i = 1; i < curve.size(); ++i) {
              const CurveRow &row = curve[i], &last = curve[i - 1];
              EXPECT_TRUE(std::isfinite(row.work + row.stored)) << where;
              EXPECT_LE(row.beta, last.beta) << where;
              EXPECT_GE(row.damage, last.damage) << where;
              // a place is reached to 1e-12 of the step, with two scalars 1e-6
              EXPECT_GE(row.friction_work,
                        last.friction_work - 1e-12 * law.toughness())
                  << where;
              if (!law.mixed()) {
                EXPECT_LE(row.damage, law.toughness() * (1. + 1e-12)) << where;
              }
            }
          }
        }
  }

  TEST(LawPath, RigidJointsStartAtTheStrength)
  {
    const Curve curve = drive("camacho-ortiz", {"Path/type=mixed"});
    EXPECT_EQ(curve[0].normal(), 0.);
    EXPECT_EQ(curve[1].opening, 0.);
    EXPECT_NEAR(std::hypot(curve[1].normal(), curve[1].tangential()), 300e6,
                1e-12 * 300e6);
  }

  TEST(LawPath, LargestTractionIsMet)
  {
    for (const std::string &name : law_names()) {
      const auto input = read(name, {"Path/steps=10"});
      double largest = 0.;
      for (const CurveRow &row : drive(*input))
        largest = std::max(largest, row.normal());
      const double strength = input->curves[0].interaction.law->strength();
      // kinks are steps of their own; before a drop by 1e-9 of the opening
      EXPECT_NEAR(largest, strength, 2e-9 * strength) << name;
    }
  }

  TEST(LawPath, FormulaInPlaceOfMarks)
  {
    const Curve curve = drive(
        "tvergaard", {"Path/type=formula", "Path/opening=1 um * sin(pi * t)^2",
                      "Path/slip=0.5 um * t", "Path/steps=100"});
    EXPECT_EQ(at(curve, 0.5).opening, 1e-6);
    EXPECT_NEAR(at(curve, 1.).slip, 0.5e-6, 1e-21);
  }

  TEST(LawPath, PathsThatStartElsewhere)
  {
    const Curve curve =
        drive("tvergaard", {"Path/type=points", "Path/opening=1 um, 0"});
    EXPECT_EQ(curve[0].opening, 0.);
    EXPECT_EQ(curve[0].path, -1.);
    EXPECT_EQ(at(curve, 0.).opening, 1e-6);
    EXPECT_EQ(curve.back().path, 1.);
  }

  TEST(LawInput, ExampleGivesWayToWhatIsGiven)
  {
    const auto law = [](const std::vector<std::string> &overrides) {
      return read("tvergaard", overrides)->curves[0].interaction.law;
    };
    EXPECT_EQ(law({})->strength(), 3e6);
    EXPECT_EQ(law({"strength=5 MPa"})->strength(), 5e6);
    EXPECT_EQ(law({"strength=5 MPa"})->final_opening(), 2e-6);
    // tied to the critical opening of the example
    EXPECT_NEAR(law({"toughness=9 J/m^2"})->toughness(), 9., 1e-14);
    EXPECT_EQ(law({"toughness=9 J/m^2"})->strength(), 3e6);
    EXPECT_NEAR(law({"strength=4", "toughness=9"})->toughness(), 9., 1e-14);
    EXPECT_EQ(read("tvergaard", {"toughness=9 J/m^2"})->entries,
              "strength = 3 MPa (example); toughness = 9 J/m^2");
  }

  TEST(LawInput, ErrorsComeAllAtOnce)
  {
    const std::string report = errors_of(
        "tvergaard", {"strenght=3 MPa", "friction=-1", "Path/type=opning",
                      "Path/steps=1.5", "Pth/steps=3", "restitution=1"});
    for (const char *text :
         {"did you mean `strength`?", "friction = -1",
          "did you mean `opening`?", "steps = 1.5", "did you mean `Path`?",
          "there are no faces", "6 errors"})
      EXPECT_NE(report.find(text), std::string::npos) << text << "\n" << report;

    EXPECT_NE(errors_of("tvergard", {}).find("did you mean `tvergaard`?"),
              std::string::npos);
    const std::string unknown = errors_of("glue", {});
    for (const std::string &name : law_names())
      EXPECT_NE(unknown.find(name), std::string::npos) << unknown;
  }

  TEST(LawInput, ImpossiblePaths)
  {
    const auto expect = [](const std::vector<std::string> &path,
                           const std::string &text) {
      std::vector<std::string> overrides = {"Path/type=points"};
      overrides.insert(overrides.end(), path.begin(), path.end());
      const std::string report = errors_of("tvergaard", overrides);
      EXPECT_NE(report.find(text), std::string::npos) << report;
    };
    expect({}, "two marks or more");
    expect({"Path/opening=1 um"}, "two marks or more");
    expect({"Path/opening=0, 1 um", "Path/slip=0, 1 um, 2 um"},
           "`opening` has 2 values, but the path has 3 marks");
    expect({"Path/opening=0, -1 um"}, "must not be negative");
    expect({"Path/opening=0, 1 MPa"}, "must be a length");
    expect({"Path/opening=0, 1 um", "Path/reaction=1 MPa"},
           "an open point is not pressed");
    expect({"Path/opening=0, 1 um, 0", "Path/reaction=0, 0, 1 MPa"},
           "an open point is not pressed");
    EXPECT_NE(errors_of("tvergaard",
                        {"Path/type=formula", "Path/opening=1 um * sin(7 * t)"})
                  .find("contact keeps u_N >= 0"),
              std::string::npos);
    EXPECT_NE(errors_of("tvergaard",
                        {"Path/type=formula", "Path/opening=1 um / (1 - t)"})
                  .find("not finite"),
              std::string::npos);
    EXPECT_NE(
        errors_of("tvergaard", {"Path/reaction=1 MPa"}).find("never presses"),
        std::string::npos);
  }

  // The echo of what was read reads the same.
  TEST(LawInput, EchoReproducesTheCurve)
  {
    const auto input =
        read("michel-suquet", {"friction=0.3", "Path/type=shear cycle"});
    InputErrors errors;
    const auto again = read_law_text(input->echo, "again.prm", {}, errors);
    ASSERT_TRUE(again) << errors.report();
    EXPECT_EQ(again->directory, "output/law_michel-suquet");
    const Curve first = drive(*input), second = drive(*again);
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      EXPECT_EQ(first[i].tangential(), second[i].tangential());
      EXPECT_EQ(first[i].work, second[i].work);
    }
  }

  TEST(LawInput, SeveralLawsOnOnePath)
  {
    const std::string text = R"(
subsection Interface: first
  set law              = tvergaard
  set strength         = 1
  set critical opening = 1
end
subsection Interface: second
  set law       = michel-suquet
  set strength  = 2
  set stiffness = 1
end
)";
    InputErrors errors;
    const auto input = read_law_text(text, "two.prm", {}, errors);
    ASSERT_TRUE(input) << errors.report();
    ASSERT_EQ(input->curves.size(), 2u);
    EXPECT_EQ(drive(*input, 0).back().opening, 1.1);
    EXPECT_EQ(drive(*input, 1).back().opening, 1.1 * 6.);

    InputErrors ambiguous;
    EXPECT_EQ(read_law_text(text, "two.prm", {"friction=1"}, ambiguous),
              nullptr);
    EXPECT_NE(ambiguous.report().find("Interface: first/"), std::string::npos)
        << ambiguous.report();
  }
} // namespace test_law_path
