#include "report.h"

#include "report_charts.h"
#include "report_cost.h"
#include "report_html.h"
#include "visualization/body_view.h"

#include "core/output_folder.h"
#include "progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
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

    std::string title_of(const Report &report)
    {
      if (!report.title.empty())
        return report.title;
      return report.info.file.empty() ? "A run of nsfd" : report.info.file;
    }

    /** Line, value, bound and verdict; whatever is not ok comes first. */
    std::string certificate_card(const Certificate &certificate)
    {
      using Of = CertificateLine::Verdict;
      Table table;
      for (const bool is_bad : {true, false})
        for (const CertificateLine &line : certificate.lines)
          if ((line.verdict == Of::bad) == is_bad)
            table.add_judged(line.name, line.value, line.bound,
                             text_of(line.verdict),
                             line.verdict == Of::ok    ? CardVerdict::good
                             : line.verdict == Of::bad ? CardVerdict::bad
                                                       : CardVerdict::none,
                             line.remark);
      return table.card("Certificate: " + certificate.verdict());
    }

    /** What is said of a run first: that it ended, and how good it is. */
    std::string state_of(const Report &report, const std::string &at)
    {
      const Summary &s = report.summary;
      if (!s.completed)
        return "<p class=\"state bad\">⚠ Stopped before the end, after " +
               escape_markup(at) + ". " +
               escape_markup(s.failure.empty() ? "No reason was recorded."
                                               : s.failure) +
               "</p>\n<p class=\"muted\">Everything below describes the "
               "steps that were accepted.</p>\n";
      const std::string completed = "Completed: " + escape_markup(at) + " in " +
                                    Progress::duration(s.wall_seconds);
      const auto &certificate = report.findings.certificate;
      if (!certificate)
        return "<p class=\"state open\">" + completed + "</p>\n";
      const auto &lines = certificate->lines;
      const bool bad =
          std::any_of(lines.begin(), lines.end(), [](const auto &line) {
            return line.verdict == CertificateLine::Verdict::bad;
          });
      return std::string("<p class=\"state ") +
             (bad                    ? "bad\">⚠ "
              : certificate->is_ok() ? "good\">✓ "
                                     : "open\">– ") +
             completed +
             "; certificate: " + escape_markup(certificate->verdict()) +
             "</p>\n";
    }

    std::string headline(const Report &report)
    {
      const Summary &s = report.summary;
      const std::string title = title_of(report);
      const std::string at = count(s.steps, "step") +
                             " up to t = " + engineering(s.final_time, "s", 4);

      std::string html = "<h1>" + escape_markup(title) + "</h1>\n";
      html += paragraphs(report.description);
      html += state_of(report, at);
      if (report.findings.certificate)
        html += certificate_card(*report.findings.certificate);
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

      if (report.summary.heat && report.summary.heat->made > 0.) {
        const PictureOptions warmth = picture_options(
            {snapshots.back()}, PictureOptions::Colouring::warmth);
        strip += figures.figure("temperature_final", [&](const SvgUse use) {
          return body_picture(snapshots.back(), warmth, use);
        });
      }
      if (report.summary.fragments > 1) {
        PictureOptions by_fragment = options;
        by_fragment.colouring = PictureOptions::Colouring::fragment;
        strip += figures.figure("fragments_final", [&](const SvgUse use) {
          return body_picture(snapshots.back(), by_fragment, use);
        });
      }
      const auto flanks = snapshots.back().dimension == 3
                              ? crack_flanks(snapshots.back())
                              : std::vector<char>();
      if (std::count(flanks.begin(), flanks.end(), 1) > 0) {
        PictureOptions inside = options;
        inside.colouring = PictureOptions::Colouring::crack;
        strip += figures.figure("cracks_final", [&](const SvgUse use) {
          return body_picture(snapshots.back(), inside, use);
        });
      }
      std::string note;
      if (n_shown < snapshots.size())
        note = fmt::format("<p class=\"muted\">{} of {} pictures; the others "
                           "are in the files deformed_*.svg.</p>\n",
                           n_shown, snapshots.size());
      return section("The body over time", note + row_of(strip));
    }

    void add_sizes(const FragmentSizes &sizes, const Units &units, Table &table)
    {
      const auto mass = [&](const double value) {
        return engineering(value * 1e3, units.mass, 4);
      };
      const auto length = [](const double value) {
        return engineering(value, "m");
      };
      table.add("mean size", length(sizes.mean_size),
                "diameter of the same volume; weighted by mass: " +
                    length(sizes.mean_size_by_mass));
      table.add("median size", length(sizes.median_size),
                length(sizes.sizes.back()) + " to " +
                    length(sizes.sizes.front()));
      table.add("mean mass", mass(sizes.mean_mass),
                mass(sizes.smallest_mass) + " to " + mass(sizes.largest_mass));
      table.add("largest fragment",
                percent(sizes.largest_mass / sizes.total_mass),
                "of the mass " + mass(sizes.total_mass));
      if (sizes.mass_exponent)
        table.add("exponent", fmt::format("{:.3g}", *sizes.mass_exponent),
                  "b of N(m) ~ m^-b, most likely one");
      table.add("new surface", engineering(sizes.surface, units.area),
                "both sides of all cracks");
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
                    s.dimension == 3 ? ""
                    : s.axisymmetric ? "area per radian"
                                     : "area per metre of depth");
      physics.add("fragments", count(s.fragments));
      physics.add("work of loads", energy(e.work),
                  s.pressure_work
                      ? "of it pressure in cracks: " + energy(*s.pressure_work)
                      : "");
      physics.add("simulated time", engineering(s.final_time, "s", 4));
      if (s.heat)
        physics.add("hottest temperature",
                    fmt::format("{:.4g} K", s.heat->hottest),
                    "heat made: " + energy(s.heat->made));
      physics.add_group("dissipated by");
      for (const auto &line : dissipated_lines()) {
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

      Table trust;
      if (s.viscous_traction_max)
        trust.add("largest viscous traction",
                  engineering(*s.viscous_traction_max, "Pa", 4),
                  "added to the strength of the law");
      if (s.positive_friction_work != 0.)
        trust.add("positive friction work", energy(s.positive_friction_work),
                  "energy that friction created");
      if (s.rigid_drift_max != 0.)
        trust.add("drift of rigid joints", engineering(s.rigid_drift_max, "m"));
      trust.add("steps", count(s.steps),
                s.steps > 0
                    ? "mean step " + engineering(s.final_time / s.steps, "s")
                    : "");
      trust.add("wall time", Progress::duration(s.wall_seconds),
                s.setup_seconds > 0.
                    ? "of it " + Progress::duration(s.setup_seconds) +
                          " to set up"
                    : "");
      trust.add("largest memory", fmt::format("{:.0f} MB", s.peak_memory_mb));

      Table errors;
      for (const auto &[name, value] : s.errors)
        errors.add(readable(name), engineering(value, "", 4));
      Table fragments;
      if (report.findings.fragment_sizes && s.fragments > 1)
        add_sizes(*report.findings.fragment_sizes, units, fragments);
      return section("Key numbers",
                     row_of(physics.card("What happened") +
                            trust.card("How far to trust it") +
                            fragments.card("Fragments") +
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
                                 const std::vector<EnergyLine> &lines) {
        account.add_group(kind);
        for (const auto &line : lines)
          account.add(line.name, energy(e.*line.member),
                      e.*line.member == 0. ? ""
                                           : percent(e.*line.member / largest));
      };
      add_lines("stored", stored_lines());
      add_lines("dissipated", dissipated_lines());
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
      account.add("worst defect", relative(report.summary.balance_residual_max),
                  "relative, all steps");
      return account.card("Energy balance at t = " +
                          engineering(report.summary.final_time, "s", 4));
    }

    /** Columns of one unit share a chart. */
    std::string charts_of(const ObservableRecord &record, Figures &figures)
    {
      std::string html;
      std::vector<bool> drawn(record.columns.size(), false);
      unsigned int number = 0;
      for (std::size_t first = 0; first < drawn.size(); ++first) {
        if (drawn[first])
          continue;
        const std::string &unit = record.columns[first].unit;
        LineChart chart(record.name + ": " + record.type, {"time", "s"},
                        {"", unit});
        std::vector<double> time;
        for (const auto &row : record.rows)
          time.push_back(row[0]);
        unsigned int n_lines = 0;
        for (std::size_t k = first; k < drawn.size(); ++k) {
          if (record.columns[k].unit != unit)
            continue;
          drawn[k] = true;
          std::vector<double> values;
          for (const auto &row : record.rows)
            values.push_back(row[1 + k]);
          chart.add_line(record.columns[k].name, time, values,
                         LineChart::palette(n_lines), n_lines >= 8);
          ++n_lines;
        }
        html += figures.figure(
            {fmt::format("observable_{}_{}", record.name, ++number), chart});
      }
      return html;
    }

    std::string observables(const Report &report, Figures &figures)
    {
      std::string html;
      for (const ObservableRecord &record : report.summary.observables)
        if (!record.rows.empty())
          html += charts_of(record, figures);
      return html.empty() ? "" : section("Observables", row_of(html));
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
    const Units units(dimension, report.summary.axisymmetric);
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
    if (report.summary.fragments > 1 && report.findings.fragment_sizes)
      curves +=
          figures.figure(fragments_by_size(*report.findings.fragment_sizes));
    curves += figures.figure(charts.active());
    html += section("Over time", row_of(curves));

    html += observables(report, figures);
    html += section("Balance and solver",
                    columns_of(ledger(report, units, charts.initial_energy()) +
                               figures.figure(charts.accuracy()) +
                               figures.figure(charts.step_size()) +
                               figures.figure(charts.newton()) +
                               figures.figure(charts.krylov())));
    html += cost_section(report.summary);
    html += how_it_was_run(report);

    html += "<p class=\"muted\">Single pictures next to this page: ";
    for (const auto &name : figures.names())
      html += "<a href=\"" + escape_markup(name) + "\">" + escape_markup(name) +
              "</a> ";
    html += "</p>\n";

    write_file_atomically(path, page(title_of(report), html));
    return figures.names();
  }
} // namespace nsfd
