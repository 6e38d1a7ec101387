#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <iterator>

// Parts built outside of this tree: nsfd is installed in the folder of the
// test, the examples of doc/examples are built against it the way a user would,
// listed, checked, driven, run on ranks, resumed, and refused.

namespace end_to_end::test_plug_ins
{
  namespace fs = std::filesystem;

  namespace
  {
    const std::string law_name = "exponential softening";

    class PlugIns : public testing::Test
    {
    protected:
      const Workspace workspace_;
      const fs::path prefix_ = workspace_.path() / "prefix";

      void SetUp() override
      {
        do_it({NSFD_CMAKE, "--install", NSFD_BUILD_DIR, "--prefix",
               prefix_.string()});
        ASSERT_TRUE(fs::exists(program()));
      }

      std::string program() const { return (prefix_ / "bin/nsfd").string(); }

      void do_it(const std::vector<std::string> &command) const
      {
        const Outcome outcome = Process(command, workspace_.path()).wait(120.);
        ASSERT_EQ(outcome.exit_code, 0)
            << command[0] << " " << command[1] << "\n"
            << outcome.out << outcome.err;
      }

      Outcome nsfd(std::vector<std::string> words) const
      {
        words.insert(words.begin(), program());
        return Process(words, workspace_.path()).wait(60.);
      }

      /** A copy of doc/examples/@p example in the folder @p name. */
      fs::path copy(const std::string &example, const std::string &name) const
      {
        const fs::path folder = workspace_.path() / name;
        fs::copy(fs::path(NSFD_SOURCE_DIR) / "doc/examples" / example, folder);
        return folder;
      }

      /** The library that two commands make of a folder. */
      std::string build(const fs::path &folder, const std::string &name) const
      {
        const std::string target = (folder / "build").string();
        do_it({NSFD_CMAKE, "-S", folder.string(), "-B", target,
               "-DCMAKE_PREFIX_PATH=" + prefix_.string(),
               "-DCMAKE_CXX_FLAGS=-Werror"});
        do_it({NSFD_CMAKE, "--build", target, "--parallel", "2"});
        return target + "/" + name + ".so";
      }

      /** The example of a law with changes in its source. */
      std::string changed_law(
          const std::string &name,
          const std::vector<std::pair<std::string, std::string>> &changes) const
      {
        const fs::path folder = copy("cohesive_law", name);
        const fs::path source = folder / "exponential_softening.cc";
        std::string text = read_text(source);
        for (const auto &[from, to] : changes) {
          EXPECT_NE(text.find(from), std::string::npos) << from;
          text = replaced(text, from, to);
        }
        write_text(source, text);
        return build(folder, "exponential_softening");
      }

      Launch launch(const std::string &scene, const std::string &library) const
      {
        Launch what{workspace_.path() / scene};
        what.program = program();
        what.more = {"--plug-in", library};
        return what;
      }

      /** Exit code 1, and all of these in the message. */
      void expect_refused(const Outcome &outcome,
                          const std::vector<std::string> &texts) const
      {
        EXPECT_EQ(outcome.exit_code, 1);
        for (const std::string &text : texts)
          EXPECT_NE(outcome.err.find(text), std::string::npos)
              << "`" << text << "` in\n"
              << outcome.err;
      }

      /** The traction of the curve is R_max exp(-u R_max / G). */
      void expect_exponential_curve(const std::string &library) const
      {
        const fs::path folder = workspace_.path() / "curve";
        const Outcome outcome = nsfd(
            {"law", law_name, "--plug-in", library, "--set", "strength=100 MPa",
             "--opening", "0, 20 nm", "--output", folder.string(), "--force"});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const History curve(read_text(folder / "curve.csv"));
        ASSERT_GE(curve.size(), 400u);
        EXPECT_EQ(curve["opening"].back(), 20e-9);
        for (std::size_t i = 1; i < curve.size(); ++i) {
          const double u = curve["opening"][i];
          ASSERT_NEAR(curve["cohesive_normal"][i],
                      1e8 * std::exp(-u * 1e8 / 0.5), 1e-12 * 1e8)
              << "u = " << u;
        }
      }
    };

    /** What run.json says of plug-ins. */
    nlohmann::json recorded(const fs::path &directory)
    {
      return nlohmann::json::parse(read_text(directory / "run.json"))
          .at("plug_ins");
    }
  } // namespace

