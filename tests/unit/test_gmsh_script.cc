// Scripts of Gmsh: what may stand in them.

#include "mesh/gmsh_script.h"
#include "mesh/gmsh_words.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

using namespace nsfd;

namespace test_gmsh_script
{
  struct Filtered {
    std::string text;
    std::vector<std::string> includes, problems;
  };

  Filtered filtered(const std::string &text)
  {
    Filtered result;
    result.text =
        filter_gmsh_script(text, "", result.includes, result.problems);
    return result;
  }

  void expect_refused(const std::string &text, const std::string &words,
                      const unsigned int line = 1)
  {
    const auto problems = filtered(text).problems;
    ASSERT_FALSE(problems.empty()) << text;
    EXPECT_EQ(problems[0].find("line " + std::to_string(line) + ":"), 0u)
        << text << "\n"
        << problems[0];
    EXPECT_NE(problems[0].find(words), std::string::npos) << text << "\n"
                                                          << problems[0];
  }

  void expect_passes(const std::string &text)
  {
    for (const std::string &problem : filtered(text).problems)
      ADD_FAILURE() << text << "\n" << problem;
  }

  TEST(GmshScript, CommandsAreRefusedByNameAndLine)
  {
    for (const char *word : {"SystemCall",
                             "NonBlockingSystemCall",
                             "System",
                             "OnelabRun",
                             "Save",
                             "Print",
                             "CreateDir",
                             "Merge",
                             "MergeWithBoundingBox",
                             "Draw",
                             "Abort",
                             "Exit",
                             "Sleep",
                             "Plugin",
                             "ListFromFile",
                             "ShapeFromFile",
                             "GetEnv",
                             "GetValue",
                             "StringToName",
                             "S2N",
                             "SetString",
                             "Solver",
                             "PostProcessing",
                             "View"})
      expect_refused("// first\n\n" + std::string(word) + " \"x\";",
                     "`" + std::string(word) + "`", 3);
  }

  TEST(GmshScript, AllRefusedWordsAreNamedAtOnce)
  {
    const auto problems =
        filtered("SystemCall \"a\";\nPoint(1) = {0, 0, 0};\nSave \"b\";\n"
                 "Printf(\"c\") > \"d\";\nExit;")
            .problems;
    ASSERT_EQ(problems.size(), 4u);
    EXPECT_EQ(problems[0], "line 1: `SystemCall` runs a command; a mesh script "
                           "may only describe geometry and meshing");
    EXPECT_EQ(problems[1].find("line 3: `Save` writes a file"), 0u);
    EXPECT_EQ(problems[2].find("line 4: `Printf`"), 0u);
    EXPECT_EQ(problems[3].find("line 5: `Exit`"), 0u);
  }

  TEST(GmshScript, WaysAroundTheWords)
  {
    // broken words are two names, which is no command either
    expect_refused("Sy\nstemCall \"ls\";", "`Sy`");
    expect_refused("Sy/* */stemCall \"ls\";", "`Sy`");
    // a command of another release
    expect_refused("RunThis \"ls\";", "`RunThis`");
    expect_refused("RunThis 5;", "`RunThis`");
    expect_refused("RunThis Str[\"ls\"];", "`RunThis`");
    // comments that are none, and the end of real ones
    expect_refused("/* /* */ SystemCall \"ls\"; */", "`SystemCall`");
    expect_refused("// \\\nSystemCall \"ls\";", "`SystemCall`", 2);
    expect_refused("x = 1; /*/ SystemCall \"ls\"; */ Save \"x\";", "`Save`");
    expect_refused("/* no end", "comment");
    // Gmsh knows no escapes in strings
    expect_refused("x = \"\\\"; SystemCall \"ls\";", "`SystemCall`");
    expect_refused("x = 'a\" ; Save 'b';", "quote");
    expect_refused("x = \"no end\nSystemCall 'ls';", "no end");
    // Gmsh cuts a string at 1024 letters and obeys the rest
    expect_refused("x = \"" + std::string(1100, 'a') + " SystemCall 'ls';\";",
                   "longer than");
    // Gmsh looks for the end of a branch without regard to strings
    expect_refused("If (0)\nx = \" EndIf SystemCall \";\nEndIf", "`EndIf`", 2);
    expect_refused("x = \"/*\"; y = \"*/\";", "comment");
    // by way of the options
    expect_refused("Solver.Executable0 = \"ls\";", "`Solver`");
    expect_refused("General.TmpFileName = \"x\";", "`General.TmpFileName`");
    expect_refused("General.OptionsFileName = \"x\";",
                   "General.OptionsFileName");
    expect_refused("General . ErrorFileName = \"x\";", "General.ErrorFileName");
    expect_refused("Geometry.DoubleClickedPointCommand = \"x\";", "Command");
    expect_refused("a = b.c;", "`b.c`");
    expect_refused("Field[1] = ExternalProcess;", "`ExternalProcess`");
    expect_refused("Field[1] = Structured;", "`Structured`");
    expect_refused("Field[ x[(1)] ] = PostView;", "`PostView`");
    expect_refused("Field[1].FileName = \"/etc/passwd\";", "`FileName`");
    expect_refused("Field[1].CommandLine = \"ls\";", "`CommandLine`");
    // all ways of Printf to a file
    expect_refused("Printf(\"%g\", f(1)) >> \"x\";", "`Printf`");
    expect_refused("Printf(\"%g\", (1 > 0)) > Str[\"x\"];", "`Printf`");
    // other folders
    expect_refused("Include \"../x.geo\";", "folder");
    expect_refused("Include \"/etc/passwd\";", "folder");
    expect_refused("Include Str[\"x.geo\"];", "in quotes");
    expect_refused("Include \"a.geo\" Save;", "semicolon");
    // what Gmsh's lexer does not know
    expect_refused("$MeshFormat", "`$`");
    expect_refused(std::string("a = 1;\0b", 8), "byte 0");
  }

