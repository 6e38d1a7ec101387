#include "progress.h"

#include "records/engineering.h"

#include <fmt/format.h>

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
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
      if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
        return size.ws_col;
      return 80;
    }

    /** Of UTF-8: bytes that begin a character. */
    std::size_t columns(const std::string &text)
    {
      return std::size_t(
          std::count_if(text.begin(), text.end(), [](const char c) {
            return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
          }));
    }

    /** "1.200 of 10.00 µs": in the unit of the end. */
    std::string time_text(const double time, const double end)
    {
      const DisplayUnit unit = engineering_scale(end, "s");
      const double whole = end / unit.factor;
      const int digits = whole < 9.9995 ? 3 : whole < 99.995 ? 2 : 1;
      return fmt::format("t {:.{}f} of {:.{}f} {}", time / unit.factor, digits,
                         whole, digits, unit.unit);
    }
  } // namespace

  Progress::Mode Progress::mode_for_stdout(const bool quiet)
  {
    if (quiet)
      return Mode::quiet;
    return isatty(STDOUT_FILENO) ? Mode::terminal : Mode::lines;
  }

  Progress::Progress(std::ostream &out, const double end_time, const Mode mode,
                     const double first_seconds, const double every_seconds)
      : out_(out), end_time_(end_time), mode_(mode),
        every_seconds_(every_seconds),
        next_seconds_(mode == Mode::lines ? first_seconds : 0.),
        start_(Clock::now())
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

  std::string Progress::live_line(const HistoryRow &row, const double end_time,
                                  const double remaining,
                                  const std::size_t width)
  {
    const double share =
        end_time > 0. ? std::clamp(row.time / end_time, 0., 1.) : 0.;
    const std::string parts[] = {
        fmt::format("{:3.0f} %", std::floor(100. * share)),
        "ETA " + duration(remaining),
        time_text(row.time, end_time),
        fmt::format("step {}", row.step),
        fmt::format("broken {}", brief(row.broken_area, 1)),
        fmt::format("active {}", row.active),
        fmt::format("newton {}", row.newton),
        "res " + brief(row.residual, 1)};
    std::string text;
    for (const std::string &part : parts) {
      const std::string longer = text + (text.empty() ? "" : "  ") + part;
      if (columns(longer) > width)
        break;
      text = longer;
    }
    return text;
  }

  /** By the second half of what has passed: steps become dearer. */
  double Progress::remaining(const double elapsed, const double time)
  {
    if (elapsed >= 2. * marks_.back().elapsed) {
      if (marks_.size() > 1)
        marks_.erase(marks_.begin());
      marks_.push_back({elapsed, time});
    }
    const Mark &from = marks_.front();
    return time > from.time
               ? std::max(0., (elapsed - from.elapsed) * (end_time_ - time) /
                                  (time - from.time))
               : std::numeric_limits<double>::quiet_NaN();
  }

  void Progress::step(const HistoryRow &row)
  {
    if (mode_ == Mode::quiet)
      return;
    if (mode_ == Mode::every_step) {
      out_ << line(row) << '\n' << std::flush;
      return;
    }
    const double elapsed =
        std::chrono::duration<double>(Clock::now() - start_).count();
    if (marks_.empty()) // also right for a run that starts at a stored state
      marks_.push_back({0., row.time - row.time_step});
    const double left = remaining(elapsed, row.time);
    if (elapsed < next_seconds_)
      return;
    const bool is_live = mode_ == Mode::terminal;
    const std::string text =
        live_line(row, end_time_, left, is_live ? terminal_width() - 1 : 120);
    if (is_live)
      out_ << "\r\033[K" << text << std::flush;
    else
      out_ << text << '\n' << std::flush;
    live_ = is_live;
    next_seconds_ = elapsed + (is_live ? 0.1 : every_seconds_);
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
    clear_live_line();
    out_ << std::flush;
  }

  void Progress::clear_live_line()
  {
    if (live_)
      out_ << "\r\033[K";
    live_ = false;
  }
} // namespace nsfd
