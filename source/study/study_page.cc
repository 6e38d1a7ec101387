#include "cost_comparison.h"
#include "distribution.h"
#include "rank_scaling.h"
#include "study_means.h"

#include "postprocess/report_html.h"

#include "core/output_folder.h"
#include "records/engineering.h"
#include "study_results.h"
#include "visualization/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

namespace nsfd
{
  namespace
  {
    using Axis = LineChart::Axis;

    std::vector<double> values(const std::vector<StudyPoint> &points,
                               double StudyPoint::*member)
    {
      std::vector<double> result;
      for (const StudyPoint &point : points)
        result.push_back(point.*member);
      return result;
    }

    const char *const cpu_label = "CPU time of the solve";

    /** Each value by itself: gaps in between, so that only dots are drawn. */
    std::vector<double> with_gaps(const std::vector<double> &data)
    {
      std::vector<double> result;
      for (const double value : data) {
        result.push_back(value);
        result.push_back(std::numeric_limits<double>::quiet_NaN());
      }
      return result;
    }

    /**
     * All points of an error over one of their numbers as dots; lines are the
     * lower envelopes of what is compared. Over the time also that of all.
     */
    LineChart error_chart(const StudyResults &study, const std::string &error,
                          const Axis &x, double StudyPoint::*member,
                          const bool is_time)
    {
      LineChart chart(readable(error), x, {"relative error", "", true});
      const auto envelope = [member](std::vector<StudyPoint> points) {
        for (StudyPoint &point : points)
          point.seconds = point.*member;
        return lower_envelope(points);
      };
      const std::vector<StudyGroup> groups = groups_of(study, error);
      if (is_time && groups.size() > 1) {
        const auto lowest = lower_envelope(all_points(study, error));
        chart.add_line("lower envelope", values(lowest, &StudyPoint::seconds),
                       values(lowest, &StudyPoint::error),
                       LineChart::Colour::ink, true);
      }
      unsigned int colour = 0;
      for (const StudyGroup &group : groups) {
        const auto lowest = envelope(group.points);
        const auto shade = LineChart::palette(colour++);
        chart.add_line(group.name.empty() ? "error" : group.name,
                       values(lowest, &StudyPoint::seconds),
                       values(lowest, &StudyPoint::error), shade);
        chart.add_line("", with_gaps(values(group.points, member)),
                       with_gaps(values(group.points, &StudyPoint::error)),
                       shade);
      }
      return chart;
    }

    /** Quantities of all cases as dots, in the order of the abscissa. */
    LineChart quantity_chart(const StudyResults &study,
                             const StudyDiagram &diagram)
    {
      LineChart chart("Over " + readable(diagram.abscissa),
                      {readable(diagram.abscissa), "", true},
                      {readable(diagram.ordinates.front()), "", false});
      unsigned int colour = 0;
      for (const std::string &name : diagram.ordinates) {
        std::map<double, double> places;
        for (const CaseResult &result : study.results) {
          const auto x = result.errors.find(diagram.abscissa),
                     y = result.errors.find(name);
          if (is_done(result) && x != result.errors.end() &&
              y != result.errors.end() && x->second > 0.)
            places.emplace(x->second, y->second);
        }
        std::vector<double> x, y;
        for (const auto &[at, value] : places) {
          x.push_back(at);
          y.push_back(value);
        }
        chart.add_line(readable(name), with_gaps(x), with_gaps(y),
                       LineChart::palette(colour++));
      }
      return chart;
    }

    /** A line of the expected order, below the coarsest point. */
    void add_expected(LineChart &chart, const StudyOrder &order)
    {
      if (!order.expected || order.points.size() < 2)
        return;
      const StudyPoint &coarse = order.points.front();
      const double share = order.points.back().size / coarse.size;
      constexpr unsigned int n = 30; // many points are drawn without dots
      std::vector<double> size, error;
      for (unsigned int i = 0; i < n; ++i) {
        const double ratio = std::pow(share, double(i) / (n - 1));
        size.push_back(coarse.size * ratio);
        error.push_back(0.5 * coarse.error * std::pow(ratio, *order.expected));
      }
      chart.add_line(fmt::format("order {:.3g}", *order.expected), size, error,
                     LineChart::Colour::grey, true);
    }

