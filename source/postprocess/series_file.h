#pragma once

#include "core/hdf5_file.h"
#include "vtu.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** What a time may take in an HDF5 file, with all of its headers, in bytes.
   */
  std::size_t most_bytes(const VtuGrid &grid);

  /**
   * Room for @p bytes more in the file, or on an empty one. HDF5 must never
   * meet a full disk: it ends the program when it cannot write what it holds.
   * @throws OutputError
   */
  void reserve_room(const std::string &name, bool anew, std::size_t bytes);

  /** The stored type of an array, of HDF5. */
  hid_t stored_type(VtuNumber number);

  /**
   * The HDF5 file of a series, open for one time. Paths are absolute; of @p
   * shape the first entry is the number of rows. All functions throw
   * OutputError.
   */
  class SeriesFile
  {
  public:
    SeriesFile(const std::string &name, bool anew);

    void group(const std::string &path);

    /** A set of one size; @p in_memory are the @p values converted to @p type.
     */
    void write(const std::string &path, hid_t type,
               const std::vector<hsize_t> &shape, const void *values,
               hid_t in_memory);
    void write(const std::string &path, const std::vector<std::string> &texts);

    /**
     * Rows at the end of a set that grows; it is made, with chunks as long as
     * these rows are, if it is not there.
     */
    void append(const std::string &path, hid_t type,
                const std::vector<hsize_t> &shape, const void *values,
                hid_t in_memory);

    /** The first rows stay. */
    void cut(const std::string &path, hsize_t rows);

    /** Of a group or set; made, or given another value. */
    void integers(const std::string &path, const std::string &name,
                  const std::vector<std::int64_t> &values);
    void attribute(const std::string &path, const std::string &name,
                   double value);
    void attribute(const std::string &path, const std::string &name,
                   const std::string &text);

    void link(const std::string &from, const std::string &to);
    bool has(const std::string &path) const;
    /** Names of all that a group holds. */
    std::vector<std::string> names(const std::string &group) const;
    void remove(const std::string &path);
    void flush();

  private:
    void demand(bool good) const;
    void attribute(const std::string &path, const std::string &name, hid_t type,
                   hid_t space, const void *value);

    const stored::QuietHdf5 quiet_;
    const std::string name_;
    stored::Handle file_;
  };
} // namespace nsfd
