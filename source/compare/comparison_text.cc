#include "comparison.h"

#include "shown_numbers.h"

#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** Columns as wide as their widest cell: the first to the left. */
    class TextTable
    {
    public:
      void add(const std::vector<std::string> &row) { rows_.push_back(row); }

      std::string text() const
      {
        std::vector<std::size_t> width;
        for (const auto &row : rows_)
          for (std::size_t c = 0; c < row.size(); ++c) {
            width.resize(std::max(width.size(), c + 1), 0);
            width[c] = std::max(width[c], row[c].size());
          }
        std::string text;
        for (const auto &row : rows_) {
          std::string line = " ";
          for (std::size_t c = 0; c < row.size(); ++c)
            line += c == 0 ? fmt::format(" {:<{}}", row[c], width[c])
                           : fmt::format("  {:>{}}", row[c], width[c]);
          line.resize(line.find_last_not_of(' ') + 1);
          text += line + "\n";
        }
        return text;
      }

    private:
      std::vector<std::vector<std::string>> rows_;
    };

    std::vector<std::string> head(const Comparison &comparison,
                                  const bool differences)
    {
      std::vector<std::string> row = {""};
      for (std::size_t k = 0; k < comparison.runs.size(); ++k)
        row.push_back(letter(k));
      for (std::size_t k = 1; differences && k < comparison.runs.size(); ++k)
        row.push_back(comparison.runs.size() == 2
                          ? "difference"
                          : letter(k) + " - " + letter(0));
      return row;
    }

    std::string runs_text(const Comparison &comparison)
    {
      std::string text;
      for (std::size_t k = 0; k < comparison.runs.size(); ++k) {
        const RunFolder &run = comparison.runs[k];
        text +=
            letter(k) + "  " + run.name +
            (run.completed
                 ? ""
                 : "  (not completed: " +
                       run.failure.substr(0, run.failure.find('\n')) + ")") +
            "\n";
      }
      return text;
    }

    std::string parameters_text(const Comparison &comparison)
    {
      if (comparison.n_parameters == 0)
        return "parameters: not beside every summary\n";
      if (comparison.parameters.empty())
        return fmt::format("parameters: all {} are the same\n",
                           comparison.n_parameters);
      std::string text =
          fmt::format("parameters: {} of {} differ\n",
                      comparison.parameters.size(), comparison.n_parameters);
      TextTable table;
      table.add(head(comparison, false));
      for (const ComparedParameter &entry : comparison.parameters) {
        std::vector<std::string> row = {
            entry.section + (entry.section.empty() ? "" : "/") + entry.name};
        for (const std::string &value : entry.values)
          row.push_back(value.empty() ? "not set" : value);
        table.add(row);
      }
      return text + table.text();
    }

    std::string numbers_text(const Comparison &comparison)
    {
      TextTable table;
      table.add(head(comparison, true));
      for (const ComparedNumber &number : comparison.numbers) {
        if (!is_shown(number))
          continue;
        std::vector<std::string> row = {number.name};
        for (const auto &value : number.values)
          row.push_back(value ? fmt::format("{:.8g}", *value) : "-");
        for (std::size_t k = 1; k < number.differences.size(); ++k)
          row.push_back(difference_text(number.differences[k]));
        table.add(row);
      }
      return "numbers: differences relative to the larger one, of energies to "
             "the largest energy\n" +
             table.text();
    }

    std::string certificate_text(const Comparison &comparison)
    {
      const auto rows = certificate_rows(comparison);
      if (rows.empty())
        return "";
      TextTable table;
      table.add(head(comparison, false));
      for (const auto &row : rows)
        table.add(row);
      return "certificate\n" + table.text();
    }

    std::string curves_text(const Comparison &comparison)
    {
      if (comparison.curves.empty())
        return "curves: not beside every summary\n";
      if (!(comparison.begin <= comparison.end))
        return "curves: no time is common to all runs\n";
      TextTable table;
      table.add({"", "largest", "at t", "mean"});
      std::size_t same = 0;
      for (const ComparedCurve &curve : comparison.curves) {
        if (curve.largest == 0.) {
          ++same;
          continue;
        }
        const bool there = std::isfinite(curve.scale) && curve.scale > 0.;
        table.add({comparison.runs.size() == 2
                       ? curve.name
                       : curve.name + ", " + letter(curve.run),
                   difference_text(curve.largest),
                   there ? fmt::format("{:.4g}", curve.time) : "",
                   difference_text(curve.mean)});
      }
      return fmt::format("curves over t = {:.4g} to {:.4g}: differences "
                         "relative to the largest value, of energies to the "
                         "largest energy\n",
                         comparison.begin, comparison.end) +
             (same < comparison.curves.size() ? table.text() : "") +
             (same > 0 ? fmt::format("  {} of {} are the same\n", same,
                                     comparison.curves.size())
                       : "");
    }

    using Json = nlohmann::ordered_json;

    Json json_of(const double value)
    {
      return std::isfinite(value) ? Json(value) : Json(nullptr);
    }
  } // namespace

  bool is_shown(const ComparedNumber &number)
  {
    const auto in = [&number](const std::string &group) {
      return number.name.compare(0, group.size(), group) == 0;
    };
    // verdicts have a table of their own
    if (in("cost/") || in("timings/") || in("certificate/"))
      return false;
    const bool differs =
        std::any_of(number.differences.begin(), number.differences.end(),
                    [](const double d) { return !(d == 0.); });
    const bool is_something =
        std::any_of(number.values.begin(), number.values.end(),
                    [](const auto &value) { return value && *value != 0.; });
    return differs || (is_something && (number.result || in("errors/") ||
                                        number.name == "steps"));
  }

  std::string difference_text(const double difference)
  {
    return std::isnan(difference) ? "n/a"
           : difference == 0.     ? "0"
                                  : fmt::format("{:.2e}", difference);
  }

  std::vector<std::vector<std::string>>
  certificate_rows(const Comparison &comparison)
  {
    std::vector<std::string> names;
    for (const RunFolder &run : comparison.runs)
      for (const auto &[name, verdict] : run.certificate)
        if (std::find(names.begin(), names.end(), name) == names.end())
          names.push_back(name);
    std::vector<std::vector<std::string>> rows;
    for (const std::string &name : names) {
      auto &row = rows.emplace_back(1, name);
      for (const RunFolder &run : comparison.runs) {
        row.emplace_back("-");
        for (const auto &[other, verdict] : run.certificate)
          if (other == name)
            row.back() = verdict;
      }
    }
    return rows;
  }

  std::string comparison_text(const Comparison &comparison)
  {
    return runs_text(comparison) + parameters_text(comparison) +
           numbers_text(comparison) + certificate_text(comparison) +
           curves_text(comparison);
  }

  std::string comparison_json(const Comparison &comparison,
                              const std::optional<double> tolerance)
  {
    Json json;
    json["runs"] = Json::array();
    for (const RunFolder &run : comparison.runs)
      json["runs"].push_back({{"name", run.name},
                              {"completed", run.completed},
                              {"failure", run.failure}});
    const auto largest = comparison.largest();
    json["largest_difference"] = json_of(largest.difference);
    json["largest_difference_of"] = largest.name;
    if (tolerance) {
      json["tolerance"] = *tolerance;
      json["within"] = largest.difference <= *tolerance;
    }
    json["parameters"] = Json::array();
    for (const ComparedParameter &entry : comparison.parameters)
      json["parameters"].push_back({{"section", entry.section},
                                    {"name", entry.name},
                                    {"values", entry.values}});
    json["numbers"] = Json::array();
    for (const ComparedNumber &number : comparison.numbers) {
      Json values = Json::array(), differences = Json::array();
      for (const auto &value : number.values)
        values.push_back(value ? json_of(*value) : Json(nullptr));
      for (const double difference : number.differences)
        differences.push_back(json_of(difference));
      json["numbers"].push_back({{"name", number.name},
                                 {"result", number.result},
                                 {"values", values},
                                 {"differences", differences}});
    }
    json["certificate"] = Json::array();
    for (const auto &row : certificate_rows(comparison))
      json["certificate"].push_back(
          {{"name", row[0]},
           {"verdicts", std::vector<std::string>(row.begin() + 1, row.end())}});
    json["begin"] = json_of(comparison.begin);
    json["end"] = json_of(comparison.end);
    json["curves"] = Json::array();
    for (const ComparedCurve &curve : comparison.curves)
      json["curves"].push_back({{"name", curve.name},
                                {"run", letter(curve.run)},
                                {"result", curve.result},
                                {"largest", json_of(curve.largest)},
                                {"time", json_of(curve.time)},
                                {"mean", json_of(curve.mean)},
                                {"scale", json_of(curve.scale)}});
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
  }
} // namespace nsfd