    /** Errors over the size with lines of the expected orders. */
    LineChart order_chart(const StudyResults &study, const std::string &error)
    {
      LineChart chart(readable(error) + ": order",
                      {size_label(study), "", true},
                      {"relative error", "", true});
      const std::vector<StudyOrder> orders = orders_of(study);
      for (const StudyOrder &order : orders)
        if (order.error == error)
          add_expected(chart, order);
      unsigned int colour = 0;
      for (const StudyOrder &order : orders)
        if (order.error == error)
          chart.add_line(order.series.empty() ? "error" : order.series,
                         values(order.points, &StudyPoint::size),
                         values(order.points, &StudyPoint::error),
                         LineChart::palette(colour++));
      return chart;
    }

    /** A number of each case over its CPU time. */
    LineChart balance_chart(const StudyResults &study, const std::string &title,
                            const std::string &label,
                            const std::function<double(const CaseResult &)> &y)
    {
      LineChart chart(title, {cpu_label, "s", true}, {label, "", true});
      unsigned int colour = 0;
      const std::vector<std::string> errors = shown_errors(study);
      for (const StudyGroup &group :
           groups_of(study, errors.empty() ? "" : errors[0])) {
        std::vector<double> seconds, number;
        for (const std::size_t k : group.cases)
          if (is_done(study.results[k])) {
            seconds.push_back(solve_median(study.results[k]));
            number.push_back(y(study.results[k]));
          }
        chart.add_line(group.name.empty() ? label : group.name,
                       with_gaps(seconds), with_gaps(number),
                       LineChart::palette(colour++));
      }
      return chart;
    }

    /** How often a quantity was in which interval, for each setting. */
    LineChart histogram_chart(const std::vector<StudyMean> &means)
    {
      LineChart chart(readable(means.front().error) + ": how often",
                      {readable(means.front().error), ""}, {"runs", ""});
      unsigned int colour = 0;
      for (const StudyMean &mean : means) {
        const Histogram histogram = histogram_of(mean.values);
        std::vector<double> x = {histogram.edges.front()}, y = {0.};
        for (std::size_t i = 0; i < histogram.counts.size(); ++i)
          for (const double edge :
               {histogram.edges[i], histogram.edges[i + 1]}) {
            x.push_back(edge);
            y.push_back(histogram.counts[i]);
          }
        x.push_back(histogram.edges.back());
        y.push_back(0.);
        const std::vector<double> floor(x.size(), 0.);
        chart.add_band(mean.setting, x, floor, y, LineChart::palette(colour++));
      }
      return chart;
    }

    /** Straight where a distribution is that of Weibull; lines are the fits. */
    LineChart weibull_chart(const std::vector<StudyMean> &means)
    {
      LineChart chart(readable(means.front().error) + ": Weibull plot",
                      {"ln(" + readable(means.front().error) + ")", ""},
                      {"ln(-ln(1 - share of the runs below))", ""});
      unsigned int colour = 0;
      for (const StudyMean &mean : means) {
        const auto shade = LineChart::palette(colour++);
        std::vector<double> x, y;
        for (const double value : mean.values)
          x.push_back(std::log(value));
        for (const double rank : median_ranks(mean.values.size()))
          y.push_back(std::log(-std::log1p(-rank)));
        chart.add_line(mean.setting, with_gaps(x), with_gaps(y), shade);
        if (const auto fit = weibull_fit(mean.values)) {
          std::vector<double> line;
          for (const double at : x)
            line.push_back(fit->shape * (at - std::log(fit->scale)));
          chart.add_line(fmt::format("shape {:.3g}", fit->shape), x, line,
                         shade, true);
        }
      }
      return chart;
    }

    /** Of a quantity: "dissipated/damage" is no folder. */
    std::string file_name(std::string quantity)
    {
      std::replace(quantity.begin(), quantity.end(), '/', '_');
      return quantity;
    }

    class Diagrams
    {
    public:
      explicit Diagrams(const std::string &directory) : directory_(directory) {}

      void add(const std::string &name, const LineChart &chart)
      {
        write_file_atomically(directory_ + "/" + name + ".svg",
                              chart.svg(SvgUse::file));
        html_ +=
            "<figure class=\"card\">" + chart.svg(SvgUse::page) + "</figure>\n";
      }

      std::string html() const { return row_of(html_); }

    private:
      std::string directory_, html_;
    };

    std::string cells(const std::vector<std::string> &row, const char *tag)
    {
      std::string html = "<tr>";
      for (const std::string &cell : row)
        html += fmt::format("<{0}>{1}</{0}>", tag, escape_markup(cell));
      return html + "</tr>\n";
    }

