#include "law_checks.h"

#include "material_point/drive_point.h"

#include <filesystem>
#include <fstream>
#include <random>
#include <unistd.h>

using namespace nsfd;
using namespace nsfd::test;

namespace test_law_tabulated
{
  namespace fs = std::filesystem;

  /** A file of this test alone; the absolute path. */
  std::string write_file(const std::string &name, const std::string &content)
  {
    const auto *test = testing::UnitTest::GetInstance()->current_test_info();
    const fs::path path = fs::path(testing::TempDir()) /
                          ("nsfd_tabulated_" + std::to_string(::getpid())) /
                          test->name() / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << content;
    return path.string();
  }

  std::unique_ptr<CohesiveLaw> tabulated(const std::string &curve)
  {
    return make_law("tabulated", {{"curve", write_file("curve.csv", curve)}});
  }

  void expect_same(const CohesiveLaw &law, const CohesiveLaw &reference)
  {
    EXPECT_EQ(law.extrinsic(), reference.extrinsic());
    if (!law.extrinsic())
      expect_relative(law.normal_stiffness(), reference.normal_stiffness());
    expect_relative(law.strength(), reference.strength());
    expect_relative(law.toughness(), reference.toughness());
    EXPECT_DOUBLE_EQ(law.elastic_limit(), reference.elastic_limit());
    EXPECT_DOUBLE_EQ(law.peak_opening(), reference.peak_opening());
    EXPECT_DOUBLE_EQ(law.final_opening(), reference.final_opening());
    expect_relative(law.steepest_softening(), reference.steepest_softening());
    for (const double x : {0., 0.01, 0.1, 0.2, 0.4, 0.6, 0.9, 0.99}) {
      const double d = x * reference.final_opening();
      expect_relative(law.beta(d), reference.beta(d), 1e-12 / (1. - x));
      expect_relative(law.traction(d), reference.traction(d), 1e-12 / (1. - x));
      expect_relative(law.energy(d), reference.energy(d));
      // the others take differences of energies
      expect_relative(law.energy_increment(d, 1.3 * d),
                      reference.energy_increment(d, 1.3 * d),
                      1e-13 / ((1. - x) * (1. - x)));
    }
  }

  TEST(Tabulated, Trapezoid)
  {
    const auto reference = make_law(
        "trapezoid", {{"strength", "3 MPa"}, {"critical opening", "2 um"}});
    const auto law = tabulated("0, 0\n0.3e-6, 3e6\n1e-6, 3e6\n2e-6, 0\n");
    expect_same(*law, *reference);
    expect_toughness(*law, {0., 0.3e-6, 1e-6, 2e-6});
    expect_broken_beyond(*law, 2e-6);
    expect_slope(*law, 1.5e-6, -3e12, 1e-10);
  }

  TEST(Tabulated, ExtrinsicAndLinear)
  {
    const auto reference = make_law(
        "camacho-ortiz", {{"strength", "3 MPa"}, {"critical opening", "2 um"}});
    const auto law = tabulated("0, 3 MPa\n2 um, 0\n");
    expect_same(*law, *reference);
    EXPECT_EQ(law->traction(0.), 3e6);
    // a point on the line changes nothing
    expect_same(*tabulated("0, 3 MPa\n0.5 um, 2.25 MPa\n2 um, 0\n"),
                *reference);
    expect_toughness(*law, {0., 2e-6});
    expect_broken_beyond(*law, 2e-6);
  }

  TEST(Tabulated, WaysToWriteACurve)
  {
    const auto plain = tabulated("0,0\n2e-7,3e6\n2e-6,0");
    for (const char *curve :
         {"opening, traction\n0, 0\n0.2 um, 3 MPa\n2 um, 0\n",
          "# measured on Monday\n\nopening [m], traction [Pa]\r\n0, 0\r\n"
          "2e-7, 3e6 # peak\r\n2e-6, 0\r\n",
          "\xEF\xBB\xBF"
          "2e-7, 3e6\n2e-6, 0\n",
          // a point on the first line, off by its digits
          "0, 0\n1e-7, 1.5000000001e6\n2e-7, 3e6\n2e-6, 0\n"}) {
      SCOPED_TRACE(curve);
      const auto law = tabulated(curve);
      EXPECT_DOUBLE_EQ(law->elastic_limit(), 2e-7);
      EXPECT_EQ(law->beta(1.5e-7), 1.);
      expect_relative(law->normal_stiffness(), plain->normal_stiffness(), 1e-9);
      expect_relative(law->toughness(), plain->toughness(), 1e-9);
      expect_relative(law->traction(1e-6), plain->traction(1e-6), 1e-9);
    }
  }

