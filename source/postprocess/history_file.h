#pragma once

#include "nsfd/records/run_record.h"
#include "table_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace nsfd
{
  /** history.csv: one row per accepted step, a table of numbers. */
  class HistoryFile
  {
  public:
    /** Starts the file; @p driven are the names of the driven boundaries. */
    HistoryFile(const std::string &path, const std::vector<std::string> &driven,
                unsigned int dimension);

    /**
     * Goes on with a file of which the first @p n_bytes are kept and what
     * follows is cut off.
     */
    HistoryFile(const std::string &path, const std::vector<std::string> &driven,
                unsigned int dimension, std::uintmax_t n_bytes);

    void write(const HistoryRow &row);

    /** Of all rows so far, on the disk for good when this returns. */
    std::uintmax_t n_bytes() { return file_.n_bytes(); }

    /**
     * The rows in the first @p n_bytes of a file with so many reactions.
     * @throws std::runtime_error if it is shorter, or these are no rows.
     */
    static std::vector<HistoryRow> read(const std::string &path,
                                        std::size_t n_reactions,
                                        std::uintmax_t n_bytes);

    static std::string header(const std::vector<std::string> &driven,
                              unsigned int dimension);

  private:
    TableFile file_;
  };
} // namespace nsfd
