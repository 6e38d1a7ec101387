#include "compare_command.h"
#include "comparison.h"

#include "core/exit_code.h"
#include "core/output_folder.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <ostream>
#include <stdexcept>

namespace nsfd
{
  int run_compare(const CompareCommand &command, std::ostream &out,
                  std::ostream &err)
  {
    std::vector<RunFolder> runs;
    bool all_read = true;
    for (const std::string &name : command.runs)
      try {
        runs.push_back(read_run(name));
      } catch (const std::runtime_error &error) {
        err << "nsfd compare: " << error.what() << "\n";
        all_read = false;
      }
    if (!all_read)
      return exit_code::bad_input;
    if (!command.output.empty() &&
        !claim_directory(command.output, command.force))
      return exit_code::bad_input;

    const Comparison comparison = compare_runs(std::move(runs));
    const auto largest = comparison.largest();
    const bool within =
        !command.tolerance || largest.difference <= *command.tolerance;
    if (!command.quiet) {
      out << comparison_text(comparison);
      out << fmt::format("largest difference of results: {:.2e}",
                         largest.difference);
      if (!largest.name.empty())
        out << ", " << largest.name;
      if (command.tolerance)
        out << fmt::format("; {} {:g}", within ? "within" : "beyond",
                           *command.tolerance);
      out << "\n";
    }
    if (!command.output.empty()) {
      OutputFolder &folder = OutputFolder::instance();
      folder.describe(nlohmann::json{
          {"subcommand", "compare"},
          {"runs",
           command.runs}}.dump());
      write_file_atomically(command.output + "/compare.json",
                            comparison_json(comparison, command.tolerance));
      write_comparison_page(comparison, command.output);
      folder.finish();
      if (!command.quiet)
        out << command.output << "/compare.html\n";
    }
    return within ? exit_code::done : exit_code::differs;
  }
} // namespace nsfd
