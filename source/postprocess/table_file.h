#pragma once

#include "row_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * A growing table of numbers, the shortest that read back to the same
   * double.
   */
  class TableFile
  {
  public:
    /** Starts the file with the names of its columns. */
    TableFile(const std::string &path, const std::vector<std::string> &columns);

    /**
     * Goes on with a file of which the first @p n_bytes are kept and what
     * follows is cut off.
     */
    TableFile(const std::string &path, const std::vector<std::string> &columns,
              std::uintmax_t n_bytes);

    void write(const std::vector<double> &row);

    /** Of all rows so far, on the disk for good when this returns. */
    std::uintmax_t n_bytes() { return rows_.n_bytes(); }

    /**
     * The rows in the first @p n_bytes of a file with so many columns.
     * @throws std::runtime_error if it is shorter, or these are no rows.
     */
    static std::vector<std::vector<double>> read(const std::string &path,
                                                 std::size_t n_columns,
                                                 std::uintmax_t n_bytes);

    static std::string header(const std::vector<std::string> &columns);

  private:
    std::size_t n_columns_;
    RowFile rows_;
  };
} // namespace nsfd
