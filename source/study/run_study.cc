#include "run_case.h"
#include "study_command.h"
#include "study_results.h"

#include "core/exit_code.h"
#include "core/load_plug_in.h"
#include "core/output_folder.h"
#include "core/version.h"
#include "parameters/input_errors.h"
#include "postprocess/progress.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <ostream>
#include <set>
#include <thread>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;
    using Status = CaseResult::Status;

    /** Runs cases, a few at a time, and says what came of each. */
    class Runner
    {
    public:
      Runner(const StudyResults &study, const StudyCommand &command,
             std::ostream &out)
          : study_(study), command_(command),
            out_(out), stamp_{study.version, study.git_hash, 1, used_plug_ins()}
      {
      }

      std::vector<CaseResult> run(const std::vector<StudyCase> &cases,
                                  const unsigned int repeats)
      {
        std::vector<CaseResult> results(cases.size());
        std::atomic<std::size_t> next{0};
        std::exception_ptr failure;
        const auto work = [&]() {
          while (!stop_was_requested()) {
            const std::size_t k = next++;
            if (k >= cases.size())
              return;
            try {
              results[k] = run_case(study_.input, cases[k], stamp_, repeats,
                                    command_.resume);
            } catch (...) {
              const std::lock_guard<std::mutex> lock(mutex_);
              failure = std::current_exception();
              return;
            }
            say(k, cases, results[k]);
          }
        };
        std::vector<std::thread> threads;
        started_ = std::chrono::steady_clock::now();
        n_taken_over_ = n_run_ = 0;
        for (unsigned int j = 1;
             j < std::min<std::size_t>(study_.input.jobs, cases.size()); ++j)
          threads.emplace_back(work);
        work();
        for (std::thread &thread : threads)
          thread.join();
        if (failure)
          std::rethrow_exception(failure);
        return results;
      }

    private:
      void say(const std::size_t k, const std::vector<StudyCase> &cases,
               const CaseResult &result)
      {
        if (command_.quiet)
          return;
        const std::lock_guard<std::mutex> lock(mutex_);
        out_ << fmt::format("[{:>{}}/{}] {}  {}", k + 1,
                            std::to_string(cases.size()).size(), cases.size(),
                            cases[k].combination.name, name_of(result.status));
        if (is_done(result))
          out_ << fmt::format("  {:.3g} s x {}{}", solve_median(result),
                              result.solve.size(),
                              result.taken_over ? ", taken over" : "");
        else
          out_ << "  " << result.failure;
        ++(result.taken_over ? n_taken_over_ : n_run_);
        const std::size_t n_left = cases.size() - n_taken_over_ - n_run_;
        if (n_run_ > 0 && n_left > 0) {
          const std::chrono::duration<double> passed =
              std::chrono::steady_clock::now() - started_;
          out_ << "  ETA "
               << Progress::duration(passed.count() / double(n_run_) *
                                     double(n_left));
        }
        out_ << std::endl;
      }

      const StudyResults &study_;
      const StudyCommand &command_;
      std::ostream &out_;
      CaseStamp stamp_;
      std::mutex mutex_;
      std::chrono::steady_clock::time_point started_;
      std::size_t n_taken_over_ = 0, n_run_ = 0; ///< of the cases at hand
    };

    std::string processor()
    {
      std::ifstream stream("/proc/cpuinfo");
      for (std::string line; std::getline(stream, line);)
        if (line.compare(0, 10, "model name") == 0)
          return line.substr(line.find(": ") + 2);
      return "unknown processor";
    }

    void fill_provenance(StudyResults &study, const StudyCommand &command)
    {
      const Version program = version();
      study.command_line = command.command_line;
      study.version = program.number;
      study.git_hash = program.git_hash;
      study.build_type = program.build_type;
#ifdef __clang__
      study.compiler = "clang " __clang_version__;
#else
      study.compiler = "gcc " __VERSION__;
#endif
      char host[256] = "";
      gethostname(host, sizeof(host) - 1);
      study.host = host;
      study.processor = processor();
      study.cores = std::thread::hardware_concurrency();
      const std::time_t now = std::time(nullptr);
      char text[32];
      std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ",
                    std::gmtime(&now));
      study.date = text;
    }

    /**
     * False, with a message, if results are there that must not be lost. Cases
     * replace or keep what is in their own folders.
     */
    bool claim(const std::string &directory, const StudyCommand &command,
               std::ostream &err)
    {
      std::error_code error;
      const fs::path folder(directory);
      const bool used =
          fs::is_directory(folder, error) && !fs::is_empty(folder, error);
      if (used && !command.force && !command.resume) {
        err << "the output directory `" << directory
            << "` exists already: nothing was run.\n"
               "  write --resume to run what is missing, --force to run all "
               "again, or --output DIR\n";
        return false;
      }
      if (used && !fs::exists(folder / "run.json") &&
          !fs::exists(folder / "study.json")) {
        err << "the output directory `" << directory
            << "` holds files, but not those of a study: nothing was run.\n"
               "  write --output DIR with another one\n";
        return false;
      }
      OutputFolder &ours = OutputFolder::instance();
      if (!ours.claim(directory, used ? OutputFolder::Claim::go_on
                                      : OutputFolder::Claim::anew))
        return false;
      ours.describe(nlohmann::json{{"subcommand", "study"},
                                   {"file", command.file},
                                   {"command_line", command.command_line}}
                        .dump());
      return true;
    }

    /** The best cases of the main error, best first. */
    std::vector<std::size_t> best_cases(const StudyResults &study,
                                        const std::string &error,
                                        const std::size_t n)
    {
      std::vector<std::size_t> best;
      for (std::size_t k = 0; k < study.results.size(); ++k)
        if (is_done(study.results[k]) && study.results[k].errors.count(error) &&
            study.results[k].errors.at(error) > 0.)
          best.push_back(k);
      std::sort(best.begin(), best.end(),
                [&](const std::size_t a, const std::size_t b) {
                  return study.results[a].errors.at(error) <
                         study.results[b].errors.at(error);
                });
      best.resize(std::min(best.size(), n));
      return best;
    }

    /** Rule 4 of the protocol, and the same for the step. */
    void check_limits(StudyResults &study, const StudyCommand &command,
                      Runner &runner, std::ostream &out)
    {
      const std::vector<std::string> errors = shown_errors(study);
      if (!study.input.limit_checks || errors.empty() || stop_was_requested())
        return;
      std::vector<StudyCase> cases;
      std::vector<std::size_t> origin;
      for (const std::size_t k : best_cases(study, errors[0], 3)) {
        const StudyCase &one = study.cases[k];
        const auto add = [&](const std::string &reason, const char *ending,
                             const std::string &assignment) {
          InputErrors problems;
          const std::string name =
              "checks/" + one.combination.name + "_" + ending;
          StudyCase more = derived_case(study.input, one, name, command.set,
                                        {assignment}, problems);
          if (problems.has_errors())
            return;
          cases.push_back(more);
          origin.push_back(k);
          study.checks.push_back(
              {name, reason, study.results[k].errors.at(errors[0]), 0., false});
        };
        add("tolerance/100", "tolerance",
            fmt::format("Solver/tolerance={:.3g}", one.tolerance / 100.));
        if (!one.half_step.empty())
          add("step/2", "step", "Time/step=" + one.half_step);
      }
      if (!command.quiet && !cases.empty())
        out << "what limits the best cases:\n";
      const std::vector<CaseResult> results = runner.run(cases, 1);
      for (std::size_t i = 0; i < results.size(); ++i) {
        const auto found = results[i].errors.find(errors[0]);
        study.checks[i].done =
            is_done(results[i]) && found != results[i].errors.end();
        if (study.checks[i].done)
          study.checks[i].after = found->second;
      }
    }

    void add_warnings(StudyResults &study)
    {
      const auto warn = [&study](const std::string &text) {
        study.warnings.push_back(text);
      };
      if (study.build_type != "Release")
        warn("times of a " + study.build_type + " build mean nothing");
      if (study.input.jobs > 1 && study.input.observed.empty())
        warn("cases ran at the same time: their times disturb each other");
      if (study.input.repeats < 5 && study.input.observed.empty())
        warn("fewer than 5 repeats: times are less certain");
      for (std::size_t k = 0; k < study.results.size(); ++k)
        if (!study.results[k].reproducible)
          warn("repeats differ: " + study.cases[k].combination.name);
      std::set<std::string> shown;
      for (const std::string &name : shown_errors(study))
        shown.insert(name);
      for (const ObservedQuantity &quantity : study.input.observed)
        if (std::none_of(study.results.begin(), study.results.end(),
                         [&](const CaseResult &result) {
                           return result.errors.count(quantity.name) != 0;
                         }))
          warn("`" + quantity.name + "` is observed, but no case has it");
      for (const auto &[name, formula] : study.input.expected_orders)
        if (shown.count(name) == 0)
          warn("expected orders name `" + name + "`, which no case has");
    }

    /** The worst of what came of the cases. */
    int code_of(const StudyResults &study)
    {
      for (const auto &[status, code] :
           {std::pair(Status::broken, exit_code::internal_error),
            {Status::stopped, exit_code::stopped},
            {Status::not_run, exit_code::stopped},
            {Status::bad_input, exit_code::bad_input},
            {Status::failed, exit_code::step_failed}})
        if (count(study, status) > 0)
          return code;
      return exit_code::done;
    }

    void print_cases(const StudyResults &study, std::ostream &out)
    {
      for (const StudyCase &one : study.cases)
        out << "  " << one.combination.name << "\n";
      out << fmt::format("{} cases in {}, each at least {} times; nothing is "
                         "run\n",
                         study.cases.size(), study.input.directory,
                         study.input.repeats);
    }
  } // namespace

  int run_study(const StudyCommand &command, std::ostream &out,
                std::ostream &err)
  {
    InputErrors errors;
    StudyResults study;
    if (const auto input =
            read_study(command.file, command.set, command.vary, errors)) {
      study.input = *input;
      study.cases = read_cases(study.input, command.set, errors);
      if (study.input.jobs == 0)
        study.input.jobs = std::max(1u, std::thread::hardware_concurrency() /
                                            study.input.ranks);
    }
    err << errors.report();
    if (errors.has_errors())
      return exit_code::bad_input;
    if (command.print_parameters) {
      out << study.input.echo;
      return exit_code::done;
    }
    if (command.check) {
      print_cases(study, out);
      return exit_code::done;
    }
    const std::string &directory = study.input.directory;
    if (!claim(directory, command, err))
      return exit_code::bad_input;

    fill_provenance(study, command);
    catch_stop_signals();
    Runner runner(study, command, out);
    study.results = runner.run(study.cases, study.input.repeats);
    check_limits(study, command, runner, out);
    add_warnings(study);
    write_file_atomically(directory + "/study.csv", study_csv(study));
    write_file_atomically(directory + "/study.json", study_json(study));
    write_study_page(study, directory);
    OutputFolder::instance().finish();
    if (!command.quiet)
      out << "\n" << study_text(study) << "  " << directory << "/study.html\n";
    const int code = code_of(study);
    if (code != exit_code::done)
      err << fmt::format("{}: {} of {} cases are not done\n", command.file,
                         study.cases.size() - count(study, Status::done),
                         study.cases.size());
    return code;
  }
} // namespace nsfd
