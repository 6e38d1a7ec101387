#include "netcdf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>

namespace nsfd::netcdf
{
  namespace
  {
    /// bytes of the types 1 to 11
    constexpr std::array<std::size_t, 12> sizes = {
        {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8}};
    enum Type { byte = 1, character, short_int, int32, single, real };
    enum { unsigned_byte = 7, unsigned_short, unsigned_int, int64, uint64 };

    struct Variable {
      std::vector<std::size_t> shape;
      std::map<std::string, std::string> texts;   ///< attributes
      std::size_t type = 0, begin = 0, bytes = 0; ///< of all, or of a record
      bool has_records = false;
    };

    /** The whole file in memory; numbers have their first byte first. */
    class ClassicFile final : public File
    {
    public:
      explicit ClassicFile(std::string bytes) : bytes_(std::move(bytes))
      {
        read_header();
      }

      bool has(const std::string &variable) const override
      {
        return variables_.count(variable) != 0;
      }

      std::vector<std::size_t> shape(const std::string &variable) override
      {
        return find(variable).shape;
      }

      std::vector<double> numbers(const std::string &variable) override
      {
        const Variable &v = find(variable);
        std::vector<double> result;
        if (!v.has_records) {
          add(v, v.begin, variable, result);
          return result;
        }
        for (std::size_t r = 0; r < v.shape[0]; ++r)
          add(v, at_record(v, r, variable), variable, result);
        return result;
      }

      std::vector<double> last_numbers(const std::string &variable) override
      {
        const Variable &v = find(variable);
        std::vector<double> result;
        if (v.shape.empty() || v.shape[0] == 0)
          return result;
        if (v.has_records) {
          add(v, at_record(v, v.shape[0] - 1, variable), variable, result);
          return result;
        }
        const std::vector<double> all = numbers(variable);
        const std::size_t n = all.size() / v.shape[0];
        return {all.end() - std::ptrdiff_t(n), all.end()};
      }

      std::vector<std::string> texts(const std::string &variable) override
      {
        const Variable &v = find(variable);
        const std::size_t width = v.shape.empty() ? 1 : v.shape.back();
        const std::size_t n = n_values(v.shape, 1, bytes_.size(), variable);
        demand(v.begin, n, variable);
        return rows(bytes_.substr(v.begin, n), width);
      }

      std::string attribute(const std::string &variable,
                            const std::string &name) override
      {
        const auto &texts = find(variable).texts;
        const auto found = texts.find(name);
        return found == texts.end() ? "" : found->second;
      }

    private:
      const Variable &find(const std::string &name) const
      {
        const auto found = variables_.find(name);
        if (found == variables_.end())
          throw BadFile(fmt::format("it has no variable `{}`", name));
        return found->second;
      }

      void demand(const std::size_t at, const std::size_t n,
                  const std::string &what) const
      {
        if (at > bytes_.size() || n > bytes_.size() - at)
          throw BadFile(fmt::format("it ends early, in `{}`", what));
      }

      std::uint64_t natural(const std::size_t at, const std::size_t size) const
      {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < size; ++i)
          value = value << 8 | static_cast<unsigned char>(bytes_[at + i]);
        return value;
      }

      double number(const std::size_t at, const std::size_t type) const
      {
        const std::size_t size = sizes[type];
        const std::uint64_t bits = natural(at, size);
        if (type == single) {
          const auto part = std::uint32_t(bits);
          float value;
          std::memcpy(&value, &part, sizeof value);
          return double(value);
        }
        if (type == real) {
          double value;
          std::memcpy(&value, &bits, sizeof value);
          return value;
        }
        const bool has_sign = type < unsigned_byte || type == int64;
        const std::uint64_t sign = std::uint64_t(1) << (8 * size - 1);
        return has_sign && (bits & sign) != 0 ? -double((sign << 1) - bits)
                                              : double(bits);
      }

      void add(const Variable &v, const std::size_t at,
               const std::string &variable, std::vector<double> &result) const
      {
        const std::size_t size = sizes[v.type];
        demand(at, v.bytes, variable);
        for (std::size_t i = 0; i + size <= v.bytes; i += size)
          result.push_back(number(at + i, v.type));
      }

      std::size_t at_record(const Variable &v, const std::size_t record,
                            const std::string &variable) const
      {
        if (record_size_ > 0 && record > bytes_.size() / record_size_)
          throw BadFile(fmt::format("it ends early, in `{}`", variable));
        return v.begin + record * record_size_;
      }

      // --- the header

      std::size_t next(const std::size_t size)
      {
        demand(at_, size, "its header");
        const std::uint64_t value = natural(at_, size);
        at_ += size;
        return std::size_t(value);
      }

      /** Of the fifth version counts have eight bytes. */
      std::size_t next_count() { return next(version_ == 5 ? 8 : 4); }

      std::string next_text(const std::size_t n)
      {
        demand(at_, n, "its header");
        const std::string text = bytes_.substr(at_, n);
        at_ += (n + 3) / 4 * 4;
        return text;
      }

