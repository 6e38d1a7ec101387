#include "command_line.h"
#include "core/output_folder.h"
#include "mesh/gmsh_process.h"
#include "processes.h"
#include "subcommand.h"

#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>

int main(int argc, char **argv)
{
  using namespace nsfd;
  if (const auto code = run_gmsh_if_asked(argc, argv))
    return *code;
  // a case of a study that is killed would go on in a folder which the next
  // study needs; killed before this line, it is no parent any more
  if (const char *const study = std::getenv("NSFD_CASE_OF_A_STUDY")) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const long parent = std::atol(study);
    if (parent > 0 && parent != long(getppid()))
      return exit_code::stopped;
  }
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