    std::string table(const std::vector<std::string> &head,
                      const std::vector<std::vector<std::string>> &rows)
    {
      std::string html = "<section class=\"card\"><table><thead>" +
                         cells(head, "th") + "</thead>\n";
      for (const auto &row : rows)
        html += cells(row, "td");
      return html + "</table></section>\n";
    }

    std::string headline(const StudyResults &study)
    {
      std::string html = "<h1>" + escape_markup(study.input.title) + "</h1>\n" +
                         paragraphs(study.input.description);
      const std::size_t n = study.results.size(),
                        done = count(study, CaseResult::Status::done);
      html += fmt::format("<p class=\"state {}\">{} of {} cases done</p>\n",
                          done == n ? "good" : "bad", done, n);
      const std::string verdict = verdict_text(study);
      if (!verdict.empty())
        html += "<p><b>Orders:</b> " + escape_markup(verdict) + "</p>\n";
      const std::vector<std::string> limits = limits_of(study);
      if (limits.empty())
        return html;
      html += "<p><b>Limit of this study:</b></p><ul>";
      for (const std::string &line : limits)
        html += "<li>" + escape_markup(line) + "</li>";
      return html + "</ul>\n";
    }

    std::string order_rows(const StudyResults &study)
    {
      std::vector<std::vector<std::string>> rows;
      for (const StudyOrder &order : orders_of(study)) {
        std::string errors, rates;
        for (const StudyPoint &point : order.points)
          errors += fmt::format("{:.2e} ", point.error);
        for (const double rate : order.fit.rates)
          rates += fmt::format("{:.2f} ", rate);
        rows.push_back({readable(order.error), order.series, errors, rates,
                        order_line(order)});
      }
      return rows.empty()
                 ? ""
                 : section("Orders of convergence in " + size_label(study),
                           table({"error", "series", "errors, coarse to fine",
                                  "rates", "verdict"},
                                 rows));
    }

    std::string cost_rows_html(const StudyResults &study)
    {
      std::vector<std::vector<std::string>> rows;
      for (const CostRow &row : cost_rows(study))
        rows.push_back(
            {fmt::format("{} = {:.2g}", readable(row.error), row.target),
             row.series, cost_text(row)});
      return rows.empty()
                 ? ""
                 : section("What an error costs",
                           table({"error", "series", "CPU time (s)"}, rows));
    }

    std::string case_rows(const StudyResults &study)
    {
      const std::vector<std::string> errors = shown_quantities(study);
      std::vector<std::string> head = {
          "case",    "status",      "unknowns",   "steps",     "Newton",
          "Krylov",  "factors",     "set-up (s)", "solve (s)", "spread",
          "repeats", "memory (MB)", "balance",    "numerical"};
      for (const std::string &error : errors)
        head.push_back(readable(error));
      std::vector<std::vector<std::string>> rows;
      for (std::size_t k = 0; k < study.cases.size(); ++k) {
        const CaseResult &r = study.results[k];
        std::vector<std::string> row = {
            setting_of(study, k),
            std::string(name_of(r.status)) +
                (is_done(r) || r.failure.empty() ? "" : ": " + r.failure),
            fmt::format("{:.0f}", r.dofs),
            fmt::format("{:.0f}", r.steps),
            fmt::format("{:.1f}", r.newton),
            fmt::format("{:.1f}", r.krylov),
            fmt::format("{:.0f} + {:.0f}", r.block_factorisations,
                        r.global_factorisations),
            fmt::format("{:.3g}", setup_median(r)),
            fmt::format("{:.3g}", solve_median(r)),
            percent(solve_spread(r)),
            fmt::format("{}", r.solve.size()),
            fmt::format("{:.0f}", r.peak_memory_mb),
            fmt::format("{:.1e}", r.balance_residual),
            fmt::format("{:.1e}", r.numerical_dissipation)};
        for (const std::string &error : errors) {
          const auto found = r.errors.find(error);
          row.push_back(found == r.errors.end()
                            ? ""
                            : fmt::format("{:.3e}", found->second));
        }
        rows.push_back(row);
      }
      return section("All cases",
                     "<p class=\"muted\">Newton and Krylov iterations are "
                     "means per step; factors are of blocks + of the whole "
                     "system; times are medians over the repeats, without "
                     "output.</p>\n" +
                         table(head, rows));
    }

