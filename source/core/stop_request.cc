#include "stop_request.h"

#include "stopwatch.h"

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <ctime>

namespace nsfd::stop_request
{
  namespace
  {
    constexpr int exit_code = 4;
    /// s: steps that take no longer are finished, and can be gone on from to
    /// the last bit; `mpirun` leaves its ranks a second
    constexpr double grace = 0.3;
    /// s: `timeout`, for one, sends its signal twice
    constexpr double patience = 1.;
    /// s between two looks at standard output
    constexpr double pause = 0.25;

    struct Name {
      int signal;
      const char *text;
    };
    constexpr Name names[] = {{SIGHUP, "SIGHUP"},
                              {SIGINT, "SIGINT"},
                              {SIGQUIT, "SIGQUIT"},
                              {SIGTERM, "SIGTERM"},
                              {SIGUSR1, "SIGUSR1"},
                              {SIGXCPU, "SIGXCPU"},
                              {SIGPIPE, "a closed standard output"}};

    std::atomic<bool> is_first{true}, catches{false}, watches{false};
    std::atomic<int> request{0};          ///< the signal, 0: none
    std::atomic<double> request_time{0.}; ///< s
    int scope_ranks = 0;                  ///< 0: not in a step
    double next_look = 0.;                ///< s
    double deadline = 0.;                 ///< s of CPU, 0: none

    double seconds()
    {
      timespec now = {};
      clock_gettime(CLOCK_MONOTONIC_COARSE, &now);
      return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
    }

    const char *name_of(const int signal)
    {
      for (const Name &name : names)
        if (name.signal == signal)
          return name.text;
      return "a signal";
    }

    void say(const char *text)
    {
      if (write(STDERR_FILENO, text, std::strlen(text)) < 0)
        return; // nobody listens
    }

    void set_request(const int signal)
    {
      request_time = seconds();
      request = signal;
    }

    extern "C" void on_signal(const int signal)
    {
      if (!catches) {
        if (is_first) {
          say("nsfd: ended by ");
          say(name_of(signal));
          say(": nothing had been computed that could be stored\n");
        }
        _exit(exit_code);
      }
      if (request == 0)
        set_request(signal);
      else if (signal != SIGXCPU && signal != SIGPIPE && // they come again
               seconds() - request_time > patience) {
        std::signal(signal, SIG_DFL);
        raise(signal);
      }
    }

    void catch_all()
    {
      struct sigaction action = {}, before = {};
      action.sa_handler = on_signal;
      action.sa_flags = SA_RESTART;
      sigemptyset(&action.sa_mask);
      for (const Name &name : names) {
        sigaction(name.signal, nullptr, &before);
        if (name.signal != SIGHUP || before.sa_handler != SIG_IGN) // nohup
          sigaction(name.signal, &action, nullptr);
      }
      std::signal(SIGXFSZ, SIG_IGN);
    }

    /** The other end of a pipe or socket is gone. */
    bool has_no_reader(const int file)
    {
      pollfd one = {file, 0, 0};
      return poll(&one, 1, 0) > 0 && (one.revents & POLLERR) != 0;
    }
  } // namespace

  void end_at_signals(const bool first)
  {
    is_first = first;
    catch_all();
  }

  void catch_signals(const bool watches_output)
  {
    struct stat status = {};
    watches = watches_output && fstat(STDOUT_FILENO, &status) == 0 &&
              (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode));
    catches = true;
    catch_all(); // libraries may have taken some
  }

  bool requested()
  {
    if (request != 0)
      return true;
    if (!watches)
      return false;
    const double now = seconds();
    if (now < next_look)
      return false;
    next_look = now + pause;
    if (has_no_reader(STDOUT_FILENO))
      set_request(SIGPIPE);
    return request != 0;
  }

  const char *reason() { return name_of(request); }

  Interruptible::Interruptible(const int n_ranks) { scope_ranks = n_ranks; }

  Interruptible::~Interruptible() { scope_ranks = 0; }

  void leave_steps_at(const double time) { deadline = time; }

  bool is_due(const int n_ranks)
  {
    if (scope_ranks != n_ranks)
      return false;
    return (deadline > 0. && cpu_seconds() >= deadline) ||
           (requested() && seconds() - request_time >= grace);
  }
} // namespace nsfd::stop_request
