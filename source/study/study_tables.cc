#include "cost_comparison.h"
#include "distribution.h"
#include "rank_scaling.h"
#include "study_means.h"

#include "study_results.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace nsfd
{
  namespace
  {
    using Json = nlohmann::ordered_json;

    std::string quoted(const std::string &text)
    {
      if (text.find_first_of(",\"\n") == std::string::npos)
        return text;
      std::string result = "\"";
      for (const char c : text)
        result += c == '"' ? std::string("\"\"") : std::string(1, c);
      return result + "\"";
    }

    struct Column {
      const char *name;
      double (*value)(const CaseResult &);
    };

    const std::vector<Column> &columns()
    {
      static const std::vector<Column> all = {
          {"exit_code",
           [](const CaseResult &r) { return double(r.exit_code); }},
          {"unknowns", [](const CaseResult &r) { return r.dofs; }},
          {"cells", [](const CaseResult &r) { return r.cells; }},
          {"steps", [](const CaseResult &r) { return r.steps; }},
          {"newton_per_step", [](const CaseResult &r) { return r.newton; }},
          {"krylov_per_step", [](const CaseResult &r) { return r.krylov; }},
          {"operator_applications_per_step",
           [](const CaseResult &r) { return r.applications; }},
          {"block_factorisations",
           [](const CaseResult &r) { return r.block_factorisations; }},
          {"global_factorisations",
           [](const CaseResult &r) { return r.global_factorisations; }},
          {"repeats",
           [](const CaseResult &r) { return double(r.solve.size()); }},
          {"cpu_setup", [](const CaseResult &r) { return setup_median(r); }},
          {"cpu_solve", [](const CaseResult &r) { return solve_median(r); }},
          {"cpu_solve_spread",
           [](const CaseResult &r) { return solve_spread(r); }},
          {"wall", [](const CaseResult &r) { return median(r.wall); }},
          {"peak_memory_mb",
           [](const CaseResult &r) { return r.peak_memory_mb; }},
          {"messages_per_step", [](const CaseResult &r) { return r.messages; }},
          {"message_bytes_per_step",
           [](const CaseResult &r) { return r.message_bytes; }},
          {"collectives_per_step",
           [](const CaseResult &r) { return r.collectives; }},
          {"waiting", [](const CaseResult &r) { return r.waiting; }},
          {"copy_gain", [](const CaseResult &r) { return r.copy_gain; }},
          {"product_gain", [](const CaseResult &r) { return r.product_gain; }},
          {"residual_max", [](const CaseResult &r) { return r.residual; }},
          {"ledger_defect_max",
           [](const CaseResult &r) { return r.balance_residual; }},
          {"numerical_dissipation",
           [](const CaseResult &r) { return r.numerical_dissipation; }}};
      return all;
    }

    std::set<std::string> error_names(const StudyResults &study)
    {
      std::set<std::string> names;
      for (const CaseResult &result : study.results)
        for (const auto &[name, value] : result.errors)
          names.insert(name);
      return names;
    }

    Json number(const double value)
    {
      return std::isfinite(value) ? Json(value) : Json(nullptr);
    }

    std::string fixed(const std::string &text, const std::size_t width)
    {
      return fmt::format("{:<{}}", text, width);
    }

    /** One series and error: sizes, errors, rates. */
    std::string order_table(const StudyResults &study, const StudyOrder &order)
    {
      std::string text =
          fmt::format("\n{}{}{}\n", order.error,
                      order.series.empty() ? "" : ", ", order.series);
      text +=
          fmt::format("  {:>12} {:>12} {:>7} {:>12} {:>10}\n",
                      size_label(study), "error", "rate", "unknowns", "CPU s");
      std::size_t rate = 0;
      for (std::size_t i = 0; i < order.points.size(); ++i) {
        const StudyPoint &point = order.points[i];
        const bool has_rate = i > 0 && rate < order.fit.rates.size();
        text += fmt::format(
            "  {:>12.4g} {:>12.4e} {:>7} {:>12.0f} {:>10.3g}\n", point.size,
            point.error,
            has_rate ? fmt::format("{:.2f}", order.fit.rates[rate++]) : "",
            point.unknowns, point.seconds);
      }
      text += "  " + order_line(order) + "\n";
      return text;
    }

    std::string case_lines(const StudyResults &study)
    {
      std::size_t width = 4;
      for (std::size_t k = 0; k < study.cases.size(); ++k)
        width = std::max(width, setting_of(study, k).size());
      const std::vector<std::string> errors = shown_quantities(study);
      std::string text =
          fixed("case", width) +
          fmt::format("  {:<9} {:>9} {:>7} {:>10} {:>6} {:>8} {:>9}", "status",
                      "unknowns", "steps", "CPU s", "+-", "MB", "balance");
      if (!errors.empty())
        text += fmt::format(" {:>16}", errors[0]);
      text += "\n";
      for (std::size_t k = 0; k < study.cases.size(); ++k) {
        const CaseResult &r = study.results[k];
        text += fixed(setting_of(study, k), width) +
                fmt::format("  {:<9} {:>9.0f} {:>7.0f} {:>10.3g} {:>5.0f}% "
                            "{:>8.0f} {:>9.1e}",
                            name_of(r.status), r.dofs, r.steps, solve_median(r),
                            50. * solve_spread(r), r.peak_memory_mb,
                            r.balance_residual);
        if (!errors.empty()) {
          const auto found = r.errors.find(errors[0]);
          text += found == r.errors.end()
                      ? fmt::format(" {:>16}", "")
                      : fmt::format(" {:>16.4e}", found->second);
        }
        text += "\n";
        if (!is_done(r) && !r.failure.empty())
          text += "    " + r.failure + "\n";
      }
      return text;
    }
  } // namespace

  std::string order_line(const StudyOrder &order)
  {
    if (order.fit.round_off)
      return "no order: all errors are round-off";
    if (!order.fit.order)
      return order.expected
                 ? fmt::format("expected order {:.2f}: too few points",
                               *order.expected)
                 : "no order: three points are needed";
    std::string text = fmt::format("order {:.2f} over {} points",
                                   *order.fit.order, order.fit.n_fitted);
    if (order.expected)
      text += fmt::format(", expected {:.2f}: {}", *order.expected,
                          text_of(order.verdict));
    if (order.fit.level)
      text += fmt::format("; levels off at {:.2g}", *order.fit.level);
    return text;
  }

  std::string study_csv(const StudyResults &study)
  {
    std::string text = "case,status";
    for (const auto &[path, value] : study.cases.at(0).combination.parameters)
      text += "," + quoted(path);
    for (const Column &column : columns())
      text += std::string(",") + column.name;
    const std::set<std::string> errors = error_names(study);
    for (const std::string &name : errors)
      text += ",error_" + name;
    text += ",reproducible,failure\n";
    for (std::size_t k = 0; k < study.cases.size(); ++k) {
      const CaseResult &r = study.results[k];
      text += study.cases[k].combination.name + "," + name_of(r.status);
      for (const auto &[path, value] : study.cases[k].combination.parameters)
        text += "," + quoted(value);
      for (const Column &column : columns())
        text += r.solve.empty() ? std::string(",")
                                : fmt::format(",{:.10g}", column.value(r));
      for (const std::string &name : errors) {
        const auto found = r.errors.find(name);
        text += found == r.errors.end() || !std::isfinite(found->second)
                    ? std::string(",")
                    : fmt::format(",{:.10g}", found->second);
      }
      text += std::string(",") + (r.reproducible ? "true" : "false") + "," +
              quoted(r.failure) + "\n";
    }
    return text;
  }

  std::string study_json(const StudyResults &study)
  {
    Json json;
    json["file"] = study.input.file;
    json["command_line"] = study.command_line;
    json["version"] = study.version;
    json["git_hash"] = study.git_hash;
    json["build_type"] = study.build_type;
    json["compiler"] = study.compiler;
    json["host"] = study.host;
    json["processor"] = study.processor;
    json["cores"] = study.cores;
    json["ranks"] = study.input.ranks;
    json["jobs"] = study.input.jobs;
    json["date"] = study.date;
    json["cases"] = study.cases.size();
    json["done"] = count(study, CaseResult::Status::done);
    json["verdict"] = verdict_text(study);
    json["limits"] = limits_of(study);
    json["warnings"] = study.warnings;
    json["orders"] = Json::array();
    for (const StudyOrder &order : orders_of(study)) {
      Json one;
      one["series"] = order.series;
      one["error"] = order.error;
      for (const StudyPoint &point : order.points) {
        one["sizes"].push_back(number(point.size));
        one["errors"].push_back(number(point.error));
      }
      one["rates"] = order.fit.rates;
      one["order"] = order.fit.order ? number(*order.fit.order) : Json(nullptr);
      one["points"] = order.fit.n_fitted;
      one["level"] = order.fit.level ? number(*order.fit.level) : Json(nullptr);
      one["expected"] =
          order.expected ? number(*order.expected) : Json(nullptr);
      one["verdict"] = text_of(order.verdict);
      json["orders"].push_back(one);
    }
    json["costs"] = Json::array();
    for (const CostRow &row : cost_rows(study)) {
      Json one;
      one["error"] = row.error;
      one["target"] = row.target;
      one["series"] = row.series;
      one["seconds"] =
          row.cost.reached ? number(row.cost.seconds) : Json(nullptr);
      one["at_most"] = row.cost.at_most;
      json["costs"].push_back(one);
    }
    json["distributions"] = Json::array();
    for (const StudyMean &mean : means_of(study)) {
      Json one;
      one["quantity"] = mean.error;
      one["setting"] = mean.setting;
      one["mean"] = number(mean.mean);
      one["half_width"] = number(mean.half_width);
      one["deviation"] = number(mean.deviation);
      one["values"] = mean.values;
      const auto weibull = weibull_fit(mean.values);
      one["weibull"] = weibull ? Json{{"shape", number(weibull->shape)},
                                      {"scale", number(weibull->scale)}}
                               : Json(nullptr);
      json["distributions"].push_back(one);
    }
    json["checks"] = Json::array();
    for (const LimitCheck &check : study.checks)
      json["checks"].push_back({{"case", check.name},
                                {"reason", check.reason},
                                {"done", check.done},
                                {"before", number(check.before)},
                                {"after", number(check.after)}});
    json["runs"] = Json::array();
    for (std::size_t k = 0; k < study.cases.size(); ++k) {
      const CaseResult &r = study.results[k];
      Json one;
      one["case"] = study.cases[k].combination.name;
      one["status"] = name_of(r.status);
      one["failure"] = r.failure;
      one["parameters"] = Json::object();
      for (const auto &[path, value] : study.cases[k].combination.parameters)
        one["parameters"][path] = value;
      for (const Column &column : columns())
        one[column.name] = number(column.value(r));
      one["setup_seconds"] = r.setup;
      one["solve_seconds"] = r.solve;
      one["errors"] = Json::object();
      for (const auto &[name, value] : r.errors)
        one["errors"][name] = number(value);
      one["reproducible"] = r.reproducible;
      json["runs"].push_back(one);
    }
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  }

  std::string study_text(const StudyResults &study)
  {
    std::string text = case_lines(study);
    const std::vector<std::string> errors = shown_errors(study);
    for (const StudyOrder &order : orders_of(study))
      if (order.expected || study.input.errors.size() > 0 ||
          order.error == errors[0])
        text += order_table(study, order);
    text += means_text(study);
    text += rank_text(study);
    const std::string costs = cost_table(study);
    if (!costs.empty())
      text += "\nCPU time (s) of an error, from the lower envelopes\n" + costs;
    const std::string verdict = verdict_text(study);
    if (!verdict.empty())
      text += "\nverdict: " + verdict + "\n";
    const std::vector<std::string> limits = limits_of(study);
    if (!limits.empty())
      text += "\nlimit of this study\n";
    for (const std::string &line : limits)
      text += "  " + line + "\n";
    for (const std::string &warning : study.warnings)
      text += "  warning: " + warning + "\n";
    return text;
  }
} // namespace nsfd
