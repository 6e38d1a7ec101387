// Damaged input of every kind must end with an exit code that says so: never
// with a signal, exit code 5, more than 20 s of CPU or 4 GiB of memory.
//
//   nsfd_fuzz --source . --mutants 300 --seed 1 --jobs 2
//
// Mutants follow from the seed and their number alone. Those that are faults
// stay in the folder `--keep`, each with its command and what was printed.

#include "child.h"
#include "mutate.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <thread>

int nsfd_main(int argc,
              char **argv); // of source/app/main.cc, see CMakeLists.txt

namespace nsfd::fuzz
{
  namespace
  {
    namespace fs = std::filesystem;

    struct Options {
      std::string source, keep;
      std::size_t n_mutants = 300, first = 0, n_jobs = 2;
      std::uint64_t seed = 1;
      std::vector<std::string> kinds;
      bool verbose = false;
    };

    /** What is mutated, and what reads it. */
    struct Seed {
      std::string kind;
      fs::path file;
    };

    std::string read_file(const fs::path &file)
    {
      std::ifstream stream(file, std::ios::binary);
      return {std::istreambuf_iterator<char>(stream),
              std::istreambuf_iterator<char>()};
    }

    void write_file(const fs::path &file, const std::string &content)
    {
      std::ofstream(file, std::ios::binary) << content;
    }

    /** Lines `kind path` of the list of seeds; `#` begins a comment. */
    std::map<std::string, std::vector<fs::path>>
    read_seeds(const Options &options)
    {
      std::map<std::string, std::vector<fs::path>> seeds;
      std::ifstream stream(fs::path(options.source) / "tests/fuzz/seeds.txt");
      for (std::string line; std::getline(stream, line);) {
        std::istringstream words(line.substr(0, line.find('#')));
        std::string kind, path;
        if (words >> kind >> path)
          seeds[kind].push_back(fs::path(options.source) / path);
      }
      return seeds;
    }

    class Fuzzer
    {
    public:
      explicit Fuzzer(const Options &options);
      int run();

    private:
      struct Job {
        std::size_t number;
        std::string kind, done;
        std::vector<std::string> command;
        fs::path folder;
        std::unique_ptr<Child> child;
        bool is_second_try = false;
      };
      struct Count {
        std::size_t n = 0, n_faults = 0;
        std::map<int, std::size_t> of_code;
        double longest = 0., largest = 0.;
      };

      Options options_;
      fs::path scratch_;
      std::map<std::string, std::vector<fs::path>> seeds_;
      std::vector<std::string> kinds_, texts_;
      std::map<std::string, Count> counts_;

      void make_checkpoint();
      Job make(std::size_t number) const;
      void judge(const Job &job);
    };

    Fuzzer::Fuzzer(const Options &options)
        : options_(options), scratch_(fs::temp_directory_path() /
                                      fmt::format("nsfd_fuzz_{}", getpid())),
          seeds_(read_seeds(options))
    {
      fs::create_directories(scratch_);
      // as often as they stand here
      kinds_ = {"scene", "scene", "scene", "scene",      "law",
                "study", "mesh",  "set",   "checkpoint", "stored"};
      if (!options.kinds.empty())
        kinds_ = options.kinds;
      for (const char *kind : {"scene", "law", "study"})
        for (const fs::path &file : seeds_[kind])
          texts_.push_back(read_file(file));
      if (std::find(kinds_.begin(), kinds_.end(), "checkpoint") != kinds_.end())
        make_checkpoint();
    }

    /** A run of a few steps, to be resumed from damaged checkpoints. */
    void Fuzzer::make_checkpoint()
    {
      const fs::path folder = scratch_ / "good";
      fs::create_directories(folder);
      fs::copy_file(seeds_.at("checkpoint").front(), folder / "scene.prm");
      Child run(::nsfd_main,
                {"nsfd", "scene.prm", "--output", "run", "--quiet"}, folder,
                folder / "log", Limits());
      while (!run.ended())
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      if (run.outcome().code != 0 || !fs::exists(folder / "run/checkpoint.h5"))
        throw std::runtime_error("no checkpoint: " + read_file(folder / "log"));
    }

