#include "comparison.h"

#include "postprocess/report_html.h"
#include "shown_numbers.h"
#include "visualization/energy_lines.h"

#include "core/output_folder.h"
#include "visualization/svg.h"

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  namespace
  {
    using Axis = LineChart::Axis;

    /** A table with a column per run. */
    class WideTable
    {
    public:
      explicit WideTable(const std::vector<std::string> &head)
      {
        html_ = "<thead>" + row_of(head, "th") + "</thead>\n";
      }

      void add(const std::vector<std::string> &row)
      {
        html_ += row_of(row, "td class=\"number\"");
      }

      std::string card(const std::string &title) const
      {
        return "<section class=\"card\"><h3>" + escape_markup(title) +
               "</h3>\n<table>\n" + html_ + "</table></section>\n";
      }

    private:
      static std::string row_of(const std::vector<std::string> &row,
                                const std::string &cell)
      {
        std::string html = "<tr>";
        for (std::size_t c = 0; c < row.size(); ++c) {
          const std::string open = c == 0 ? "th" : cell;
          html += "<" + open + ">" + escape_markup(row[c]) + "</" +
                  open.substr(0, 2) + ">";
        }
        return html + "</tr>\n";
      }

      std::string html_;
    };

    std::vector<std::string> page_head(const Comparison &comparison,
                                       const bool differences)
    {
      std::vector<std::string> row = {""};
      for (std::size_t k = 0; k < comparison.runs.size(); ++k)
        row.push_back(letter(k));
      for (std::size_t k = 1; differences && k < comparison.runs.size(); ++k)
        row.push_back(letter(k) + " against " + letter(0));
      return row;
    }

    std::string unit_of(const std::string &column, const Units &units)
    {
      for (const EnergyLine &line : all_lines())
        if (column == line.name)
          return units.energy;
      if (column == "work")
        return units.energy;
      if (column.compare(0, 9, "reaction_") == 0)
        return units.force;
      return column == "broken_area" ? units.area
             : column == "time_step" ? "s"
                                     : "";
    }

    LineChart curve_chart(const Comparison &comparison, const std::string &name,
                          const Units &units)
    {
      LineChart chart(readable(name), {"time", "s"},
                      {readable(name), unit_of(name, units),
                       name == "residual" || name == "ledger_defect"});
      for (std::size_t k = 0; k < comparison.runs.size(); ++k)
        if (const auto *values = comparison.runs[k].column(name))
          chart.add_line(letter(k), *comparison.runs[k].column("time"), *values,
                         LineChart::palette(unsigned(k)), k > 0);
      return chart;
    }

    LineChart fragment_chart(const Comparison &comparison)
    {
      LineChart chart("Fragments by size, at the end",
                      {"diameter of the same volume", "m", true},
                      {"fragments of this size or larger", "", true});
      for (std::size_t k = 0; k < comparison.runs.size(); ++k) {
        std::vector<double> number;
        for (std::size_t n = 1; n <= comparison.runs[k].fragment_sizes.size();
             ++n)
          number.push_back(double(n));
        chart.add_line(letter(k), comparison.runs[k].fragment_sizes, number,
                       LineChart::palette(unsigned(k)), k > 0);
      }
      return chart;
    }

    std::string diagrams(const Comparison &comparison,
                         const std::string &directory)
    {
      const Units units(comparison.runs[0].dimension,
                        comparison.runs[0].axisymmetric);
      std::string html;
      const auto add = [&](const std::string &file, const LineChart &chart) {
        write_file_atomically(directory + "/" + file + ".svg",
                              chart.svg(SvgUse::file));
        html +=
            "<figure class=\"card\">" + chart.svg(SvgUse::page) + "</figure>\n";
      };
      std::vector<std::string> drawn;
      for (const ComparedCurve &curve : comparison.curves) {
        // what is zero all the time is no picture
        if (!(curve.scale > 0.) ||
            std::find(drawn.begin(), drawn.end(), curve.name) != drawn.end())
          continue;
        drawn.push_back(curve.name);
        add(fmt::format("curve_{:02}", drawn.size()),
            curve_chart(comparison, curve.name, units));
      }
      if (std::any_of(comparison.runs.begin(), comparison.runs.end(),
                      [](const RunFolder &run) {
                        return run.fragment_sizes.size() > 1;
                      }))
        add("fragments_by_size", fragment_chart(comparison));
      return html;
    }

    std::string runs_html(const Comparison &comparison)
    {
      Table table;
      for (std::size_t k = 0; k < comparison.runs.size(); ++k) {
        const RunFolder &run = comparison.runs[k];
        table.add_text(letter(k),
                       run.name + (run.completed
                                       ? ""
                                       : ": not completed, " + run.failure));
      }
      const auto largest = comparison.largest();
      table.add_text("largest difference of results",
                     difference_text(largest.difference) +
                         (largest.name.empty() ? "" : ", " + largest.name));
      return table.card("Runs");
    }

    std::string parameters_html(const Comparison &comparison)
    {
      WideTable table(page_head(comparison, false));
      for (const ComparedParameter &entry : comparison.parameters) {
        std::vector<std::string> row = {
            entry.section + (entry.section.empty() ? "" : "/") + entry.name};
        for (const std::string &value : entry.values)
          row.push_back(value.empty() ? "not set" : value);
        table.add(row);
      }
      return comparison.parameters.empty()
                 ? ""
                 : table.card("Parameters that differ");
    }

    std::string numbers_html(const Comparison &comparison)
    {
      WideTable table(page_head(comparison, true));
      for (const ComparedNumber &number : comparison.numbers) {
        if (!is_shown(number))
          continue;
        std::vector<std::string> row = {readable(number.name)};
        for (const auto &value : number.values)
          row.push_back(value ? fmt::format("{:.6g}", *value) : "-");
        for (std::size_t k = 1; k < number.differences.size(); ++k)
          row.push_back(difference_text(number.differences[k]));
        table.add(row);
      }
      return table.card("Numbers");
    }

    std::string certificates_html(const Comparison &comparison)
    {
      const auto rows = certificate_rows(comparison);
      WideTable table(page_head(comparison, false));
      for (const auto &row : rows)
        table.add(row);
      return rows.empty() ? "" : table.card("Certificates");
    }

    std::string curves_html(const Comparison &comparison)
    {
      WideTable table({"", "run", "largest", "at t", "mean"});
      for (const ComparedCurve &curve : comparison.curves)
        if (!(curve.largest == 0.))
          table.add({readable(curve.name), letter(curve.run),
                     difference_text(curve.largest),
                     fmt::format("{:.4g}", curve.time),
                     difference_text(curve.mean)});
      return table.card("Curves that differ");
    }
  } // namespace

  void write_comparison_page(const Comparison &comparison,
                             const std::string &directory)
  {
    const std::string pictures = diagrams(comparison, directory);
    const std::string content =
        "<h1>Comparison of runs</h1>\n" +
        row_of(runs_html(comparison) + parameters_html(comparison) +
               certificates_html(comparison)) +
        section("Over time", row_of(pictures)) +
        section("Differences",
                "<p class=\"muted\">Relative to the larger value, of energies "
                "to the largest energy.</p>\n" +
                    row_of(numbers_html(comparison) + curves_html(comparison)));
    write_file_atomically(directory + "/compare.html",
                          page("Comparison of runs", content));
  }
} // namespace nsfd
