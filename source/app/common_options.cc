#include "common_options.h"

#include "core/load_plug_in.h"

#include <cstdlib>
#include <filesystem>

namespace nsfd::common_options
{
  namespace
  {
    /** What follows --resume is the file: `nsfd --resume FILE.prm`. */
    bool is_file(const std::string &word)
    {
      const std::filesystem::path path(word);
      std::error_code error;
      return path.extension() == ".prm" ||
             std::filesystem::is_regular_file(path, error);
    }

    void settle_folder(CommandLine &line)
    {
      if (line.file.empty() && is_file(line.resume_folder))
        line.file.swap(line.resume_folder);
      if (line.resume_folder.empty())
        return;
      if (!line.output.empty() && line.output != line.resume_folder)
        throw WrongUsage(
            "--resume " + line.resume_folder + " and --output " + line.output +
                " are two folders",
            "a run goes on in the folder of its checkpoint: name one");
      line.output = line.resume_folder;
    }
  } // namespace

  void add_general(CLI::App &app, CommandLine &line)
  {
    app.add_flag("--quiet", line.quiet, "print errors only");
    app.add_option("--plug-in", line.plug_ins,
                   "load parts built outside, see doc/adding.md; repeatable")
        ->type_size(1)
        ->allow_extra_args(false)
        ->type_name("FILE");
    app.add_flag("-h,--help", "print this help")->group("Information");
  }

  void add_file(CLI::App &app, CommandLine &line, const std::string &name,
                const std::string &text)
  {
    app.add_option(name, line.file, text);
  }

  void add_assignments(CLI::App &app, const std::string &name,
                       std::vector<std::string> &target,
                       const std::string &text, const std::string &example)
  {
    // one value per option: further words are not its own
    app.add_option_function<std::vector<std::string>>(
           name,
           [&target, name, example](const std::vector<std::string> &values) {
             for (const std::string &value : values)
               if (value.find('=') == std::string::npos)
                 throw WrongUsage(name + " " + value + ": there is no `=`",
                                  "write for example: " + name + " '" +
                                      example + "'");
             target = values;
           },
           text + "; repeatable")
        ->type_size(1)
        ->allow_extra_args(false)
        ->type_name("NAME=VALUE");
  }

  void add_set(CLI::App &app, CommandLine &line, const std::string &text,
               const std::string &example)
  {
    add_assignments(app, "--set", line.set, text, example);
  }

  void add_output(CLI::App &app, CommandLine &line, const std::string &text)
  {
    app.add_option("--output", line.output, text)->type_name("DIR");
  }

  void add_resume(CLI::App &app, CommandLine &line, const std::string &text)
  {
    app.add_option_function<std::string>(
           "--resume",
           [&line](const std::string &folder) {
             line.resume = true;
             line.resume_folder = folder;
           },
           text)
        ->type_name("[DIR]")
        ->expected(0, 1);
  }

  void add_force(CLI::App &app, CommandLine &line, const std::string &text)
  {
    app.add_flag("--force", line.force, text);
  }

  void add_check(CLI::App &app, CommandLine &line, const std::string &text)
  {
    app.add_flag("--check", line.check, text);
  }

  void add_print_parameters(CLI::App &app, CommandLine &line,
                            const std::string &text)
  {
    app.add_flag("--print-parameters", line.print_parameters, text);
  }

  void add_verbose(CLI::App &app, CommandLine &line)
  {
    app.add_flag("--verbose", line.verbose, "print a line for every step");
  }

  void add_strict(CLI::App &app, CommandLine &line, const std::string &text)
  {
    app.add_flag("--strict", line.strict, text);
  }

  void check(CommandLine &line)
  {
    if (line.resume)
      settle_folder(line);
    if (line.resume && line.force)
      throw WrongUsage("--force and --resume exclude each other",
                       "--force begins again, --resume goes on");
    if (line.quiet && line.verbose)
      throw WrongUsage("--quiet and --verbose exclude each other",
                       "write one of them");
  }

  void load_plug_ins(const CommandLine &line)
  {
    if (const char *folders = std::getenv("NSFD_PLUG_INS"))
      load_plug_ins_of(folders);
    for (const std::string &file : line.plug_ins)
      load_plug_in(file);
  }
} // namespace nsfd::common_options
