#include "core/machine_memory.h"
#include "input/read_scene.h"
#include "parameters/bad_values.h"
#include "parameters/place_of.h"
#include "parameters/text_file.h"
#include "time_integration/step_control.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

// Input that nobody means well with: it is refused in a moment, whatever its
// size, and what is refused names its file and line.

namespace nsfd::test_hostile_input
{
  namespace
  {
    namespace fs = std::filesystem;

    const std::string base_file = R"(subsection Constants
  set sc   = 10 MPa
  set s0   = 2 * sc
  set bare = 3
  set rise = 1 us
end
subsection Mesh
  set upper corner = 10 mm, 1 mm
  set cells = 10, 1
end
subsection Material: m
  set Young modulus = 1 GPa
  set Poisson ratio = 0.3
  set density = 1000 kg/m^3
end
subsection Interface: all
  set law = rigid
end
subsection Boundary: left
  set traction x = 1 MPa
end
subsection Time
  set end = 1 us
end
)";

    std::string with(const std::string &old_text, const std::string &new_text)
    {
      const std::size_t at = base_file.find(old_text);
      EXPECT_NE(at, std::string::npos) << old_text;
      std::string text = base_file;
      return text.replace(at, old_text.size(), new_text);
    }

    std::string report_of(const std::string &text)
    {
      InputErrors errors;
      const auto scene = read_scene_text(text, "bad.prm", {}, errors);
      EXPECT_EQ(scene == nullptr, errors.has_errors());
      constexpr unsigned int all = 100000;
      return errors.report(all);
    }

    std::string repeated(const std::string &word, const std::size_t count)
    {
      std::string result;
      for (std::size_t i = 0; i < count; ++i)
        result += word;
      return result;
    }

    void expect_in(const std::string &part, const std::string &report)
    {
      EXPECT_NE(report.find(part), std::string::npos)
          << "no `" << part << "` in\n"
          << report;
    }

    /** A folder of its own, removed at the end. */
    struct Folder {
      fs::path path =
          fs::temp_directory_path() / fmt::format("nsfd_hostile_{}", getpid());
      Folder() { fs::create_directories(path); }
      ~Folder() { fs::remove_all(path); }
      std::string file(const std::string &name,
                       const std::string &content) const
      {
        std::ofstream(path / name, std::ios::binary) << content;
        return (path / name).string();
      }
    };

