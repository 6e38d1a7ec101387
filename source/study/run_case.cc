#include "run_case.h"

#include "core/exit_code.h"
#include "core/output_folder.h"
#include "nsfd/core/plug_in.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <numeric>
#include <sstream>
#include <thread>
#include <utility>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;

    volatile sig_atomic_t stop_requested = 0;
    std::array<std::atomic<pid_t>, 256> running{}; // processes, 0: free

    extern "C" void stop_all(int)
    {
      stop_requested = 1;
      for (const auto &pid : running)
        if (pid.load() > 0)
          kill(pid.load(), SIGTERM);
    }

    /** Runs of less than this (s) are repeated more often. */
    constexpr double short_run = 0.2;
    constexpr unsigned int most_repeats = 2; // times those asked for

    constexpr const char *mpi_files_variable = "OMPI_MCA_orte_tmpdir_base";

    /**
     * A folder for what MPI keeps of one run. By default all runs of a user
     * share one, and a run that ends removes it while another one starts.
     */
    class MpiFiles
    {
    public:
      explicit MpiFiles(const bool needed)
      {
        if (!needed)
          return;
        const char *base = std::getenv(mpi_files_variable);
        // short: names of sockets in it may have 107 characters
        path_ = (base != nullptr ? fs::path(base) : fs::temp_directory_path()) /
                "nsfd_XXXXXX";
        if (mkdtemp(path_.data()) == nullptr)
          throw OutputError("cannot create '" + path_ +
                            "': " + std::strerror(errno));
      }
      ~MpiFiles()
      {
        std::error_code error;
        if (!path_.empty())
          fs::remove_all(path_, error);
      }
      MpiFiles(const MpiFiles &) = delete;
      MpiFiles &operator=(const MpiFiles &) = delete;

      /** Empty for a run without MPI. */
      const std::string &path() const { return path_; }

    private:
      std::string path_;
    };

    std::vector<std::string> environment(const MpiFiles &mpi)
    {
      const std::string own = mpi_files_variable + std::string("=");
      std::vector<std::string> all;
      for (char **entry = environ; *entry != nullptr; ++entry)
        if (mpi.path().empty() ||
            std::strncmp(*entry, own.c_str(), own.size()) != 0)
          all.emplace_back(*entry);
      if (std::getenv("OMP_NUM_THREADS") == nullptr)
        all.emplace_back("OMP_NUM_THREADS=1");
      // the parent of ranks is mpirun
      all.push_back("NSFD_CASE_OF_A_STUDY=" +
                    std::to_string(mpi.path().empty() ? getpid() : 0));
      if (mpi.path().empty())
        return all;
      all.push_back(own + mpi.path());
      for (const char *name :
           {"OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM",
            "OMPI_MCA_rmaps_base_oversubscribe"})
        if (std::getenv(name) == nullptr)
          all.push_back(std::string(name) + "=1");
      return all;
    }

    std::vector<char *> pointers(std::vector<std::string> &words)
    {
      std::vector<char *> result;
      for (std::string &word : words)
        result.push_back(word.data());
      result.push_back(nullptr);
      return result;
    }

    /** A process that can be ended by stop_all(), with its place in the list.
     */
    int wait_for(const pid_t pid)
    {
      std::size_t place = 0;
      for (; place < running.size(); ++place) {
        pid_t free = 0;
        if (running[place].compare_exchange_strong(free, pid))
          break;
      }
      if (stop_requested != 0) // between start and entry
        kill(pid, SIGTERM);
      int status = 0;
      while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
      }
      if (place < running.size())
        running[place] = 0;
      return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }

    /** Its exit code, 128 + signal; what it prints goes into @p log. */
    int run_process(std::vector<std::string> words, const bool parallel,
                    const std::string &log)
    {
      const MpiFiles mpi(parallel);
      std::vector<std::string> variables = environment(mpi);
      posix_spawn_file_actions_t actions;
      posix_spawn_file_actions_init(&actions);
      posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
      posix_spawn_file_actions_addopen(&actions, 1, log.c_str(),
                                       O_WRONLY | O_CREAT | O_TRUNC, 0644);
      posix_spawn_file_actions_adddup2(&actions, 1, 2);
      pid_t pid = 0;
      const int failed =
          posix_spawnp(&pid, words[0].c_str(), &actions, nullptr,
                       pointers(words).data(), pointers(variables).data());
      posix_spawn_file_actions_destroy(&actions);
      if (failed != 0)
        throw OutputError("cannot start '" + words[0] +
                          "': " + std::strerror(failed));
      return wait_for(pid);
    }

    std::vector<std::string> command(const std::string &scene,
                                     const std::string &output,
                                     const unsigned int ranks)
    {
      std::vector<std::string> words;
      if (ranks > 1)
        words = {"mpirun", "-n", std::to_string(ranks)};
      words.push_back(fs::read_symlink("/proc/self/exe").string());
      words.insert(words.end(),
                   {scene, "--output", output, "--force", "--quiet"});
      for (const PlugIn &one : loaded_plug_ins())
        words.insert(words.end(), {"--plug-in", one.file});
      return words;
    }

    std::string text_of(const std::string &file)
    {
      std::ifstream stream(file, std::ios::binary);
      std::ostringstream text;
      text << stream.rdbuf();
      return text.str();
    }

    /** What a run that did not end well has said last. */
    std::string last_words(const std::string &log)
    {
      std::istringstream stream(text_of(log));
      std::string last;
      for (std::string line; std::getline(stream, line);)
        if (line.find("error") != std::string::npos || last.empty())
          last = line;
      return last;
    }

    /**
     * What a study that was killed has left running needs a moment to end; its
     * ranks, if it has several, do not know and go on to their end.
     */
    void wait_for_writer(const std::string &folder)
    {
      using namespace std::chrono_literals;
      bool said = false;
      for (auto waited = 0ms; !stop_was_requested(); waited += 20ms) {
        const auto writer = writer_of(folder);
        if (!writer)
          return;
        if (waited >= 1s && !std::exchange(said, true))
          std::cerr << "note: `" + folder + "` is in use by " + *writer +
                           ": the case waits until that has ended\n";
        std::this_thread::sleep_for(20ms);
      }
    }

    CaseResult::Status status_of(const int code)
    {
      switch (code) {
      case exit_code::done:
        return CaseResult::Status::done;
      case exit_code::bad_input:
        return CaseResult::Status::bad_input;
      case exit_code::step_failed:
        return CaseResult::Status::failed;
      case exit_code::stopped:
        return CaseResult::Status::stopped;
      default:
        return stop_requested != 0 ? CaseResult::Status::stopped
                                   : CaseResult::Status::broken;
      }
    }

    bool wants_another(const CaseResult &result, const unsigned int repeats)
    {
      const std::size_t n = result.solve.size();
      if (n < repeats)
        return true;
      // a single run was asked for: for its errors, not its time
      return repeats > 1 && n < most_repeats * repeats &&
             std::accumulate(result.solve.begin(), result.solve.end(), 0.) <
                 short_run;
    }
  } // namespace

  void catch_stop_signals()
  {
    struct sigaction action = {};
    action.sa_handler = stop_all;
    sigemptyset(&action.sa_mask);
    for (const int signal :
         {SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGXCPU, SIGPIPE})
      sigaction(signal, &action, nullptr);
    struct sigaction before = {};
    sigaction(SIGHUP, nullptr, &before);
    if (before.sa_handler != SIG_IGN) // nohup
      sigaction(SIGHUP, &action, nullptr);
  }

  bool stop_was_requested() { return stop_requested != 0; }

  CaseResult run_case(const StudyInput &study, const StudyCase &one,
                      const CaseStamp &program, const unsigned int repeats,
                      const bool resume)
  {
    CaseStamp stamp = program;
    stamp.ranks = one.ranks;
    const std::string folder = study.directory + "/" + one.combination.name;
    const std::string scene = folder + "/scene.prm", log = folder + "/log.txt";
    const std::string record = folder + "/case.json", again = folder + "/again";
    CaseResult result;
    if (resume && text_of(scene) == one.scene &&
        read_case(record, stamp, repeats, result)) {
      observe(study.observed, folder, result.errors);
      return result;
    }

    std::error_code error;
    fs::create_directories(folder, error);
    wait_for_writer(folder);
    fs::remove(record, error); // until it is finished
    write_file_atomically(scene, one.scene);
    if (!fs::exists(folder + "/run.json", error)) // else it is no run's folder
      write_file_atomically(folder + "/run.json", "{\"files\": []}\n");
    do {
      const bool first = result.solve.empty();
      const std::string output = first ? folder : again;
      result.exit_code =
          run_process(command(scene, output, one.ranks), one.ranks > 1, log);
      result.status = status_of(result.exit_code);
      const bool found = add_summary(output + "/summary.json", result);
      if (found && is_done(result))
        observe(study.observed, folder, result.errors);
      if (is_done(result) && !found) {
        result.status = CaseResult::Status::broken;
        result.failure = "it left no summary.json";
      }
      if (!is_done(result) && result.failure.empty())
        result.failure = last_words(log);
      fs::remove_all(again, error);
    } while (is_done(result) && wants_another(result, repeats) &&
             !stop_was_requested());
    if (is_done(result) && result.solve.size() < repeats)
      result.status = CaseResult::Status::stopped;
    if (result.status != CaseResult::Status::stopped)
      write_case(record, stamp, result);
    return result;
  }
} // namespace nsfd
