#include "progress.h"

#include <fmt/format.h>

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    double seconds_between(const std::chrono::steady_clock::time_point &a,
                           const std::chrono::steady_clock::time_point &b)
    {
      return std::chrono::duration<double>(b - a).count();
    }

    /** 3.2e-6 instead of 3.2e-06, 0 instead of 0.0e+00. */
    std::string brief(const double value, const int digits)
    {
      if (value == 0.)
        return "0";
      std::string text = fmt::format("{:.{}e}", value, digits);
      const auto e = text.find('e');
      if (e != std::string::npos && text[e + 2] == '0')
        text.erase(e + 2, 1);
      return text;
    }

    std::size_t terminal_width()
    {
      winsize size{};
      if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20)
        return size.ws_col;
      return 80;
    }
  } // namespace

  Progress::Mode Progress::mode_for_stdout(const bool quiet)
  {
    if (quiet)
      return Mode::quiet;
    return isatty(STDOUT_FILENO) ? Mode::terminal : Mode::lines;
  }

  Progress::Progress(std::ostream &out, const double end_time, const Mode mode,
                     const unsigned int every_steps, const double every_seconds)
      : out_(out), end_time_(end_time), mode_(mode), every_steps_(every_steps),
        every_seconds_(every_seconds), start_(Clock::now()), last_print_(start_)
  {
  }

  std::string Progress::line(const HistoryRow &row)
  {
    return fmt::format(
        "step {:<6}  t {:.4e}  active {:<6}  broken {:<7}  newton {:<3}  "
        "krylov {:<5}  res {:<7}  defect {}",
        row.step, row.time, row.active, brief(row.broken_area, 1), row.newton,
        row.krylov, brief(row.residual, 1), brief(row.balance_residual, 0));
  }

  std::string Progress::duration(const double seconds)
  {
    if (!std::isfinite(seconds) || seconds < 0.)
      return "?";
    if (seconds < 9.95)
      return fmt::format("{:.1f} s", seconds);
    const auto s = static_cast<unsigned long long>(std::lround(seconds));
    if (s < 60)
      return fmt::format("{} s", s);
    if (s < 3600)
      return fmt::format("{} min {:02} s", s / 60, s % 60);
    if (s < 86400)
      return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
    return fmt::format("{} d {:02} h", s / 86400, s / 3600 % 24);
  }

  std::string Progress::live_line(const HistoryRow &row) const
  {
    const double share =
        end_time_ > 0. ? std::clamp(row.time / end_time_, 0., 1.) : 0.;
    const double elapsed = seconds_between(start_, Clock::now());
    const double advanced = row.time - start_time_;
    const double remaining =
        advanced > 0. ? elapsed * (end_time_ - row.time) / advanced : NAN;
    return fmt::format("step {}  t {:.4e}  {:3.0f} %  ETA {}  broken {}  "
                       "newton {}  res {}",
                       row.step, row.time, std::floor(100. * share),
                       duration(std::max(remaining, 0.)),
                       brief(row.broken_area, 1), row.newton,
                       brief(row.residual, 1));
  }

  void Progress::step(const HistoryRow &row)
  {
    if (mode_ == Mode::quiet)
      return;

    // also right for a run that starts at a stored state
    if (n_steps_++ == 0)
      start_time_ = row.time - row.time_step;
    last_ = row;
    printed_ = false;

    const auto now = Clock::now();
    const double waited = seconds_between(last_print_, now);
    const bool first = n_steps_ == 1;
    if (mode_ == Mode::terminal) {
      if (!first && waited < 0.1)
        return;
      out_ << "\r\033[K" << live_line(row).substr(0, terminal_width() - 1)
           << std::flush;
      live_ = true;
    } else {
      const bool due = every_steps_ != 0 && row.step % every_steps_ == 0;
      if (!first && !due && waited < every_seconds_)
        return;
      out_ << line(row) << '\n' << std::flush;
      printed_ = true;
    }
    last_print_ = now;
  }

  void Progress::message(const std::string &text)
  {
    if (mode_ == Mode::quiet)
      return;
    clear_live_line();
    out_ << text << '\n' << std::flush;
  }

  void Progress::finish()
  {
    if (mode_ == Mode::quiet)
      return;
    clear_live_line();
    if (!printed_)
      out_ << line(last_) << '\n';
    printed_ = true;
    out_ << std::flush;
  }

  void Progress::clear_live_line()
  {
    if (live_)
      out_ << "\r\033[K";
    live_ = false;
  }
} // namespace nsfd
