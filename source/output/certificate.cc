#include "nsfd/output/certificate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    using Line = CertificateLine;
    using Verdict = Line::Verdict;

    // of the largest energy
    constexpr double largest_defect = 1e-9;
    constexpr double largest_creation = 1e-2; // as well as curves can be read

    Verdict within(const bool holds)
    {
      return holds ? Verdict::ok : Verdict::bad;
    }

    Line unmeasured(const std::string &name, const std::string &remark)
    {
      Line line;
      line.name = name;
      line.remark = remark;
      return line;
    }

    Line none(const std::string &name, const std::string &remark)
    {
      Line line = unmeasured(name, remark);
      line.verdict = Verdict::none;
      return line;
    }

    /** NaN is never within a bound. */
    Line line_of(const std::string &name, const double number,
                 const double limit, const Verdict verdict,
                 const std::string &format = "{:.1e}",
                 const char *relation = "at most ")
    {
      Line line;
      line.name = name;
      line.number = number;
      line.limit = limit;
      line.value = fmt::format(fmt::runtime(format), number);
      line.bound = relation + fmt::format(fmt::runtime(format), limit);
      line.verdict = verdict;
      return line;
    }

    unsigned long long accepted(const RunFacts &facts)
    {
      return facts.steps + facts.static_steps + facts.smooth_steps;
    }

    Line end_of(const RunFacts &facts)
    {
      Line line;
      line.name = "end";
      line.value = fmt::format("t = {:.6g}", facts.time);
      line.verdict = within(facts.completed);
      if (!facts.completed)
        line.remark = "not reached: " + (facts.failure.empty()
                                             ? "no reason was recorded"
                                             : facts.failure);
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
        line.remark = "steps were kept that were not solved: lower "
                      "Solver/tolerance or Time/step";
      return line;
    }

    void add_residuals(const RunFacts &facts, std::vector<Line> &lines)
    {
      if (facts.steps > 0)
        lines.push_back(
            residual_of("residual", facts.residual, facts.tolerance));
      if (facts.static_steps > 0)
        lines.push_back(residual_of("imbalance", facts.imbalance,
                                    facts.static_tolerance));
      if (facts.smooth_steps > 0)
        lines.push_back(unmeasured(
            "residual", "scheme = arkode solves no contact problem; its "
                        "errors follow Time/integration tolerance"));
      if (accepted(facts) == 0)
        lines.push_back(unmeasured("residual", "no step was accepted"));
    }

    Line penetration_of(const RunFacts &facts)
    {
      if (facts.steps == 0 && facts.penetration > 0.)
        return unmeasured("penetration",
                          fmt::format("{:.3g} m: equilibria have no speed of "
                                      "approach to bound it",
                                      facts.penetration));
      if (facts.steps + facts.static_steps == 0)
        return facts.smooth_steps > 0
                   ? none("penetration", "nothing can touch")
                   : unmeasured("penetration", "no step was accepted");
      // speeds change within a step: bounds hold to first order in its length
      const double noise = facts.tolerance * facts.displacement +
                           1e-3 * facts.penetration_bound;
      Line line = line_of("penetration", facts.penetration,
                          facts.penetration_bound,
                          within(facts.penetration_excess <= noise), "{:.3g} m");
      if (line.verdict == Verdict::bad)
        line.remark = fmt::format(
            "a point is {:.3g} m deeper than its own bound ({:.2g} % of the "
            "largest): it closes again and again, or bodies overlap at the "
            "start; shorten Time/step",
            facts.penetration_excess,
            100. * facts.penetration_excess / facts.penetration_bound);
      else if (facts.penetration == 0.)
        line.remark = "none";
      return line;
    }

    Line defect_of(const RunFacts &facts)
    {
      if (accepted(facts) == 0)
        return unmeasured("ledger defect", "no step was accepted");
      const double defect = std::abs(facts.ledger_defect);
      Line line = line_of("ledger defect", defect, largest_defect,
                          within(defect <= largest_defect));
      if (line.verdict == Verdict::bad)
        line.remark = "energies do not add up: hardly any energy in the "
                      "scene, or rows that ask for the same; energies.svg "
                      "shows when";
      return line;
    }

    /** The books of a scheme that makes energy close like all others. */
    void add_created(const RunFacts &facts, std::vector<Line> &lines)
    {
      if (facts.steps + facts.smooth_steps == 0)
        return;
      Line line = line_of("created", facts.created, largest_creation,
                          within(facts.created <= largest_creation));
      if (line.verdict == Verdict::bad)
        line.remark = "the scheme has made energy: shorten Time/step, or take "
                      "scheme = moreau-jean";
      lines.push_back(line);
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
              facts.brittle ? "its traction jumps, no step is short enough"
              : facts.automatic_steps
                  ? "raise Time/maximum halvings"
                  : "set step = auto, or a shorter one (--check names it)");
        lines.push_back(line);
      }
      if (facts.static_steps > 0) {
        Line line = line_of("solution jumps", double(facts.solution_jumps), 0.,
                            within(facts.solution_jumps == 0), "{:.0f}");
        if (facts.solution_jumps > 0)
          line.remark = "no equilibrium continues the last one: set at "
                        "solution jump = dynamic follows it in time";
        lines.push_back(line);
      }
      if (facts.steps + facts.static_steps == 0)
        lines.push_back(facts.smooth_steps > 0
                            ? none("uniqueness", "nothing can soften")
                            : unmeasured("uniqueness", "no step was accepted"));
    }

    Line zone_of(const RunFacts &facts)
    {
      if (!facts.zone)
        return none("cohesive zone", facts.softens ? "no point has softened"
                                                   : "nothing can soften");
      const ZoneResolution &zone = *facts.zone;
      if (!(zone.length > 0.))
        return none("cohesive zone", "between rigid bodies alone");
      Line line = line_of("cohesive zone", zone.points(),
                          points_per_cohesive_length,
                          within(zone.points() >= points_per_cohesive_length),
                          "{:.3g} points", "at least ");
      line.remark = fmt::format("length {:.3g} m in {}", zone.length,
                                zone.interface);
      if (line.verdict == Verdict::bad)
        line.remark += fmt::format(
            ": its energy is right, stresses at its front are not; points "
            "every {:.2g} m, or a strength {:.2g} times as large",
            zone.length / points_per_cohesive_length,
            std::sqrt(zone.points() / points_per_cohesive_length));
      return line;
    }

    Line attempts_of(const RunFacts &facts)
    {
      if (accepted(facts) == 0)
        return unmeasured("taken again",
                          fmt::format("{} attempts, no step was accepted",
                                      facts.rejected + facts.redone));
      const double again = double(facts.rejected + facts.redone);
      const double kept = double(accepted(facts));
      Line line = line_of("taken again", again, kept, within(again < kept),
                          "{:.0f} steps",
                          "less than ");
      if (line.verdict == Verdict::bad)
        line.remark = "most attempts are lost: shorten Time/step";
      else if (again > 0.)
        line.remark = fmt::format("{} not solved, {} too long", facts.rejected,
                                  facts.redone);
      return line;
    }
  } // namespace

  const char *text_of(const CertificateLine::Verdict verdict)
  {
    return verdict == Verdict::ok    ? "ok"
           : verdict == Verdict::bad ? "not ok"
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
    add_created(facts, lines);
    add_uniqueness(facts, lines);
    lines.push_back(zone_of(facts));
    lines.push_back(attempts_of(facts));
    return certificate;
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
      std::string row = fmt::format(
          "  {:<{}}  {:<{}}  {:<{}}  {:<12}  {}", line.name, name, line.value,
          value, line.bound, bound, text_of(line.verdict), line.remark);
      row.resize(row.find_last_not_of(' ') + 1);
      text += row + "\n";
    }
    return text;
  }
} // namespace nsfd