    Fuzzer::Job Fuzzer::make(const std::size_t number) const
    {
      Random random(options_.seed * 1000003u + number);
      for (unsigned int i = 0; i < 8; ++i)
        random();
      Job job;
      job.number = number;
      job.kind = kinds_[below(random, kinds_.size())];
      job.folder = scratch_ / std::to_string(number);
      // scenes name files by paths relative to their own folder
      const fs::path inner = job.folder / "prm" / "case";
      fs::create_directories(inner);
      const auto &files = seeds_.at(job.kind == "set" ? "scene" : job.kind);
      const fs::path &seed = files[below(random, files.size())];
      const fs::path prm = fs::path(options_.source) / "prm";
      for (const auto &entry : fs::directory_iterator(prm))
        if (entry.is_directory())
          fs::create_directory_symlink(
              entry.path(), job.folder / "prm" / entry.path().filename());
      for (const auto &entry : fs::directory_iterator(seed.parent_path()))
        if (entry.path().extension() == ".prm")
          fs::create_symlink(entry.path(), inner / entry.path().filename());
      const auto mutate = [&](const bool is_text) {
        const std::string content = read_file(seed);
        const Mutant mutant = is_text ? mutate_text(content, texts_, random)
                                      : mutate_bytes(content, random);
        job.done = seed.filename().string() + ": " + mutant.done;
        return mutant.content;
      };
      auto &command = job.command;
      command = {"nsfd"};
      if (job.kind == "scene") {
        write_file(inner / "mutant.prm", mutate(true));
        command.insert(command.end(), {"mutant.prm", "--check"});
      } else if (job.kind == "law") {
        write_file(inner / "mutant.prm", mutate(true));
        command.insert(command.end(),
                       {"law", "mutant.prm", "--output", "run", "--quiet"});
      } else if (job.kind == "study") {
        write_file(inner / "mutant.prm", mutate(true));
        command.insert(command.end(),
                       {"study", "mutant.prm", "--print-parameters"});
      } else if (job.kind == "set") {
        fs::copy_file(seed, inner / "mutant.prm");
        static const std::vector<std::string> names = {
            "Mesh/cells",
            "Time/end",
            "Time/step",
            "Time/theta",
            "dimension",
            "Discretization/degree",
            "Mesh/refinements",
            "Output/fields every",
            "Boundary: left/velocity x",
            "Material: bulk/density",
            "Mesh/upper corner",
            "Constants/a"};
        std::string assignment =
            names[below(random, names.size())] + "=" + extreme_value(random);
        job.done = assignment;
        if (below(random, 4) == 0)
          assignment[below(random, assignment.size())] =
              char(1 + below(random, 255));
        command.insert(command.end(),
                       {"mutant.prm", "--check", "--set", assignment});
      } else if (job.kind == "mesh") {
        const std::string extension = seed.extension().string();
        const bool is_text = read_file(seed).find('\0') == std::string::npos;
        const bool is_in_space =
            seed.filename().string().compare(0, 5, "block") == 0;
        write_file(inner / ("mutant" + extension), mutate(is_text));
        write_file(inner / "mutant.prm",
                   (is_in_space ? "set dimension = 3\n" : "") +
                       std::string("subsection Mesh\n set type = file\n"
                                   " set file = mutant") +
                       extension +
                       "\nend\nsubsection Material: m\n set Young modulus = 1\n"
                       " set Poisson ratio = 0.2\n set density = 1\nend\n"
                       "subsection Interface: i\n set law = rigid\nend\n"
                       "subsection Time\n set end = 1\n set step = 0.1\nend\n");
        command.insert(command.end(), {"mutant.prm", "--check"});
      } else if (job.kind == "checkpoint") {
        fs::copy(scratch_ / "good", inner,
                 fs::copy_options::recursive |
                     fs::copy_options::overwrite_existing);
        const std::string content = read_file(inner / "run/checkpoint.h5");
        const Mutant mutant = mutate_bytes(content, random);
        job.done = mutant.done;
        write_file(inner / "run/checkpoint.h5", mutant.content);
        command.insert(command.end(),
                       {"scene.prm", "--output", "run", "--quiet", "--resume"});
      } else { // stored
        write_file(inner / "mutant.hdf5", mutate(false));
        command.insert(command.end(), {"solve", "mutant.hdf5", "--tolerance",
                                       "0.1", "--attempts", "20"});
      }
      job.child = std::make_unique<Child>(::nsfd_main, command, inner,
                                          job.folder / "log", Limits());
      return job;
    }

