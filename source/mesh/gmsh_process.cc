#include "gmsh_process.h"

#include "core/lock_process.h"
#include "exodus_reader.h"
#include "gmsh_job.h"

#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <fmt/format.h>

#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;

    const std::string hidden_argument = "--run-gmsh-for-its-parent";

    /// where the other process finds its end of the line
    constexpr int line_of_child = 3;

    /// set by main, or else every copy of a test would run all tests again
    bool main_asks = false;

    template <typename T>
    std::string to_bytes(const T &value)
    {
      std::ostringstream out;
      boost::archive::binary_oarchive(out, boost::archive::no_header) << value;
      return out.str();
    }

    template <typename T>
    T from_bytes(const std::string &bytes)
    {
      std::istringstream in(bytes);
      T value;
      boost::archive::binary_iarchive(in, boost::archive::no_header) >> value;
      return value;
    }

    [[noreturn]] void throw_system_error(const char *what)
    {
      throw std::system_error(errno, std::generic_category(), what);
    }

    /** All of it; false if nobody reads any more. */
    bool send_all(const int line, const std::string &bytes)
    {
      std::size_t done = 0;
      while (done < bytes.size()) {
        const ssize_t n =
            send(line, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
        if (n < 0 && errno != EINTR)
          return false;
        done += n > 0 ? std::size_t(n) : 0;
      }
      return shutdown(line, SHUT_WR) == 0;
    }

    using Clock = std::chrono::steady_clock;

    /** Until the other side closes the line; false if it takes too long. */
    bool receive_all(const int line, const double seconds, std::string &bytes)
    {
      const auto end = Clock::now() + std::chrono::duration<double>(seconds);
      std::array<char, 65536> buffer;
      while (true) {
        const std::chrono::duration<double, std::milli> left =
            end - Clock::now();
        pollfd entry = {line, POLLIN, 0};
        const int ready =
            poll(&entry, 1, int(std::clamp(left.count(), 0., 1e6)));
        if (ready == 0 && Clock::now() >= end)
          return false;
        if (ready <= 0)
          continue;
        const ssize_t n = recv(line, buffer.data(), buffer.size(), 0);
        if (n == 0 || (n < 0 && errno != EINTR))
          return true;
        bytes.append(buffer.data(), n > 0 ? std::size_t(n) : 0);
      }
    }

    /** Removed with what is in it. */
    class PrivateFolder
    {
    public:
      PrivateFolder()
          : path_((fs::temp_directory_path() / "nsfd-mesh-XXXXXX").string())
      {
        if (mkdtemp(path_.data()) == nullptr)
          throw_system_error("no temporary folder can be made");
      }
      ~PrivateFolder()
      {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
      }
      PrivateFolder(const PrivateFolder &) = delete;
      PrivateFolder &operator=(const PrivateFolder &) = delete;

      const std::string &path() const { return path_; }

    private:
      std::string path_;
    };

    class Descriptor
    {
    public:
      explicit Descriptor(const int number) : number_(number) {}
      ~Descriptor() { close_now(); }
      Descriptor(const Descriptor &) = delete;
      Descriptor &operator=(const Descriptor &) = delete;

      int number() const { return number_; }
      void close_now()
      {
        if (number_ >= 0)
          ::close(number_);
        number_ = -1;
      }

    private:
      int number_;
    };

    struct Outcome {
      std::string bytes;
      bool too_long = false;
      int status = 0;
      rusage used{};
    };

    pid_t start(const int line)
    {
      posix_spawn_file_actions_t actions;
      posix_spawn_file_actions_init(&actions);
      posix_spawn_file_actions_adddup2(&actions, line, line_of_child);
      posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
      // OpenCASCADE chatters
      posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
      posix_spawn_file_actions_adddup2(&actions, 1, 2);
      std::string name = "nsfd", argument = hidden_argument;
      char *const words[] = {name.data(), argument.data(), nullptr};
      pid_t pid = -1;
      errno = posix_spawn(&pid, "/proc/self/exe", &actions, nullptr, words,
                          environ);
      posix_spawn_file_actions_destroy(&actions);
      if (errno != 0)
        throw_system_error("no process can be started for Gmsh");
      return pid;
    }

    Outcome run(const GmshJob &job)
    {
      if (!main_asks)
        throw std::logic_error("the main of this program does not ask whether "
                               "it has to run Gmsh");
      std::array<int, 2> ends{};
      if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
        throw_system_error("no line to another process");
      Descriptor mine(ends[0]), its(ends[1]);
      const pid_t pid = start(its.number());
      its.close_now();
      Outcome outcome;
      send_all(mine.number(), to_bytes(job));
      // the process may have to share its core with many others
      constexpr double patience = 20.;
      outcome.too_long = !receive_all(
          mine.number(), patience * job.request.seconds, outcome.bytes);
      if (outcome.too_long)
        kill(pid, SIGKILL);
      while (wait4(pid, &outcome.status, 0, &outcome.used) < 0 &&
             errno == EINTR) {
      }
      return outcome;
    }

    double cpu_seconds(const rusage &used)
    {
      const auto seconds = [](const timeval &t) {
        return double(t.tv_sec) + 1e-6 * double(t.tv_usec);
      };
      return seconds(used.ru_utime) + seconds(used.ru_stime);
    }

    bool names_lack_of_memory(const std::vector<std::string> &problems)
    {
      return std::any_of(
          problems.begin(), problems.end(), [](const std::string &problem) {
            return problem.find("bad_alloc") != std::string::npos ||
                   problem.find("Out of memory") != std::string::npos;
          });
    }

    /** What works in the other process. */
    const char *library(const GmshJob &job)
    {
      return job.kind == GmshJob::Kind::exodus ? "HDF5" : "Gmsh";
    }

    std::string took_too_long(const GmshJob &job)
    {
      if (job.kind == GmshJob::Kind::exodus)
        return fmt::format("HDF5 took more than {:g} s; write a larger "
                           "`meshing time` if it needs more",
                           job.request.seconds);
      return fmt::format("Gmsh took more than {:g} s; write a larger `meshing "
                         "time` if it needs more, or a larger `element size`",
                         job.request.seconds);
    }

    std::string needs_memory(const GmshJob &job)
    {
      if (job.kind == GmshJob::Kind::exodus)
        return fmt::format("it needs more than {:.1f} GiB of memory; write a "
                           "larger `meshing time`, with which the memory "
                           "grows that it may take",
                           job.memory * 0x1p-30);
      return fmt::format("Gmsh needs more than {:.1f} GiB of memory; write a "
                         "larger `element size`, or a larger `meshing time`, "
                         "with which the memory grows that it may take",
                         job.memory * 0x1p-30);
    }

    /** Of a process that did not come to its end. */
    std::string reason(const GmshJob &job, const Outcome &outcome)
    {
      // the system looks at the limit by the clock of its own ticks
      const int signal =
          WIFSIGNALED(outcome.status) ? WTERMSIG(outcome.status) : 0;
      if (outcome.too_long || signal == SIGXCPU ||
          cpu_seconds(outcome.used) > job.request.seconds)
        return took_too_long(job);
      // in kB; a crash after most of it was used is a crash by lack of it
      if (1024. * double(outcome.used.ru_maxrss) > .8 * job.memory)
        return needs_memory(job);
      if (signal != 0)
        return fmt::format("{} crashed on it (signal {}, {})", library(job),
                           signal, strsignal(signal));
      return fmt::format("{} ended without a mesh (exit code {})", library(job),
                         WEXITSTATUS(outcome.status));
    }

    NamedMesh mesh_of(GmshJob &job, std::vector<std::string> &problems)
    {
      // a mesher that makes cells at a steady rate fills both at once
      constexpr double gib = 0x1p30, base_time = 20., base_memory = 4. * gib;
      job.memory = base_memory * std::max(1., job.request.seconds / base_time);
      const Outcome outcome = run(job);
      if (outcome.too_long || !WIFEXITED(outcome.status) ||
          WEXITSTATUS(outcome.status) != 0) {
        problems.push_back(reason(job, outcome));
        return {};
      }
      GmshResult result = from_bytes<GmshResult>(outcome.bytes);
      if (names_lack_of_memory(result.problems))
        result.problems = {needs_memory(job)};
      problems.insert(problems.end(), result.problems.begin(),
                      result.problems.end());
      return std::move(result.mesh);
    }

    void write_text(const fs::path &file, const std::string &text)
    {
      std::ofstream out(file, std::ios::binary);
      out << text;
      out.close();
      if (!out)
        throw std::runtime_error("cannot write " + file.string());
    }

    std::string replaced(std::string text, const std::string &what,
                         const std::string &by)
    {
      for (auto at = text.find(what); at != std::string::npos;
           at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
      return text;
    }
  } // namespace

  namespace
  {
    NamedMesh read_file(const GmshJob::Kind kind, const GmshRequest &request,
                        std::vector<std::string> &problems)
    {
      const PrivateFolder folder;
      GmshJob job;
      job.kind = kind;
      job.folder = folder.path();
      job.request = request;
      // under a name that tells Gmsh what it is, with nothing beside it
      job.request.file = "mesh" + request.extension;
      fs::create_symlink(fs::absolute(request.file),
                         fs::path(folder.path()) / job.request.file);
      // text of a mesh is read at 5 to 10 MB/s
      constexpr double bytes_per_second = 1e6;
      job.request.seconds +=
          double(fs::file_size(request.file)) / bytes_per_second;
      return mesh_of(job, problems);
    }
  } // namespace

  NamedMesh read_gmsh(const GmshRequest &request,
                      std::vector<std::string> &problems)
  {
    return read_file(GmshJob::Kind::file, request, problems);
  }

  NamedMesh read_exodus(const GmshRequest &request,
                        std::vector<std::string> &problems)
  {
    return read_file(GmshJob::Kind::exodus, request, problems);
  }

  NamedMesh read_gmsh(const GmshRequest &request, const GmshScript &script,
                      std::vector<std::string> &problems)
  {
    const PrivateFolder folder;
    for (const auto &[name, text] : script.files)
      write_text(fs::path(folder.path()) / name, text);
    GmshJob job;
    job.folder = folder.path();
    job.request = request;
    job.request.file = script.name;
    std::vector<std::string> found;
    NamedMesh mesh = mesh_of(job, found);
    for (const std::string &problem : found)
      problems.push_back(replaced(problem, script.name,
                                  fs::path(request.file).filename().string()));
    return mesh;
  }

  NamedMesh mesh_regions(const PlaneRegions &regions, const double element_size,
                         const double seconds,
                         std::vector<std::string> &problems)
  {
    const PrivateFolder folder;
    GmshJob job;
    job.kind = GmshJob::Kind::regions;
    job.folder = folder.path();
    job.regions = regions;
    job.request.is_geometry = true;
    job.request.shape = GmshRequest::Shape::cubes;
    job.request.element_size = element_size;
    job.request.seconds = seconds;
    return mesh_of(job, problems);
  }

  std::optional<int> run_gmsh_if_asked(const int argc, char **argv)
  {
    main_asks = true;
    if (argc != 2 || argv[1] != hidden_argument)
      return {};
    try {
      std::string bytes;
      constexpr double one_minute = 60.;
      receive_all(line_of_child, one_minute, bytes);
      const GmshJob job = from_bytes<GmshJob>(bytes);
      if (chdir(job.folder.c_str()) != 0)
        throw_system_error("no folder");
      lock_process({job.request.seconds, job.memory});
      GmshResult result;
      result.mesh =
          job.kind == GmshJob::Kind::regions
              ? mesh_regions_here(job.regions, job.request, result.problems)
          : job.kind == GmshJob::Kind::exodus
              ? read_exodus_here(job.request.file, job.request.dimension,
                                 result.problems)
              : read_gmsh_here(job.request, result.problems);
      // an answer that nobody reads is no failure
      send_all(line_of_child, to_bytes(result));
      // no destructors of Gmsh, MPI or Kokkos: nothing is left to be done
      _exit(0);
    } catch (const std::exception &) {
      _exit(1);
    }
  }
} // namespace nsfd
