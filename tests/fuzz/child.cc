#include "child.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <stdexcept>

namespace nsfd::fuzz
{
  namespace
  {
    double now()
    {
      timespec time{};
      clock_gettime(CLOCK_MONOTONIC, &time);
      return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
    }

    [[noreturn]] void become(const Program program,
                             const std::vector<std::string> &command,
                             const std::string &folder, const std::string &log,
                             const Limits &limits)
    {
      setpgid(0, 0);
      rlimit space{};
      space.rlim_cur = space.rlim_max = rlim_t(limits.bytes);
      setrlimit(RLIMIT_AS, &space);
      // a file that grows without end is a fault as well
      rlimit file{};
      file.rlim_cur = file.rlim_max = rlim_t(1) << 30;
      setrlimit(RLIMIT_FSIZE, &file);
      rlimit cpu{};
      cpu.rlim_cur = cpu.rlim_max = rlim_t(limits.cpu_seconds);
      setrlimit(RLIMIT_CPU, &cpu);
      rlimit core{};
      setrlimit(RLIMIT_CORE, &core);
      const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
      const int in = open("/dev/null", O_RDONLY);
      if (out < 0 || in < 0 || chdir(folder.c_str()) != 0)
        _exit(126);
      dup2(in, 0);
      dup2(out, 1);
      dup2(out, 2);
      std::vector<char *> arguments;
      for (const std::string &argument : command)
        arguments.push_back(const_cast<char *>(argument.c_str()));
      arguments.push_back(nullptr);
      std::exit(program(int(command.size()), arguments.data()));
    }
  } // namespace

  Child::Child(const Program program, const std::vector<std::string> &command,
               const std::string &folder, const std::string &log,
               const Limits &limits)
      : limits_(limits), start_(now())
  {
    std::fflush(nullptr); // or the child would print it once more
    process_ = fork();
    if (process_ < 0)
      throw std::runtime_error("no process could be started");
    if (process_ == 0)
      become(program, command, folder, log, limits);
    setpgid(process_, process_);
  }

  bool Child::ended()
  {
    if (is_over_)
      return true;
    const bool too_long = now() - start_ > limits_.seconds;
    if (too_long && !outcome_.timed_out) {
      outcome_.timed_out = true;
      kill(-process_, SIGKILL);
    }
    int status = 0;
    rusage used{};
    if (wait4(process_, &status, WNOHANG, &used) != process_)
      return false;
    kill(-process_, SIGKILL); // what it may have started itself
    is_over_ = true;
    outcome_.seconds = now() - start_;
    const auto seconds = [](const timeval &t) {
      return double(t.tv_sec) + 1e-6 * double(t.tv_usec);
    };
    outcome_.cpu_seconds = seconds(used.ru_utime) + seconds(used.ru_stime);
    outcome_.timed_out =
        outcome_.timed_out || outcome_.cpu_seconds >= limits_.cpu_seconds;
    outcome_.peak_bytes = 1024. * double(used.ru_maxrss);
    if (WIFSIGNALED(status))
      outcome_.signal = WTERMSIG(status);
    else
      outcome_.code = WEXITSTATUS(status);
    return true;
  }
} // namespace nsfd::fuzz
