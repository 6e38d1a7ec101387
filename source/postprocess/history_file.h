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
    /** What follows the columns that all runs have. */
    struct Columns {
      std::vector<std::string> driven; ///< names of the boundaries
      unsigned int dimension = 2;
      bool absorbed = false;     ///< there are absorbing sides: the last column
      bool axisymmetric = false; ///< measures are per radian
      bool heat = false;         ///< the last columns of all
      bool heated_sides = false; ///< one more behind them
      bool load_time = false;    ///< the last one of all

      std::size_t n_reactions() const { return driven.size() * dimension; }
    };

    /** Starts the file. */
    HistoryFile(const std::string &path, const Columns &columns);

    /**
     * Goes on with a file of which the first @p n_bytes are kept and what
     * follows is cut off.
     */
    HistoryFile(const std::string &path, const Columns &columns,
                std::uintmax_t n_bytes);

    /** @p load_time (s) is the last column, where Columns has it. */
    void write(const HistoryRow &row, double load_time = 0.);

    /** Of all rows so far, on the disk for good when this returns. */
    std::uintmax_t n_bytes() { return file_.n_bytes(); }

    /**
     * The rows in the first @p n_bytes of a file with these columns.
     * @throws std::runtime_error if it is shorter, or these are no rows.
     */
    static std::vector<HistoryRow> read(const std::string &path,
                                        const Columns &columns,
                                        std::uintmax_t n_bytes);

    static std::string header(const Columns &columns);

  private:
    const bool absorbed_, heat_, heated_sides_, load_time_;
    TableFile file_;
  };
} // namespace nsfd
