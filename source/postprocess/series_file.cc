#include "series_file.h"

#include "core/output_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <functional>
#include <numeric>

namespace nsfd
{
  using stored::Handle;

  namespace
  {
    constexpr std::size_t most_of_chunk = 1 << 18; ///< bytes
  }

  std::size_t most_bytes(const VtuGrid &grid)
  {
    std::size_t bytes = 1 << 16;
    // the last chunk may be all but empty, and there are sets beside it
    const auto add = [&bytes](const std::size_t n) {
      bytes += 8 * n + std::min(8 * n, most_of_chunk) + 8192;
    };
    add(3 * grid.points.size());
    add(grid.connectivity.size() + 2 * grid.cells.size());
    add(grid.cells.size() + 1);
    for (const auto *arrays : {&grid.point_data, &grid.cell_data})
      for (const VtuGrid::Array &array : *arrays)
        add(array.values.size());
    return bytes;
  }

  void reserve_room(const std::string &name, const bool anew,
                    const std::size_t bytes)
  {
    const int file =
        open(name.c_str(),
             O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC | (anew ? O_TRUNC : 0),
             0666);
    int failure = errno;
    if (file >= 0) {
      struct stat status = {};
      fstat(file, &status);
      failure = posix_fallocate(file, status.st_size, off_t(bytes));
      if (failure != 0 && ftruncate(file, status.st_size) != 0)
        failure = errno;
      close(file);
    }
    if (file < 0 || failure != 0)
      throw OutputError("Cannot write '" + name +
                        "': " + std::strerror(failure) + '.');
  }

  hid_t stored_type(const VtuNumber number)
  {
    switch (number) {
    case VtuNumber::integer:
      return H5T_STD_I32LE;
    case VtuNumber::code:
      return H5T_STD_U8LE;
    default:
      return H5T_IEEE_F64LE;
    }
  }

