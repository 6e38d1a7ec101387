#include "nsfd/output/report.h"

#include "nsfd/output/progress.h"
#include "nsfd/output/summary_file.h"
#include "nsfd/output/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace nsfd
{
  namespace
  {
    using Colour = LineChart::Colour;

    /** An energy line: its name, where it is, and its colour in charts. */
    struct Line {
      const char *name;
      double EnergyLines::*member;
      Colour colour;
    };

    const std::vector<Line> stored_lines = {
        {"kinetic", &EnergyLines::kinetic, Colour::blue},
        {"elastic", &EnergyLines::elastic, Colour::sky},
        {"cohesive", &EnergyLines::cohesive, Colour::violet}};

    const std::vector<Line> dissipated_lines = {
        {"damage", &EnergyLines::damage, Colour::red},
        {"friction", &EnergyLines::friction, Colour::orange},
        {"viscous", &EnergyLines::viscous, Colour::olive},
        {"plastic", &EnergyLines::plastic, Colour::green},
        {"impact", &EnergyLines::impact, Colour::pink},
        {"numerical", &EnergyLines::numerical, Colour::grey}};

    std::vector<Line> all_lines()
    {
      auto lines = stored_lines;
      lines.insert(lines.end(), dissipated_lines.begin(),
                   dissipated_lines.end());
      return lines;
    }

    double sum_of(const EnergyLines &energy, const std::vector<Line> &lines)
    {
      double sum = 0.;
      for (const auto &line : lines)
        sum += energy.*line.member;
      return sum;
    }

    /** Units of a run: in two dimensions everything is per metre of depth. */
    struct Units {
      explicit Units(const unsigned int dimension)
          : energy(dimension == 3 ? "J" : "J/m"),
            force(dimension == 3 ? "N" : "N/m"),
            area(dimension == 3 ? "m²" : "m"),
            broken(dimension == 3 ? "broken area" : "broken length")
      {
      }
      std::string energy, force, area, broken;
    };

    // ------------------------------------------------------------------ charts

    struct NamedChart {
      std::string name; ///< of the file
      LineChart chart;
    };

    using Picker = std::function<double(const HistoryRow &)>;

    std::vector<double> column(const std::vector<HistoryRow> &rows,
                               const Picker &pick)
    {
      std::vector<double> values;
      values.reserve(rows.size());
      for (const auto &row : rows)
        values.push_back(pick(row));
      return values;
    }

    double largest_size(const std::vector<double> &values)
    {
      double largest = 0.;
      for (const double value : values)
        if (std::isfinite(value))
          largest = std::max(largest, std::abs(value));
      return largest;
    }

    /** The curves of a report. */
    class Charts
    {
    public:
      Charts(const std::vector<HistoryRow> &rows, const Units &units,
             const std::vector<std::string> &reaction_names,
             const unsigned int dimension)
          : rows_(rows), units_(units), reaction_names_(reaction_names),
            dimension_(dimension),
            time_(column(rows, [](const auto &row) { return row.time; })),
            // nothing was solved for the initial state
            step_(column(rows, [](const auto &row) {
              return row.step > 0 ? row.step : std::nan("");
            }))
      {
        for (const auto &line : all_lines())
          largest_energy_ =
              std::max(largest_energy_, largest_size(energy_column(line)));
        initial_energy_ = rows.empty() ? 0.
                                       : sum_of(rows[0].energy, all_lines()) -
                                             rows[0].energy.work;
      }

      double initial_energy() const { return initial_energy_; }

      /** All lines stacked; their top is the initial energy plus the work. */
      NamedChart energy_stack() const
      {
        LineChart chart("Where the energy is", time_axis(),
                        {"energy", units_.energy});
        std::vector<double> top(rows_.size(), 0.), bottom(rows_.size(), 0.);
        for (const auto &line : all_lines()) {
          const auto values = energy_column(line);
          if (negligible(values))
            continue;
          // what is negative is stacked below zero
          std::vector<double> lower(values.size()), upper(values.size());
          for (std::size_t i = 0; i < values.size(); ++i) {
            double &level = values[i] < 0. ? bottom[i] : top[i];
            lower[i] = level;
            level += std::isfinite(values[i]) ? values[i] : 0.;
            upper[i] = std::isfinite(values[i]) ? level : values[i];
          }
          chart.add_band(line.name, time_, lower, upper, line.colour);
        }
        chart.add_line("initial + work", time_,
                       column(rows_,
                              [this](const auto &row) {
                                return initial_energy_ + row.energy.work;
                              }),
                       Colour::ink, true);
        return {"energies", chart};
      }

      NamedChart energy_lines() const
      {
        LineChart chart("Energy lines", time_axis(), {"energy", units_.energy});
        for (const auto &line : stored_lines)
          if (const auto values = energy_column(line); !negligible(values))
            chart.add_line(line.name, time_, values, line.colour);
        chart.add_line("dissipated", time_,
                       column(rows_,
                              [](const auto &row) {
                                return sum_of(row.energy, dissipated_lines);
                              }),
                       Colour::red);
        chart.add_line(
            "work", time_,
            column(rows_, [](const auto &row) { return row.energy.work; }),
            Colour::ink, true);
        return {"energy_lines", chart};
      }

      NamedChart dissipated() const
      {
        LineChart chart("Dissipated energy", time_axis(),
                        {"energy", units_.energy});
        bool any = false;
        for (const auto &line : dissipated_lines)
          if (const auto values = energy_column(line); !negligible(values)) {
            chart.add_line(line.name, time_, values, line.colour);
            any = true;
          }
        if (!any)
          chart.add_line("nothing", time_,
                         std::vector<double>(rows_.size(), 0.), Colour::grey);
        return {"dissipated", chart};
      }

      NamedChart broken_area() const
      {
        return single(
            "broken_area",
            units_.broken == "broken area" ? "Broken area" : "Broken length",
            time_axis(), time_, {units_.broken, units_.area}, Colour::red,
            [](const auto &row) { return row.broken_area; });
      }

      NamedChart fragments() const
      {
        return single("fragments", "Fragments", time_axis(), time_,
                      {"number", ""}, Colour::green,
                      [](const auto &row) { return row.fragments; });
      }

      NamedChart active() const
      {
        return single("active_points", "Points in contact or softening",
                      time_axis(), time_, {"points", ""}, Colour::green,
                      [](const auto &row) { return row.active; });
      }

      NamedChart reactions() const
      {
        LineChart chart("Reactions of driven boundaries", time_axis(),
                        {"force", units_.force});
        std::vector<std::pair<std::string, std::vector<double>>> columns;
        double largest = 0.;
        for (std::size_t i = 0; i < reaction_names_.size(); ++i)
          for (unsigned int d = 0; d < dimension_; ++d) {
            const std::size_t entry = i * dimension_ + d;
            columns.emplace_back(reaction_names_[i] + ' ' + "xyz"[d],
                                 column(rows_, [entry](const auto &row) {
                                   return entry < row.reactions.size()
                                              ? row.reactions[entry]
                                              : std::nan("");
                                 }));
            largest = std::max(largest, largest_size(columns.back().second));
          }
        // components that are only rounding are left out
        unsigned int n = 0;
        for (const auto &[name, values] : columns)
          if (largest == 0. || largest_size(values) > 1e-10 * largest) {
            chart.add_line(name, time_, values, LineChart::palette(n), n >= 8);
            ++n;
          }
        return {"reactions", chart};
      }

      NamedChart step_size() const
      {
        return single("step_size", "Step size", step_axis(), step_,
                      {"step", "s"}, Colour::blue,
                      [](const auto &row) { return row.time_step; });
      }

      NamedChart newton() const
      {
        return single("newton", "Newton iterations per step", step_axis(),
                      step_, {"iterations", ""}, Colour::blue,
                      [](const auto &row) { return row.newton; });
      }

      NamedChart krylov() const
      {
        return single("krylov", "Krylov iterations per step", step_axis(),
                      step_, {"iterations", ""}, Colour::violet,
                      [](const auto &row) { return row.krylov; });
      }

      NamedChart accuracy() const
      {
        LineChart chart("Residual and ledger defect", step_axis(),
                        {"relative", "", true});
        chart.add_line(
            "residual of the contact problem", step_,
            column(rows_, [](const auto &row) { return row.residual; }),
            Colour::blue);
        chart.add_line(
            "ledger defect", step_,
            column(rows_,
                   [](const auto &row) { return std::abs(row.ledger_defect); }),
            Colour::orange);
        return {"accuracy", chart};
      }

    private:
      static LineChart::Axis time_axis() { return {"time", "s"}; }
      static LineChart::Axis step_axis() { return {"step", ""}; }

      std::vector<double> energy_column(const Line &line) const
      {
        return column(rows_,
                      [&](const auto &row) { return row.energy.*line.member; });
      }

      /** Zero but for rounding, compared with the largest energy. */
      bool negligible(const std::vector<double> &values) const
      {
        return largest_size(values) <= 1e-11 * largest_energy_;
      }

      NamedChart single(const std::string &name, const std::string &title,
                        const LineChart::Axis &x_axis,
                        const std::vector<double> &x,
                        const LineChart::Axis &y_axis, const Colour colour,
                        const Picker &pick) const
      {
        LineChart chart(title, x_axis, y_axis);
        chart.add_line(y_axis.label, x, column(rows_, pick), colour);
        return {name, chart};
      }

      const std::vector<HistoryRow> &rows_;
      const Units &units_;
      const std::vector<std::string> &reaction_names_;
      unsigned int dimension_;
      std::vector<double> time_, step_;
      double largest_energy_ = 0., initial_energy_ = 0.;
    };

    // -------------------------------------------------------------------- HTML

    const char *const page_style = R"css(
:root{color-scheme:light dark;--back:#f5f6f8;--card:#fff;--ink:#1c2128;
--muted:#5b636e;--line:#dfe3e8;--good:#12734a;--good-back:#e2f4ea;
--bad:#a8281a;--bad-back:#fdeae6;--bar:#8bb8dc}
@media screen and (prefers-color-scheme:dark){:root{--back:#12151a;
--card:#1b1f26;--ink:#e6e9ee;--muted:#a4acb8;--line:#323943;--good:#6fdca6;
--good-back:#15352a;--bad:#ff9d86;--bad-back:#43211b;--bar:#2f5f86}}
*{box-sizing:border-box}
body{margin:0;background:var(--back);color:var(--ink);
font:15px/1.5 system-ui,'Segoe UI',Roboto,Helvetica,Arial,sans-serif}
main{max-width:1240px;margin:0 auto;padding:20px 16px 40px}
h1{font-size:1.6rem;line-height:1.25;margin:0 0 .4rem}
h2{font-size:1.15rem;margin:2rem 0 .6rem}
h3{font-size:1rem;margin:0 0 .5rem}
p{margin:.4rem 0;max-width:75ch}
.muted{color:var(--muted)}
.state{display:inline-block;border-radius:6px;padding:.45rem .8rem;
margin:.5rem 0;font-weight:600;overflow-wrap:anywhere}
.good{color:var(--good)}.bad{color:var(--bad)}
.state.good{background:var(--good-back)}.state.bad{background:var(--bad-back)}
.row{display:grid;gap:14px;align-items:start;
grid-template-columns:repeat(auto-fill,minmax(min(100%,370px),1fr))}
.columns{columns:370px;column-gap:14px}
.columns>.card{break-inside:avoid;margin-bottom:14px}
.card{background:var(--card);border:1px solid var(--line);border-radius:8px;
padding:12px;margin:0;overflow-x:auto}
.card svg{display:block;width:100%;height:auto;max-width:620px;margin:0 auto}
table{border-collapse:collapse;width:100%}
th,td{text-align:left;padding:.28rem .5rem .28rem 0;vertical-align:top;
border-bottom:1px solid var(--line);font-weight:400}
tr:last-child>th,tr:last-child>td{border-bottom:0}
th{color:var(--muted)}thead th{font-size:.85rem}
td.number{text-align:right;white-space:nowrap;
font-variant-numeric:tabular-nums;color:var(--ink)}
tr.sum>th,tr.sum>td{font-weight:600;color:var(--ink);
border-top:1px solid var(--muted)}
tr.group>th{font-size:.85rem;font-weight:600;padding-top:.6rem;border-bottom:0;
color:var(--ink)}
td.remark{color:var(--muted);font-size:.88rem}
td.text{overflow-wrap:anywhere}
.share,.state{print-color-adjust:exact;-webkit-print-color-adjust:exact}
.share{display:block;height:8px;border-radius:2px;background:var(--bar);
min-width:1px;margin-top:.45rem}
td.bar{width:32%;padding-right:0}
details{margin-top:.5rem}summary{cursor:pointer;font-weight:600}
pre{overflow-x:auto;background:var(--card);border:1px solid var(--line);
border-radius:8px;padding:12px;font:12.5px/1.45 ui-monospace,Menlo,Consolas,
'DejaVu Sans Mono',monospace}
a{color:inherit}
@media print{body{background:#fff;font-size:11px}main{padding:0}
.card{break-inside:avoid;border-color:#ccc}
.row{grid-template-columns:repeat(2,1fr)}h2{break-after:avoid}
pre{white-space:pre-wrap}}
)css";

    /** 12 480 with a narrow space. */
    std::string count(const double value)
    {
      if (!std::isfinite(value) || value != std::floor(value) ||
          std::abs(value) >= 1e15)
        return engineering(value, "", 4);
      std::string text = fmt::format("{:.0f}", value);
      for (int i = static_cast<int>(text.size()) - 3;
           i > (value < 0. ? 1 : 0) && std::abs(value) >= 1e4; i -= 3)
        text.insert(i, "\u202f");
      return text;
    }

    /** "1 step", "2 steps" */
    std::string count(const double n, const std::string &noun)
    {
      return count(n) + ' ' + noun + (n == 1. ? "" : "s");
    }

    std::string readable(std::string key)
    {
      std::replace(key.begin(), key.end(), '_', ' ');
      return key;
    }

    /** A relative quantity. */
    std::string relative(const double value)
    {
      return value == 0. ? "0" : engineering(value, "", 2);
    }

    std::string percent(const double share)
    {
      return std::isfinite(share) ? fmt::format("{:.1f} %", 100. * share)
                                  : "n/a";
    }

    enum class Verdict { none, good, bad };

    /** A table of one line per quantity: name, value, remark. */
    class Table
    {
    public:
      void add(const std::string &name, const std::string &value,
               const std::string &remark = "",
               const Verdict verdict = Verdict::none)
      {
        const char *mark = verdict == Verdict::good ? "<b class=\"good\">✓</b> "
                           : verdict == Verdict::bad ? "<b class=\"bad\">⚠</b> "
                                                     : "";
        rows_ += fmt::format("<tr><th>{}</th><td class=\"number\">{}</td>"
                             "<td class=\"remark\">{}{}</td></tr>\n",
                             escape_markup(name), escape_markup(value), mark,
                             escape_markup(remark));
      }

      void add_sum(const std::string &name, const std::string &value)
      {
        rows_ += fmt::format("<tr class=\"sum\"><th>{}</th>"
                             "<td class=\"number\">{}</td><td></td></tr>\n",
                             escape_markup(name), escape_markup(value));
      }

      void add_group(const std::string &name)
      {
        rows_ += "<tr class=\"group\"><th colspan=\"3\">" +
                 escape_markup(name) + "</th></tr>\n";
      }

      /** A bar of @p share of the width next to the value. */
      void add_share(const std::string &name, const std::string &value,
                     const double share)
      {
        rows_ += fmt::format(
            "<tr><th>{}</th><td class=\"number\">{}</td>"
            "<td class=\"number\">{}</td><td class=\"bar\">"
            "<span class=\"share\" style=\"width:{:.1f}%\"></span></td></tr>\n",
            escape_markup(name), escape_markup(value), percent(share),
            std::isfinite(share) ? 100. * std::clamp(share, 0., 1.) : 0.);
      }

      void add_text(const std::string &name, const std::string &text)
      {
        if (!text.empty())
          rows_ +=
              fmt::format("<tr><th>{}</th><td class=\"text\">{}</td></tr>\n",
                          escape_markup(name), escape_markup(text));
      }

      bool empty() const { return rows_.empty(); }

      /** Nothing if there is no line. */
      std::string card(const std::string &title) const
      {
        if (empty())
          return "";
        return "<section class=\"card\"><h3>" + escape_markup(title) +
               "</h3>\n<table>\n" + rows_ + "</table></section>\n";
      }

    private:
      std::string rows_;
    };

    std::string section(const std::string &title, const std::string &content)
    {
      return "<h2>" + escape_markup(title) + "</h2>\n" + content;
    }

    std::string columns_of(const std::string &cards)
    {
      return "<div class=\"columns\">\n" + cards + "</div>\n";
    }

    std::string row_of(const std::string &cards)
    {
      return "<div class=\"row\">\n" + cards + "</div>\n";
    }

    /** Writes each picture as a file and returns it as part of the page. */
    class Figures
    {
    public:
      explicit Figures(const std::string &directory) : directory_(directory) {}

      template <typename Drawing>
      std::string figure(const std::string &name, const Drawing &draw,
                         const bool on_page = true)
      {
        write_file_atomically(directory_ + name + ".svg", draw(SvgUse::file));
        names_.push_back(name + ".svg");
        return on_page ? "<figure class=\"card\">" + draw(SvgUse::page) +
                             "</figure>\n"
                       : "";
      }

      std::string figure(const NamedChart &named)
      {
        return figure(named.name,
                      [&](const SvgUse use) { return named.chart.svg(use); });
      }

      const std::vector<std::string> &names() const { return names_; }

    private:
      std::string directory_;
      std::vector<std::string> names_;
    };

    /** Paragraphs are separated by empty lines. */
    std::string paragraphs(const std::string &text)
    {
      std::string html;
      std::size_t begin = 0;
      while (begin < text.size()) {
        const std::size_t end = std::min(text.find("\n\n", begin), text.size());
        if (end > begin)
          html +=
              "<p>" + escape_markup(text.substr(begin, end - begin)) + "</p>\n";
        begin = end + 2;
      }
      return html;
    }

    std::string title_of(const Report &report)
    {
      if (!report.title.empty())
        return report.title;
      return report.info.file.empty() ? "A run of nsfd" : report.info.file;
    }

    std::string headline(const Report &report)
    {
      const Summary &s = report.summary;
      const std::string title = title_of(report);
      const std::string at = count(s.steps, "step") +
                             " up to t = " + engineering(s.final_time, "s", 4);

      std::string html = "<h1>" + escape_markup(title) + "</h1>\n";
      html += paragraphs(report.description);
      if (s.completed)
        html += "<p class=\"state good\">✓ Completed: " + escape_markup(at) +
                " in " + Progress::duration(s.wall_seconds) + "</p>\n";
      else
        html += "<p class=\"state bad\">⚠ Stopped before the end, after " +
                escape_markup(at) + ". " +
                escape_markup(s.failure.empty() ? "No reason was recorded."
                                                : s.failure) +
                "</p>\n<p class=\"muted\">Everything below describes the "
                "steps that were accepted.</p>\n";
      html += fmt::format("<p class=\"muted\">{}D · {} · {} · {}</p>\n",
                          s.dimension, count(s.cells, "cell"),
                          count(s.dofs, "unknown") + " of motion",
                          count(s.interface_points, "interface point"));
      return html;
    }

    /** The strip, with the same scales in all pictures. */
    std::string body_pictures(const Report &report, Figures &figures)
    {
      // what a page can hold and a browser draws at once
      const std::size_t max_pictures = 9, max_polygons = 60000,
                        max_polygons_of_one = 200000;
      const auto &snapshots = report.snapshots;
      if (snapshots.empty())
        return "";

      std::size_t n_polygons = 1;
      for (const auto &snapshot : snapshots)
        n_polygons = std::max(n_polygons, snapshot.polygons.size());
      if (n_polygons > max_polygons_of_one)
        return section("The body over time",
                       "<p>" + count(n_polygons) +
                           " cells are too many for pictures on a page; see "
                           "fields.pvd.</p>\n");
      const std::size_t n_shown =
          std::min({snapshots.size(), max_pictures,
                    std::max<std::size_t>(1, max_polygons / n_polygons)});

      // evenly over the series, always with the last one
      std::vector<bool> shown(snapshots.size(), false);
      shown.back() = true;
      for (std::size_t i = 0; i + 1 < n_shown; ++i)
        shown[i * (snapshots.size() - 1) / (n_shown - 1)] = true;

      const PictureOptions options = picture_options(snapshots);
      std::string strip;
      for (std::size_t i = 0; i < snapshots.size(); ++i)
        strip += figures.figure(
            fmt::format("deformed_{:03}", i),
            [&](const SvgUse use) {
              return body_picture(snapshots[i], options, use);
            },
            shown[i]);

      if (report.summary.fragments > 1) {
        PictureOptions by_fragment = options;
        by_fragment.colouring = PictureOptions::Colouring::fragment;
        strip += figures.figure("fragments_final", [&](const SvgUse use) {
          return body_picture(snapshots.back(), by_fragment, use);
        });
      }
      std::string note;
      if (n_shown < snapshots.size())
        note = fmt::format("<p class=\"muted\">{} of {} pictures; the others "
                           "are in the files deformed_*.svg.</p>\n",
                           n_shown, snapshots.size());
      return section("The body over time", note + row_of(strip));
    }

    std::string key_numbers(const Report &report, const Units &units)
    {
      const Summary &s = report.summary;
      const EnergyLines &e = s.energy;
      const auto energy = [&](const double value) {
        return engineering(value, units.energy, 4);
      };

      Table physics;
      const double broken =
          report.history.empty() ? 0. : report.history.back().broken_area;
      if (!report.history.empty())
        physics.add(units.broken, engineering(broken, units.area, 4),
                    s.dimension == 3 ? "" : "area per metre of depth");
      physics.add("fragments", count(s.fragments));
      physics.add("work of loads", energy(e.work));
      physics.add("simulated time", engineering(s.final_time, "s", 4));
      physics.add_group("dissipated by");
      for (const auto &line : dissipated_lines) {
        const double value = e.*line.member;
        const bool damage = line.member == &EnergyLines::damage;
        if (value == 0. && !damage)
          continue;
        physics.add(line.name, energy(value),
                    damage && broken > 0.
                        ? "per broken area: " +
                              engineering(value / broken, "J/m²", 4)
                        : "");
      }

      Table certificate;
      const auto within = [](const bool holds) {
        return holds ? Verdict::good : Verdict::bad;
      };
      certificate.add("worst ledger defect", relative(s.ledger_defect_max),
                      std::abs(s.ledger_defect_max) <= 1e-9
                          ? "below 10⁻⁹ of the largest energy"
                          : "not below 10⁻⁹ of the largest energy",
                      within(std::abs(s.ledger_defect_max) <= 1e-9));
      certificate.add("worst residual", relative(s.residual_max),
                      "relative, over all accepted steps");
      if (s.penetration_bound > 0.)
        certificate.add(
            "penetration", engineering(s.penetration_max, "m"),
            fmt::format("{:.2g} of the bound {}",
                        s.penetration_max / s.penetration_bound,
                        engineering(s.penetration_bound, "m")),
            within(s.penetration_max <= s.penetration_bound * (1. + 1e-9)));
      else
        certificate.add("penetration", engineering(s.penetration_max, "m"));
      if (s.positive_friction_work != 0.)
        certificate.add("positive friction work",
                        energy(s.positive_friction_work),
                        "energy that friction created");
      if (s.rigid_drift_max != 0.)
        certificate.add("drift of rigid rows",
                        engineering(s.rigid_drift_max, "m"));
      certificate.add("steps", count(s.steps),
                      s.steps > 0 ? "mean step " +
                                        engineering(s.final_time / s.steps, "s")
                                  : "");
      certificate.add("wall time", Progress::duration(s.wall_seconds),
                      s.setup_seconds > 0.
                          ? "of it " + Progress::duration(s.setup_seconds) +
                                " to set up"
                          : "");
      certificate.add("largest memory",
                      fmt::format("{:.0f} MB", s.peak_memory_mb));

      Table errors;
      for (const auto &[name, value] : s.errors)
        errors.add(readable(name), engineering(value, "", 4));
      return section("Key numbers",
                     row_of(physics.card("What happened") +
                            certificate.card("How far to trust it") +
                            errors.card("Errors against exact values")));
    }

    std::string ledger(const Report &report, const Units &units,
                       const double initial_energy)
    {
      const EnergyLines &e = report.summary.energy;
      double largest = std::abs(e.work);
      for (const auto &line : all_lines())
        largest = std::max(largest, std::abs(e.*line.member));
      const auto energy = [&](const double value) {
        return engineering(value, units.energy, 4);
      };

      Table account;
      const auto add_lines = [&](const char *kind,
                                 const std::vector<Line> &lines) {
        account.add_group(kind);
        for (const auto &line : lines)
          account.add(line.name, energy(e.*line.member),
                      e.*line.member == 0. ? ""
                                           : percent(e.*line.member / largest));
      };
      add_lines("stored", stored_lines);
      add_lines("dissipated", dissipated_lines);
      const double sum = sum_of(e, all_lines());
      account.add_sum("sum", energy(sum));
      account.add_group("against");
      if (!report.history.empty())
        account.add("initial energy", energy(initial_energy),
                    report.history.front().step == 0 ? ""
                                                     : "from the first row");
      account.add("work of loads", energy(e.work));
      if (!report.history.empty())
        account.add_sum("difference", energy(sum - initial_energy - e.work));
      account.add("worst defect", relative(report.summary.ledger_defect_max),
                  "relative, all steps");
      return account.card("Energy ledger at t = " +
                          engineering(report.summary.final_time, "s", 4));
    }

    std::string cost(const Report &report)
    {
      const Summary &s = report.summary;
      Table timings;
      double sum = 0.;
      for (const auto &timing : s.timings)
        sum += timing.second;
      const double total = std::max(sum, s.cpu_seconds);
      for (const auto &[name, seconds] : s.timings)
        timings.add_share(readable(name), fmt::format("{:.3f} s", seconds),
                          seconds / total);
      if (!s.timings.empty() && total > 1.0005 * sum)
        timings.add_share("all else", fmt::format("{:.3f} s", total - sum),
                          (total - sum) / total);

      Table counters;
      for (const auto &[name, value] : s.counters)
        counters.add(readable(name), count(value),
                     s.steps > 0 && value >= s.steps
                         ? engineering(value / s.steps, "") + " per step"
                         : "");
      const std::string cards =
          timings.card(
              fmt::format("CPU time by part of the step, {:.3g} s", total)) +
          counters.card("Counters");
      return cards.empty() ? "" : section("Cost", row_of(cards));
    }

    std::string how_it_was_run(const Report &report)
    {
      const RunInfo &info = report.info;
      Table run;
      run.add_text("command", info.command_line);
      run.add_text("file", info.file);
      run.add_text("date", info.date);
      run.add_text("machine",
                   info.host + ", " +
                       (info.ranks == 1 ? "1 process"
                                        : count(info.ranks) + " processes"));
      run.add_text("nsfd",
                   info.version +
                       (info.git_hash.empty() ? "" : ", " + info.git_hash) +
                       (info.build_type.empty() ? "" : ", " + info.build_type));
      std::string libraries;
      for (const auto &[name, version] : info.libraries)
        libraries += (libraries.empty() ? "" : ", ") + name + ' ' + version;
      run.add_text("libraries", libraries);
      std::string seeds;
      for (const unsigned int seed : info.seeds)
        seeds += (seeds.empty() ? "" : ", ") + std::to_string(seed);
      run.add_text("seeds", seeds);

      Table parts;
      for (const auto &[kind, name] : info.parts)
        parts.add_text(kind, name);
      std::string html = section(
          "How it was run",
          row_of(run.card("Run") + parts.card("Parts that were built")));
      if (!report.parameters.empty())
        html += "<details><summary>All parameters (running them again "
                "reproduces the run)</summary>\n<pre>" +
                escape_markup(report.parameters) + "</pre></details>\n";
      return html;
    }
  } // namespace

  std::vector<std::string> write_report(const std::string &path,
                                        const Report &report)
  {
    const std::size_t slash = path.find_last_of('/');
    Figures figures(slash == std::string::npos ? ""
                                               : path.substr(0, slash + 1));
    const unsigned int dimension = report.summary.dimension;
    const Units units(dimension);
    const Charts charts(report.history, units, report.reaction_names,
                        dimension);

    std::string html = headline(report);
    html += body_pictures(report, figures);
    html += key_numbers(report, units);

    std::string curves = figures.figure(charts.energy_stack()) +
                         figures.figure(charts.energy_lines()) +
                         figures.figure(charts.dissipated()) +
                         figures.figure(charts.broken_area());
    if (!report.reaction_names.empty())
      curves += figures.figure(charts.reactions());
    if (report.summary.fragments > 1)
      curves += figures.figure(charts.fragments());
    curves += figures.figure(charts.active());
    html += section("Over time", row_of(curves));

    html += section("Balance and solver",
                    columns_of(ledger(report, units, charts.initial_energy()) +
                               figures.figure(charts.accuracy()) +
                               figures.figure(charts.step_size()) +
                               figures.figure(charts.newton()) +
                               figures.figure(charts.krylov())));
    html += cost(report);
    html += how_it_was_run(report);

    html += "<p class=\"muted\">Single pictures next to this page: ";
    for (const auto &name : figures.names())
      html += "<a href=\"" + escape_markup(name) + "\">" + escape_markup(name) +
              "</a> ";
    html += "</p>\n";

    const std::string title = title_of(report);
    write_file_atomically(
        path, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
              "<meta charset=\"utf-8\">\n"
              "<meta name=\"viewport\" content=\"width=device-width, "
              "initial-scale=1\">\n<title>" +
                  escape_markup(title) + " - nsfd</title>\n<style>" +
                  page_style + svg_style() +
                  "@media screen and (prefers-color-scheme:dark){:root{" +
                  svg_dark_colours() + "}}</style>\n</head>\n<body>\n<main>\n" +
                  html + "</main>\n</body>\n</html>\n");
    return figures.names();
  }
} // namespace nsfd