    std::string report_of_file(const std::string &file)
    {
      InputErrors errors;
      EXPECT_EQ(read_scene(file, {}, errors), nullptr);
      return errors.report();
    }
  } // namespace

  TEST(HostileInput, EmptyEntriesAreErrorsEverywhere)
  {
    unsigned int n_entries = 0;
    for (const char *name :
         {"quickstart.prm", "benchmarks/falling_wall.prm",
          "benchmarks/flaw.prm", "benchmarks/square_mac.prm",
          "stability/painleve.prm", "verification/bimodular.prm",
          "verification/crack_pressure.prm", "verification/dilatancy.prm",
          "verification/graded_bar.prm", "verification/heavy_top.prm",
          "verification/interface_law.prm", "verification/plastic_bar.prm",
          "verification/pull_out.prm"}) {
      const std::string path = NSFD_SOURCE_DIR "/prm/" + std::string(name);
      std::ifstream stream(path);
      std::vector<std::string> lines;
      for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
      ASSERT_FALSE(lines.empty()) << path;
      for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::size_t first = lines[i].find_first_not_of(' ');
        if (first == std::string::npos ||
            lines[i].compare(first, 4, "set ") != 0)
          continue;
        ++n_entries;
        std::string text;
        for (std::size_t j = 0; j < lines.size(); ++j)
          text +=
              (j == i ? lines[j].substr(0, lines[j].find('=') + 1) : lines[j]) +
              "\n";
        InputErrors errors;
        EXPECT_EQ(read_scene_text(text, path, {}, errors), nullptr)
            << path << ":" << i + 1;
        bool told = false;
        for (const Diagnostic &d : errors.diagnostics())
          told = told || (d.is_error() && d.location.line == i + 1);
        EXPECT_TRUE(told) << path << ":" << i + 1 << "\n" << errors.report();
      }
    }
    EXPECT_GT(n_entries, 200u);
  }

  TEST(HostileInput, SizesAreBounded)
  {
    const std::string value = "traction x = 1 MPa";
    expect_in("300 bytes, more than 80",
              report_of(with("Boundary: left",
                             "Boundary: " + std::string(290, 'a'))));
    expect_in(
        "bad.prm:20: error: this line has",
        report_of(with(value, "traction x = " + std::string(1000000, '1'))));
    expect_in(
        "this line has 1200",
        report_of(with(value, "traction x = 1" + repeated(" + 1", 300000))));
    expect_in(
        "this formula has 12",
        report_of(with(value, "traction x = 1" + repeated(" + 1", 3000))));
    expect_in("this statement of several lines has",
              report_of(with(value, "traction x = 1" +
                                        repeated(" + \\\n 1", 300000))));
    expect_in("more than 20000 statements",
              report_of(base_file + repeated("set a = 1\n", 30000)));
    std::string constants;
    for (unsigned int i = 0; i < 5000; ++i)
      constants += fmt::format("  set a{} = b{}\n", i, i);
    expect_in("more than 1000",
              report_of(with("  set rise", constants + "  set rise")));
  }

  TEST(HostileInput, NestingIsBounded)
  {
    const std::string value = "traction x = 1 MPa";
    for (const std::string &formula :
         {repeated("(", 4000) + "1" + repeated(")", 4000),
          "2" + repeated("^2", 3000), repeated("abs(", 2000) + "1",
          repeated("x > 0 ? ", 500) + "1" + repeated(" : 0", 500)})
      expect_in("nested more than 200 times",
                report_of(with(value, "traction x = " + formula)));
    expect_in("sections are not nested",
              report_of(repeated("subsection A\n", 1000)));
  }

  TEST(HostileInput, NumbersOfNoMachineAreRefused)
  {
    for (const char *modulus : {"1e300", "1e-300", "1e300 Pa"})
      expect_in("bad.prm:12: error: Young modulus = " + std::string(modulus),
                report_of(with("1 GPa", modulus)));
    expect_in("below 1e-20", report_of(with("10 mm, 1 mm", "1e-30, 1e-30")));
    expect_in("too large or too small", report_of(with("1 GPa", "1e400")));
    expect_in("beyond 1e+45",
              report_of(with("traction x = 1 MPa", "traction x = 1e300")));
    for (const char *cells :
         {"-1, 1", "1e400, 1", "0.5, 1", "1e10, 1", "nan, 1"})
      expect_in("bad.prm:9: error: cells",
                report_of(with("10, 1\nend", std::string(cells) + "\nend")));
  }

  TEST(HostileInput, MeshesBeyondTheMemoryAreRefused)
  {
    // 1e9 cells take terabytes
    expect_in("bad.prm:9: error: the mesh would have 1e+09 cells",
              report_of(with("10, 1\nend", "100000, 10000\nend")));
    expect_in(
        "the mesh would have 1.1e+13 cells after 20 refinements",
        report_of(with("10, 1\nend", "10, 1\n  set refinements = 20\nend")));
    EXPECT_GT(available_memory(), 1e6);
  }

  TEST(HostileInput, FilesWithoutEndAreNotRead)
  {
    const Folder folder;
    expect_in("is a device", report_of_file("/dev/zero"));
    expect_in("is a folder", report_of_file(folder.path.string()));
    const std::string pipe = (folder.path / "pipe").string();
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    expect_in("is a pipe", report_of_file(pipe));
    const std::string large = folder.file("large.prm", "set a = 1\n");
    fs::resize_file(large, std::uintmax_t(1) << 30); // a hole, no blocks
    expect_in("is larger than 4 MiB", report_of_file(large));
    expect_in("cannot be read", report_of_file(large + "x"));
    expect_in("is a device",
              report_of_file(folder.file("i.prm", "include /dev/zero\n")));
  }

  TEST(HostileInput, BytesThatAreNoText)
  {
    const Folder folder;
    const std::string file = folder.file("a.prm", "# \xc3\xa4\nset a = \xff\n");
    expect_in(file + ":2: error:", report_of_file(file));
    expect_in("is not UTF-8: the byte 0xff", report_of_file(file));
    expect_in("is not a text file",
              report_of_file(folder.file("b.prm", std::string("a\0b", 3))));
    for (const char *bad :
         {"\xc3", "\xed\xa0\x80", "\xc0\xaf", "\xf5\x80\x80\x80"})
      EXPECT_EQ(find_non_utf8("a" + std::string(bad)), 1u);
    EXPECT_EQ(find_non_utf8("\u00b5 \u20ac \U0001d54f"), std::string::npos);
    InputErrors errors;
    read_scene_text(base_file, "good.prm", {"Time/end=\xff"}, errors);
    expect_in("--set is not UTF-8", errors.report());
  }

  TEST(HostileInput, ConstantsThatAreFormulasHaveTheUnitOfTheirParts)
  {
    for (const char *traction :
         {"s0 * t / rise + 0 Pa", "s0 * (t / rise) + 0 Pa",
          "bare * t / rise + 0 Pa", "s0 / rise * t + 0 Pa"})
      EXPECT_EQ(report_of(with("1 MPa", traction)), "") << traction;
    expect_in("cannot be added to",
              report_of(with("1 MPa", "s0 * t / rise + 1 m")));
    expect_in("cannot be added to", report_of(with("1 MPa", "s0 * t + 1 Pa")));
  }

  TEST(HostileInput, FormulasWithoutValueTellWhere)
  {
    InputErrors errors;
    const auto scene =
        read_scene_text(with("1 MPa", "1 / (x - 2)"), "nan.prm", {}, errors);
    ASSERT_NE(scene, nullptr) << errors.report();
    take_bad_values();
    scene->boundaries[0].traction[0](1., 0., 0., 0.);
    EXPECT_FALSE(has_bad_values());
    scene->boundaries[0].traction[0](2., 7., 0., 0.5);
    scene->boundaries[0].traction[0](2., 8., 0., 0.5);
    const auto told = take_bad_values();
    ASSERT_EQ(told.size(), 1u);
    EXPECT_EQ(told[0], "Boundary: left/traction x = 1 / (x - 2) is infinite at "
                       "(2, 7, 0), t = 0.5");
    EXPECT_FALSE(has_bad_values());
  }

  TEST(HostileInput, WhatIsFoundLaterHasALine)
  {
    const Folder folder;
    const std::string file = folder.file("a.prm", base_file);
    EXPECT_EQ(place_of(file, "Boundary: left: no face is there").line, 19u);
    EXPECT_EQ(place_of(file, "Boundary: left/traction x = 1 is bad").line, 20u);
    EXPECT_EQ(place_of(file, "Time/end: too late").line, 23u);
    EXPECT_EQ(place_of(file, "Time/step: not in the file").line, 22u);
    EXPECT_EQ(place_of(file, "something else").line, 0u);
    EXPECT_EQ(place_of("no such file", "Time/end: x").line, 0u);
  }

  // wave speeds over cells 1e4 m from the origin are off by round-off
  TEST(StepControl, RoundOffAddsNoStep)
  {
    const auto n_steps = [](const double end, const double step) {
      StepControl control(end, step, 0);
      unsigned int n = 0;
      for (; !control.finished(); ++n)
        control.accept();
      return n;
    };
    EXPECT_EQ(n_steps(840., 1.), 840u);
    EXPECT_EQ(n_steps(840., 1. - 2e-9), 840u);
    EXPECT_EQ(n_steps(840., 1. + 2e-9), 840u);
    EXPECT_EQ(n_steps(840., 1. - 1e-4), 841u);
  }
} // namespace nsfd::test_hostile_input
