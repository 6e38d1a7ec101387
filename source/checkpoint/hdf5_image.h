#pragma once

#include "core/hdf5_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace nsfd
{
  /** An HDF5 file in memory, with a user block in front. One process. */
  class Hdf5Image
  {
  public:
    /** An empty one, to be written. */
    explicit Hdf5Image(std::size_t user_block);
    /** To be read. */
    explicit Hdf5Image(std::vector<char> &bytes);

    template <typename T>
    void write(const std::string &path, const std::vector<T> &values,
               unsigned int components = 1);
    void write(const std::string &path, const std::string &text);

    /** False if there is none of this name and type. */
    template <typename T>
    bool read(const std::string &path, std::vector<T> &values,
              unsigned int &components) const;
    bool read(const std::string &path, std::string &text) const;

    /**
     * Everything that was written, behind a user block of zeros. @throws
     * std::runtime_error if not.
     */
    std::vector<char> bytes();

  private:
    void write(const std::string &path, hid_t type,
               const std::vector<hsize_t> &shape, const void *values);
    stored::Handle open(const std::string &path) const;

    const stored::QuietHdf5 quiet_;
    const std::size_t user_block_ = 0;
    stored::Handle file_;
    bool good_ = true;
  };
} // namespace nsfd
