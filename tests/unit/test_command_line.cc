#include "app/command_line.h"
#include "nsfd/cohesive_laws/cohesive_law.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

namespace nsfd::test_command_line
{
  namespace
  {
    /** Exit code (-1: go on) and what was printed. */
    struct Parsed {
      CommandLine command_line;
      int code;
      std::string out, err;
    };

    Parsed parse(std::vector<const char *> arguments)
    {
      arguments.insert(arguments.begin(), "nsfd");
      Parsed result;
      std::ostringstream out, err;
      result.code =
          parse_command_line(static_cast<int>(arguments.size()),
                             arguments.data(), result.command_line, out, err)
              .value_or(-1);
      result.out = out.str();
      result.err = err.str();
      return result;
    }

    const std::vector<std::string> subcommands = {"run",   "study",   "law",
                                                  "solve", "compare", "mesh"};
  } // namespace

  TEST(CommandLineTest, Options)
  {
    const Parsed parsed =
        parse({"a.prm", "--set", "Time/theta=0.6", "--force", "--set",
               "Interface: x/where=between materials [a, b]", "--output", "out",
               "--quiet", "--check", "--print-parameters"});
    EXPECT_EQ(parsed.code, -1) << parsed.err;
    const CommandLine &line = parsed.command_line;
    EXPECT_EQ(line.file, "a.prm");
    EXPECT_EQ(line.set, (std::vector<std::string>{
                            "Time/theta=0.6",
                            "Interface: x/where=between materials [a, b]"}));
    EXPECT_TRUE(line.force && line.quiet && line.check &&
                line.print_parameters);
    EXPECT_EQ(line.output, "out");
    EXPECT_EQ(line.overrides().back(), "Output/directory=out");
    EXPECT_EQ(parse({"--set", "a=b", "a.prm"}).command_line.file, "a.prm");
    EXPECT_EQ(parse({"--set=Mesh/cells=[1,2]", "a.prm"}).command_line.set,
              (std::vector<std::string>{"Mesh/cells=[1,2]"}));
    for (const std::vector<const char *> &arguments :
         {std::vector<const char *>{"a.prm", "--resume", "--output", "b"},
          {"a.prm", "--resume", "b"},
          {"--resume=b", "a.prm"},
          {"--resume", "a.prm", "--output", "b"}}) {
      const CommandLine line = parse(arguments).command_line;
      EXPECT_TRUE(line.resume);
      EXPECT_EQ(line.file, "a.prm");
      EXPECT_EQ(line.output, "b");
    }
  }

