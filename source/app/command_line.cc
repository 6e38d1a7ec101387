#include "command_line.h"

#include "common_options.h"
#include "core/load_plug_in.h"
#include "core/version.h"
#include "help_text.h"
#include "input/read_scene.h"
#include "nsfd/core/plug_in.h"
#include "parameters/input_errors.h"
#include "processes.h"
#include "study/study_input.h"
#include "subcommand.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <ostream>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;

    /** The words of a command line before they are parsed. */
    struct Words {
      std::string subcommand;       ///< empty: none is named
      std::vector<std::string> all; ///< without the subcommand
      std::string first;            ///< that is no option
      std::vector<std::string> set; ///< values of --set
      bool only_information = true; ///< --help, --version, --list
    };

    /** An option of any subcommand, or null. */
    const CLI::Option *option_of(const CLI::App &nsfd, const std::string &name)
    {
      for (const CLI::App *sub : nsfd.get_subcommands(nullptr))
        if (const CLI::Option *option = sub->get_option_no_throw(name))
          return option;
      return nullptr;
    }

    bool is_subcommand(const CLI::App &nsfd, const std::string &word)
    {
      for (const CLI::App *sub : nsfd.get_subcommands(nullptr))
        if (sub->get_name() == word)
          return true;
      return false;
    }

    /** Finds the subcommand wherever it stands: --quiet law tvergaard. */
    Words sorted_words(const CLI::App &nsfd, const int argc,
                       const char *const *argv)
    {
      Words words;
      std::error_code error;
      for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool is_option = word.size() > 1 && word[0] == '-';
        if (!is_option && words.subcommand.empty() && words.first.empty() &&
            is_subcommand(nsfd, word)) {
          words.subcommand = word;
          continue;
        }
        words.all.push_back(word);
        if (!is_option) {
          words.only_information = false;
          if (words.first.empty())
            words.first = word;
          continue;
        }
        words.only_information =
            words.only_information && nsfd.get_option_no_throw(word) != nullptr;
        if (word.compare(0, 6, "--set=") == 0)
          words.set.push_back(word.substr(6));
        const CLI::Option *option = option_of(nsfd, word);
        if (option == nullptr || i + 1 == argc)
          continue;
        const std::string next = argv[i + 1];
        const bool takes_next = option->get_items_expected_min() > 0 ||
                                (option->get_items_expected_max() > 0 &&
                                 fs::is_directory(next, error));
        if (takes_next) {
          words.all.push_back(next);
          if (word == "--set")
            words.set.push_back(next);
          ++i;
        }
      }
      return words;
    }

    /** A word in the place of a file or a subcommand that is neither. */
    void refuse_unknown(const CLI::App &nsfd, const std::string &word)
    {
      std::error_code error;
      if (word.empty() || word.find_first_of("./") != std::string::npos ||
          fs::exists(word, error))
        return;
      std::vector<std::string> names;
      for (const CLI::App *sub : nsfd.get_subcommands(nullptr))
        names.push_back(sub->get_name());
      throw WrongUsage(
          fmt::format("there is no subcommand and no file `{}`", word),
          did_you_mean(word, names, "`nsfd --help` prints all subcommands"));
    }

    /** What no option has taken: an argument too many, or an option that does
     * not exist, or not here. */
    [[noreturn]] void refuse_extra(const CLI::App &nsfd,
                                   const NamedSubcommand &chosen,
                                   const std::string &program,
                                   const std::string &word)
    {
      const std::string option = word.substr(0, word.find('='));
      if (option.empty() || option[0] != '-')
        throw WrongUsage(
            fmt::format("`{}` is one {} too many", word, chosen.argument),
            chosen.advice);
      for (const CLI::App *other : nsfd.get_subcommands(nullptr))
        if (other->get_option_no_throw(option) != nullptr)
          throw WrongUsage(
              fmt::format("there is no option `{}` here", option),
              fmt::format("it belongs to `nsfd {}`", other->get_name()));
      std::vector<std::string> known;
      const CLI::App *sub = nsfd.get_subcommand(chosen.name);
      for (const CLI::App *app : {sub, &nsfd})
        for (const CLI::Option *other : app->get_options())
          for (const std::string &name : other->get_lnames())
            known.push_back("--" + name);
      throw WrongUsage(
          fmt::format("there is no option `{}`", option),
          did_you_mean(option, known,
                       fmt::format("`{} --help` prints them all", program)));
    }

    /** The names that a parameter file may write, with their texts. */
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
        for (const PlugIn &one : loaded_plug_ins())
          if (one.name == part.plug_in)
            out << fmt::format("  {:<{}}  of the plug-in {}\n", "", width,
                               one.file);
      }
    }

    /** --help, --version or --list. */
    bool print_information(const CLI::App &nsfd, const CLI::App *sub,
                           const CommandLine &line, std::ostream &out)
    {
      const auto given = [&](const std::string &name) {
        for (const CLI::App *app : {&nsfd, sub})
          if (app != nullptr)
            if (const CLI::Option *option = app->get_option_no_throw(name))
              if (option->count() > 0)
                return true;
        return false;
      };
      if (given("--help"))
        out << nsfd.help();
      else if (given("--version"))
        out << "nsfd " << version().number << " " << version().git_hash << "\n";
      else if (given("--list")) {
        common_options::load_plug_ins(line);
        print_list(out);
      } else
        return false;
      return true;
    }

    const char *const footer =
        "`nsfd law --help`, `nsfd study --help`, ... say more of a "
        "subcommand.\n"
        "Exit code: 0 done, 1 bad input (nothing was run), 2 wrong usage, 3 a "
        "step could\n"
        "not be solved, 4 stopped on request, 5 a fault of machine or "
        "program, 6 runs\n"
        "differ (compare), 7 the certificate is not ok (--strict).\n"
        "Example:\n"
        "  nsfd prm/quickstart.prm --set 'Time/end=40 us' --output "
        "output/short";

    /** The tree; its subcommands write into @p line. */
    class Tree
    {
    public:
      explicit Tree(CommandLine &line)
          : nsfd_("Nonsmooth fracture dynamics: every cell is a body, faces "
                  "carry cohesion, contact and friction.",
                  "nsfd")
      {
        nsfd_.set_help_flag();
        nsfd_.allow_extras();
        nsfd_.fallthrough(); // to --version and --list
        nsfd_.require_subcommand(0, 1);
        nsfd_.formatter(std::make_shared<HelpText>());
        nsfd_.footer(footer);
        nsfd_
            .add_flag("--list",
                      "print the names of all laws, meshes, solvers, ...")
            ->group("Information");
        nsfd_.add_flag("--version", "print the version")->group("Information");
        nsfd_.add_flag("-h,--help", "print this help")->group("Information");
        for (const NamedSubcommand &one : subcommands_)
          one.subcommand->declare(*nsfd_.add_subcommand(one.name, one.text),
                                  line);
      }

      std::optional<int> parse(const int argc, const char *const *argv,
                               CommandLine &line, std::ostream &out,
                               std::ostream &err)
      {
        Words words = sorted_words(nsfd_, argc, argv);
        if (words.all.empty() &&
            (words.subcommand.empty() || words.subcommand == "run")) {
          err << "nsfd - nonsmooth fracture dynamics\n"
              << overview(nsfd_)
              << wrapped("  nsfd --help", "print all options", 30);
          return exit_code::wrong_usage;
        }
        if (words.subcommand.empty() && words.only_information) {
          nsfd_.parse(argc, argv);
          print_information(nsfd_, nullptr, line, out);
          return exit_code::done;
        }
        const NamedSubcommand &chosen = choose(words);
        if (chosen.name != std::string("run"))
          line.program += std::string(" ") + chosen.name;
        std::vector<std::string> &all = words.all;
        all.insert(all.begin(), chosen.name);
        std::reverse(all.begin(), all.end()); // as CLI11 takes them
        nsfd_.parse(all);
        const std::vector<std::string> extras = nsfd_.remaining(true);
        if (!extras.empty())
          refuse_extra(nsfd_, chosen, line.program, extras.front());
        if (print_information(nsfd_, nsfd_.get_subcommand(chosen.name), line,
                              out))
          return exit_code::done;
        common_options::check(line);
        chosen.subcommand->check(line);
        common_options::load_plug_ins(line);
        line.subcommand = chosen.subcommand;
        return {};
      }

    private:
      /** The subcommand that is named, or the one for the file. */
      const NamedSubcommand &choose(const Words &words) const
      {
        std::string name = words.subcommand;
        if (name.empty()) {
          refuse_unknown(nsfd_, words.first);
          name = "run";
        }
        if (name == "run" && is_study(words.first, words.set))
          name = "study";
        for (const NamedSubcommand &one : subcommands_)
          if (one.name == name)
            return one;
        throw WrongUsage("there is no subcommand `" + name + "`");
      }

      CLI::App nsfd_;
      const std::vector<NamedSubcommand> subcommands_ = {
          run_subcommand(),   study_subcommand(),   law_subcommand(),
          solve_subcommand(), compare_subcommand(), mesh_subcommand()};
    };
  } // namespace

  std::vector<std::string> CommandLine::overrides() const
  {
    std::vector<std::string> result = set;
    if (!output.empty())
      result.push_back("Output/directory=" + output);
    return result;
  }

  std::string CommandLine::text() const
  {
    std::string result;
    for (const std::string &word : words)
      result += (result.empty() ? "" : " ") + word;
    return result;
  }

  std::optional<int> parse_command_line(const int argc, const char *const *argv,
                                        CommandLine &line, std::ostream &out,
                                        std::ostream &err)
  {
    line.words.assign(argv, argv + argc);
    const auto refuse = [&](const std::string &message,
                            const std::string &advice) {
      err << line.program << ": " << message << "\n";
      if (!advice.empty())
        err << "  " << advice << "\n";
      return exit_code::wrong_usage;
    };
    Tree tree(line);
    try {
      return tree.parse(argc, argv, line, out, err);
    } catch (const WrongUsage &error) {
      return refuse(error.what(), error.advice());
    } catch (const PlugInError &error) {
      InputErrors errors;
      errors.error({error.file(), 0, 0, 0, ""}, error.what(), error.advice());
      if (is_first_process())
        err << errors.report();
      return exit_code::bad_input;
    } catch (const CLI::ParseError &error) {
      return refuse(error.what(),
                    "`" + line.program + " --help` prints all options");
    }
  }
} // namespace nsfd
