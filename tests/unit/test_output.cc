#include "output_checks.h"

namespace output_checks::test_output
{
  // ------------------------------------------------------------------ tables

  TEST(HistoryFile, HeaderIsTheAgreedOne)
  {
    EXPECT_EQ(HistoryFile::header({{"left", "top"}, 2}),
              "step,time,time_step,kinetic,elastic,cohesive,damage,friction,"
              "viscous,plastic,impact,numerical,work,ledger_defect,"
              "broken_area,fragments,active,newton,krylov,residual,"
              "reaction_left_x,reaction_left_y,reaction_top_x,reaction_top_y");
    EXPECT_EQ(n_times(HistoryFile::header({{"a"}, 3}), "reaction_a_"), 3u);
    EXPECT_EQ(HistoryFile::header({{"a"}, 2, true}),
              HistoryFile::header({{"a"}, 2}) + ",absorbed");
  }

  TEST(HistoryFile, RowsAreOnDiskAtOnceAndReadBackExactly)
  {
    const std::string path = scratch("history.csv");
    HistoryFile file(path, {{"left"}, 2});
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
    EXPECT_THROW(HistoryFile("/no/such/folder/history.csv", {{}, 2}),
                 std::runtime_error);
    HistoryFile file(scratch("history_2.csv"), {{}, 2});
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
    row.balance_residual = 2e-13;
    std::istringstream words(Progress::line(row));
    std::string word, line;
    while (words >> word)
      line += (line.empty() ? "" : " ") + word;
    EXPECT_EQ(line, "step 12 t 1.2000e-04 active 34 broken 3.2e-6 newton 4 "
                    "krylov 81 res 8.1e-11 defect 2e-13");
  }

  std::string steps_to(const unsigned int n, Progress progress,
                       const std::ostringstream &out)
  {
    for (unsigned int step = 1; step <= n; ++step)
      progress.step(history_row(step));
    progress.message("careful");
    progress.finish();
    return out.str();
  }

  TEST(Progress, LinesByTheClock)
  {
    using Mode = Progress::Mode;
    std::ostringstream pipe, first, all, silence, terminal;
    EXPECT_EQ(steps_to(25, {pipe, 1., Mode::lines}, pipe), "careful\n")
        << "a run of less than ten seconds says nothing of its steps";
    const std::string one = steps_to(25, {first, 1., Mode::lines, 0.}, first);
    EXPECT_EQ(n_times(one, "\n"), 2u) << "then a minute passes\n" << one;
    EXPECT_EQ(one.find('\r'), std::string::npos);
    EXPECT_EQ(n_times(steps_to(25, {all, 1., Mode::every_step}, all), "step "),
              25u);
    EXPECT_EQ(steps_to(25, {silence, 1., Mode::quiet}, silence), "");

    Progress live(terminal, 1e-11, Mode::terminal);
    live.step(history_row(1));
    EXPECT_NE(terminal.str().find("100 %"), std::string::npos);
    EXPECT_EQ(terminal.str().find('\n'), std::string::npos);
  }

  // Parts that do not fit are left out; no number is cut.
  TEST(Progress, NarrowTerminals)
  {
    HistoryRow row;
    row.step = 1234;
    row.time = 2.5e-6;
    row.broken_area = 3.2e-6;
    row.active = 34;
    const auto line = [&](const std::size_t width) {
      return Progress::live_line(row, 40e-6, 247., width);
    };
    EXPECT_EQ(line(200), "  6 %  ETA 4 min 07 s  t 2.50 of 40.00 µs  step 1234"
                         "  broken 3.2e-6  active 34  newton 0  res 0");
    EXPECT_EQ(line(52), "  6 %  ETA 4 min 07 s  t 2.50 of 40.00 µs  step 1234");
    EXPECT_EQ(line(51), "  6 %  ETA 4 min 07 s  t 2.50 of 40.00 µs");
    EXPECT_EQ(line(21), "  6 %  ETA 4 min 07 s");
    EXPECT_EQ(line(20), "  6 %");
    EXPECT_EQ(line(3), "");
  }

  TEST(Progress, Durations)
  {
    EXPECT_EQ(Progress::duration(1.25), "1.2 s");
    EXPECT_EQ(Progress::duration(247.), "4 min 07 s");
    EXPECT_EQ(Progress::duration(12300.), "3 h 25 min");
    EXPECT_EQ(Progress::duration(nan_value), "?");
  }
} // namespace output_checks::test_output