    void Fuzzer::judge(const Job &job)
    {
      const Outcome &outcome = job.child->outcome();
      constexpr int internal_error = 5, highest_code = 7;
      std::string fault;
      if (outcome.timed_out)
        fault = "took more than 20 s";
      else if (outcome.signal != 0)
        fault = fmt::format("ended by signal {}", outcome.signal);
      else if (outcome.code == internal_error || outcome.code > highest_code)
        fault = fmt::format("exit code {}", outcome.code);
      else if (outcome.peak_bytes > Limits().bytes)
        fault = fmt::format("took {:.2g} bytes", outcome.peak_bytes);

      Count &count = counts_[job.kind];
      ++count.n;
      ++count.of_code[outcome.code];
      count.longest = std::max(count.longest, outcome.cpu_seconds);
      count.largest = std::max(count.largest, outcome.peak_bytes);
      if (options_.verbose)
        fmt::print("{} {} code {} {:.2f} s {:.0f} MB  {}\n", job.number,
                   job.kind, outcome.code, outcome.cpu_seconds,
                   outcome.peak_bytes / 1e6, job.done);
      if (!fault.empty()) {
        ++count.n_faults;
        std::string command;
        for (const std::string &word : job.command)
          command += " '" + word + "'";
        const std::string log = read_file(job.folder / "log");
        fmt::print(
            "FAULT {} ({}): {}\n  {}\n  {}\n  {}\n", job.number, job.kind,
            fault, job.done, command,
            log.substr(log.size() - std::min<std::size_t>(log.size(), 400)));
        if (!options_.keep.empty()) {
          const fs::path kept =
              fs::path(options_.keep) / fs::path(job.folder).filename();
          fs::remove_all(kept);
          fs::create_directories(options_.keep);
          fs::copy(job.folder, kept,
                   fs::copy_options::recursive |
                       fs::copy_options::copy_symlinks);
          write_file(kept / "command", command + "\n" + fault + "\n");
        }
        std::cout.flush();
      }
      fs::remove_all(job.folder);
    }

    int Fuzzer::run()
    {
      std::vector<Job> running;
      std::size_t next = options_.first;
      const std::size_t end = options_.first + options_.n_mutants;
      while (next < end || !running.empty()) {
        while (next < end && running.size() < options_.n_jobs)
          running.push_back(make(next++));
        for (std::size_t i = 0; i < running.size();)
          if (running[i].child->ended()) {
            // the clock alone may speak of what else the machine does
            const Outcome &outcome = running[i].child->outcome();
            if (outcome.timed_out && !running[i].is_second_try &&
                outcome.cpu_seconds < Limits().cpu_seconds) {
              fs::remove_all(running[i].folder);
              running[i] = make(running[i].number);
              running[i].is_second_try = true;
              continue;
            }
            judge(running[i]);
            running.erase(running.begin() + std::ptrdiff_t(i));
          } else
            ++i;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
      fs::remove_all(scratch_);

      std::size_t n_faults = 0;
      for (const auto &[kind, count] : counts_) {
        std::string codes;
        for (const auto &[code, n] : count.of_code)
          codes += fmt::format(" {}: {}", code, n);
        fmt::print("{:<10} {:>5} mutants, {} faults, longest {:.1f} s of CPU, "
                   "largest {:.0f} MB, exit codes{}\n",
                   kind, count.n, count.n_faults, count.longest,
                   count.largest / 1e6, codes);
        n_faults += count.n_faults;
      }
      return n_faults == 0 ? 0 : 1;
    }
  } // namespace
} // namespace nsfd::fuzz

int main(const int argc, char **argv)
{
  using namespace nsfd::fuzz;
  // the program may start itself again, by the name of its file
  if (argc < 2 || argv[1] != std::string("--source"))
    return nsfd_main(argc, argv);
  Options options;
  CLI::App app("Damaged input must be refused, never crash or hang.");
  app.add_option("--source", options.source, "the checkout")->required();
  app.add_option("--mutants", options.n_mutants, "how many");
  app.add_option("--first", options.first, "number of the first");
  app.add_option("--seed", options.seed, "of all of them");
  app.add_option("--jobs", options.n_jobs, "at the same time");
  app.add_option("--keep", options.keep, "folder for those that are faults");
  app.add_option("--kind", options.kinds,
                 "scene, law, study, mesh, set, checkpoint, stored");
  app.add_flag("--verbose", options.verbose, "a line for each");
  CLI11_PARSE(app, argc, argv);
  options.source = std::filesystem::absolute(options.source).string();
  try {
    return Fuzzer(options).run();
  } catch (const std::exception &error) {
    std::cerr << "nsfd_fuzz: " << error.what() << "\n";
    return 2;
  }
}
