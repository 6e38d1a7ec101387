#include "rank_scaling.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace nsfd
{
  namespace
  {
    const char *const ranks_path = "Study/ranks";

    /** What else varies; equal for cases that are compared. */
    std::string setting_without_ranks(const StudyResults &study,
                                      const std::size_t k)
    {
      const Combination &combination = study.cases[k].combination;
      std::string text;
      for (std::size_t v = 0; v < study.input.variations.size(); ++v) {
        const Variation &variation = study.input.variations[v];
        const auto &leader = variation.leader();
        if (variation.is_constant() || leader.path == ranks_path)
          continue;
        text += (text.empty() ? "" : ", ") + short_name(leader.path) + " = " +
                Variation::value(leader, combination.index[v]);
      }
      return text.empty() ? "all" : text;
    }

    bool ranks_vary(const StudyInput &input)
    {
      for (const Variation &variation : input.variations)
        for (const auto &parameter : variation.parameters)
          if (parameter.path == ranks_path && parameter.values.size() > 1)
            return true;
      return false;
    }
  } // namespace

  double RankRow::share() const
  {
    const double best = std::min(copy_gain, product_gain);
    return best > 0. ? gain / best : 0.;
  }

  std::vector<RankRow> rank_rows(const StudyResults &study)
  {
    std::vector<RankRow> rows;
    if (!ranks_vary(study.input))
      return rows;
    std::map<std::string, RankRow> fewest;
    for (std::size_t k = 0; k < study.cases.size(); ++k) {
      const CaseResult &r = study.results[k];
      if (!is_done(r))
        continue;
      RankRow row;
      row.setting = setting_without_ranks(study, k);
      row.ranks = study.cases[k].ranks;
      row.unknowns = r.dofs;
      row.seconds_per_step = solve_median(r) / std::max(1., r.steps);
      row.copy_gain = r.copy_gain;
      row.product_gain = r.product_gain;
      row.messages = r.messages;
      row.message_bytes = r.message_bytes;
      row.collectives = r.collectives;
      row.waiting = r.waiting;
      const auto [found, is_new] = fewest.emplace(row.setting, row);
      if (!is_new && row.ranks < found->second.ranks)
        found->second = row;
      rows.push_back(row);
    }
    for (RankRow &row : rows)
      row.gain = fewest.at(row.setting).seconds_per_step / row.seconds_per_step;
    return rows;
  }

  std::vector<std::string> rank_head()
  {
    return {"setting",      "unknowns",
            "ranks",        "ms per step",
            "gain",         "gain of a copy",
            "of a product", "share of the lesser",
            "messages",     "kB",
            "reductions",   "waiting"};
  }

  std::vector<std::string> rank_cells(const RankRow &row)
  {
    const auto known = [](const double value, const std::string &text) {
      return value > 0. ? text : std::string("-");
    };
    return {row.setting,
            fmt::format("{:.0f}", row.unknowns),
            fmt::format("{}", row.ranks),
            fmt::format("{:.4g}", 1e3 * row.seconds_per_step),
            fmt::format("{:.2f}", row.gain),
            known(row.copy_gain, fmt::format("{:.2f}", row.copy_gain)),
            known(row.product_gain, fmt::format("{:.2f}", row.product_gain)),
            known(row.share(), fmt::format("{:.2f}", row.share())),
            fmt::format("{:.1f}", row.messages),
            fmt::format("{:.3g}", 1e-3 * row.message_bytes),
            fmt::format("{:.1f}", row.collectives),
            fmt::format("{:.1f} %", 100. * row.waiting)};
  }

  std::string rank_text(const StudyResults &study)
  {
    const std::vector<RankRow> rows = rank_rows(study);
    if (rows.empty())
      return "";
    std::vector<std::vector<std::string>> table{rank_head()};
    for (const RankRow &row : rows)
      table.push_back(rank_cells(row));
    std::vector<std::size_t> width(table[0].size(), 0);
    for (const auto &line : table)
      for (std::size_t c = 0; c < line.size(); ++c)
        width[c] = std::max(width[c], line[c].size());
    std::string text =
        "\nranks (messages, kB and reductions: per rank and step, at most)\n";
    for (const auto &line : table) {
      text += " ";
      for (std::size_t c = 0; c < line.size(); ++c)
        text += fmt::format("  {:>{}}", line[c], width[c]);
      text += "\n";
    }
    return text;
  }
} // namespace nsfd
