#include "nsfd/records/cost_record.h"

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  bool CostRecord::limited_by_copy() const
  {
    return bytes / copy_bytes_per_second > flops / product_flops_per_second;
  }

  double CostRecord::share_of_limit() const
  {
    return std::max(bytes / copy_bytes_per_second,
                    flops / product_flops_per_second) /
           seconds;
  }

  std::string messages_text(const CostRecord &cost)
  {
    const double steps = std::max(1., cost.steps);
    std::string text = fmt::format(
        "{} ranks, each per step at most: {:.4g} messages of {:.3g} kB, {:.4g} "
        "reductions and the like of {:.3g} B",
        cost.ranks, cost.sent.messages / steps,
        1e-3 * cost.sent.message_bytes / std::max(1., cost.sent.messages),
        cost.sent.collectives / steps,
        cost.sent.collective_bytes / std::max(1., cost.sent.collectives));
    if (cost.copy_gain > 0.)
      text += fmt::format("; all of them copy {:.2f} times and multiply {:.2f} "
                          "times as much as one alone",
                          cost.copy_gain, cost.product_gain);
    return text;
  }

  std::string cost_text(const CostRecord &cost, const double peak_memory_mb)
  {
    double total = 0.;
    for (const auto &part : cost.parts)
      total += part.seconds;
    std::string text = fmt::format("  CPU time {:.3g} s:\n", total);
    for (const auto &part : cost.parts)
      if (part.seconds >= 5e-4 * total)
        text += fmt::format("    {:<24} {:>9.3g} s {:>5.1f} %  {:>10} calls\n",
                            part.name, part.seconds,
                            100. * part.seconds / total, part.calls);
    text += "  per step, median (worst):";
    for (const auto &spread : cost.per_step)
      text += fmt::format("{} {} {:.4g} ({:.4g})",
                          &spread == &cost.per_step.front() ? "" : ",",
                          spread.name, spread.median, spread.worst);
    if (cost.ranks > 1)
      text += "\n  " + messages_text(cost);
    text += "\n  memory:";
    for (const auto &[owner, bytes] : cost.memory)
      text += fmt::format(" {} {:.3g} MB,", owner, bytes / 1e6);
    text += fmt::format(" at most {:.0f} MB resident\n", peak_memory_mb);
    if (cost.applications > 0.)
      text +=
          fmt::format("  one application of W: {:.3g} us, {:.3g} Mflop, "
                      "{:.3g} MB",
                      1e6 * cost.seconds, 1e-6 * cost.flops, 1e-6 * cost.bytes);
    if (cost.has_limits()) {
      const char *limit = cost.limited_by_copy() ? "copy" : "product";
      text += fmt::format(
          "; {:.3g} of {:.3g} Gflop/s in a small dense product, {:.3g} of "
          "{:.3g} GB/s in a copy: ",
          1e-9 * cost.flops / cost.seconds,
          1e-9 * cost.product_flops_per_second,
          1e-9 * cost.bytes / cost.seconds, 1e-9 * cost.copy_bytes_per_second);
      // both are measured on a machine that may do something else meanwhile
      text +=
          cost.share_of_limit() > 1.
              ? fmt::format("faster than the nearer limit ({}) came out", limit)
              : fmt::format("{:.0f} % of the nearer limit ({})",
                            100. * cost.share_of_limit(), limit);
    }
    return text + (cost.applications > 0. ? "\n" : "");
  }
} // namespace nsfd
