#pragma once

namespace nsfd
{
  /** CPU time of this process so far, all threads. */
  double cpu_seconds();

  /** Time on a clock that never jumps; only differences mean something. */
  double wall_seconds();

  /** The most memory this process has had. */
  double peak_memory_mb();

  /** Adds the CPU time of a scope to a line of a table. */
  class Stopwatch
  {
  public:
    explicit Stopwatch(double &line) : line_(line), start_(cpu_seconds()) {}
    ~Stopwatch() { line_ += cpu_seconds() - start_; }
    Stopwatch(const Stopwatch &) = delete;
    Stopwatch &operator=(const Stopwatch &) = delete;

  private:
    double &line_;
    double start_;
  };
} // namespace nsfd
