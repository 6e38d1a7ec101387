#include "cost_comparison.h"

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  std::vector<CostRow> cost_rows(const StudyResults &study)
  {
    std::vector<CostRow> rows;
    const std::vector<std::string> errors = shown_errors(study);
    if (errors.empty())
      return rows;
    const std::string &error = errors[0];
    const std::vector<StudyGroup> groups = groups_of(study, error);
    std::vector<double> targets = study.input.targets;
    const auto first = lower_envelope(groups.front().points);
    if (groups.size() > 1 && !first.empty())
      targets.push_back(first.back().error);
    std::sort(targets.rbegin(), targets.rend());
    for (const double target : targets) {
      const auto add = [&](const std::string &name,
                           const std::vector<StudyPoint> &points) {
        const auto envelope = lower_envelope(points);
        if (!envelope.empty())
          rows.push_back({error, target, name, cost_of_error(points, target),
                          envelope.back().error});
      };
      if (groups.size() > 1)
        for (const StudyGroup &group : groups)
          add(group.name, group.points);
      add("all", all_points(study, error));
    }
    return rows;
  }

  std::string cost_text(const CostRow &row)
  {
    if (!row.cost.reached)
      return fmt::format("not reached (best {:.1e})", row.best);
    return fmt::format("{}{:.3g}", row.cost.at_most ? "< " : "",
                       row.cost.seconds);
  }

  std::string cost_table(const StudyResults &study)
  {
    std::string text;
    for (const CostRow &row : cost_rows(study))
      text += fmt::format("  {} = {:<9.2g} {:<24} {}\n", row.error, row.target,
                          row.series, cost_text(row));
    return text;
  }
} // namespace nsfd
