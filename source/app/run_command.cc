#include "common_options.h"
#include "input/read_scene.h"
#include "parameters/input_errors.h"
#include "processes.h"
#include "simulation/simulation.h"

#include <deal.II/base/mpi.h>

#include <malloc.h>

#include <iostream>
#include <memory>

namespace nsfd
{
  namespace
  {
    /** For a shell: quoted only where it must be. */
    std::string quoted(const std::string &word)
    {
      if (!word.empty() &&
          word.find_first_not_of("abcdefghijklmnopqrstuvwxyz"
                                 "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                 "_-./:=,+@%") == std::string::npos)
        return word;
      std::string result = "'";
      for (const char c : word)
        result += c == '\'' ? "'\\''" : std::string(1, c);
      return result + "'";
    }

    /** What goes on with a run of this command. */
    std::string resume_line(const CommandLine &line, const unsigned int n_ranks)
    {
      std::string result =
          n_ranks > 1 ? "mpirun -n " + std::to_string(n_ranks) + " " : "";
      for (std::size_t i = 0; i < line.words.size(); ++i)
        if (line.words[i] != "--force")
          result += (i > 0 ? " " : "") + quoted(line.words[i]);
      return line.resume ? result : result + " --resume";
    }

    /** Runs a scene. */
    class RunCommandLine final : public Subcommand
    {
    public:
      void declare(CLI::App &app, CommandLine &line) override
      {
        namespace common = common_options;
        app.footer("nsfd FILE.prm is the same. Names that a file may write: "
                   "nsfd --list.");
        common::add_file(app, line, "FILE.prm", "the scene to run");
        common::add_set(app, line, "change an entry, 'Section/name=value'",
                        "Time/theta=0.5");
        common::add_output(app, line,
                           "folder for the results, default output/FILE");
        common::add_resume(app, line,
                           "go on from the last checkpoint in DIR, default "
                           "the folder of the results");
        common::add_force(app, line,
                          "replace the files of an earlier run, and no others");
        common::add_check(app, line, "say whether it would run, do not run it");
        common::add_print_parameters(
            app, line,
            "print the complete file, all defaults with their texts");
        common::add_verbose(app, line);
        common::add_strict(app, line,
                           "exit code 7 if the certificate is not ok");
        common::add_general(app, line);
      }

      void check(CommandLine &line) override
      {
        if (line.file.empty())
          throw WrongUsage("no parameter file is named",
                           "write for example: nsfd prm/quickstart.prm");
      }

      int execute(const CommandLine &line) const override
      {
        // Vectors come and go in every step: their pages stay with the process.
        mallopt(M_MMAP_THRESHOLD, 1 << 28);
        mallopt(M_TRIM_THRESHOLD, 1 << 28);
        InputErrors errors;
        if (line.print_parameters) {
          const auto scene = read_scene(line.file, line.overrides(), errors);
          return print_parameters(scene ? scene->echo : "", errors);
        }
        prepare_process();
        const std::unique_ptr<SceneInput> input =
            read_scene(line.file, line.overrides(), errors);
        if (is_first_process())
          std::cerr << errors.report();
        if (!input)
          return exit_code::bad_input;
        return run_on_all_processes(line, [&](const MPI_Comm communicator) {
          RunOptions options;
          options.command_line = line.text();
          options.resume_line = resume_line(
              line, dealii::Utilities::MPI::n_mpi_processes(communicator));
          options.force = line.force;
          options.quiet = line.quiet;
          options.verbose = line.verbose;
          options.strict = line.strict;
          options.check = line.check;
          options.resume = line.resume;
          return run_scene(*input, options, communicator);
        });
      }
    };
  } // namespace

  NamedSubcommand run_subcommand()
  {
    return {"run", "run a scene", "file",
            "run one scene at a time, or vary it: nsfd study",
            std::make_shared<RunCommandLine>()};
  }
} // namespace nsfd
