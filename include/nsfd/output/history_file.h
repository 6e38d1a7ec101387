#pragma once

#include "nsfd/output/run_record.h"

#include <fstream>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * history.csv: one row per accepted step, on disk as soon as it is written.
   * Numbers are the shortest that read back to the same double. Throws
   * std::runtime_error when the file cannot be written.
   */
  class HistoryFile
  {
  public:
    /** Starts the file; @p driven are the names of the driven boundaries. */
    HistoryFile(const std::string &path, const std::vector<std::string> &driven,
                unsigned int dimension);

    void write(const HistoryRow &row);

    static std::string header(const std::vector<std::string> &driven,
                              unsigned int dimension);

  private:
    void write_line(const std::string &line);

    std::string path_;
    std::size_t n_reactions_;
    std::ofstream file_;
  };
} // namespace nsfd