  // Each of them alone, and without the sources of the program.
  TEST_F(PlugIns, HeadersStandAlone)
  {
    const fs::path folder = workspace_.path() / "headers";
    fs::create_directory(folder);
    unsigned int n = 0;
    for (const auto &file :
         fs::recursive_directory_iterator(prefix_ / "include"))
      if (file.path().extension() == ".h")
        write_text(folder / (std::to_string(n++) + ".cc"),
                   "#include \"" + file.path().string() + "\"\n");
    EXPECT_GT(n, 40u);
    write_text(folder / "CMakeLists.txt",
               "cmake_minimum_required(VERSION 3.22)\n"
               "project(headers LANGUAGES CXX)\n"
               "find_package(nsfd REQUIRED)\n"
               "file(GLOB files *.cc)\n"
               "nsfd_add_plug_in(headers ${files})\n");
    build(folder, "headers");
  }

  TEST_F(PlugIns, CohesiveLaw)
  {
    const fs::path folder = copy("cohesive_law", "law");
    const std::string library = build(folder, "exponential_softening");
    const Outcome list = nsfd({"--list", "--plug-in", library});
    EXPECT_EQ(list.exit_code, 0);
    EXPECT_NE(list.out.find("  " + law_name), std::string::npos) << list.out;
    EXPECT_NE(list.out.find("of the plug-in " + library), std::string::npos);
    EXPECT_EQ(nsfd({"--list"}).out.find(law_name), std::string::npos);
    expect_exponential_curve(library);
    const Outcome kept =
        nsfd({"law", law_name, "--contract", "--plug-in", library});
    EXPECT_EQ(kept.exit_code, 0) << kept.out << kept.err;
    EXPECT_NE(kept.out.find("kept    dissipation never falls"),
              std::string::npos);

    const Launch what = launch("law/pulled_apart.prm", library);
    EXPECT_EQ(
        nsfd({what.file.string(), "--check", "--plug-in", library}).exit_code,
        0);
    const Result whole = good_run(workspace_, "whole", what);
    ASSERT_TRUE(whole.completed());
    // toughness times height, but for exp(-30) times a factor of 30
    EXPECT_NEAR(whole.dissipated("damage"), 5e-6, 1e-11 * 5e-6);
    const auto plug_in = recorded(whole.directory).at(0);
    EXPECT_EQ(plug_in.at("name"), "exponential_softening");
    EXPECT_EQ(plug_in.at("file"), library);
    EXPECT_TRUE(plug_in.at("used"));

    Launch parallel = what;
    parallel.ranks = 2;
    const Result both = good_run(workspace_, "both", parallel);
    EXPECT_TRUE(whole.history_text == both.history_text);
  }

  TEST_F(PlugIns, ResumedRuns)
  {
    const fs::path folder = copy("cohesive_law", "law");
    const std::string library = build(folder, "exponential_softening");
    const Launch what = launch("law/pulled_apart.prm", library);
    const Result whole = good_run(workspace_, "whole", what);
    ASSERT_TRUE(whole.completed());
    const Launch stored =
        storing(what, unsigned(0.4 * whole.number("steps")) + 1);
    const Result before = good_run(workspace_, "resumed", stored);
    fs::rename(previous(before.directory), newest(before.directory));

    // the scene no longer says what it needs, its law is another one
    const fs::path scene = folder / "pulled_apart.prm";
    const std::string text = read_text(scene);
    write_text(scene, replaced(replaced(text, "set plug-ins", "# set plug-ins"),
                               law_name, "camacho-ortiz"));
    Launch without = stored;
    without.more = {};
    expect_refused(resume(workspace_, "resumed", without).outcome,
                   {"`exponential_softening` is not loaded", "--plug-in"});
    write_text(scene, text);

    // the same name, another formula
    Launch other = stored;
    other.more = {"--plug-in", changed_law("other", {{"-d / length()",
                                                      "-2. * d / length()"}})};
    expect_refused(resume(workspace_, "resumed", other).outcome,
                   {other.more[1] + " is another file now", "--output DIR"});

    const Result after = resume(workspace_, "resumed", stored);
    ASSERT_TRUE(after.completed()) << after.description();
    EXPECT_EQ(after.counter("resumed"), 1.);
    EXPECT_TRUE(whole.history_text == after.history_text);
  }

