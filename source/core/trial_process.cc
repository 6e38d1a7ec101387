#include "trial_process.h"

#include <fmt/format.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fcntl.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <new>
#include <system_error>

namespace nsfd
{
  namespace
  {
    constexpr int lacks_memory = 1, is_lost = 2;

    [[noreturn]] void throw_system_error()
    {
      throw std::system_error(errno, std::generic_category(),
                              "no process can be started");
    }

    bool write_all(const int line, const std::string &bytes)
    {
      std::size_t done = 0;
      while (done < bytes.size()) {
        const ssize_t n = write(line, bytes.data() + done, bytes.size() - done);
        if (n < 0 && errno != EINTR)
          return false;
        done += n > 0 ? std::size_t(n) : 0;
      }
      return true;
    }

    std::string read_all(const int line)
    {
      std::string bytes;
      std::array<char, 65536> buffer;
      while (true) {
        const ssize_t n = read(line, buffer.data(), buffer.size());
        if (n == 0 || (n < 0 && errno != EINTR))
          return bytes;
        bytes.append(buffer.data(), n > 0 ? std::size_t(n) : 0);
      }
    }

    [[noreturn]] void work_and_end(const std::function<std::string()> &work,
                                   const ProcessLimits &limits, const int line)
    {
      // what a crash means is said by the process that waits
      for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
        std::signal(number, SIG_DFL);
      const int nowhere = open("/dev/null", O_WRONLY);
      dup2(nowhere, STDOUT_FILENO);
      dup2(nowhere, STDERR_FILENO);
      // nothing of the other process may be flushed or destroyed here
      try {
        lock_process(limits);
        _exit(write_all(line, work()) ? 0 : is_lost);
      } catch (const std::bad_alloc &) {
        _exit(lacks_memory);
      } catch (...) {
        _exit(is_lost);
      }
    }
  } // namespace

  CopyAnswer ask_a_copy(const std::function<std::string()> &work,
                        const ProcessLimits &limits)
  {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
      throw_system_error();
    const pid_t pid = fork();
    if (pid < 0)
      throw_system_error();
    if (pid == 0) {
      close(ends[0]);
      work_and_end(work, limits, ends[1]);
    }
    close(ends[1]);
    CopyAnswer answer;
    answer.bytes = read_all(ends[0]);
    close(ends[0]);
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status)) {
      const int number = WTERMSIG(status);
      answer.end =
          number == SIGXCPU || number == SIGKILL
              ? fmt::format("more than {:g} s", limits.seconds)
              : fmt::format("signal {}, {}", number, strsignal(number));
    } else if (WEXITSTATUS(status) == lacks_memory)
      answer.end = fmt::format("more than {:.1f} GiB of memory",
                               limits.memory * 0x1p-30);
    else if (WEXITSTATUS(status) != 0)
      answer.end = fmt::format("exit code {}", WEXITSTATUS(status));
    return answer;
  }
} // namespace nsfd
