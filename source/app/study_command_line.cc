#include "study/study_command.h"
#include "study/study_input.h"

#include "refuse_word.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdlib>
#include <ostream>

namespace nsfd
{
  namespace
  {
    const char *const study_footer =
        "Variations:\n"
        "  --vary 'Discretization/degree=1..4'        every value, every "
        "combination with the others\n"
        "  --vary 'Mesh/cells=[8*2^0..3, 1]'          8, 1; 16, 1; 32, 1; 64, "
        "1\n"
        "  --vary 'Mesh/refinements=0..3 & Time/step=4/2^0..3 us'\n"
        "                                             values that go together\n"
        "  --vary 'Solver/method=dual newton, gauss seidel'\n"
        "In a file: sections `Vary: name` with lines `set Mesh/cells = ...` "
        "that "
        "go together,\n"
        "and section `Study`; --print-parameters shows it, --set "
        "'Study/repeats=1' changes it.\n"
        "Results: a folder per case, study.csv, study.json, study.html.\n"
        "Exit code: 0 all cases done, 1 one is no valid scene (nothing is "
        "run), "
        "3 one could not be\n"
        "solved (the others are there), 4 stopped, 5 one broke off.\n"
        "Example:\n"
        "  nsfd study prm/verification/mode.prm --vary "
        "'Discretization/degree=1..3' --vary 'Mesh/cells=[8*2^0..2, 1]'\n";

    /** Options that may be given several times, one value each. */
    void add_repeatable(CLI::App &app, const char *name,
                        std::vector<std::string> &target, const char *text)
    {
      app.add_option_function<std::vector<std::string>>(
             name,
             [&target](const std::vector<std::string> &values) {
               target = values;
             },
             text)
          ->type_size(1)
          ->allow_extra_args(false)
          ->type_name("TEXT");
    }

    bool starts_more_than_one_process()
    {
      for (const char *name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
        if (const char *value = std::getenv(name))
          if (std::atoi(value) > 1)
            return true;
      return false;
    }

    /** An assignment without `=`; empty if there is none. */
    std::string without_equals(const std::vector<std::string> &assignments)
    {
      for (const std::string &assignment : assignments)
        if (assignment.find('=') == std::string::npos)
          return assignment;
      return "";
    }
  } // namespace

  bool asks_for_study(const int argc, const char *const *argv)
  {
    if (argc > 1 && argv[1] == std::string("study"))
      return true;
    std::string file;
    std::vector<std::string> set;
    for (int i = 1; i < argc; ++i) {
      const std::string word = argv[i];
      if (i == 1 && (word == "law" || word == "solve" || word == "compare"))
        return false;
      if (word == "--set" && i + 1 < argc)
        set.emplace_back(argv[++i]);
      else if (word.compare(0, 6, "--set=") == 0)
        set.push_back(word.substr(6));
      else if (word == "--output")
        ++i;
      else if (word.compare(0, 1, "-") != 0 && file.empty())
        file = word;
    }
    return !file.empty() && is_study(file, set);
  }

  std::optional<int> parse_study_command_line(const int argc,
                                              const char *const *argv,
                                              StudyCommand &command,
                                              std::ostream &out,
                                              std::ostream &err)
  {
    CLI::App app("Run a scene for every combination of the values of some "
                 "parameters: tables, orders of convergence, error against "
                 "run time.",
                 "nsfd study");
    app.set_help_flag();
    app.allow_extras();
    app.footer(study_footer);
    bool help = false;
    std::string output;
    app.add_option("FILE.prm", command.file, "the scene that varies");
    add_repeatable(app, "--vary", command.vary,
                   "values of parameters, 'Section/name=a, b'; repeatable");
    add_repeatable(app, "--set", command.set,
                   "change an entry of all cases, or of section `Study`");
    app.add_option("--output", output,
                   "folder for the results, default output/FILE")
        ->type_name("DIR");
    app.add_flag("--resume", command.resume,
                 "take over the cases that are done, run the others");
    app.add_flag("--force", command.force,
                 "run all again, over the results of an earlier study");
    app.add_flag("--check", command.check,
                 "check and list all cases, do not run them");
    app.add_flag("--print-parameters", command.print_parameters,
                 "print section `Study` and what varies, complete");
    app.add_flag("--quiet", command.quiet, "print errors only");
    app.add_flag("--help", help, "print this help");
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError &error) {
      return refuse(err, "nsfd study", error.what(),
                    "`nsfd study --help` prints all options");
    }
    const std::vector<std::string> extras = app.remaining();
    if (!extras.empty())
      return refuse_word(err, "nsfd study", extras.front(), app, "file",
                         "a study varies one scene; vary its parameters");
    if (help) {
      out << app.help();
      return exit_code::done;
    }
    for (const auto &[option, values] :
         {std::pair("--set", command.set), {"--vary", command.vary}}) {
      const std::string wrong = without_equals(values);
      if (!wrong.empty())
        return refuse(err, "nsfd study",
                      fmt::format("{} {}: there is no `=`", option, wrong),
                      fmt::format("write for example: {} 'Time/theta=0.5{}'",
                                  option, option[2] == 'v' ? ", 1" : ""));
    }
    if (command.file.empty())
      return refuse(err, "nsfd study", "no parameter file is named",
                    "write for example: nsfd study prm/verification/mode.prm "
                    "--vary 'Discretization/degree=1..3'");
    if (command.force && command.resume)
      return refuse(
          err, "nsfd study", "--force and --resume exclude each other",
          "--force runs all cases again, --resume only what is missing");
    if (starts_more_than_one_process())
      return refuse(err, "nsfd study",
                    "a study starts its cases itself, without mpirun",
                    "write: nsfd study FILE.prm --set Study/ranks=2");
    if (!output.empty())
      command.set.push_back("Output/directory=" + output);
    for (int i = 0; i < argc; ++i)
      command.command_line += std::string(i ? " " : "") + argv[i];
    return {};
  }
} // namespace nsfd