  TEST(CommandLineTest, InformationEndsWithZero)
  {
    const Parsed help = parse({"--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_NE(help.out.find("--print-parameters"), std::string::npos);
    EXPECT_NE(help.out.find("--resume"), std::string::npos);
    EXPECT_EQ(parse({"--version"}).code, 0);
    EXPECT_NE(parse({"--version"}).out.find("nsfd "), std::string::npos);
    const Parsed list = parse({"--list"});
    EXPECT_EQ(list.code, 0);
    for (const char *name :
         {"camacho-ortiz", "rigid", "rectangle", "gauss seidel", "hyper_cube"})
      EXPECT_NE(list.out.find(name), std::string::npos) << name;
    for (const auto &[name, entry] : CohesiveLawRegistry::instance().entries())
      for (const std::string &example : entry.examples) {
        const bool is_first = &example == &entry.examples.front();
        EXPECT_EQ(list.out.find(": " + example + "\n") != std::string::npos,
                  is_first)
            << name << ": " << example;
      }
  }

  TEST(CommandLineTest, WrongUsageEndsWithTwo)
  {
    const auto fails = [](const std::vector<const char *> &arguments,
                          const std::string &message) {
      const Parsed parsed = parse(arguments);
      EXPECT_EQ(parsed.code, 2) << message;
      EXPECT_EQ(parsed.out, "");
      EXPECT_NE(parsed.err.find(message), std::string::npos) << parsed.err;
    };
    fails({}, "run a scene");
    fails({"a.prm", "--froce"}, "did you mean `--force`?");
    fails({"a.prm", "-x"}, "there is no option `-x`");
    fails({"a.prm", "b.prm"}, "`b.prm` is one file too many");
    fails({"--check"}, "no parameter file is named");
    fails({"a.prm", "--set"}, "--set");
    fails({"a.prm", "--set", "theta"}, "there is no `=`");
    fails({"law"}, "no law is named");
    fails({"law", "rcc", "--stpes=3"}, "did you mean `--steps`?");
    fails({"a.prm", "--resume", "b", "--output", "c"}, "are two folders");
    fails({"a.prm", "--resume", "--force"}, "exclude each other");
    fails({"--resume"}, "no parameter file is named");
    fails({"a.prm", "--force=maybe"}, "--force");
    fails({"study", "a.prm", "--force", "--resume"}, "exclude each other");
    fails({"compare", "a"}, "two runs are needed");
    fails({"solve", "a.hdf5", "--solver", "dual newtn"}, "`dual newton`");
  }

  TEST(CommandLineTest, WordsThatAreNoSubcommand)
  {
    const auto fails = [](const std::vector<const char *> &arguments,
                          const std::string &message) {
      const Parsed parsed = parse(arguments);
      EXPECT_EQ(parsed.code, 2) << message;
      EXPECT_NE(parsed.err.find(message), std::string::npos) << parsed.err;
    };
    fails({"lwa", "tvergaard"}, "no subcommand and no file `lwa`");
    fails({"lwa", "tvergaard"}, "did you mean `law`?");
    fails({"--quiet", "studdy", "a.prm"}, "did you mean `study`?");
    fails({"nothing"}, "`nsfd --help` prints all subcommands");
    fails({"a.prm", "--vary", "Time/theta=0.5, 1"},
          "it belongs to `nsfd study`");
    // in the place of an argument they are arguments
    EXPECT_EQ(parse({"law", "solve"}).command_line.file, "solve");
    fails({"a.prm", "study"}, "`study` is one file too many");
  }

  TEST(CommandLineTest, SubcommandsStandAnywhereAndShareOptions)
  {
    const CommandLine law =
        parse({"--set", "friction=0.3", "--quiet", "law", "rcc"}).command_line;
    EXPECT_EQ(law.program, "nsfd law");
    EXPECT_EQ(law.file, "rcc");
    EXPECT_TRUE(law.quiet);
    EXPECT_EQ(law.set, std::vector<std::string>{"friction=0.3"});
    EXPECT_EQ(parse({"run", "a.prm", "--output", "b"}).command_line.program,
              "nsfd");
    const CommandLine study =
        parse({"study", "--resume", "a.prm", "--output", "b"}).command_line;
    EXPECT_EQ(study.file, "a.prm");
    EXPECT_EQ(study.output, "b");
    EXPECT_TRUE(study.resume);
    // a value of section `Study` makes it one
    EXPECT_EQ(parse({"a.prm", "--set", "Study/repeats=1"}).command_line.program,
              "nsfd study");
    for (const std::string &name : subcommands) {
      EXPECT_EQ(parse({name.c_str(), "--version"}).code, 0) << name;
      EXPECT_EQ(parse({name.c_str(), "--list"}).code, 0) << name;
    }
  }

  // For a terminal: no line beyond column 80, all subcommands in the first.
  TEST(CommandLineTest, HelpsFitATerminal)
  {
    const auto expect_narrow = [](const std::string &text) {
      std::istringstream lines(text);
      for (std::string line; std::getline(lines, line);)
        EXPECT_LT(line.size(), 80u) << line;
    };
    const std::string first = parse({"--help"}).out;
    expect_narrow(first);
    expect_narrow(parse({}).err);
    for (const std::string &name : subcommands) {
      const std::string usage = name == "run" ? "  nsfd " : "  nsfd " + name;
      EXPECT_NE(first.find(usage), std::string::npos) << name;
      EXPECT_NE(parse({}).err.find(usage), std::string::npos) << name;
      const Parsed help = parse({name.c_str(), "--help"});
      EXPECT_EQ(help.code, 0);
      EXPECT_NE(help.out.find("Usage: nsfd " + name), std::string::npos);
      EXPECT_NE(help.out.find("--quiet"), std::string::npos) << name;
      expect_narrow(help.out);
      EXPECT_EQ(parse({name.c_str(), "-h"}).out, help.out);
    }
    EXPECT_NE(parse({"study", "--help"}).out.find("--vary NAME=VALUE"),
              std::string::npos);
  }
} // namespace nsfd::test_command_line
