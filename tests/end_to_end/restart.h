#pragma once

#include "program.h"

/** Runs that are stopped, killed and resumed. */
namespace end_to_end
{
  /** `nsfd FILE --set ... --output DIRECTORY`, then @p more. */
  std::vector<std::string> command_of(const Launch &what,
                                      const std::filesystem::path &directory,
                                      const std::vector<std::string> &more);

  /** The same launch with --resume in the directory of @p name. */
  Result resume(const Workspace &workspace, const std::string &name,
                const Launch &what);

  /** With other settings, in place of those of the same name. */
  Launch with(Launch launch, const std::vector<std::string> &settings);

  /** With a checkpoint every @p steps. */
  Launch storing(Launch what, unsigned int steps);

  std::filesystem::path newest(const std::filesystem::path &directory);
  std::filesystem::path previous(const std::filesystem::path &directory);

  /** @p before goes as far as 0.8 of the steps of @p whole, @p after on. With
      ASSERT_NO_FATAL_FAILURE. */
  void go_on(const Workspace &workspace, const Launch &before,
             const Launch &after, const Result &whole, Result &resumed);

  /** Wait until history.csv has so many rows; false if it takes too long. */
  bool wait_for_rows(const std::filesystem::path &directory, long n);
} // namespace end_to_end
