#include "trial_process.h"

#include <fmt/format.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <new>
#include <system_error>

namespace nsfd
{
  namespace
  {
    [[noreturn]] void work_and_end(const std::function<void()> &work,
                                   const ProcessLimits &limits)
    {
      // what a crash means is said by the process that waits
      for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
        std::signal(number, SIG_DFL);
      try {
        lock_process(limits);
        work();
      } catch (const std::bad_alloc &) {
        _exit(1);
      } catch (...) {
      }
      _exit(0); // nothing of the other process may be flushed or destroyed here
    }
  } // namespace

  std::string try_in_a_copy(const std::function<void()> &work,
                            const ProcessLimits &limits)
  {
    const pid_t pid = fork();
    if (pid < 0)
      throw std::system_error(errno, std::generic_category(),
                              "no process can be started");
    if (pid == 0)
      work_and_end(work, limits);
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == 1)
      return fmt::format("more than {:.1f} GiB of memory",
                         limits.memory * 0x1p-30);
    if (!WIFSIGNALED(status))
      return "";
    const int number = WTERMSIG(status);
    if (number == SIGXCPU || number == SIGKILL)
      return fmt::format("more than {:g} s", limits.seconds);
    return fmt::format("signal {}, {}", number, strsignal(number));
  }
} // namespace nsfd
