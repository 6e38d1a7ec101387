#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * A CSV file of numbers: each row is on the disk as soon as it is written.
   * Numbers are the shortest that read back to the same double. Throws
   * std::runtime_error when the file cannot be written.
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
    std::uintmax_t n_bytes();

    /**
     * The rows in the first @p n_bytes of a file with so many columns.
     * @throws std::runtime_error if it is shorter, or these are no rows.
     */
    static std::vector<std::vector<double>> read(const std::string &path,
                                                 std::size_t n_columns,
                                                 std::uintmax_t n_bytes);

    static std::string header(const std::vector<std::string> &columns);

  private:
    void write_line(const std::string &line);

    std::string path_;
    std::size_t n_columns_;
    std::ofstream file_;
  };
} // namespace nsfd