  // From a folder of the environment, by the program that is not installed.
  TEST_F(PlugIns, Observable)
  {
    const fs::path folder = copy("observable", "observable");
    const std::string library = build(folder, "momentum");
    setenv("NSFD_PLUG_INS", (folder / "build").c_str(), 1);
    Launch what{folder / "thrown_plate.prm"};
    const Result one = good_run(workspace_, "one", what);
    what.ranks = 2;
    const Result two = good_run(workspace_, "two", what);
    unsetenv("NSFD_PLUG_INS");
    ASSERT_TRUE(one.completed() && two.completed());
    EXPECT_EQ(recorded(one.directory).at(0).at("file"), library);

    const fs::path file = "observables/momentum.csv";
    const std::string text = read_text(one.directory / file);
    EXPECT_EQ(text, read_text(two.directory / file));
    // m (v_0 + g t), at the middle of the step: theta = 1/2
    const History rows(text);
    ASSERT_EQ(rows.size(), 21u);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double t = rows["time"][i] - (i > 0 ? 0.5 * 1e-4 : 0.);
      EXPECT_NEAR(rows["mass"][i], 500., 1e-12 * 500.);
      EXPECT_NEAR(rows["momentum_x"][i], 1000., 1e-11 * 1000.);
      EXPECT_NEAR(rows["momentum_y"][i], -500. * 9.81 * t, 1e-11 * 1000.);
    }
  }

  TEST_F(PlugIns, VerificationCase)
  {
    const fs::path folder = copy("verification_case", "case");
    const std::string library = build(folder, "growing_force");
    const Result result = good_run(workspace_, "growing_force",
                                   launch("case/growing_force.prm", library));
    ASSERT_TRUE(result.completed());
    const auto bounds = nlohmann::json::parse(read_text(folder / "bounds.json"))
                            .at("growing_force")
                            .at("bounds");
    for (const auto &[name, bound] : bounds.items())
      expect_below(name,
                   std::abs(result.error(name) - bound.value("value", 0.)),
                   bound.at("tolerance"), bound.at("reason"));
  }

  TEST_F(PlugIns, StudiesPassThemOn)
  {
    const fs::path folder = copy("cohesive_law", "law");
    const std::string library = build(folder, "exponential_softening");
    const Outcome outcome =
        nsfd({"study", (folder / "pulled_apart.prm").string(), "--vary",
              "Interface: midline/toughness=0.4 J/m^2, 0.5 J/m^2", "--set",
              "Time/end=4 ns", "--output", "study", "--plug-in", library});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  }

  TEST_F(PlugIns, RefusedWithTheReason)
  {
    const fs::path folder = copy("cohesive_law", "law");
    const fs::path scene = folder / "pulled_apart.prm";
    const std::string library = build(folder, "exponential_softening");
    const auto load = [&](const std::string &file) {
      return nsfd({"--list", "--plug-in", file});
    };

    // a scene loads nothing: it says what to type
    expect_refused(nsfd({scene.string()}),
                   {":5: error: the plug-in `exponential_softening` is not "
                    "loaded",
                    "type: nsfd " + scene.string() + " --plug-in " + library});
    write_text(scene, replaced(read_text(scene), "set plug-ins", "# "));
    expect_refused(nsfd({scene.string()}), {"law = exponential softening is "
                                            "not a law",
                                            "needs --plug-in FILE"});

    EXPECT_EQ(
        nsfd({"--list", "--plug-in", library, "--plug-in",
              (folder / "build/../build/exponential_softening.so").string()})
            .exit_code,
        0)
        << "the same file twice";
    expect_refused(load("gone.so"), {"gone.so: error: there is no such file"});
    expect_refused(load(scene.string()), {"it is not a shared library"});
    expect_refused(load(NSFD_PROGRAM), {"but no plug-in of nsfd"});
    expect_refused(
        load(changed_law("taken", {{"\"" + law_name + "\"", "\"tvergaard\""}})),
        {"registers a name that is taken: `tvergaard` of the program"});
    expect_refused(
        load(changed_law("undefined", {{"{ return strength_; }", ";"}})),
        {"a virtual function of `nsfd::ExponentialSoftening` is declared and "
         "not defined"});

    // a law that takes twice its toughness is loaded, and found out
    const std::string tougher = changed_law(
        "tougher", {{"{ return toughness_; }", "{ return 2. * toughness_; }"}});
    const Outcome broken =
        nsfd({"law", law_name, "--contract", "--plug-in", tougher});
    EXPECT_EQ(broken.exit_code, 1);
    EXPECT_NE(broken.out.find("BROKEN  dissipation never falls and ends at the "
                              "toughness"),
              std::string::npos)
        << broken.out;

    // a class may be called like one of the program and remains its own
    expect_exponential_curve(
        changed_law("namesake", {{"ExponentialSoftening", "CamachoOrtiz"}}));

    // public headers change, plug-ins are built again
    const fs::path interface = prefix_ / "include/nsfd/core/interface.h";
    const std::string text = read_text(interface);
    write_text(interface,
               replaced(text, "NSFD_INTERFACE \"", "NSFD_INTERFACE \"other"));
    const std::string other = changed_law("later", {});
    expect_refused(load(other), {other + ": error: the plug-in "
                                         "`exponential_softening` was built "
                                         "against nsfd ",
                                 "interface other", "this program is nsfd ",
                                 "-DCMAKE_PREFIX_PATH=" + prefix_.string()});
  }
} // namespace end_to_end::test_plug_ins
