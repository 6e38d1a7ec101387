#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace nsfd::fuzz
{
  struct Limits {
    double cpu_seconds = 20.;
    double seconds = 100.; ///< of the clock: machines have other work, too
    double bytes = 4. * (1u << 30); ///< of address space
  };

  /** How a program ended. */
  struct Outcome {
    int code = 0;   ///< exit code, if no signal ended it
    int signal = 0; ///< 0: none
    bool timed_out = false;
    double seconds = 0., cpu_seconds = 0.;
    double peak_bytes = 0.; ///< resident
  };

  /** The program that is tried. */
  using Program = int (*)(int argc, char **argv);

  /**
   * One run of a program with limits, in a process of its own, which is forked
   * rather than started: loading its libraries takes longer than most runs.
   */
  class Child
  {
  public:
    /** Starts at once, in @p folder, what it prints goes to @p log. */
    Child(Program program, const std::vector<std::string> &command,
          const std::string &folder, const std::string &log,
          const Limits &limits);

    /** True once it has ended, by itself or since its time is over. */
    bool ended();

    const Outcome &outcome() const { return outcome_; }

  private:
    Limits limits_;
    pid_t process_ = -1;
    double start_ = 0.;
    bool is_over_ = false;
    Outcome outcome_;
  };
} // namespace nsfd::fuzz