  TEST(Tabulated, ManyPoints)
  {
    // Tvergaard's law at 2000 openings: off by T'' h^2 / 8
    const auto exact = make_law(
        "tvergaard", {{"strength", "3 MPa"}, {"critical opening", "2 um"}});
    std::string curve;
    const unsigned int n = 2000;
    for (unsigned int i = 0; i <= n; ++i) {
      char line[80];
      const double d = 2e-6 * i / n;
      std::snprintf(line, sizeof line, "%.17g, %.17g\n", d,
                    i == n ? 0. : exact->traction(d));
      curve += line;
    }
    const auto law = tabulated(curve);
    EXPECT_EQ(law->beta(0.), 1.);
    expect_relative(law->strength(), 3e6, 1e-6);
    expect_relative(law->peak_opening(), 2e-6 / 3., 1e-3);
    expect_relative(law->toughness(), exact->toughness(), 1e-6);
    expect_relative(law->steepest_softening(), exact->steepest_softening(),
                    1e-6);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0., 1.);
    double last = 1.;
    for (unsigned int i = 0; i < 20000; ++i) {
      const double d = 2e-6 * i / 20000.;
      EXPECT_NEAR(law->traction(d), exact->traction(d), 1e-5 * 3e6);
      EXPECT_LE(law->beta(d), last);
      last = law->beta(d);
      const double d0 = 2e-6 * unit(random),
                   d1 = i % 2 ? 2e-6 * unit(random)
                              : d0 * (1. + 1e-3 * unit(random));
      EXPECT_NEAR(law->energy_increment(d0, d1),
                  law->energy(d1) - law->energy(d0), 1e-14 * 3.375);
    }
  }

  TEST(Tabulated, PointsOfTheScene)
  {
    const auto from_file =
        tabulated("0, 0\n0.3 um, 3 MPa\n1 um, 2.5 MPa\n2 um, 0\n");
    expect_same(
        *make_law("tabulated",
                  {{"points", "0 : 0, 0.3 um: 3 MPa, \\\n"
                              "    max(1 um, 0.5 um) : 2.5e6, 2e-6:0"}}),
        *from_file);

    // the place is that of the point, on whichever line
    const LawEntries grows{
        {"points", "0 : 0, 0.3 um : 3 MPa, \\\n  1 um : 4 MPa, 1 um : 0"}};
    expect_error("tabulated", grows, "test.prm:3: error");
    expect_error("tabulated", grows, "                 ^~~~~~~~\n");
    expect_error("tabulated", grows, "opening = 1e-06 is not beyond");
    expect_error("tabulated", {{"points", "0 : 0, 1 um, 2 um : 0"}},
                 "`1 um` is not a point");
    expect_error("tabulated", {{"points", "0 : 0, 1 um : 1 um"}}, "traction");
    expect_error("tabulated", {{"points", "0 : 1"}}, "has 1 point");
    expect_error("tabulated", {{"points", ""}}, "`points` has no value");
    expect_error("tabulated", {{"curve", ""}}, "`curve` has no value");
    expect_error("tabulated", {{"points", "0 : 1, 1 : 0"}, {"curve", "a.csv"}},
                 "both give the curve");
  }

  TEST(Tabulated, RelativeToTheParameterFile)
  {
    write_file("curves/bilinear.csv", "0, 0\n1e-7, 3e6\n2e-6, 0\n");
    const std::string prm =
        write_file("scene.prm", "subsection Interface: test\n"
                                "  set curve = curves/bilinear.csv\n"
                                "end\n");
    InputErrors errors;
    ParameterFile file;
    file.read_file(prm, errors);
    SectionReader reader(file.open("Interface: test"), errors);
    const auto law =
        CohesiveLawRegistry::instance().create("tabulated", reader);
    EXPECT_EQ(errors.report(), "");
    expect_relative(law->toughness(), 3.);

    // in a text without a folder: where the program runs
    const auto relative =
        fs::relative(fs::path(prm).parent_path() / "curves" / "bilinear.csv")
            .string();
    expect_relative(make_law("tabulated", {{"curve", relative}})->toughness(),
                    3.);
  }

  TEST(Tabulated, WrongCurves)
  {
    // file, line and value
    const struct {
      const char *curve, *place, *message;
    } wrong[] = {
        {"0, 0\n1e-7, lots\n2e-6, 0\n", "curve.csv:2", "lots"},
        {"0, 0\n1 kg, 3e6\n2e-6, 0\n", "curve.csv:2", "opening"},
        {"0, 0\n1e-7, -3e6\n2e-6, 0\n", "curve.csv:2", "traction = -3e6"},
        {"0, 0\n1e-7; 3e6\n2e-6, 0\n", "curve.csv:2", "1e-7; 3e6"},
        {"0, 0\n1e-7, 3e6, 5\n2e-6, 0\n", "curve.csv:2", "not a point"},
        {"0, 0\n1e-7, 3e6\n1e-7, 2e6\n2e-6, 0\n", "curve.csv:3",
         "opening = 1e-07 is not beyond"},
        {"0, 0\n1e-7, 3e6\n2e-6, 0\n3e-6, 0\n", "curve.csv:4",
         "opening = 3e-06"},
        {"0, 0\n1e-7, 1e6\n2e-7, 3e6\n2e-6, 0\n", "curve.csv:3",
         "traction / opening = 1.5e+13 grows from 1e+13"},
        {"0, 0\n1e-7, 3e6\n1e-6, 2e6\n1.1e-6, 2.1e6\n2e-6, 0\n", "curve.csv:4",
         "traction = 2.1e+06 grows from 2e+06"},
        {"0, 3e6\n1e-7, 4e6\n2e-6, 0\n", "curve.csv:2", "extrinsic"},
        {"0, 0\n1e-7, 3e6\n# x\n2e-6, 1e3\n", "curve.csv:4",
         "ends with traction = 1000"},
        {"1e-7, 0\n2e-7, 3e6\n2e-6, 0\n", "curve.csv:1", "does not rise"},
        {"0, 0\n1e-7, 0\n", "curve.csv:2", "does not rise"},
        {"opening, traction\n0, 0\n", "test.prm:2", "has 1 point"},
        {"", "test.prm:2", "has 0 points"},
    };
    for (const auto &[curve, place, message] : wrong) {
      SCOPED_TRACE(curve);
      const LawEntries entries{{"curve", write_file("curve.csv", curve)}};
      expect_error("tabulated", entries, place);
      expect_error("tabulated", entries, message);
    }
    expect_error("tabulated", {{"curve", "no/such.csv"}},
                 "`no/such.csv` cannot be read");
    expect_error("tabulated", {{"curve", "."}}, "is a folder");
    expect_error("tabulated", {}, "needs `curve` or `points`");
  }

  // A path to 3 um has a step to each kink of the law.
  TEST(LawTabulated, KinksAreStepsOfTheirOwn)
  {
    const auto law = tabulated("0, 3 MPa\n0.7 um, 1 MPa\n2 um, 0\n");
    const auto path = with_kinks({{0., {}}, {1., {3e-6, 0., 0.}}}, *law);
    const double expected[] = {0., 0.7e-6, 2e-6, 3e-6};
    ASSERT_EQ(path.size(), 4u);
    for (unsigned int i = 0; i < 4; ++i) {
      EXPECT_NEAR(path[i].at.opening, expected[i], 1e-21);
      EXPECT_NEAR(path[i].path, expected[i] / 3e-6, 1e-15);
    }
  }
} // namespace test_law_tabulated
