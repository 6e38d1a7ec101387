#include "output_checks.h"

namespace output_checks::test_pictures
{
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
    report.summary.balance_residual_max = nan_value;
    report.summary.energy.work = nan_value;
    report.history = {history_row(0)};
    report.history[0].energy.elastic = nan_value;
    report.history[0].reactions = {};
    report.reaction_names = {"left"};
    report.snapshots = {Snapshot()};
    write_report(path, report);
    EXPECT_EQ(unbalanced_tag(read(path), html_void), "");
  }
} // namespace output_checks::test_pictures
