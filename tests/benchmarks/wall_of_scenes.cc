// A wall of scenes: draws scenes as users write them, runs each with ten
// seconds of CPU, and counts by kind what went through. Not part of the test
// suite; a few fixed seeds are.
//
//   wall_of_scenes FIRST_SEED N [FOLDER] [--only KIND] [--write SEED]
//                  [--program NSFD] [--seconds S] [--keep] [--details]
//
// Scenes FIRST_SEED to FIRST_SEED + N - 1. FOLDER (default: wall) gets the
// scene, the log and the results of every failure; with --keep of all. KIND is
// any part of the name of a kind, as the table prints it. --write prints a
// scene and runs nothing; --details prints a line for what went through, too.
#include "../wall/drawn_scene.h"
#include "../wall/verdict.h"

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace
{
  namespace fs = std::filesystem;

  struct Options {
    unsigned int first = 1, number = 100;
    fs::path folder = "wall";
    std::string only, program = NSFD_PROGRAM;
    long write = -1;
    unsigned int seconds = 10;
    bool keep = false, details = false;
  };

  /** The program, with a limit of CPU, and what it printed in a file. */
  wall::Ended run(const Options &options, const fs::path &scene,
                  const fs::path &output, const fs::path &log)
  {
    const std::string directory = "Output/directory=" + output.string();
    const char *const words[] = {
        options.program.c_str(), scene.c_str(), "--force", "--set",
        directory.c_str(),       nullptr};
    const pid_t process = fork();
    if (process == 0) {
      // a run that is warned writes what it has
      rlimit cpu{};
      cpu.rlim_cur = options.seconds;
      cpu.rlim_max = options.seconds + 3;
      setrlimit(RLIMIT_CPU, &cpu);
      rlimit core{};
      setrlimit(RLIMIT_CORE, &core);
      setenv("OMPI_MCA_ess_singleton_isolated", "1", 1);
      setenv("OMP_NUM_THREADS", "1", 1);
      const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
      dup2(out, 1);
      dup2(out, 2);
      execv(options.program.c_str(), const_cast<char *const *>(words));
      _exit(127);
    }
    int status = 0;
    rusage used{};
    wait4(process, &status, 0, &used);
    wall::Ended ended;
    ended.exit_code =
        WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    ended.cpu_seconds =
        double(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
        1e-6 * double(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
    return ended;
  }

  struct Count {
    unsigned int through = 0, not_through = 0, refused = 0, silent = 0;
    double worst = -1., seconds = 0.;
    unsigned int seed = 0;
    std::string message;
  };

  bool read_options(const int argc, char **argv, Options &options)
  {
    std::vector<std::string> words;
    for (int i = 1; i < argc; ++i) {
      const bool more = i + 1 < argc;
      if (!std::strcmp(argv[i], "--only") && more)
        options.only = argv[++i];
      else if (!std::strcmp(argv[i], "--write") && more)
        options.write = std::atol(argv[++i]);
      else if (!std::strcmp(argv[i], "--program") && more)
        options.program = argv[++i];
      else if (!std::strcmp(argv[i], "--seconds") && more)
        options.seconds = unsigned(std::atoi(argv[++i]));
      else if (!std::strcmp(argv[i], "--keep"))
        options.keep = true;
      else if (!std::strcmp(argv[i], "--details"))
        options.details = true;
      else
        words.emplace_back(argv[i]);
    }
    if (words.size() > 2)
      options.folder = words[2];
    if (words.size() > 1) {
      options.first = unsigned(std::atol(words[0].c_str()));
      options.number = unsigned(std::atol(words[1].c_str()));
    }
    return words.size() > 1 || options.write >= 0;
  }
} // namespace

int main(int argc, char **argv)
{
  Options options;
  if (!read_options(argc, argv, options)) {
    fmt::print("wall_of_scenes FIRST_SEED N [FOLDER] [--only KIND] [--write "
               "SEED] [--program NSFD] [--seconds S] [--keep] [--details]\n");
    return 1;
  }
  if (options.write >= 0) {
    fmt::print("{}", wall::draw_scene(unsigned(options.write)).text);
    return 0;
  }
  fs::create_directories(options.folder);
  options.folder = fs::absolute(options.folder);
  std::map<std::string, Count> kinds;
  for (unsigned int seed = options.first; seed < options.first + options.number;
       ++seed) {
    const wall::DrawnScene scene = wall::draw_scene(seed);
    if (scene.kind.find(options.only) == std::string::npos)
      continue;
    const fs::path base = options.folder / std::to_string(seed),
                   file = base.string() + ".prm", log = base.string() + ".log";
    std::ofstream(file) << scene.text;
    for (const auto &[name, text] : scene.files)
      std::ofstream(options.folder / name) << text;
    const wall::Ended ended = run(options, file, base, log);
    const wall::Verdict verdict =
        wall::judge(base, log, ended, scene.keeps_momentum, scene.end);
    Count &count = kinds[scene.kind];
    count.seconds += ended.cpu_seconds;
    if (verdict.through)
      ++count.through;
    else if (verdict.refused)
      ++count.refused;
    else
      ++count.not_through;
    count.silent += verdict.silent;
    if (verdict.through && options.details)
      fmt::print("{:>6} {}: through, {:.2f} s\n", seed, scene.kind,
                 ended.cpu_seconds);
    if (!verdict.through) {
      fmt::print("{:>6} {}: {}{}\n", seed, scene.kind,
                 verdict.silent ? "SILENT " : "", verdict.message);
      std::fflush(stdout);
      if (verdict.worst > count.worst) {
        count.worst = verdict.worst;
        count.seed = seed;
        count.message = verdict.message;
      }
    } else if (!options.keep) {
      std::error_code error;
      fs::remove_all(base, error);
      fs::remove(file, error);
      fs::remove(log, error);
      for (const auto &[name, text] : scene.files)
        fs::remove(options.folder / name, error);
    }
  }
  fmt::print("\n{:<38} {:>7} {:>4} {:>7} {:>6} {:>8}  {}\n", "kind", "through",
             "not", "refused", "silent", "CPU s", "worst");
  Count all;
  for (const auto &[kind, count] : kinds) {
    fmt::print("{:<38} {:>7} {:>4} {:>7} {:>6} {:>8.1f}  {}\n", kind,
               count.through, count.not_through, count.refused, count.silent,
               count.seconds,
               count.seed ? fmt::format("{}: {:.80}", count.seed, count.message)
                          : std::string());
    all.through += count.through;
    all.not_through += count.not_through;
    all.refused += count.refused;
    all.silent += count.silent;
    all.seconds += count.seconds;
  }
  fmt::print("{:<38} {:>7} {:>4} {:>7} {:>6} {:>8.1f}\n", "all", all.through,
             all.not_through, all.refused, all.silent, all.seconds);
  return all.not_through + all.refused > 0;
}
