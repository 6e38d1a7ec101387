#pragma once

#include "nsfd/records/run_record.h"

#include <chrono>
#include <ostream>
#include <string>

namespace nsfd
{
  /**
   * What a run says while it runs: on a terminal one line that is rewritten,
   * in a file or pipe an aligned line every few steps or seconds.
   */
  class Progress
  {
  public:
    enum class Mode { quiet, lines, terminal };

    /** quiet if asked for, else what standard output is. */
    static Mode mode_for_stdout(bool quiet);

    /**
     * In `lines` mode a row is printed after @p every_steps steps or
     * @p every_seconds seconds, whichever comes first.
     */
    Progress(std::ostream &out, double end_time, Mode mode,
             unsigned int every_steps = 100, double every_seconds = 5.);

    /** Call after every accepted step. */
    void step(const HistoryRow &row);

    /** A line of its own that stays (warnings); also when not due. */
    void message(const std::string &text);

    /** Prints the last row if it was not, and leaves the live line. */
    void finish();

    /** step 12  t 1.2000e-04  active 34  broken 3.2e-6  newton 4 ... */
    static std::string line(const HistoryRow &row);

    /** 9 s, 4 min 07 s, 3 h 25 min, 2 d 04 h */
    static std::string duration(double seconds);

  private:
    using Clock = std::chrono::steady_clock;

    std::string live_line(const HistoryRow &row) const;
    void clear_live_line();

    std::ostream &out_;
    double end_time_;
    Mode mode_;
    unsigned int every_steps_;
    double every_seconds_;
    Clock::time_point start_, last_print_;
    HistoryRow last_;
    double start_time_ = 0.;
    unsigned int n_steps_ = 0;
    bool printed_ = true, live_ = false;
  };
} // namespace nsfd
