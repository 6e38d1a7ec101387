#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * A table that grows while a run goes on: a header, then lines that are on
   * disk as soon as they are written. Throws std::runtime_error when the file
   * cannot be written.
   */
  class RowFile
  {
  public:
    /** Starts the file. */
    RowFile(const std::string &path, const std::string &header);

    /**
     * Goes on with a file of which the first @p n_bytes are kept and what
     * follows is cut off.
     */
    RowFile(const std::string &path, std::uintmax_t n_bytes);

    /** One line or several, without the last line break. */
    void write(const std::string &lines);

    /** Of all rows so far, on the disk for good when this returns. */
    std::uintmax_t n_bytes();

    const std::string &path() const { return path_; }

  private:
    void demand_good() const;

    std::string path_;
    std::ofstream file_;
  };

  /**
   * The first @p n_bytes of such a file.
   * @throws std::runtime_error if it is shorter.
   */
  std::string read_rows(const std::string &path, std::uintmax_t n_bytes);

  /** The @p n numbers of a line; empty if there are others. */
  std::vector<double> numbers_of(const std::string &line, std::size_t n);
} // namespace nsfd
