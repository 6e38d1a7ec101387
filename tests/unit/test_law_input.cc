#include "law_formulas.h"

namespace law_formulas::test_law_input
{
  void expect_error(const std::string &name, const test::LawEntries &entries,
                    const std::string &part)
  {
    const std::string errors = law_errors(name, entries);
    EXPECT_NE(errors.find(part), std::string::npos)
        << "expected '" << part << "' in: " << errors;
  }

  TEST(LawInput, OverDeterminedNamesTheRelation)
  {
    expect_error("tvergaard",
                 {{"strength", "3 MPa"},
                  {"toughness", "3.375 J/m^2"},
                  {"critical opening", "2 um"}},
                 "G = 9/16 R_max delta_N");
    expect_error("michel-suquet",
                 {{"stiffness", "5e12"},
                  {"strength", "10 MPa"},
                  {"toughness", "35 J/m^2"}},
                 "G = (9/2 - 4 ln 2) R_max^2 / C");
    expect_error("camacho-ortiz",
                 {{"strength", "300 MPa"},
                  {"toughness", "0.5 J/m^2"},
                  {"critical opening", "3 nm"}},
                 "G = 1/2 R_max d_c");
  }

  TEST(LawInput, TooFewEntries)
  {
    expect_error("tvergaard", {{"strength", "3 MPa"}}, "critical opening");
    expect_error("tvergaard", {{"toughness", "3 J/m^2"}}, "strength");
    expect_error("michel-suquet", {{"stiffness", "5e12"}}, "toughness");
    expect_error("michel-suquet", {}, "two of");
    expect_error("camacho-ortiz", {{"strength", "300 MPa"}}, "toughness");
    expect_error("rcc", {{"stiffness", "2e12"}}, "adhesion energy");
    expect_error("rcc", {{"adhesion energy", "8 J/m^2"}}, "stiffness");
  }

  TEST(LawInput, ValuesOutOfRange)
  {
    expect_error("tvergaard",
                 {{"strength", "-3 MPa"}, {"critical opening", "2 um"}},
                 "strength");
    expect_error("michel-suquet", {{"strength", "10 MPa"}, {"toughness", "0"}},
                 "toughness");
    expect_error("camacho-ortiz",
                 {{"strength", "300 MPa"},
                  {"toughness", "0.5 J/m^2"},
                  {"mode mixity", "0"}},
                 "mode mixity");
    expect_error("rcc", {{"stiffness", "2e12"}, {"adhesion energy", "-8"}},
                 "adhesion energy");
  }

  TEST(LawInput, ForeignEntriesAreStray)
  {
    expect_error("rcc",
                 {{"stiffness", "2e12"},
                  {"adhesion energy", "8 J/m^2"},
                  {"strength", "4 MPa"}},
                 "strength");
  }
} // namespace law_formulas::test_law_input
