#include "run_end.h"

#include "visualization/energy_lines.h"

#include "postprocess/progress.h"
#include "records/engineering.h"

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  namespace
  {
    std::string happened(const Summary &summary, const double broken_area)
    {
      const Units units(summary.dimension, summary.axisymmetric);
      std::string text = fmt::format(
          "{} step{} to t = {} in {}; energy at the end:", summary.steps,
          summary.steps == 1 ? "" : "s",
          engineering(summary.final_time, "s", 4),
          Progress::duration(summary.wall_seconds));
      const auto add = [&](const std::string &name, const double value) {
        if (value != 0.)
          text += " " + name + " " + engineering(value, units.energy, 4) + ",";
      };
      for (const EnergyLine &line : all_lines())
        add(line.name, summary.energy.*line.member);
      add("work of loads", summary.energy.work);
      text += fmt::format(" {} {}, {} fragment{}", units.broken,
                          engineering(broken_area, units.area),
                          summary.fragments, summary.fragments == 1 ? "" : "s");
      return wrapped(text, 2);
    }

    /** One sentence on where the time went. */
    std::string costs(const Summary &s)
    {
      const auto counter = [&](const std::string &name) {
        const auto found = s.counters.find(name);
        return found == s.counters.end() ? 0. : found->second;
      };
      // a static start is no step, steps of the load are
      const bool has_loads = s.counters.count("shortened_load_steps") != 0;
      const auto sum = [&](const std::string &name) {
        return counter(name) +
               (has_loads ? counter("equilibrium_" + name) : 0.);
      };
      double seconds = 0.;
      for (const auto &[name, value] : s.timings)
        if (name != "set-up" && name != "output" &&
            (name != "equilibria" || has_loads))
          seconds += value;
      const double steps = std::max(1., double(s.steps));
      return wrapped(
          fmt::format("{:.3g} s of CPU, at most {:.0f} MB; per step {}, Newton "
                      "{:.2f}, Krylov {:.1f}, sweeps {:.1f}",
                      s.cpu_seconds, s.peak_memory_mb,
                      engineering(seconds / steps, "s"), sum("newton") / steps,
                      sum("krylov") / steps,
                      counter("gauss_seidel_sweeps") / steps),
          2);
    }
  } // namespace

  std::string run_end_text(const Summary &summary,
                           const Certificate &certificate,
                           const double broken_area, const std::string &files,
                           const bool verbose)
  {
    std::string text = certificate_text(certificate);
    text += happened(summary, broken_area);
    if (!summary.errors.empty())
      text += "  compared with what is known, relative or in SI units:\n";
    for (const auto &[name, value] : summary.errors)
      text += fmt::format("    {:<28} {:.4g}\n", name, value);
    if (verbose) {
      text += costs(summary);
      text += cost_text(summary.cost, summary.peak_memory_mb);
    }
    return text + wrapped(files, 2);
  }
} // namespace nsfd
