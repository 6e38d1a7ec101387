#include "command_line.h"

#include "input/read_scene.h"
#include "parameters/input_errors.h"
#include "refuse_word.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#ifndef NSFD_VERSION
#define NSFD_VERSION "unknown"
#endif
#ifndef NSFD_GIT_HASH
#define NSFD_GIT_HASH ""
#endif

namespace nsfd
{
  namespace
  {
    const char *const short_help =
        "nsfd - nonsmooth fracture dynamics\n"
        "  nsfd FILE.prm             run a scene\n"
        "  nsfd FILE.prm --check     only say whether it would run\n"
        "  nsfd study FILE.prm       vary its parameters: errors, orders, "
        "cost\n"
        "  nsfd law NAME             drive one point of a cohesive law\n"
        "  nsfd solve PROBLEM.hdf5   solve stored contact problems\n"
        "  nsfd compare RUN RUN      what differs between runs\n"
        "  nsfd --help               all options\n";

    /** Options without a value, and what they switch on. */
    struct Flag {
      const char *name;
      bool *target;
      const char *text;
    };

    /** What follows --resume; false if --output says something else. */
    bool take_folder(std::string &folder, CommandLine &command_line)
    {
      command_line.resume = true;
      if (folder.size() > 4 && command_line.file.empty() &&
          folder.compare(folder.size() - 4, 4, ".prm") == 0) {
        std::swap(folder, command_line.file);
        return true;
      }
      if (folder.empty())
        return true;
      if (!command_line.output.empty() && command_line.output != folder)
        return false;
      command_line.output = folder;
      return true;
    }

    /** Arguments that no option has taken. */
    int fail_at(std::ostream &err, const std::string &word, const CLI::App &app)
    {
      return refuse_word(err, "nsfd", word, app, "file",
                         "run one scene at a time, or vary it: nsfd study");
    }
  } // namespace

  std::vector<std::string> CommandLine::overrides() const
  {
    std::vector<std::string> result = set;
    if (!output.empty())
      result.push_back("Output/directory=" + output);
    return result;
  }

  void print_list(std::ostream &out)
  {
    const std::vector<NamedPart> parts = named_parts();
    std::size_t width = 0;
    for (const NamedPart &part : parts)
      width = std::max(width, part.name.size());
    std::string kind;
    for (const NamedPart &part : parts) {
      if (part.kind != kind)
        out << (kind.empty() ? "" : "\n") << part.kind << "\n";
      kind = part.kind;
      out << fmt::format("  {:<{}}  {}\n", part.name, width, part.text);
      if (!part.example.empty())
        out << fmt::format("  {:<{}}  for example: {}\n", "", width,
                           part.example);
    }
  }

  std::optional<int> parse_command_line(const int argc, const char *const *argv,
                                        CommandLine &command_line,
                                        std::ostream &out, std::ostream &err)
  {
    if (argc < 2) {
      err << short_help;
      return exit_code::wrong_usage;
    }
    if (argv[1] == std::string("law"))
      return parse_law_command_line(argc - 1, argv + 1, command_line, out, err);

    CLI::App app("Nonsmooth fracture dynamics: every cell is a body, faces "
                 "carry cohesion, contact and friction.",
                 "nsfd");
    app.set_help_flag();
    app.allow_extras();
    app.footer("nsfd run FILE.prm is the same.\n"
               "Or: nsfd study FILE.prm --vary 'Section/name=a, b', every "
               "combination of values; nsfd study --help says more.\n"
               "    nsfd law NAME, drive one interface point along a path; "
               "nsfd law --help says more.\n"
               "    nsfd solve PROBLEM.hdf5, stored contact problems; "
               "nsfd solve --help says more.\n"
               "    nsfd compare RUN RUN, folders of results side by side; "
               "nsfd compare --help says more.");
    bool help = false, list = false, version = false;
    app.add_option("FILE.prm", command_line.file, "the scene to run");
    // one value per --set: further words are not its own
    app.add_option_function<std::vector<std::string>>(
           "--set",
           [&](const std::vector<std::string> &values) {
             command_line.set = values;
           },
           "change an entry, 'Section/name=value'; repeatable")
        ->type_size(1)
        ->allow_extra_args(false)
        ->type_name("TEXT");
    app.add_option("--output", command_line.output,
                   "folder for the results, default output/FILE")
        ->type_name("DIR");
    std::string folder; // to resume in
    auto *resume =
        app.add_option("--resume", folder,
                       "go on from the last checkpoint in DIR, default the "
                       "folder of the results")
            ->type_name("[DIR]")
            ->expected(0, 1);
    const Flag flags[] = {
        {"--force", &command_line.force,
         "replace the files of an earlier run, and no others"},
        {"--check", &command_line.check,
         "say whether it would run, do not run it"},
        {"--print-parameters", &command_line.print_parameters,
         "print the complete file, all defaults with their texts"},
        {"--quiet", &command_line.quiet, "print errors only"},
        {"--verbose", &command_line.verbose, "print a line for every step"},
        {"--strict", &command_line.strict,
         "exit code 7 if the certificate is not ok"},
        {"--list", &list, "print the names of all laws, meshes, solvers, ..."},
        {"--version", &version, "print the version"},
        {"--help", &help, "print this help"}};
    for (const Flag &flag : flags)
      app.add_flag(flag.name, *flag.target, flag.text);

    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError &error) {
      return refuse(err, "nsfd", error.what(),
                    "`nsfd --help` prints all options");
    }
    if (resume->count() > 0 &&
        !take_folder(folder, command_line)) // the file is no folder
      return refuse(err, "nsfd",
                    "--resume " + folder + " and --output " +
                        command_line.output + " are two folders",
                    "a run goes on in the folder of its checkpoint: name one");
    if (command_line.resume && command_line.force)
      return refuse(err, "nsfd", "--force and --resume exclude each other",
                    "--force begins again, --resume goes on");
    if (command_line.quiet && command_line.verbose)
      return refuse(err, "nsfd", "--quiet and --verbose exclude each other",
                    "write one of them");
    const std::vector<std::string> extras = app.remaining();
    if (!extras.empty())
      return fail_at(err, extras.front(), app);
    if (help) {
      out << app.help();
      return exit_code::done;
    }
    if (version) {
      out << "nsfd " << NSFD_VERSION << " " << NSFD_GIT_HASH << "\n";
      return exit_code::done;
    }
    if (list) {
      print_list(out);
      return exit_code::done;
    }
    for (const std::string &assignment : command_line.set)
      if (assignment.find('=') == std::string::npos)
        return refuse(err, "nsfd",
                      fmt::format("--set {}: there is no `=`", assignment),
                      "write for example: --set 'Time/theta=0.5'");
    if (command_line.file.empty())
      return refuse(err, "nsfd", "no parameter file is named",
                    "write for example: nsfd prm/quickstart.prm");
    return {};
  }
} // namespace nsfd
