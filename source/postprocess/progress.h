#pragma once

#include "nsfd/records/run_record.h"

#include <chrono>
#include <ostream>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * What a run says while it runs: on a terminal one line that is rewritten, in
   * a file or pipe a line a minute at most, or one for every step if asked for.
   */
  class Progress
  {
  public:
    enum class Mode { quiet, lines, every_step, terminal };

    /** quiet if asked for, else what standard output is. */
    static Mode mode_for_stdout(bool quiet);

    /**
     * In `lines` mode there is a line @p first_seconds after the start, and
     * then one every @p every_seconds.
     */
    Progress(std::ostream &out, double end_time, Mode mode,
             double first_seconds = 10., double every_seconds = 60.);

    /** Call after every accepted step. */
    void step(const HistoryRow &row);

    /** A line of its own that stays (warnings); also when not due. */
    void message(const std::string &text);

    /** Leaves the live line. */
    void finish();

    /** step 12  t 1.2000e-04  active 34  broken 3.2e-6  newton 4 ... */
    static std::string line(const HistoryRow &row);

    /**
     * " 12 %  ETA 4 min 07 s  t 1.200 of 10.00 µs  step 120 ...": what follows
     * from the left in at most @p width columns, no part of it cut.
     * @p remaining in s, NaN if not known.
     */
    static std::string live_line(const HistoryRow &row, double end_time,
                                 double remaining, std::size_t width);

    /** 9 s, 4 min 07 s, 3 h 25 min, 2 d 04 h */
    static std::string duration(double seconds);

  private:
    using Clock = std::chrono::steady_clock;
    /** How far the run was after so many seconds. */
    struct Mark {
      double elapsed = 0., time = 0.;
    };

    double remaining(double elapsed, double time);
    void clear_live_line();

    std::ostream &out_;
    double end_time_;
    Mode mode_;
    double every_seconds_, next_seconds_;
    Clock::time_point start_;
    std::vector<Mark> marks_; ///< the last two, each after twice the seconds
    bool live_ = false;
  };
} // namespace nsfd
