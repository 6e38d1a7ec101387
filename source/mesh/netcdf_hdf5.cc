#include "core/hdf5_file.h"
#include "netcdf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace nsfd::netcdf
{
  namespace
  {
    using stored::Handle;

    /** netCDF-4: variables are data sets of the root of a file of HDF5. */
    class Hdf5File final : public File
    {
    public:
      explicit Hdf5File(const std::string &file)
          : file_(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose)
      {
        if (!file_)
          throw BadFile("HDF5 cannot open it");
        // what is packed by zlib is not unpacked without bound
        constexpr std::size_t small = std::size_t(1) << 26, ratio = 200;
        most_bytes_ = std::max<std::size_t>(
            small, ratio * std::filesystem::file_size(file));
      }

      bool has(const std::string &variable) const override
      {
        return H5Lexists(file_, variable.c_str(), H5P_DEFAULT) > 0;
      }

      std::vector<std::size_t> shape(const std::string &variable) override
      {
        const Handle set = open(variable);
        return extents(set, variable);
      }

      std::vector<double> numbers(const std::string &variable) override
      {
        const Handle set = open(variable);
        const std::vector<std::size_t> shape = extents(set, variable);
        std::vector<double> result(
            n_values(shape, sizeof(double), most_bytes_, variable));
        if (!result.empty() && H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL,
                                       H5P_DEFAULT, result.data()) < 0)
          throw cannot_read(variable);
        return result;
      }

      std::vector<double> last_numbers(const std::string &variable) override
      {
        const Handle set = open(variable);
        const std::vector<std::size_t> shape = extents(set, variable);
        if (shape.empty() || shape[0] == 0)
          return {};
        std::vector<hsize_t> start(shape.size(), 0),
            count(shape.begin(), shape.end());
        start[0] = shape[0] - 1;
        count[0] = 1;
        std::vector<double> result(n_values({count.begin(), count.end()},
                                            sizeof(double), most_bytes_,
                                            variable));
        const Handle space(H5Dget_space(set), H5Sclose),
            memory(H5Screate_simple(int(count.size()), count.data(), nullptr),
                   H5Sclose);
        if (!space || !memory ||
            H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr,
                                count.data(), nullptr) < 0 ||
            H5Dread(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT,
                    result.data()) < 0)
          throw cannot_read(variable);
        return result;
      }

      std::vector<std::string> texts(const std::string &variable) override
      {
        const Handle set = open(variable);
        const std::vector<std::size_t> shape = extents(set, variable);
        std::string characters(n_values(shape, 1, most_bytes_, variable), '\0');
        const Handle type(H5Dget_type(set), H5Tclose);
        if (!type || H5Tget_size(type) != 1)
          throw BadFile(fmt::format("the variable `{}` is no text", variable));
        if (!characters.empty() && H5Dread(set, type, H5S_ALL, H5S_ALL,
                                           H5P_DEFAULT, &characters[0]) < 0)
          throw cannot_read(variable);
        return rows(characters, shape.empty() ? 1 : shape.back());
      }

      std::string attribute(const std::string &variable,
                            const std::string &name) override
      {
        const Handle set = open(variable);
        if (H5Aexists(set, name.c_str()) <= 0)
          return "";
        const Handle at(H5Aopen(set, name.c_str(), H5P_DEFAULT), H5Aclose);
        const Handle type(at ? H5Aget_type(at) : -1, H5Tclose);
        if (!type || H5Tget_class(type) != H5T_STRING)
          throw cannot_read(variable + ":" + name);
        return H5Tis_variable_str(type) > 0 ? variable_text(at, type)
                                            : fixed_text(at, type);
      }

    private:
      static BadFile cannot_read(const std::string &variable)
      {
        return BadFile(fmt::format("HDF5 cannot read `{}`", variable));
      }

      static std::string fixed_text(const Handle &at, const Handle &type)
      {
        constexpr std::size_t longest = 4096;
        const std::size_t n = H5Tget_size(type);
        std::string text(n, '\0');
        const Handle space(H5Aget_space(at), H5Sclose);
        if (n == 0 || n > longest || !space ||
            H5Sget_simple_extent_npoints(space) != 1 ||
            H5Aread(at, type, &text[0]) < 0)
          return "";
        return text.substr(0, text.find('\0'));
      }

      static std::string variable_text(const Handle &at, const Handle &type)
      {
        const Handle space(H5Aget_space(at), H5Sclose);
        char *text = nullptr;
        if (!space || H5Sget_simple_extent_npoints(space) != 1 ||
            H5Aread(at, type, &text) < 0 || text == nullptr)
          return "";
        const std::string result = text;
        H5free_memory(text);
        return result;
      }

      Handle open(const std::string &variable) const
      {
        Handle set(H5Dopen2(file_, variable.c_str(), H5P_DEFAULT), H5Dclose);
        if (!set)
          throw BadFile(fmt::format("it has no variable `{}`", variable));
        return set;
      }

      static std::vector<std::size_t> extents(const Handle &set,
                                              const std::string &variable)
      {
        const Handle space(H5Dget_space(set), H5Sclose);
        const int n = space ? H5Sget_simple_extent_ndims(space) : -1;
        if (n < 0)
          throw cannot_read(variable);
        std::vector<hsize_t> lengths(std::size_t(n), 0);
        if (n > 0)
          H5Sget_simple_extent_dims(space, lengths.data(), nullptr);
        return {lengths.begin(), lengths.end()};
      }

      const stored::QuietHdf5 quiet_;
      Handle file_;
      std::size_t most_bytes_ = 0;
    };
  } // namespace

  std::unique_ptr<File> open_hdf5(const std::string &file)
  {
    return std::make_unique<Hdf5File>(file);
  }
} // namespace nsfd::netcdf
