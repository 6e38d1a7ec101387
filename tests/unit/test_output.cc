// What a run leaves behind: history.csv, JSON, pictures, the report, VTU files
// and the lines on the terminal.

#include "core/output_folder.h"
#include "postprocess/history_file.h"
#include "postprocess/progress.h"
#include "postprocess/report.h"
#include "postprocess/summary_file.h"
#include "postprocess/vtu.h"
#include "visualization/svg.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

namespace test_output
{
  using namespace nsfd;

  const double nan_value = std::numeric_limits<double>::quiet_NaN();

  std::string scratch(const std::string &name)
  {
    const std::string folder = testing::TempDir() + "nsfd_test_output/";
    std::filesystem::create_directories(folder);
    return folder + name;
  }

  std::string read(const std::string &path)
  {
    std::ifstream file(path, std::ios::binary);
    EXPECT_TRUE(file) << path;
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

  std::size_t n_times(const std::string &text, const std::string &part)
  {
    std::size_t n = 0;
    for (auto at = text.find(part); at != std::string::npos;
         at = text.find(part, at + part.size()))
      ++n;
    return n;
  }

  /** Every tag is closed in order; empty if so, else the offending tag. */
  std::string unbalanced_tag(const std::string &text,
                             const std::vector<std::string> &never_closed = {})
  {
    std::vector<std::string> open;
    for (auto begin = text.find('<'); begin != std::string::npos;
         begin = text.find('<', begin)) {
      const auto end = text.find('>', begin);
      if (end == std::string::npos)
        return "'<' that is not closed";
      const std::string tag = text.substr(begin + 1, end - begin - 1);
      begin = end;
      if (tag[0] == '?' || tag[0] == '!' || tag.back() == '/')
        continue;
      const std::string name = tag.substr(
          tag[0] == '/', tag.find_first_of(" \n/>", 1) - (tag[0] == '/'));
      if (std::count(never_closed.begin(), never_closed.end(), name))
        continue;
      if (tag[0] != '/')
        open.push_back(name);
      else if (open.empty() || open.back() != tag.substr(1))
        return tag;
      else
        open.pop_back();
    }
    return open.empty() ? "" : open.back();
  }

  void expect_good_svg(const std::string &svg)
  {
    EXPECT_EQ(unbalanced_tag(svg), "");
    EXPECT_EQ(svg.find("nan"), std::string::npos) << svg;
    EXPECT_EQ(svg.find("inf"), std::string::npos) << svg;
  }

  /**
   * A plate of n x n cells, 10 um wide, torn along its middle: the halves are
   * apart by @p opening, the upper quarter of the crack is not broken yet.
   */
  Snapshot torn_plate(const unsigned int n, const double opening)
  {
    Snapshot snapshot;
    snapshot.time = 5e-9;
    const double h = 10e-6 / n;
    for (unsigned int j = 0; j < n; ++j)
      for (unsigned int i = 0; i < n; ++i) {
        Snapshot::Polygon cell;
        for (const auto &corner :
             {std::array<unsigned int, 2>{0, 0}, {1, 0}, {1, 1}, {0, 1}})
          cell.reference.push_back(
              {(i + corner[0]) * h, (j + corner[1]) * h, 0.});
        const double u = (i < n / 2 ? -0.5 : 0.5) * opening;
        cell.displacement.assign(4, {u, 0., 0.});
        cell.value = 1e8 * (i + j) / (2. * n);
        cell.fragment = i < n / 2 ? 0 : 1;
        snapshot.polygons.push_back(cell);
      }
    for (unsigned int j = 0; j < n; ++j) {
      Snapshot::FacePiece face;
      face.a = {5e-6, j * h, 0.};
      face.b = {5e-6, (j + 1) * h, 0.};
      face.displacement_a = face.displacement_b = {};
      face.can_break = true;
      face.beta = j < 3 * n / 4 ? 0. : 0.5;
      snapshot.faces.push_back(face);
    }
    return snapshot;
  }

  HistoryRow history_row(const unsigned int step)
  {
    HistoryRow row;
    row.step = step;
    row.time = 1e-11 * step;
    row.time_step = 1e-11;
    row.energy.kinetic = 0.1 + 0.2;
    row.residual = 1e-10;
    row.reactions = {1. / 3., -2.};
    return row;
  }

  // ------------------------------------------------------------------ tables

  TEST(HistoryFile, HeaderIsTheAgreedOne)
  {
    EXPECT_EQ(HistoryFile::header({"left", "top"}, 2),
              "step,time,time_step,kinetic,elastic,cohesive,damage,friction,"
              "viscous,plastic,impact,numerical,work,ledger_defect,"
              "broken_area,fragments,active,newton,krylov,residual,"
              "reaction_left_x,reaction_left_y,reaction_top_x,reaction_top_y");
    EXPECT_EQ(n_times(HistoryFile::header({"a"}, 3), "reaction_a_"), 3u);
  }

  TEST(HistoryFile, RowsAreOnDiskAtOnceAndReadBackExactly)
  {
    const std::string path = scratch("history.csv");
    HistoryFile file(path, {"left"}, 2);
    file.write(history_row(7));

    std::istringstream text(read(path));
    std::string header, row, entry;
    std::getline(text, header);
    std::getline(text, row);
    EXPECT_EQ(n_times(row, ","), n_times(header, ","));
    std::vector<std::string> entries;
    for (std::istringstream line(row); std::getline(line, entry, ',');)
      entries.push_back(entry);
    EXPECT_EQ(entries[0], "7");
    EXPECT_EQ(std::stod(entries[3]), 0.1 + 0.2);
    EXPECT_EQ(std::stod(entries[20]), 1. / 3.);
  }

  TEST(HistoryFile, RefusesWhatItCannotWrite)
  {
    EXPECT_THROW(HistoryFile("/no/such/folder/history.csv", {}, 2),
                 std::runtime_error);
    HistoryFile file(scratch("history_2.csv"), {}, 2);
    EXPECT_THROW(file.write(history_row(1)), std::logic_error);
  }

  TEST(SummaryFile, HasTheAgreedKeys)
  {
    Summary summary;
    summary.completed = true;
    summary.steps = 12;
    summary.energy.damage = 5e-6;
    summary.residual_max = nan_value;
    summary.penetration_max = std::numeric_limits<double>::infinity();
    summary.errors["displacement_L2"] = 1e-3;
    summary.timings = {{"z last", 1.}, {"a first", 2.}};
    summary.cost.parts = {{"laws", 0.25, 7}};
    summary.cost.per_step = {{"Newton", 3., 9.}};
    summary.cost.memory = {{"mesh", 1024.}};
    const std::string path = scratch("summary.json");
    write_summary(path, summary);

    const auto json = nlohmann::ordered_json::parse(read(path));
    for (const char *key :
         {"completed", "steps", "dofs", "interface_points", "final_time",
          "wall_seconds", "peak_memory_mb", "energy", "dissipated", "work",
          "ledger_defect_max", "residual_max", "penetration_max", "counters",
          "errors", "fragments", "failure", "timings", "cost"})
      EXPECT_TRUE(json.contains(key)) << key;
    for (const char *key : {"crack_pressure_work", "viscous_traction_max"})
      EXPECT_FALSE(json.contains(key)) << "no such part";
    summary.pressure_work = 0.5;
    summary.viscous_traction_max = 3.;
    write_summary(path, summary);
    const auto more = nlohmann::json::parse(read(path));
    EXPECT_EQ(more["crack_pressure_work"], 0.5);
    EXPECT_EQ(more["viscous_traction_max"], 3.);
    for (const char *key : {"kinetic", "elastic", "cohesive"})
      EXPECT_TRUE(json["energy"].contains(key)) << key;
    for (const char *key :
         {"damage", "friction", "viscous", "plastic", "impact", "numerical"})
      EXPECT_TRUE(json["dissipated"].contains(key)) << key;
    EXPECT_EQ(json["dissipated"]["damage"], 5e-6);
    EXPECT_EQ(json["errors"]["displacement_L2"], 1e-3);
    EXPECT_TRUE(json["residual_max"].is_null());
    EXPECT_TRUE(json["penetration_max"].is_null());
    EXPECT_EQ(json["timings"].begin().key(), "z last");
    EXPECT_EQ(json["cost"]["parts"]["laws"]["seconds"], 0.25);
    EXPECT_EQ(json["cost"]["parts"]["laws"]["calls"], 7);
    EXPECT_EQ(json["cost"]["per_step"]["Newton"]["worst"], 9.);
    EXPECT_EQ(json["cost"]["memory_bytes"]["mesh"], 1024.);
    EXPECT_FALSE(json["cost"]["application_of_W"].contains("limit"))
        << "not measured";
    EXPECT_FALSE(std::ifstream(path + ".part"));
  }

  TEST(SummaryFile, RunInfoSurvivesAnyText)
  {
    RunInfo info;
    info.command_line = "nsfd \"a\".prm \xff";
    info.seeds = {1, 2};
    info.parts = {{"cohesive law", "camacho-ortiz"}};
    const auto json = nlohmann::json::parse(describe_run(info));
    EXPECT_EQ(json["ranks"], 1);
    EXPECT_EQ(json["seeds"][1], 2);
    EXPECT_EQ(json["parts"][0]["name"], "camacho-ortiz");
    EXPECT_THROW(write_file_atomically("/no/such/folder/run.json", "{}"),
                 std::runtime_error);
  }

  // -------------------------------------------------------------------- texts

  TEST(Engineering, ThreeDigitsAndAPrefix)
  {
    EXPECT_EQ(engineering(5e-6, "J/m"), "5.00 µJ/m");
    EXPECT_EQ(engineering(135e9, "Pa"), "135 GPa");
    EXPECT_EQ(engineering(-0.25, "m"), "−250 mm");
    EXPECT_EQ(engineering(999.96e-9, "s"), "1.00 µs");
    EXPECT_EQ(engineering(9.999, "m"), "10.0 m");
    EXPECT_EQ(engineering(3600., "s"), "3600 s");
    EXPECT_EQ(engineering(2.5e-11, "m²"), "25.0 µm²");
    EXPECT_EQ(engineering(0., "J"), "0 J");
    EXPECT_EQ(engineering(2e-12, ""), "2.00×10⁻¹²");
    EXPECT_EQ(engineering(1e-19, "J"), "1.00×10⁻¹⁹ J");
    EXPECT_EQ(engineering(nan_value, "J"), "n/a");
  }

  TEST(Markup, IsEscaped)
  {
    EXPECT_EQ(escape_markup("a<b & \"c\" 'd'>"),
              "a&lt;b &amp; &quot;c&quot; &#39;d&#39;&gt;");
  }

  // ----------------------------------------------------------------- pictures

  TEST(LineChart, CopesWithAnyData)
  {
    const std::vector<double> x = {0., 1., 2., 3.};
    const std::vector<std::vector<double>> cases = {
        {},
        {1.},
        {0., 0., 0., 0.},
        {nan_value, nan_value, nan_value, nan_value},
        {1., nan_value, 2., HUGE_VAL},
        {-1., -1e-300, 1e300, 0.},
        {5., 5., 5., 5.},
        {1e-30, 2e-30, 0., 3e-30},
        {1., 1. + 1e-15, 1., 1.}};
    for (const auto &y : cases)
      for (const bool logarithmic : {false, true}) {
        LineChart chart("<title>", {"time", "s"}, {"y", "J", logarithmic});
        chart.add_line("a & b", x, y, LineChart::Colour::blue);
        chart.add_band("band", x, y, y, LineChart::Colour::red);
        expect_good_svg(chart.svg(SvgUse::file));
        expect_good_svg(chart.svg(SvgUse::page));
      }
    const LineChart empty("empty", {"x", ""}, {"y", ""});
    EXPECT_NE(empty.svg(SvgUse::file).find("no data"), std::string::npos);
  }

  TEST(LineChart, LongSeriesKeepTheirPeaks)
  {
    std::vector<double> x(100000), y(100000, 0.);
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = static_cast<double>(i);
    LineChart flat("a", {"x", ""}, {"y", ""}), peak("a", {"x", ""}, {"y", ""});
    flat.add_line("y", x, y, LineChart::Colour::blue);
    y[54321] = 1.;
    peak.add_line("y", x, y, LineChart::Colour::blue);
    EXPECT_LT(peak.svg(SvgUse::page).size(), 30000u);
    EXPECT_NE(peak.svg(SvgUse::page), flat.svg(SvgUse::page));
    // up to the top of the plot and back
    EXPECT_NE(peak.svg(SvgUse::page).find("-165"), std::string::npos);
  }

  TEST(BodyPicture, SmallOpeningsAreMagnified)
  {
    const Snapshot plate = torn_plate(8, 2e-9);
    const PictureOptions options = picture_options({plate});
    // 1 nm at most against 10 um: 5 % are 500 nm
    EXPECT_DOUBLE_EQ(options.magnification, 500.);
    EXPECT_NEAR(options.upper[0] - options.lower[0], 11e-6, 1e-9);

    const std::string svg = body_picture(plate, options, SvgUse::file);
    expect_good_svg(svg);
    EXPECT_NE(svg.find("deformation × 500"), std::string::npos);
    EXPECT_NE(svg.find("t = 5.00 ns"), std::string::npos);
    EXPECT_NE(svg.find("von Mises stress (MPa)"), std::string::npos);
    EXPECT_NE(svg.find(">2 µm<"), std::string::npos);
    EXPECT_NE(svg.find(">broken<"), std::string::npos);
    EXPECT_NE(svg.find(">damaged<"), std::string::npos);
    EXPECT_EQ(svg.find(">in contact<"), std::string::npos);

    // both flanks of the six broken faces, each a piece of one path
    const auto begin = svg.find("d=\"", svg.find("stroke=\"#e3122b\""));
    const auto end = svg.find('"', begin + 3);
    EXPECT_EQ(n_times(svg.substr(begin + 3, end - begin - 3), "m"), 12u);
  }

  TEST(BodyPicture, LargeOpeningsAreTrue)
  {
    const Snapshot plate = torn_plate(4, 2e-6);
    EXPECT_EQ(picture_options({plate}).magnification, 1.);
    EXPECT_NE(body_picture(plate, picture_options({plate}), SvgUse::page)
                  .find("true deformation"),
              std::string::npos);
  }

  TEST(BodyPicture, FlightOfTheWholeIsNotMagnified)
  {
    Snapshot plate = torn_plate(4, 2e-9);
    for (auto &cell : plate.polygons)
      for (auto &u : cell.displacement)
        u[1] += 3e-6;
    EXPECT_DOUBLE_EQ(picture_options({plate}).magnification, 500.);
  }

  TEST(BodyPicture, CopesWithAnyData)
  {
    EXPECT_NO_THROW(
        body_picture(Snapshot(), picture_options({}), SvgUse::file));

    Snapshot plate = torn_plate(4, 0.);
    plate.polygons[0].displacement[0][0] = nan_value;
    plate.polygons[1].value = nan_value;
    plate.polygons[2].displacement.clear();
    plate.faces[0].displacement_a[1] = nan_value;
    expect_good_svg(
        body_picture(plate, picture_options({plate}), SvgUse::file));
    for (auto &cell : plate.polygons)
      cell.value = 0.;
    expect_good_svg(
        body_picture(plate, picture_options({plate}), SvgUse::file));

    plate.dimension = 3;
    for (const auto colouring :
         {PictureOptions::Colouring::stress, PictureOptions::Colouring::speed,
          PictureOptions::Colouring::fragment})
      expect_good_svg(body_picture(plate, picture_options({plate}, colouring),
                                   SvgUse::file));
  }

  TEST(BodyPicture, IsCompact)
  {
    const Snapshot plate = torn_plate(100, 1e-8);
    const std::string svg =
        body_picture(plate, picture_options({plate}), SvgUse::page);
    EXPECT_LT(svg.size(), 40u * plate.polygons.size());
  }

  // ------------------------------------------------------------------- report

  const std::vector<std::string> html_void = {"meta", "!DOCTYPE"};

  TEST(ReportPage, SaysWhatHappened)
  {
    Report report;
    report.title = "a <b> & c";
    report.description = "First.\n\nSecond.";
    report.parameters = "set x = \"<y>\"\n";
    report.summary.completed = false;
    report.summary.failure = "step 7 could not be solved";
    report.summary.fragments = 2;
    report.summary.errors["energy"] = 1e-3;
    report.summary.counters["law_calls"] = 123456;
    report.summary.timings = {{"solve", 3.}, {"rest", 1.}};
    report.reaction_names = {"left"};
    for (unsigned int step = 1; step < 8; ++step)
      report.history.push_back(history_row(step));
    report.snapshots = {torn_plate(4, 0.), torn_plate(4, 1e-9)};
    const std::string path = scratch("report.html");
    const auto pictures = write_report(path, report);

    const std::string html = read(path);
    EXPECT_EQ(unbalanced_tag(html, html_void), "");
    EXPECT_NE(html.find("a &lt;b&gt; &amp; c"), std::string::npos);
    EXPECT_EQ(html.find("<y>"), std::string::npos);
    EXPECT_NE(html.find("step 7 could not be solved"), std::string::npos);
    EXPECT_NE(html.find("75.0 %"), std::string::npos);
    EXPECT_NE(html.find("Errors against exact values"), std::string::npos);
    // nothing is fetched from elsewhere
    EXPECT_EQ(html.find("http"), std::string::npos);
    EXPECT_EQ(html.find("src="), std::string::npos);

    EXPECT_EQ(pictures[0], "deformed_000.svg");
    EXPECT_TRUE(std::count(pictures.begin(), pictures.end(), "energies.svg"));
    for (const auto &picture : pictures)
      expect_good_svg(read(scratch(picture)));
  }

  TEST(ReportPage, CopesWithNoData)
  {
    const std::string path = scratch("empty_report.html");
    write_report(path, Report());
    EXPECT_EQ(unbalanced_tag(read(path), html_void), "");

    Report report;
    report.summary.completed = true;
    report.summary.ledger_defect_max = nan_value;
    report.summary.energy.work = nan_value;
    report.history = {history_row(0)};
    report.history[0].energy.elastic = nan_value;
    report.history[0].reactions = {};
    report.reaction_names = {"left"};
    report.snapshots = {Snapshot()};
    write_report(path, report);
    EXPECT_EQ(unbalanced_tag(read(path), html_void), "");
  }

  // ---------------------------------------------------------------------- VTU

  TEST(Vtu, BinaryBlocksAreWhereTheHeaderSays)
  {
    VtuGrid grid;
    grid.time = 0.5;
    grid.points = {{0., 0., 0.}, {1., 0., 0.}, {1., 2., 0.}};
    grid.add_cell(VtuCell::line, {0, 1});
    grid.add_cell(VtuCell::line, {1, 2});
    grid.cell_data = {{"beta", 1, {1., 0.25}}};
    grid.point_data = {{"jump", 3, {0., 0., 0., 1., 2., 3., 4., 5., 6.}}};
    const std::string path = scratch("faces.vtu");
    write_vtu(path, grid);

    const std::string text = read(path);
    const auto block = [&](const std::string &name) {
      const auto at = text.find("offset=\"", text.find('"' + name + '"')) + 8;
      return text.find('_', text.find("<AppendedData")) + 1 +
             std::stoul(text.substr(at));
    };
    std::uint64_t n_bytes = 0;
    double beta[2];
    std::memcpy(&n_bytes, text.data() + block("beta"), 8);
    std::memcpy(beta, text.data() + block("beta") + 8, 16);
    EXPECT_EQ(n_bytes, 16u);
    EXPECT_EQ(beta[1], 0.25);
    std::int64_t corners[4];
    std::memcpy(corners, text.data() + block("connectivity") + 8, 32);
    EXPECT_EQ(corners[3], 2);
    EXPECT_EQ(text[block("types") + 8], 3);

    grid.cell_data[0].values.pop_back();
    EXPECT_THROW(write_vtu(path, grid), std::logic_error);
  }

  TEST(Vtu, EmptyPiecesAndCollections)
  {
    VtuGrid empty;
    empty.point_data = {{"jump", 3, {}}};
    write_vtu(scratch("empty.vtu"), empty);

    EXPECT_EQ(vtu_name("faces", 12, 0, 1), "faces_00012.vtu");
    EXPECT_EQ(vtu_name("faces", 12, 3, 4), "faces_00012.0003.vtu");
    write_pvtu(scratch("faces.pvtu"), empty, {"a.vtu", "b.vtu"});
    const std::string pvtu = read(scratch("faces.pvtu"));
    EXPECT_EQ(unbalanced_tag(pvtu), "");
    EXPECT_EQ(n_times(pvtu, "<Piece "), 2u);

    PvdSeries series(scratch("faces.pvd"));
    series.add(0., "a.pvtu");
    series.add(1e-9, "b.pvtu");
    const std::string pvd = read(scratch("faces.pvd"));
    EXPECT_EQ(unbalanced_tag(pvd), "");
    EXPECT_NE(pvd.find("timestep=\"1e-09\" part=\"0\" file=\"b.pvtu\""),
              std::string::npos);
  }

  // ----------------------------------------------------------------- progress

  TEST(Progress, OneAlignedLine)
  {
    HistoryRow row;
    row.step = 12;
    row.time = 1.2e-4;
    row.active = 34;
    row.broken_area = 3.2e-6;
    row.newton = 4;
    row.krylov = 81;
    row.residual = 8.1e-11;
    row.ledger_defect = 2e-13;
    std::istringstream words(Progress::line(row));
    std::string word, line;
    while (words >> word)
      line += (line.empty() ? "" : " ") + word;
    EXPECT_EQ(line, "step 12 t 1.2000e-04 active 34 broken 3.2e-6 newton 4 "
                    "krylov 81 res 8.1e-11 defect 2e-13");
  }

  TEST(Progress, LinesAreDueEveryFewSteps)
  {
    std::ostringstream out;
    Progress progress(out, 1., Progress::Mode::lines, 10, 1e9);
    for (unsigned int step = 1; step <= 25; ++step)
      progress.step(history_row(step));
    progress.message("careful");
    progress.finish();
    // 1, 10, 20, the message and 25
    EXPECT_EQ(n_times(out.str(), "\n"), 5u);
    EXPECT_EQ(out.str().find('\r'), std::string::npos);

    std::ostringstream silence;
    Progress quiet(silence, 1., Progress::Mode::quiet);
    quiet.step(history_row(1));
    quiet.finish();
    EXPECT_EQ(silence.str(), "");

    std::ostringstream terminal;
    Progress live(terminal, 1e-11, Progress::Mode::terminal);
    live.step(history_row(1));
    EXPECT_NE(terminal.str().find("100 %"), std::string::npos);
    EXPECT_EQ(terminal.str().find('\n'), std::string::npos);
  }

  TEST(Progress, Durations)
  {
    EXPECT_EQ(Progress::duration(1.25), "1.2 s");
    EXPECT_EQ(Progress::duration(247.), "4 min 07 s");
    EXPECT_EQ(Progress::duration(12300.), "3 h 25 min");
    EXPECT_EQ(Progress::duration(nan_value), "?");
  }
} // namespace test_output
