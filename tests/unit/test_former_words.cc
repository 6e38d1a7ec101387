#include "checkpoint/parameter_changes.h"
#include "input/read_scene.h"
#include "parameters/former_words.h"
#include "small_scene.h"
#include "study/study_input.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

// Words of parameter files that are called otherwise today go on working, with
// one note.

namespace nsfd::test_former_words
{
  using small_scene_text::replaced;
  using small_scene_text::report_of;
  using small_scene_text::small_scene;

  namespace
  {
    using Place = FormerWord::Place;

    /** What a scene needs to have the entry. */
    std::vector<std::string> surroundings(const FormerWord &word)
    {
      if (word.entry == "dynamic step")
        return {"Time/scheme=quasi-static", "Time/step=1 ns",
                "Time/at solution jump=dynamic"};
      return {};
    }

    /** `Section/entry=value` with the former word, or with today's. */
    std::string assignment(const FormerWord &word, const bool former)
    {
      const std::string &written = former ? word.former : word.now;
      switch (word.place) {
      case Place::entry:
        return word.section + "/" + written + "=3";
      case Place::value:
        return word.section + "/" + word.entry + "=" + written;
      default:
        return word.section + "/" + word.entry + "=0.3 " + written;
      }
    }

    struct Reading {
      std::string echo, report;
    };

    Reading read(const FormerWord &word, const bool former)
    {
      std::vector<std::string> overrides = surroundings(word);
      overrides.push_back(assignment(word, former));
      InputErrors errors;
      const auto scene =
          read_scene_text(small_scene, "small.prm", overrides, errors);
      return {scene ? scene->echo : "", errors.report()};
    }

    std::string note_of(const FormerWord &word)
    {
      return "note: `" + word.former + "` is called `" + word.now +
             "` today; both words work\n";
    }

    std::size_t count(const std::string &text, const std::string &part)
    {
      std::size_t n = 0;
      for (std::size_t at = text.find(part); at != std::string::npos;
           at = text.find(part, at + 1))
        ++n;
      return n;
    }

    /** A word with two letters exchanged. */
    std::string misspelt(std::string word)
    {
      std::swap(word[2], word[3]);
      return word;
    }

    /** The echo with the former word in place of today's. */
    std::string echo_of_old_program(const FormerWord &word, std::string echo)
    {
      std::size_t at = echo.find("subsection " + word.section);
      at = echo.find("set " + word.entry, at);
      at = echo.find(word.now, at);
      EXPECT_NE(at, std::string::npos) << word.former;
      return echo.replace(at, word.now.size(), word.former);
    }
  } // namespace

  TEST(FormerWords, AreTheSameScene)
  {
    for (const FormerWord &word : former_words()) {
      const Reading old = read(word, true), now = read(word, false);
      EXPECT_EQ(now.report, "") << word.now;
      EXPECT_EQ(old.report, word.stays ? "" : "--set: " + note_of(word));
      EXPECT_NE(now.echo, "") << word.now;
      EXPECT_EQ(old.echo, now.echo) << word.former;
    }
  }

  // A checkpoint of an older program has them in its parameters.
  TEST(FormerWords, AreNoChangeOfParameters)
  {
    for (const FormerWord &word : former_words()) {
      const std::string now = read(word, false).echo;
      const std::string then = echo_of_old_program(word, now);
      ASSERT_NE(then, now);
      EXPECT_TRUE(parameter_changes(then, now).empty()) << word.former;
    }
  }

  TEST(FormerWords, MisspeltMeanTodays)
  {
    for (FormerWord word : former_words()) {
      const std::string meant = "did you mean `" + word.now + "`?";
      word.former = misspelt(word.former);
      const Reading reading = read(word, true);
      EXPECT_NE(reading.report.find(meant), std::string::npos)
          << word.former << "\n"
          << reading.report;
      EXPECT_EQ(reading.echo, "");
    }
  }

  TEST(FormerWords, StandAtTheirLine)
  {
    const std::string scene =
        replaced(small_scene, "set end = 10 ns",
                 "set end = 10 ns\n  set maximum  halvings = 3");
    EXPECT_EQ(report_of(scene),
              "small.prm:17: note: `maximum halvings` is called `maximum "
              "bisections` today; both words work\n");
    // what is wrong is still underlined in the line as it is written
    EXPECT_NE(report_of(replaced(scene, "= 3", "= -3"))
                  .find("  17 |   set maximum  halvings = -3\n"
                        "     |                           ^~"),
              std::string::npos)
        << report_of(replaced(scene, "= 3", "= -3"));
    EXPECT_NE(report_of(replaced(small_scene, "set end = 10 ns",
                                 "set end = 10 ns\n  set step = -2 crossings"))
                  .find("step = -2 must be positive"),
              std::string::npos);
  }

  TEST(FormerWords, NameOneEntryTogetherWithTodays)
  {
    const std::string scene =
        replaced(small_scene, "set end = 10 ns",
                 "set end = 10 ns\n  set maximum bisections = 4");
    EXPECT_NE(report_of(replaced(scene, "bisections = 4",
                                 "bisections = 4\n  set maximum halvings = 4"))
                  .find("`maximum bisections` is given twice"),
              std::string::npos);
    InputErrors errors;
    const auto read = read_scene_text(scene, "small.prm",
                                      {"Time/maximum halvings=7"}, errors);
    ASSERT_NE(read, nullptr) << errors.report();
    EXPECT_EQ(read->time.maximum_bisections, 7u);
    InputErrors twice;
    read_scene_text(scene, "small.prm",
                    {"Time/maximum halvings=7", "Time/maximum bisections=7"},
                    twice);
    EXPECT_NE(twice.report().find("is set twice on the command line"),
              std::string::npos)
        << twice.report();
  }

  // A study reads its scene once per case.
  TEST(FormerWords, AreNotedOncePerStudy)
  {
    const auto folder = std::filesystem::temp_directory_path() /
                        ("nsfd_former_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    const std::string file = (folder / "small.prm").string();
    std::ofstream(file) << replaced(small_scene, "set end = 10 ns",
                                    "set end = 10 ns\n  set scheme = "
                                    "moreau-jean\nend\nsubsection Solver\n"
                                    "  set path = element-wise");
    InputErrors errors;
    const auto study =
        read_study(file, {},
                   {"Time/maximum halvings=3, 4", "Time/step=[0.25*2^0..1 "
                                                  "crossings]"},
                   errors);
    ASSERT_TRUE(study) << errors.report();
    const auto cases = read_cases(*study, {}, errors);
    EXPECT_FALSE(errors.has_errors()) << errors.report();
    ASSERT_EQ(cases.size(), 4u);
    EXPECT_EQ(cases[3].numbers.at("step"), 0.5);
    EXPECT_EQ(cases[3].half_step, "0.25 courant");
    EXPECT_NE(cases[3].scene.find("maximum bisections = 4"), std::string::npos);
    const std::string report = errors.report();
    EXPECT_EQ(count(report, "is called `maximum bisections` today"), 1u);
    EXPECT_EQ(count(report, "is called `local` today"), 1u) << report;
    std::filesystem::remove_all(folder);
  }
} // namespace nsfd::test_former_words
