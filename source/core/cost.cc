#include "cost.h"

#include "nsfd/core/message_counts.h"
#include "stopwatch.h"

#include <malloc.h>

#include <algorithm>
#include <array>
#include <chrono>

namespace nsfd
{
  namespace
  {
    constexpr std::size_t n_lines = std::size_t(Cost::count);
    using Clock = std::chrono::steady_clock;

    // one thread per rank: plain counters
    struct Meter {
      std::array<Clock::duration, n_lines> spent{};
      std::array<unsigned long long, n_lines> calls{};
      Cost current = Cost::rest;
      Clock::time_point since = Clock::now(), begin = since;
      double cpu_at_begin = 0.;

      void change_to(const Cost line)
      {
        const auto now = Clock::now();
        spent[std::size_t(current)] += now - since;
        since = now;
        current = line;
      }
    };

    Meter &meter()
    {
      static Meter instance;
      return instance;
    }

    double heap_bytes()
    {
      const auto info = mallinfo2();
      return double(info.uordblks) + double(info.hblkhd);
    }

    struct Heap {
      std::vector<std::pair<std::string, double>> lines;
      double last = 0.;
    };

    Heap &heap()
    {
      static Heap instance;
      return instance;
    }
  } // namespace

  const char *cost_name(const Cost line)
  {
    static const std::array<const char *, n_lines> names = {
        {"rest", "set-up", "body blocks", "loads and free motion",
         "vectors of the solver", "laws of the points", "applications of W",
         "preconditioner, set-up", "preconditioner, applied",
         "sums over points", "Gauss-Seidel sweeps", "update of bodies",
         "energy ledger", "output", "W, single precision",
         "waiting for other ranks", "motion of fragments", "heat"}};
    return names[std::size_t(line)];
  }

  Charge::Charge(const Cost line) : outside_(meter().current)
  {
    meter().change_to(line);
    if (line != outside_)
      ++meter().calls[std::size_t(line)];
  }

  Charge::~Charge() { meter().change_to(outside_); }

  void begin_costs()
  {
    meter() = Meter();
    meter().cpu_at_begin = cpu_seconds();
    heap() = Heap();
    heap().last = heap_bytes();
    begin_message_counts();
  }

  TimePassed passed_since_begin()
  {
    return {std::chrono::duration<double>(Clock::now() - meter().begin).count(),
            cpu_seconds() - meter().cpu_at_begin};
  }

  std::vector<CostLine> cost_lines()
  {
    Meter &m = meter();
    m.change_to(m.current);
    const double passed =
        std::chrono::duration<double>(m.since - m.begin).count();
    const double cpu = cpu_seconds() - m.cpu_at_begin;
    std::vector<CostLine> lines;
    for (std::size_t k = 0; k < n_lines; ++k) {
      const double seconds = std::chrono::duration<double>(m.spent[k]).count();
      if (m.calls[k] > 0 || (k == 0 && seconds > 0.))
        lines.push_back({cost_name(Cost(k)),
                         passed > 0. ? seconds * cpu / passed : 0.,
                         m.calls[k]});
    }
    std::rotate(lines.begin(), lines.begin() + 1, lines.end()); // rest last
    return lines;
  }

  void charge_memory(const std::string &owner)
  {
    Heap &h = heap();
    const double now = heap_bytes(), growth = std::max(0., now - h.last);
    h.last = now;
    for (auto &line : h.lines)
      if (line.first == owner) {
        line.second += growth;
        return;
      }
    h.lines.emplace_back(owner, growth);
  }

  const std::vector<std::pair<std::string, double>> &memory_lines()
  {
    return heap().lines;
  }
} // namespace nsfd