  TEST(GmshScript, NamesAndTextsAreFree)
  {
    expect_passes("// SystemCall \"x\"; Save \"y\";\n/* Merge \"z\"; */");
    expect_passes("Physical Surface(\"Save the SystemCall\", 3) = {1};");
    expect_passes("saved = 1; print() = {1, 2}; Sleepy = saved + print(0);");
    expect_passes("For i In {0 : 4 : .5}\n x~{i} = 2^i;\nEndFor");
    expect_passes("If (a > 1 && b) c += 1; ElseIf (!a) c = 1e-3; Else c = 2.;"
                  " EndIf");
    expect_passes("Macro column\n Point(newp) = {x, y, 0, h};\nReturn\n"
                  "Call column;");
    expect_passes("DefineConstant[ n = {4, Min 1, Max 20, Step 1, Name "
                  "\"Parameters/n\"} ];");
    expect_passes("Printf(\"h = %g\", h); Error(\"no\"); Warning(\"%g\", 2);");
    expect_passes(
        "Mesh.Algorithm = 6; Mesh.MeshSizeMax *= 2; Geometry.Tolerance "
        "= 1e-6; General.Terminal = 1; Mesh.Color.Lines = Red;");
    expect_passes("Field[1] = Threshold; Field[1].DistMin = .1;\n"
                  "Field[2] = MathEval; Field[2].F = \"x^2\";\n"
                  "Background Field = 2;");
    expect_passes("Transfinite Curve {1, 2} = 10 Using Progression 1.1;\n"
                  "Transfinite Surface {1} Alternated; Recombine Surface {1};");
    expect_passes(
        "SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 1, 1, 1};\n"
        "v() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; };");
    expect_passes("e[] = Extrude {0, 0, 1} { Surface{1}; Layers{3}; Recombine; "
                  "};\nCurve{1} In Surface{1}; Coherence Mesh; Mesh 2;");
  }

  TEST(GmshScript, TextKeepsItsLinesAndLosesItsComments)
  {
    EXPECT_EQ(filtered("a = 1; // one\n/* two\nthree */ b = 'c';\n").text,
              "a = 1; \n \n b = 'c';\n");
    // Gmsh must not stop reading in the middle of a string
    std::string list = "x() = {0";
    for (unsigned int i = 0; i < 20000; ++i)
      list += ", 1";
    list += "};\n";
    const auto long_line = filtered(list);
    EXPECT_TRUE(long_line.problems.empty());
    std::istringstream lines(long_line.text);
    std::string line;
    while (std::getline(lines, line))
      EXPECT_LT(line.size(), 8192u);
  }

  TEST(GmshScript, EveryShippedScriptPasses)
  {
    unsigned int n = 0;
    for (const char *folder : {"/prm/meshes", "/tests/meshes"})
      for (const auto &entry : std::filesystem::directory_iterator(
               std::string(NSFD_SOURCE_DIR) + folder))
        if (entry.path().extension() == ".geo") {
          ++n;
          std::vector<std::string> problems;
          read_gmsh_script(entry.path().string(), problems);
          for (const std::string &problem : problems)
            ADD_FAILURE() << entry.path() << ": " << problem;
        }
    EXPECT_GT(n, 15u);
  }

  TEST(GmshScript, IncludedFilesAreFilteredToo)
  {
    namespace fs = std::filesystem;
    const fs::path folder = fs::temp_directory_path() / "nsfd_test_included";
    fs::create_directories(folder);
    std::ofstream(folder / "main.geo") << "Include \"sizes.txt\";\n"
                                          "Include \"missing.geo\";\n";
    std::ofstream(folder / "sizes.txt") << "h = 1;\nSystemCall \"ls\";\n"
                                           "Include \"sizes.txt\";\n";
    std::vector<std::string> problems;
    const GmshScript script =
        read_gmsh_script((folder / "main.geo").string(), problems);
    EXPECT_EQ(script.files.size(), 2u);
    ASSERT_EQ(problems.size(), 3u);
    EXPECT_EQ(problems[0].find("line 2 of `sizes.txt`: `SystemCall`"), 0u)
        << problems[0];
    EXPECT_NE(problems[1].find("includes itself"), std::string::npos);
    EXPECT_NE(problems[2].find("missing.geo"), std::string::npos);
    fs::remove_all(folder);
  }

  TEST(GmshScript, ListedWordsAreOneThingOnly)
  {
    EXPECT_EQ(classify_gmsh_word("Point"), GmshWord::allowed);
    EXPECT_EQ(classify_gmsh_word("SystemCall"), GmshWord::refused);
    EXPECT_EQ(classify_gmsh_word("my_length"), GmshWord::free);
    EXPECT_EQ(deed_of_gmsh_word("Save"), "writes a file");
  }
} // namespace test_gmsh_script
