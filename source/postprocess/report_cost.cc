#include "report_cost.h"

#include "report_html.h"

#include "records/engineering.h"

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  namespace
  {
    std::string times(const Summary &s)
    {
      std::vector<std::pair<std::string, double>> lines;
      for (const auto &part : s.cost.parts)
        lines.emplace_back(part.name, part.seconds);
      if (lines.empty())
        lines = s.timings;
      double sum = 0.;
      for (const auto &line : lines)
        sum += line.second;
      const double total = std::max(sum, s.cpu_seconds);
      Table table;
      for (const auto &[name, seconds] : lines)
        table.add_share(readable(name), fmt::format("{:.3f} s", seconds),
                        seconds / total);
      if (!lines.empty() && total > 1.0005 * sum)
        table.add_share("before the run", fmt::format("{:.3f} s", total - sum),
                        (total - sum) / total);
      return table.card(fmt::format("CPU time, {:.3g} s", total));
    }

    std::string memory(const Summary &s)
    {
      Table table;
      const double peak = 1048576. * s.peak_memory_mb;
      for (const auto &[owner, bytes] : s.cost.memory)
        table.add_share(owner, engineering(bytes, "B"),
                        peak > 0. ? bytes / peak : 0.);
      return table.card(fmt::format(
          "Memory by owner, at most {:.0f} MB resident", s.peak_memory_mb));
    }

    std::string iterations(const Summary &s)
    {
      Table table;
      for (const auto &spread : s.cost.per_step)
        table.add(spread.name, count(spread.median),
                  "worst " + count(spread.worst));
      return table.card("Per step, median");
    }

    std::string messages(const CostRecord &cost)
    {
      Table table;
      if (cost.ranks > 1) {
        const double steps = std::max(1., cost.steps);
        table.add("messages", engineering(cost.sent.messages / steps, ""));
        table.add("sent in them",
                  engineering(cost.sent.message_bytes / steps, "B"));
        table.add("reductions and the like",
                  engineering(cost.sent.collectives / steps, ""));
        table.add("put into them",
                  engineering(cost.sent.collective_bytes / steps, "B"));
        if (cost.copy_gain > 0.) {
          table.add("all ranks over one alone, a copy",
                    fmt::format("{:.2f}", cost.copy_gain));
          table.add("a small dense product",
                    fmt::format("{:.2f}", cost.product_gain));
        }
      }
      return table.card("Per rank and step, at most");
    }

    std::string hot_loop(const CostRecord &cost)
    {
      Table table;
      if (cost.applications > 0.) {
        table.add("time", engineering(cost.seconds, "s"),
                  count(cost.applications) + " of them");
        table.add("operations", engineering(cost.flops, "flop"));
        table.add("data", engineering(cost.bytes, "B"));
      }
      if (cost.has_limits()) {
        table.add("operations per second",
                  engineering(cost.flops / cost.seconds, "flop/s"),
                  engineering(cost.product_flops_per_second, "flop/s") +
                      " in a small dense product");
        table.add(
            "data per second", engineering(cost.bytes / cost.seconds, "B/s"),
            engineering(cost.copy_bytes_per_second, "B/s") + " in a copy");
        table.add(
            "share of the nearer limit",
            cost.share_of_limit() > 1. ? "all" : percent(cost.share_of_limit()),
            std::string(cost.limited_by_copy() ? "the copy" : "the product") +
                (cost.share_of_limit() > 1.
                     ? "; it was measured while the machine was busier"
                     : ""));
      }
      return table.card("One application of W");
    }
  } // namespace

  std::string cost_section(const Summary &s)
  {
    Table counters;
    for (const auto &[name, value] : s.counters)
      counters.add(readable(name), count(value),
                   s.steps > 0 && value >= s.steps
                       ? engineering(value / s.steps, "") + " per step"
                       : "");
    const std::string cards = times(s) + iterations(s) + messages(s.cost) +
                              hot_loop(s.cost) + memory(s) +
                              counters.card("Counters");
    return cards.empty() ? "" : section("Cost", row_of(cards));
  }
} // namespace nsfd