      std::size_t next_type()
      {
        const std::size_t type = next(4);
        if (type == 0 || type >= sizes.size())
          throw BadFile(fmt::format("its header has a type {}, which there is "
                                    "not",
                                    type));
        return type;
      }

      /** Of a list: its tag, and its length, which no header outgrows. */
      std::size_t next_list()
      {
        next(4);
        const std::size_t n = next_count();
        if (n > bytes_.size())
          throw BadFile("its header ends early");
        return n;
      }

      void read_attributes(std::map<std::string, std::string> *texts)
      {
        for (std::size_t n = next_list(); n > 0; --n) {
          const std::string name = next_text(next_count());
          const std::size_t type = next_type(), count = next_count();
          if (count > bytes_.size())
            throw BadFile("its header ends early");
          const std::string value = next_text(count * sizes[type]);
          if (texts != nullptr && type == character)
            (*texts)[name] = value.substr(0, value.find('\0'));
        }
      }

      void read_header()
      {
        demand(0, 4, "its header");
        version_ = static_cast<unsigned char>(bytes_[3]);
        at_ = 4;
        if (version_ != 1 && version_ != 2 && version_ != 5)
          throw BadFile(fmt::format("it is a netCDF file of version {}; there "
                                    "are 1, 2 and 5",
                                    version_));
        n_records_ = next_count();
        std::vector<std::size_t> lengths;
        for (std::size_t n = next_list(); n > 0; --n) {
          next_text(next_count());
          lengths.push_back(next_count());
        }
        read_attributes(nullptr);
        std::size_t n_of_records = 0, last_bytes = 0;
        for (std::size_t n = next_list(); n > 0; --n) {
          const std::string name = next_text(next_count());
          Variable v = next_variable(lengths, name);
          if (v.has_records) {
            ++n_of_records;
            last_bytes = v.bytes;
            record_size_ += (v.bytes + 3) / 4 * 4;
          }
          variables_.emplace(name, std::move(v));
        }
        if (n_of_records == 1)
          record_size_ = last_bytes; // one alone is not padded
      }

      Variable next_variable(const std::vector<std::size_t> &lengths,
                             const std::string &name)
      {
        Variable v;
        const std::size_t n_dimensions = next_count();
        if (n_dimensions > lengths.size())
          throw BadFile(fmt::format("the variable `{}` has {} dimensions, the "
                                    "file has {}",
                                    name, n_dimensions, lengths.size()));
        for (std::size_t d = 0; d < n_dimensions; ++d) {
          const std::size_t id = next_count();
          if (id >= lengths.size())
            throw BadFile(
                fmt::format("the variable `{}` has a dimension that is not "
                            "there",
                            name));
          v.shape.push_back(lengths[id]);
        }
        read_attributes(&v.texts);
        v.type = next_type();
        next_count(); // its bytes, which do not fit in if they are many
        v.begin = next(version_ == 1 ? 4 : 8);
        v.has_records = !v.shape.empty() && v.shape[0] == 0;
        std::vector<std::size_t> shape = v.shape;
        if (v.has_records) {
          shape.erase(shape.begin());
          v.shape[0] = n_records_;
        }
        v.bytes =
            sizes[v.type] * n_values(shape, sizes[v.type], bytes_.size(), name);
        return v;
      }

      const std::string bytes_;
      std::size_t at_ = 0; ///< in the header
      unsigned int version_ = 0;
      std::size_t n_records_ = 0, record_size_ = 0;
      std::map<std::string, Variable> variables_;
    };
  } // namespace

  std::unique_ptr<File> open_classic(const std::string &file)
  {
    std::ifstream in(file, std::ios::binary);
    return std::make_unique<ClassicFile>(
        std::string((std::istreambuf_iterator<char>(in)), {}));
  }

  std::unique_ptr<File> open_file(const std::string &file)
  {
    std::ifstream in(file, std::ios::binary);
    std::array<char, 8> head{};
    in.read(head.data(), head.size());
    if (std::memcmp(head.data(), "CDF", 3) == 0)
      return open_classic(file);
    if (std::memcmp(head.data(), "\x89HDF\r\n\x1a\n", 8) == 0)
      return open_hdf5(file);
    throw BadFile("this is no Exodus file: it is neither netCDF nor HDF5");
  }

  std::vector<std::string> rows(const std::string &characters,
                                const std::size_t width)
  {
    std::vector<std::string> result;
    for (std::size_t at = 0; width > 0 && at + width <= characters.size();
         at += width) {
      std::string row = characters.substr(at, width);
      row = row.substr(0, row.find('\0'));
      const std::size_t last = row.find_last_not_of(' ');
      result.push_back(row.substr(0, last + 1));
    }
    return result;
  }

  std::size_t n_values(const std::vector<std::size_t> &shape,
                       const std::size_t size, const std::size_t most,
                       const std::string &variable)
  {
    std::size_t n = 1;
    for (const std::size_t length : shape) {
      if (length > 0 && n > most / size / length)
        throw BadFile(fmt::format("the variable `{}` is said to have more "
                                  "values than fit into the file",
                                  variable));
      n *= length;
    }
    return n;
  }
} // namespace nsfd::netcdf
