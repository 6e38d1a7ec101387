#include "compare.h"

#include <gtest/gtest.h>

// What is found out when the mesh is there: with file and line, exit code 1.

namespace end_to_end::test_reader
{
  namespace
  {
    const std::string bodies = R"(subsection Mesh
  set upper corner = 4, 1
  set cells        = 4, 1
end
subsection Material: soft
  set where         = x < 2
  set Young modulus = 1
  set Poisson ratio = 0.2
  set density       = 1
end
subsection Material: hard
  set model   = rigid
  set density = 1
end
)";
    const std::string end = R"(subsection Time
  set end  = 1
  set step = 0.1
end
)";
    const std::string joined = R"(subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 1
  set toughness = 1
end
)";
    const std::string rigid = "subsection Interface: all\n  set law = rigid\n"
                              "end\n";

    Outcome check(const std::string &text)
    {
      const Workspace workspace;
      write_text(workspace.path() / "a.prm", text);
      return nsfd(workspace, {"a.prm", "--check"});
    }

    void expect(const Outcome &outcome, const int code, const std::string &part)
    {
      EXPECT_EQ(outcome.exit_code, code) << outcome.err;
      EXPECT_NE(outcome.err.find(part), std::string::npos)
          << "no `" << part << "` in\n"
          << outcome.err;
    }
  } // namespace

  TEST(Reader, BlocksThatMatchNothingHaveALine)
  {
    const std::string no_place = "  set where = x > 100\n";
    expect(check(bodies + rigid + "subsection Boundary: b\n" + no_place +
                 "  set velocity x = 1\nend\n" + end),
           1, "a.prm:18: error: Boundary: b: no boundary face");
    expect(check(bodies + rigid + "subsection Obstacle: o\n" + no_place +
                 "  set point = 0, 0\n  set normal = 0, 1\nend\n" + end),
           1, "a.prm:18: error: Obstacle: o: no boundary face");
    // as of a Material block, a warning
    expect(check(bodies + "subsection Interface: none\n" + no_place +
                 "  set law = rigid\nend\n" + rigid + end),
           0, "a.prm:15: warning: Interface: none: no face");
    expect(check(bodies +
                 "subsection Interface: i\n  set where = abs(x - 1) < "
                 "0.1\n  set law = camacho-ortiz\n  set strength = 1\n"
                 "  set toughness = 1\n  set broken = y > 2\nend\n" +
                 rigid + end),
           0, "a.prm:20: warning: Interface: i/broken: no point");
  }

  TEST(Reader, RigidCellsAreJoinedByRows)
  {
    // two rigid cells in a scene that has others as well, and rigid ones alone
    std::string rigid_only = bodies;
    const std::size_t begin = rigid_only.find("subsection Material: soft");
    rigid_only.erase(begin,
                     rigid_only.find("subsection Material: hard") - begin);
    const std::string bonded = "subsection Interface: all\n"
                               "  set law = bonded\nend\n";
    for (const std::string &cells : {bodies, rigid_only})
      for (const std::string &faces : {joined, bonded}) {
        const Workspace workspace;
        write_text(workspace.path() / "a.prm", cells + faces + end);
        EXPECT_EQ(nsfd(workspace, {"a.prm", "--quiet"}).exit_code, 0);
      }
  }

  TEST(Reader, FormulasWithoutValueNameThemselves)
  {
    expect(check(bodies + rigid +
                 "subsection Boundary: left\n"
                 "  set velocity x = 1 / x\nend\n" +
                 end),
           1,
           "a.prm:19: error: Boundary: left/velocity x = 1 / x is infinite "
           "at (0, ");
    // in the middle of the run: the last good state is kept
    const Workspace workspace;
    write_text(workspace.path() / "a.prm",
               bodies + rigid +
                   "subsection Boundary: left\n"
                   "  set traction x = sqrt((t - 0.3)*(t - 0.7))"
                   "\nend\n" +
                   end);
    const Outcome run = nsfd(workspace, {"a.prm", "--quiet"});
    expect(run, 3, "Boundary: left/traction x = ");
    EXPECT_NE(run.err.find("is not a number at ("), std::string::npos);
  }

  TEST(Reader, TooManyStepsAreFound)
  {
    std::string long_time = end;
    long_time.replace(long_time.find("= 1\n"), 3, "= 1e17");
    expect(check(bodies + rigid + long_time), 1,
           "a.prm:19: error: Time/end: 1e+17 s in steps of 0.1 s are 1e+18");
  }
} // namespace end_to_end::test_reader