    std::string means_html(const StudyResults &study)
    {
      const std::string text = means_text(study);
      return text.empty()
                 ? ""
                 : section("Means", "<pre>" + escape_markup(text) + "</pre>\n");
    }

    std::string ranks_html(const StudyResults &study)
    {
      std::vector<std::vector<std::string>> rows;
      for (const RankRow &row : rank_rows(study))
        rows.push_back(rank_cells(row));
      return rows.empty()
                 ? ""
                 : section(
                       "Ranks",
                       "<p class=\"muted\">Time of the first rank; messages, "
                       "kB and reductions per rank and step, at most; what "
                       "a copy and a small dense product gain on the same "
                       "ranks is measured at the end of each run.</p>\n" +
                           table(rank_head(), rows));
    }

    /** "1, 2, 4 ranks" */
    std::string ranks_text(const StudyResults &study)
    {
      std::set<unsigned int> ranks;
      for (const StudyCase &one : study.cases)
        ranks.insert(one.ranks);
      std::string text;
      for (const unsigned int n : ranks)
        text += fmt::format("{}{}", text.empty() ? "" : ", ", n);
      return text;
    }

    std::string provenance(const StudyResults &study)
    {
      Table table;
      table.add_text("command", study.command_line);
      table.add_text("version", study.version + " " + study.git_hash + " " +
                                    study.build_type);
      table.add_text("compiler", study.compiler);
      table.add_text("machine", fmt::format("{}, {}, {} cores", study.host,
                                            study.processor, study.cores));
      table.add_text(
          "processes",
          fmt::format("{} rank(s) of one thread per case, {} case(s) "
                      "at a time",
                      ranks_text(study), study.input.jobs));
      table.add_text("seeds", "in scene.prm of each case, if it has any");
      table.add_text("date", study.date);
      for (const std::string &warning : study.warnings)
        table.add_text("warning", warning);
      return table.card("How it was made");
    }
  } // namespace

  void write_study_page(const StudyResults &study, const std::string &directory)
  {
    Diagrams diagrams(directory);
    const std::vector<StudyMean> means = means_of(study);
    for (std::size_t first = 0, end = 0; first < means.size(); first = end) {
      while (end < means.size() && means[end].error == means[first].error)
        ++end;
      const std::vector<StudyMean> same(means.begin() + long(first),
                                        means.begin() + long(end));
      diagrams.add("histogram_" + file_name(same.front().error),
                   histogram_chart(same));
      diagrams.add("weibull_" + file_name(same.front().error),
                   weibull_chart(same));
    }
    const std::vector<std::string> errors = shown_errors(study);
    const Axis cpu = {cpu_label, "s", true}, unknowns = {"unknowns", "", true};
    constexpr std::size_t most_errors = 4;
    for (std::size_t e = 0; e < std::min(errors.size(), most_errors); ++e) {
      diagrams.add(
          "error_time_" + file_name(errors[e]),
          error_chart(study, errors[e], cpu, &StudyPoint::seconds, true));
      diagrams.add("error_unknowns_" + file_name(errors[e]),
                   error_chart(study, errors[e], unknowns,
                               &StudyPoint::unknowns, false));
      if (study.input.abscissa >= 0)
        diagrams.add("order_" + file_name(errors[e]),
                     order_chart(study, errors[e]));
    }
    diagrams.add(
        "ledger_defect",
        balance_chart(study, "Energy balance", "relative defect",
                      [](const CaseResult &r) { return r.balance_residual; }));
    diagrams.add("numerical_dissipation",
                 balance_chart(study, "Numerical dissipation",
                               "share of the energy, absolute value",
                               [](const CaseResult &r) {
                                 return std::abs(r.numerical_dissipation);
                               }));
    for (const StudyDiagram &diagram : study.input.diagrams)
      diagrams.add("diagram_" + diagram.abscissa,
                   quantity_chart(study, diagram));
    const std::string content =
        headline(study) + section("Diagrams", diagrams.html()) +
        order_rows(study) + ranks_html(study) + means_html(study) +
        cost_rows_html(study) + case_rows(study) + provenance(study) +
        "<details><summary>Section Study</summary><pre>" +
        escape_markup(study.input.echo) + "</pre></details>\n";
    write_file_atomically(directory + "/study.html",
                          page(study.input.title, content));
  }
} // namespace nsfd
