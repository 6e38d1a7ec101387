#pragma once

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace nsfd::netcdf
{
  /** What is wrong with a file. */
  struct BadFile : std::runtime_error {
    using std::runtime_error::runtime_error;
  };

  /**
   * Variables of a netCDF file, which is of the classic kind or one of HDF5.
   * All of it throws BadFile; nothing takes much more memory than the file has
   * bytes, whatever its header says.
   */
  class File
  {
  public:
    virtual ~File() = default;

    virtual bool has(const std::string &variable) const = 0;
    /** Lengths of its dimensions; that of the records is what there is. */
    virtual std::vector<std::size_t> shape(const std::string &variable) = 0;
    /** Its values, the last dimension fastest. */
    virtual std::vector<double> numbers(const std::string &variable) = 0;
    /** Those of the last entry of the first dimension: the last time. */
    virtual std::vector<double> last_numbers(const std::string &variable) = 0;
    /** Rows of characters, without blanks and zeros at their ends. */
    virtual std::vector<std::string> texts(const std::string &variable) = 0;
    /** A text; empty if there is no such attribute. */
    virtual std::string attribute(const std::string &variable,
                                  const std::string &name) = 0;
  };

  std::unique_ptr<File> open_file(const std::string &file);
  std::unique_ptr<File> open_classic(const std::string &file);
  std::unique_ptr<File> open_hdf5(const std::string &file);

  /** Rows of @p width characters each. */
  std::vector<std::string> rows(const std::string &characters,
                                std::size_t width);

  /**
   * The number of values of these dimensions; refused if they have more than
   * @p most bytes, @p size each.
   */
  std::size_t n_values(const std::vector<std::size_t> &shape, std::size_t size,
                       std::size_t most, const std::string &variable);
} // namespace nsfd::netcdf
