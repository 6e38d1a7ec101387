#include "study/study_command.h"

#include "common_options.h"

#include <cstdlib>
#include <iostream>

namespace nsfd
{
  namespace
  {
    const char *const study_footer =
        "Variations:\n"
        "  --vary 'Discretization/degree=1..4'     every value, every "
        "combination with\n"
        "                                          the others\n"
        "  --vary 'Mesh/cells=[8*2^0..3, 1]'       8, 1; 16, 1; 32, 1; 64, 1\n"
        "  --vary 'Mesh/refinements=0..3 & Time/step=4/2^0..3 us'\n"
        "                                          values that go together\n"
        "  --vary 'Solver/method=dual newton, gauss seidel'\n"
        "In a file: sections `Vary: name` with lines `set Mesh/cells = ...` "
        "that go\n"
        "together, and section `Study`; --print-parameters shows it,\n"
        "--set 'Study/repeats=1' changes it. A file with such a section needs "
        "no word\n"
        "`study`: nsfd FILE.prm.\n"
        "Results: a folder per case, study.csv, study.json, study.html.\n"
        "Exit code: 0 all cases done, 1 one is no valid scene (nothing is "
        "run), 3 one\n"
        "could not be solved (the others are there), 4 stopped, 5 one broke "
        "off.\n"
        "Example:\n"
        "  nsfd study prm/verification/mode.prm --vary "
        "'Discretization/degree=1..3'\n"
        "    --vary 'Mesh/cells=[8*2^0..2, 1]'";

    bool starts_more_than_one_process()
    {
      for (const char *name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
        if (const char *value = std::getenv(name))
          if (std::atoi(value) > 1)
            return true;
      return false;
    }

    /** Runs a scene for many values. The cases are processes of their own: it
     * needs no MPI itself. */
    class StudyCommandLine final : public Subcommand
    {
    public:
      void declare(CLI::App &app, CommandLine &line) override
      {
        namespace common = common_options;
        app.footer(study_footer);
        common::add_file(app, line, "FILE.prm", "the scene that varies");
        common::add_assignments(
            app, "--vary", command_.vary,
            "values of parameters, 'Section/name=a, b', see below",
            "Time/theta=0.5, 1");
        common::add_set(app, line,
                        "change an entry of all cases, or of section `Study`",
                        "Time/theta=0.5");
        common::add_output(app, line,
                           "folder for the results, default output/FILE");
        common::add_resume(app, line,
                           "take over the cases that are done in DIR, run the "
                           "others; default the folder of the results");
        common::add_force(
            app, line, "run all again, over the results of an earlier study");
        common::add_check(app, line,
                          "check and list all cases, do not run them");
        common::add_print_parameters(
            app, line, "print section `Study` and what varies, complete");
        common::add_general(app, line);
      }

      void check(CommandLine &line) override
      {
        if (line.file.empty())
          throw WrongUsage("no parameter file is named",
                           "write for example: nsfd study "
                           "prm/verification/mode.prm --vary "
                           "'Discretization/degree=1..3'");
        if (starts_more_than_one_process())
          throw WrongUsage("a study starts its cases itself, without mpirun",
                           "write: nsfd study FILE.prm --set Study/ranks=2");
        command_.file = line.file;
        command_.set = line.overrides();
        command_.force = line.force;
        command_.resume = line.resume;
        command_.check = line.check;
        command_.quiet = line.quiet;
        command_.print_parameters = line.print_parameters;
        command_.command_line = line.text();
      }

      int execute(const CommandLine &) const override
      {
        return run_study(command_, std::cout, std::cerr);
      }

    private:
      StudyCommand command_;
    };
  } // namespace

  NamedSubcommand study_subcommand()
  {
    return {"study", "run a scene for every combination of values", "file",
            "a study varies one scene; vary its parameters",
            std::make_shared<StudyCommandLine>()};
  }
} // namespace nsfd
