#include "certificate.h"

#include "certificate_lines.h"

#include "engineering.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    using Line = CertificateLine;
    using Verdict = Line::Verdict;

    // of the largest energy
    constexpr double largest_defect = 1e-9;

    /** Of a length in m. */
    std::string length_text(const double value)
    {
      return engineering(value, "m");
    }

    unsigned long long accepted(const RunFacts &facts)
    {
      return facts.steps + facts.static_steps + facts.smooth_steps;
    }

    Line end_of(const RunFacts &facts)
    {
      Line line;
      line.name = "end";
      line.value = "t = " + engineering(facts.time, "s", 6);
      line.verdict = within(facts.completed);
      if (!facts.completed)
        line.remark =
            "not reached: " +
            (facts.failure.empty() ? "no reason was recorded" : facts.failure);
      // what follows a line break is advice that is printed elsewhere
      line.remark = line.remark.substr(0, line.remark.find('\n'));
      return line;
    }

    Line residual_of(const std::string &name, const double residual,
                     const double tolerance)
    {
      Line line =
          line_of(name, residual, tolerance, within(residual <= tolerance));
      if (line.verdict == Verdict::bad)
        line.remark = "steps were kept that were not solved to "
                      "Solver/tolerance: a shorter Time/step or another "
                      "Solver/method may be";
      return line;
    }

    void add_residuals(const RunFacts &facts, std::vector<Line> &lines)
    {
      if (facts.steps > 0)
        lines.push_back(
            residual_of("residual", facts.residual, facts.tolerance));
      if (facts.static_steps > 0)
        lines.push_back(
            residual_of("imbalance", facts.imbalance, facts.static_tolerance));
      if (facts.smooth_steps > 0)
        lines.push_back(unmeasured_line(
            "residual", "scheme = arkode solves no contact problem; its "
                        "errors follow Time/integration tolerance"));
      if (accepted(facts) == 0)
        lines.push_back(unmeasured_line("residual", "no step was accepted"));
    }

    /**
     * What positions are known to: each is rounded once, each of its changes
     * once more. A contact adds a handful of them; round-off of n steps grows
     * like sqrt(n) as a rule and like n at worst.
     */
    double rounding_of_positions(const RunFacts &facts)
    {
      constexpr double unit = std::numeric_limits<double>::epsilon();
      constexpr double terms = 8.; // of a gap: two bodies, place and shape
      return terms * unit *
             (facts.extent + double(accepted(facts)) * facts.displacement);
    }

    Line penetration_of(const RunFacts &facts)
    {
      // normals turn within a step of a large motion: then bounds of single
      // points hold to second order in the longest of all ways
      const bool turns = !facts.limits.rotation;
      const double noise = facts.tolerance * facts.displacement +
                           rounding_of_positions(facts) +
                           (turns ? 1e-3 * facts.penetration_bound : 0.);
      if (facts.steps == 0 && facts.penetration > noise)
        return unmeasured_line("penetration",
                               length_text(facts.penetration) +
                                   ": equilibria have no speed of approach to "
                                   "bound it");
      if (facts.steps + facts.static_steps == 0)
        return facts.smooth_steps > 0
                   ? no_line("penetration", "nothing can touch")
                   : unmeasured_line("penetration", "no step was accepted");
      const double bound = facts.penetration_bound + noise;
      Line line = line_of("penetration", facts.penetration, bound,
                          within(facts.penetration_excess <= noise));
      // a point may be deeper than its own bound and not than that of all
      if (line.verdict == Verdict::bad) {
        line.number = facts.penetration_excess;
        line.limit = noise;
      }
      print_both(line, 3, "at most ",
                 [](const double value, const unsigned int digits) {
                   return engineering(value, "m", digits);
                 });
      if (line.verdict == Verdict::bad) {
        line.remark = fmt::format(
            "a point is {} deeper than what its last closing explains: it "
            "closes again and again without opening, or bodies overlap at the "
            "start; the deepest {}",
            line.value, length_text(facts.penetration));
        if (!facts.automatic_steps)
          line.remark += "; shorten Time/step";
      }
      return line;
    }

    Line defect_of(const RunFacts &facts)
    {
      if (accepted(facts) == 0)
        return unmeasured_line("balance residual", "no step was accepted");
      const double defect = std::abs(facts.balance_residual);
      Line line = line_of("balance residual", defect, largest_defect,
                          within(defect <= largest_defect));
      if (line.verdict == Verdict::bad)
        line.remark =
            facts.smooth_steps == accepted(facts)
                ? "what the integration leaves: lower Time/integration "
                  "tolerance"
                : "the energy balance is violated: joints may be redundant; "
                  "energies.svg shows when";
      return line;
    }

    /** The first law: what was dissipated is in the bodies. */
    Line heat_of(const RunFacts &facts)
    {
      Line line = line_of("heat residual", *facts.heat_residual, largest_defect,
                          within(*facts.heat_residual <= largest_defect));
      if (line.verdict == Verdict::bad)
        line.remark = "the bodies have not the heat that was made in them";
      else if (facts.cells_crossed_by_heat < 1.)
        line.remark = fmt::format("heat has crossed {:.2g} of a cell: the "
                                  "hottest temperature is that "
                                  "of the cells, surfaces are hotter",
                                  facts.cells_crossed_by_heat);
      return line;
    }

    /** A balance closes whatever its lines do: each has a bound of its own. */
    void add_given(const RunFacts &facts, std::vector<Line> &lines)
    {
      for (const GivenEnergy &given : facts.given) {
        if (accepted(facts) == 0) {
          lines.push_back(unmeasured_line("given by " + given.line,
                                          "no step was accepted"));
          continue;
        }
        Line line = line_of("given by " + given.line, given.share, given.bound,
                            within(given.share <= given.bound));
        if (line.verdict == Verdict::bad)
          line.remark = "energy created, over the largest of the run" +
                        (given.advice.empty() ? "" : ": " + given.advice);
        lines.push_back(line);
      }
    }

    void add_uniqueness(const RunFacts &facts, std::vector<Line> &lines)
    {
      if (facts.steps > 0) {
        Line line = line_of("uniqueness", double(facts.beyond_unique), 0.,
                            within(facts.beyond_unique == 0), "{:.0f} steps");
        if (!facts.softens)
          line.remark = "nothing softens";
        if (line.verdict == Verdict::bad)
          line.remark = fmt::format(
              "in {} of {} steps a softening face may have had several "
              "solutions: {}",
              facts.beyond_unique, facts.steps,
              facts.brittle
                  ? std::string("its traction jumps, no step is short enough")
              : facts.explicit_steps
                  ? std::string(
                        "smaller cells (a third of the cohesive length) "
                        "or a shorter Time/step")
              : facts.automatic_steps
                  ? fmt::format("raise Time/maximum bisections above {}",
                                facts.maximum_bisections)
                  : std::string(
                        "set step = auto, or a shorter one (--check names "
                        "it)"));
        lines.push_back(line);
      }
      if (facts.static_steps > 0) {
        Line line = line_of("solution jumps", double(facts.solution_jumps), 0.,
                            within(facts.solution_jumps == 0), "{:.0f}");
        if (facts.solution_jumps > 0)
          line.remark =
              facts.follows_jumps
                  ? "no equilibrium continues the last one: from there on it "
                    "is "
                    "a motion, and its energies are those of one"
              : facts.takes_jumps
                  ? "no equilibrium continues the last one: the next one was "
                    "taken; set at solution jump = dynamic follows it in time"
                  : "no equilibrium continues the last one: set at solution "
                    "jump = dynamic follows it in time, = relax takes the "
                    "next one";
        lines.push_back(line);
      }
      if (facts.steps + facts.static_steps == 0)
        lines.push_back(
            facts.smooth_steps > 0
                ? no_line("uniqueness", "nothing can soften")
                : unmeasured_line("uniqueness", "no step was accepted"));
    }

    Line zone_of(const RunFacts &facts)
    {
      if (!facts.zone)
        return no_line("cohesive zone", facts.softens ? "no point has softened"
                                                      : "nothing can soften");
      const ZoneResolution &zone = *facts.zone;
      if (!(zone.length > 0.))
        return no_line("cohesive zone", "between rigid bodies alone");
      Line line =
          line_of("cohesive zone", zone.points(), points_per_cohesive_length,
                  within(zone.points() >= points_per_cohesive_length),
                  "{:.3g} points", "at least ");
      line.remark = fmt::format("length {} in {}", length_text(zone.length),
                                zone.interface);
      if (line.verdict == Verdict::bad)
        line.remark += fmt::format(
            ": its energy is right, stresses at its front are not; points "
            "every {}, or a strength {:.2g} times as large",
            engineering(zone.length / points_per_cohesive_length, "m", 2),
            std::sqrt(zone.points() / points_per_cohesive_length));
      return line;
    }

    Line held_of(const RunFacts &facts)
    {
      const HeldFaces &held = *facts.held;
      Line line = line_of("held faces", held.share, 1.,
                          within(held.share <= 1.), "{:.3g} of strength");
      line.bound = "at most 1";
      if (line.verdict == Verdict::bad)
        line.remark = fmt::format(
            "faces between cells of two sizes, and faces with a node in the "
            "middle of a larger one, cannot open: at {} the traction is {:.2g} "
            "times the strength; let the small cells reach further",
            held.place, held.share);
      else if (held.share == 0.) {
        line.value = "far below";
        line.remark = "no face where cells of two sizes meet came near its "
                      "strength";
      }
      return line;
    }

    Line attempts_of(const RunFacts &facts)
    {
      if (accepted(facts) == 0)
        return unmeasured_line("rejected steps",
                               fmt::format("{} attempts, no step was accepted",
                                           facts.rejected + facts.overshoots));
      const double again = double(facts.rejected + facts.overshoots);
      const double kept = double(accepted(facts));
      Line line = line_of("rejected steps", again, kept, within(again < kept),
                          "{:.0f} steps", "less than ");
      if (line.verdict == Verdict::bad)
        line.remark = std::string("most attempted steps are rejected: ") +
                      (facts.automatic_steps ? "set Time/step to a shorter time"
                                             : "shorten Time/step");
      else if (again > 0.)
        line.remark = fmt::format("{} not solved, {} too long", facts.rejected,
                                  facts.overshoots);
      return line;
    }
  } // namespace

  const char *text_of(const CertificateLine::Verdict verdict)
  {
    return verdict == Verdict::ok     ? "ok"
           : verdict == Verdict::bad  ? "not ok"
           : verdict == Verdict::none ? "none"
                                      : "not measured";
  }

  bool Certificate::is_ok() const
  {
    return std::all_of(lines.begin(), lines.end(), [](const Line &line) {
      return line.verdict == Verdict::ok || line.verdict == Verdict::none;
    });
  }

  std::string Certificate::verdict() const
  {
    const auto n = [this](const Verdict verdict) {
      return std::count_if(lines.begin(), lines.end(), [&](const Line &line) {
        return line.verdict == verdict;
      });
    };
    const auto bad = n(Verdict::bad), open = n(Verdict::not_measured);
    if (bad > 0)
      return fmt::format("{} of {} lines not ok", bad, lines.size());
    if (open > 0)
      return fmt::format("ok as far as measured, {} of {} lines are not", open,
                         lines.size());
    return "ok";
  }

  Certificate certify(const RunFacts &facts)
  {
    Certificate certificate;
    auto &lines = certificate.lines;
    lines.push_back(end_of(facts));
    add_residuals(facts, lines);
    lines.push_back(penetration_of(facts));
    lines.push_back(defect_of(facts));
    if (facts.heat_residual)
      lines.push_back(heat_of(facts));
    add_given(facts, lines);
    add_uniqueness(facts, lines);
    lines.push_back(zone_of(facts));
    if (facts.held && facts.softens)
      lines.push_back(held_of(facts));
    lines.push_back(attempts_of(facts));
    add_motion_limits(facts, lines);
    return certificate;
  }

  std::string wrapped(const std::string &text, const std::size_t indent,
                      const std::size_t width)
  {
    std::string result, row(indent, ' ');
    std::size_t begin = 0, columns = indent; // bytes are not columns
    const auto size_of = [](const std::string &part) {
      return std::size_t(std::count_if(part.begin(), part.end(), [](char c) {
        return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
      }));
    };
    while (begin < text.size()) {
      // to the next blank that does not follow a number
      std::size_t end = text.find(' ', begin);
      while (end != std::string::npos && end > begin && text[end - 1] >= '0' &&
             text[end - 1] <= '9')
        end = text.find(' ', end + 1);
      const std::string word = text.substr(begin, end - begin);
      const bool first = columns == indent;
      if (!first && columns + 1 + size_of(word) > width) {
        result += row + "\n";
        row = std::string(indent, ' ') + word;
        columns = indent + size_of(word);
      } else {
        row += (first ? "" : " ") + word;
        columns += size_of(word) + (first ? 0 : 1);
      }
      begin = end == std::string::npos ? text.size() : end + 1;
    }
    return columns == indent ? result : result + row + "\n";
  }

  std::string certificate_text(const Certificate &certificate)
  {
    std::size_t name = 0, value = 0, bound = 0;
    for (const Line &line : certificate.lines) {
      name = std::max(name, line.name.size());
      value = std::max(value, line.value.size());
      bound = std::max(bound, line.bound.size());
    }
    std::string text = "certificate: " + certificate.verdict() + "\n";
    for (const Line &line : certificate.lines) {
      std::string row = fmt::format("  {:<{}}  {:<{}}  {:<{}}  {:<12}",
                                    line.name, name, line.value, value,
                                    line.bound, bound, text_of(line.verdict));
      const bool fits = row.size() + 2 + line.remark.size() <= 80;
      if (fits)
        row += "  " + line.remark;
      row.resize(row.find_last_not_of(' ') + 1);
      text += row + "\n" + (fits ? "" : wrapped(line.remark, 6));
    }
    return text;
  }
} // namespace nsfd
