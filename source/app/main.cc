#include "command_line.h"
#include "core/output_folder.h"
#include "mesh/gmsh_process.h"
#include "processes.h"
#include "subcommand.h"

#include <iostream>

int main(int argc, char **argv)
{
  using namespace nsfd;
  if (const auto code = run_gmsh_if_asked(argc, argv))
    return *code;
  try {
    CommandLine line;
    if (const auto code =
            parse_command_line(argc, argv, line, std::cout, std::cerr))
      return *code;
    return line.subcommand->execute(line);
  } catch (const OutputError &error) {
    std::cerr << "error: " << error.what() << "\n";
    return exit_code::internal_error;
  } catch (const std::exception &error) {
    return report_failure(error);
  }
}