  SeriesFile::SeriesFile(const std::string &name, const bool anew)
      : name_(name),
        file_(anew ? H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT,
                               H5P_DEFAULT)
                   : H5Fopen(name.c_str(), H5F_ACC_RDWR, H5P_DEFAULT),
              H5Fclose)
  {
    demand(bool(file_));
  }

  void SeriesFile::group(const std::string &path)
  {
    const Handle group(
        H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Gclose);
    demand(bool(group));
  }

  void SeriesFile::write(const std::string &path, const hid_t type,
                         const std::vector<hsize_t> &shape, const void *values,
                         const hid_t in_memory)
  {
    const Handle space(
        H5Screate_simple(int(shape.size()), shape.data(), nullptr), H5Sclose);
    const Handle set(H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT,
                                H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
    demand(set && H5Dwrite(set, in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                           values) >= 0);
  }

  void SeriesFile::write(const std::string &path,
                         const std::vector<std::string> &texts)
  {
    std::vector<const char *> pointers;
    for (const std::string &text : texts)
      pointers.push_back(text.c_str());
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    demand(H5Tset_size(type, H5T_VARIABLE) >= 0);
    write(path, type, {pointers.size()}, pointers.data(), type);
  }

  void SeriesFile::append(const std::string &path, const hid_t type,
                          const std::vector<hsize_t> &shape, const void *values,
                          const hid_t in_memory)
  {
    const int rank = int(shape.size());
    if (!has(path)) {
      std::vector<hsize_t> none = shape, most = shape, chunk = shape;
      none[0] = 0;
      most[0] = H5S_UNLIMITED;
      // whole rows, in parts that are equal
      const std::size_t row =
          std::accumulate(shape.begin() + 1, shape.end(), H5Tget_size(type),
                          std::multiplies<std::size_t>());
      const hsize_t parts = row * shape[0] / most_of_chunk + 1;
      // small ones are the tables of a row for each time
      chunk[0] = std::max<hsize_t>((shape[0] + parts - 1) / parts, 16);
      const Handle space(H5Screate_simple(rank, none.data(), most.data()),
                         H5Sclose),
          creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
      H5Pset_chunk(creation, rank, chunk.data());
      const Handle set(H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT,
                                  creation, H5P_DEFAULT),
                       H5Dclose);
      demand(bool(set));
    }
    if (shape[0] == 0)
      return;
    const Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    demand(bool(set));
    std::vector<hsize_t> begin(shape.size(), 0), size = shape;
    {
      const Handle before(H5Dget_space(set), H5Sclose);
      demand(H5Sget_simple_extent_ndims(before) == rank);
      H5Sget_simple_extent_dims(before, size.data(), nullptr);
    }
    begin[0] = size[0];
    size[0] += shape[0];
    demand(H5Dset_extent(set, size.data()) >= 0);
    const Handle space(H5Dget_space(set), H5Sclose),
        part(H5Screate_simple(rank, shape.data(), nullptr), H5Sclose);
    demand(H5Sselect_hyperslab(space, H5S_SELECT_SET, begin.data(), nullptr,
                               shape.data(), nullptr) >= 0 &&
           H5Dwrite(set, in_memory, part, space, H5P_DEFAULT, values) >= 0);
  }

  void SeriesFile::cut(const std::string &path, const hsize_t rows)
  {
    const Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    demand(bool(set));
    const Handle space(H5Dget_space(set), H5Sclose);
    std::vector<hsize_t> size(
        std::size_t(std::max(1, H5Sget_simple_extent_ndims(space))));
    demand(H5Sget_simple_extent_dims(space, size.data(), nullptr) ==
               int(size.size()) &&
           size[0] >= rows);
    size[0] = rows;
    demand(H5Dset_extent(set, size.data()) >= 0);
  }

  void SeriesFile::attribute(const std::string &path, const std::string &name,
                             const hid_t type, const hid_t space,
                             const void *value)
  {
    const Handle object(H5Oopen(file_, path.c_str(), H5P_DEFAULT), H5Oclose);
    demand(bool(object));
    const bool is_there = H5Aexists(object, name.c_str()) > 0;
    const Handle attribute(is_there
                               ? H5Aopen(object, name.c_str(), H5P_DEFAULT)
                               : H5Acreate2(object, name.c_str(), type, space,
                                            H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    demand(attribute && H5Awrite(attribute, type, value) >= 0);
  }

  void SeriesFile::integers(const std::string &path, const std::string &name,
                            const std::vector<std::int64_t> &values)
  {
    const hsize_t size = values.size();
    const Handle space(size == 1 ? H5Screate(H5S_SCALAR)
                                 : H5Screate_simple(1, &size, nullptr),
                       H5Sclose);
    attribute(path, name, H5T_NATIVE_INT64, space, values.data());
  }

  void SeriesFile::attribute(const std::string &path, const std::string &name,
                             const double value)
  {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    attribute(path, name, H5T_NATIVE_DOUBLE, space, &value);
  }

  void SeriesFile::attribute(const std::string &path, const std::string &name,
                             const std::string &text)
  {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose),
        type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, std::max<std::size_t>(1, text.size()));
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    attribute(path, name, type, space, text.c_str());
  }

  void SeriesFile::link(const std::string &from, const std::string &to)
  {
    demand(H5Lcreate_hard(file_, from.c_str(), file_, to.c_str(), H5P_DEFAULT,
                          H5P_DEFAULT) >= 0);
  }

  bool SeriesFile::has(const std::string &path) const
  {
    return H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0;
  }

  std::vector<std::string> SeriesFile::names(const std::string &group) const
  {
    std::vector<std::string> found;
    const Handle handle(H5Gopen2(file_, group.c_str(), H5P_DEFAULT), H5Gclose);
    const auto add = [](hid_t, const char *name, const H5L_info_t *,
                        void *data) -> herr_t {
      static_cast<std::vector<std::string> *>(data)->emplace_back(name);
      return 0;
    };
    demand(handle && H5Literate(handle, H5_INDEX_NAME, H5_ITER_INC, nullptr,
                                add, &found) >= 0);
    return found;
  }

  void SeriesFile::remove(const std::string &path)
  {
    demand(H5Ldelete(file_, path.c_str(), H5P_DEFAULT) >= 0);
  }

  void SeriesFile::flush() { demand(H5Fflush(file_, H5F_SCOPE_LOCAL) >= 0); }

  void SeriesFile::demand(const bool good) const
  {
    if (!good)
      throw OutputError("Cannot write '" + name_ + "'.");
  }
} // namespace nsfd
