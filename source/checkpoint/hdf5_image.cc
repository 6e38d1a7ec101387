#include "hdf5_image.h"

#include <stdexcept>

namespace nsfd
{
  using stored::Handle;

  namespace
  {
    template <typename T>
    hid_t native_type();
    template <>
    hid_t native_type<double>()
    {
      return H5T_NATIVE_DOUBLE;
    }
    template <>
    hid_t native_type<std::uint8_t>()
    {
      return H5T_NATIVE_UINT8;
    }
    template <>
    hid_t native_type<std::uint32_t>()
    {
      return H5T_NATIVE_UINT32;
    }
    template <>
    hid_t native_type<std::uint64_t>()
    {
      return H5T_NATIVE_UINT64;
    }

    Handle in_memory(std::vector<char> *bytes)
    {
      Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
      H5Pset_fapl_core(access, 1 << 20, false);
      if (bytes)
        H5Pset_file_image(access, bytes->data(), bytes->size());
      return access;
    }

    Handle create(const std::size_t user_block)
    {
      const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
      H5Pset_userblock(creation, user_block);
      return Handle(H5Fcreate("checkpoint that is written", H5F_ACC_TRUNC,
                              creation, in_memory(nullptr)),
                    H5Fclose);
    }
  } // namespace

  Hdf5Image::Hdf5Image(const std::size_t user_block)
      : user_block_(user_block), file_(create(user_block)), good_(bool(file_))
  {
  }

  Hdf5Image::Hdf5Image(std::vector<char> &bytes)
      : file_(H5Fopen("checkpoint that is read", H5F_ACC_RDONLY,
                      in_memory(&bytes)),
              H5Fclose),
        good_(bool(file_))
  {
  }

  void Hdf5Image::write(const std::string &path, const hid_t type,
                        const std::vector<hsize_t> &shape, const void *values)
  {
    const Handle space(shape.empty() ? H5Screate(H5S_SCALAR)
                                     : H5Screate_simple(int(shape.size()),
                                                        shape.data(), nullptr),
                       H5Sclose);
    const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(links, 1);
    const Handle set(H5Dcreate2(file_, path.c_str(), type, space, links,
                                H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
    good_ = good_ && set &&
            H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0;
  }

  template <typename T>
  void Hdf5Image::write(const std::string &path, const std::vector<T> &values,
                        const unsigned int components)
  {
    std::vector<hsize_t> shape = {values.size()};
    if (components > 1)
      shape = {values.size() / components, components};
    write(path, native_type<T>(), shape, values.data());
  }

  void Hdf5Image::write(const std::string &path, const std::string &text)
  {
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, text.size() + 1);
    write(path, type, {}, text.c_str());
  }

  Handle Hdf5Image::open(const std::string &path) const
  {
    return Handle(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
  }

  template <typename T>
  bool Hdf5Image::read(const std::string &path, std::vector<T> &values,
                       unsigned int &components) const
  {
    const Handle set = open(path);
    if (!set)
      return false;
    const Handle space(H5Dget_space(set), H5Sclose);
    hsize_t shape[2] = {0, 1};
    if (H5Sget_simple_extent_ndims(space) > 2 ||
        H5Sget_simple_extent_dims(space, shape, nullptr) < 1)
      return false;
    components = unsigned(shape[1]);
    values.resize(shape[0] * shape[1]);
    return H5Dread(set, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                   values.data()) >= 0;
  }

  bool Hdf5Image::read(const std::string &path, std::string &text) const
  {
    const Handle set = open(path);
    if (!set)
      return false;
    const Handle type(H5Dget_type(set), H5Tclose);
    if (H5Tget_class(type) != H5T_STRING)
      return false;
    text.assign(H5Tget_size(type), '\0');
    const bool good =
        H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) >= 0;
    while (!text.empty() && text.back() == '\0')
      text.pop_back();
    return good;
  }

  std::vector<char> Hdf5Image::bytes()
  {
    good_ = good_ && H5Fflush(file_, H5F_SCOPE_LOCAL) >= 0;
    const ssize_t size = good_ ? H5Fget_file_image(file_, nullptr, 0) : -1;
    const std::size_t n = size > 0 ? std::size_t(size) : 0;
    std::vector<char> result(user_block_ + n); // the image is without it
    if (n == 0 || H5Fget_file_image(file_, &result[user_block_], n) != size)
      throw std::runtime_error("HDF5 could not hold it in memory");
    return result;
  }

#define NSFD_INSTANTIATE(T)                                                    \
  template void Hdf5Image::write(const std::string &, const std::vector<T> &,  \
                                 unsigned int);                                \
  template bool Hdf5Image::read(const std::string &, std::vector<T> &,         \
                                unsigned int &) const;
  NSFD_INSTANTIATE(double)
  NSFD_INSTANTIATE(std::uint8_t)
  NSFD_INSTANTIATE(std::uint32_t)
  NSFD_INSTANTIATE(std::uint64_t)
#undef NSFD_INSTANTIATE
#undef NSFD_INSTANTIATE
} // namespace nsfd
