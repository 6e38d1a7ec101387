#include "vtk_bytes.h"
#include "vtk_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>

namespace nsfd::vtk
{
  namespace
  {
    /** What is wrong with a file; leaves by read_legacy(). */
    struct Refusal : std::runtime_error {
      using std::runtime_error::runtime_error;
    };

    enum class NumberKind { none, integer, natural, real };
    struct NumberType {
      NumberKind kind;
      std::size_t size; ///< bytes
    };

    const std::map<std::string, NumberType> number_types = {
        {"char", {NumberKind::integer, 1}},
        {"unsigned_char", {NumberKind::natural, 1}},
        {"short", {NumberKind::integer, 2}},
        {"unsigned_short", {NumberKind::natural, 2}},
        {"int", {NumberKind::integer, 4}},
        {"unsigned_int", {NumberKind::natural, 4}},
        {"vtkIdType", {NumberKind::integer, 4}}, // whatever it is in memory
        {"vtktypeint32", {NumberKind::integer, 4}},
        {"vtktypeuint32", {NumberKind::natural, 4}},
        {"long", {NumberKind::integer, 8}},
        {"unsigned_long", {NumberKind::natural, 8}},
        {"vtktypeint64", {NumberKind::integer, 8}},
        {"vtktypeuint64", {NumberKind::natural, 8}},
        {"float", {NumberKind::real, 4}},
        {"double", {NumberKind::real, 8}}};

    /** Of a binary file: the first byte weighs most. */
    double big_endian(const char *bytes, const NumberType &type)
    {
      std::uint64_t bits = 0;
      for (std::size_t i = 0; i < type.size; ++i)
        bits = bits << 8 | static_cast<unsigned char>(bytes[i]);
      if (type.kind == NumberKind::natural)
        return double(bits);
      if (type.kind == NumberKind::integer) {
        const std::uint64_t sign = std::uint64_t(1) << (8 * type.size - 1);
        return (bits & sign) != 0 ? -double((sign << 1) - bits) : double(bits);
      }
      if (type.size == 4) {
        const auto half = std::uint32_t(bits);
        float value;
        std::memcpy(&value, &half, sizeof value);
        return double(value);
      }
      double value;
      std::memcpy(&value, &bits, sizeof value);
      return value;
    }

    /** `%20` is a blank. */
    std::string without_codes(const std::string &name)
    {
      std::string result;
      for (std::size_t i = 0; i < name.size(); ++i) {
        int code = 0;
        const char *const at = name.data() + i + 1;
        if (name[i] == '%' && i + 2 < name.size() &&
            std::from_chars(at, at + 2, code, 16).ptr == at + 2) {
          result += char(code);
          i += 2;
        } else
          result += name[i];
      }
      return result;
    }

    class LegacyReader
    {
    public:
      explicit LegacyReader(std::string text) : text_(std::move(text)) {}

      Grid read()
      {
        if (next_line().rfind("# vtk DataFile", 0) != 0)
          throw Refusal(
              "this is no VTK file: it does not begin with # vtk DataFile");
        next_line(); // title
        const std::string format = next_line();
        is_binary_ = format.rfind("BINARY", 0) == 0;
        if (!is_binary_ && format.rfind("ASCII", 0) != 0)
          throw Refusal(fmt::format("its third line is `{}`; it must be ASCII "
                                    "or BINARY",
                                    format));
        for (std::string line; find_line(line);)
          read_block(line);
        return std::move(grid_);
      }

    private:
      std::string next_line()
      {
        const std::size_t end = std::min(text_.find('\n', at_), text_.size());
        std::string line = text_.substr(at_, end - at_);
        at_ = std::min(end + 1, text_.size());
        while (!line.empty() &&
               std::isspace(static_cast<unsigned char>(line.back())))
          line.pop_back();
        return line;
      }

      /** The next one that is not empty; false at the end. */
      bool find_line(std::string &line)
      {
        while (at_ < text_.size())
          if (line = next_line(); !line.empty())
            return true;
        return false;
      }

      NumberType type_of(const std::string &name, const std::string &array)
      {
        const auto found = number_types.find(name);
        if (found != number_types.end())
          return found->second;
        throw Refusal(fmt::format("the array `{}` is of the type `{}`, which "
                                  "is not read; save the file without it",
                                  array, name));
      }

      std::vector<double> numbers(const std::size_t n, const NumberType type,
                                  const std::string &array)
      {
        const std::size_t left = text_.size() - at_;
        const std::size_t least = is_binary_ ? type.size : 1;
        if (n > left / least)
          throw Refusal(
              fmt::format("it ends early: {} values of `{}` do not fit into "
                          "the {} bytes that are left",
                          n, array, left));
        std::vector<double> result;
        result.reserve(n);
        for (std::size_t i = 0; i < n; ++i)
          result.push_back(is_binary_
                               ? big_endian(&text_[at_ + i * type.size], type)
                               : next_number(array));
        if (is_binary_)
          at_ += n * type.size;
        return result;
      }

      double next_number(const std::string &array)
      {
        std::string word;
        const auto value = vtk::next_number(text_, at_, word);
        if (!value)
          throw Refusal(
              word.empty()
                  ? fmt::format("it ends early, in `{}`", array)
                  : fmt::format("`{}` in `{}` is not a number", word, array));
        return *value;
      }

      /** Words of a line behind the first one. */
      struct Line {
        std::istringstream in;
        explicit Line(const std::string &text) : in(text)
        {
          std::string keyword;
          in >> keyword;
        }
        std::string word()
        {
          std::string result;
          in >> result;
          return result;
        }
        std::size_t count(const std::size_t otherwise = 0)
        {
          std::size_t n = otherwise;
          const std::string text = word();
          std::from_chars(text.data(), text.data() + text.size(), n);
          return n;
        }
      };

      void read_block(const std::string &text)
      {
        Line line(text);
        std::istringstream in(text);
        std::string keyword;
        in >> keyword;
        if (keyword == "DATASET") {
          const std::string kind = line.word();
          if (kind != "UNSTRUCTURED_GRID")
            throw Refusal(fmt::format("its data set is {}; an "
                                      "UNSTRUCTURED_GRID is needed",
                                      kind));
        } else if (keyword == "POINTS") {
          const std::size_t n = line.count();
          grid_.coordinates =
              numbers(times(n, 3), type_of(line.word(), "POINTS"), "POINTS");
        } else if (keyword == "CELLS")
          read_cells(line);
        else if (keyword == "CELL_TYPES")
          grid_.types =
              numbers(line.count(), {NumberKind::integer, 4}, "CELL_TYPES");
        else if (keyword == "CELL_DATA" || keyword == "POINT_DATA") {
          n_tuples_ = line.count();
          is_cell_data_ = keyword == "CELL_DATA";
        } else if (keyword == "METADATA")
          while (at_ < text_.size() && !next_line().empty()) {
          }
        else if (keyword == "FIELD")
          read_field(line);
        else
          read_attribute(keyword, line);
      }

      static std::size_t times(const std::size_t a, const std::size_t b)
      {
        // more than any file holds, refused where it is read
        constexpr std::size_t most = std::size_t(1) << 60;
        return b > 0 && a > most / b ? most : a * b;
      }

      /** Versions before 5 give the number of corners with every cell. */
      void read_cells(Line &line)
      {
        const std::size_t n = line.count(), size = line.count();
        const std::size_t here = at_;
        const std::string next = next_line();
        if (next.rfind("OFFSETS", 0) == 0) {
          Line offsets(next);
          grid_.first =
              numbers(n, type_of(offsets.word(), "OFFSETS"), "OFFSETS");
          std::string connectivity;
          find_line(connectivity);
          Line words(connectivity);
          grid_.points = numbers(size, type_of(words.word(), "CONNECTIVITY"),
                                 "CONNECTIVITY");
          return;
        }
        at_ = here;
        const std::vector<double> all =
            numbers(size, {NumberKind::integer, 4}, "CELLS");
        for (std::size_t i = 0, c = 0; c < n; ++c) {
          const bool is_there =
              i < all.size() && all[i] >= 0. && all[i] < double(all.size() - i);
          if (!is_there)
            throw Refusal(fmt::format("CELLS ends early, in cell {}", c));
          const auto end = i + 1 + std::size_t(all[i]);
          grid_.points.insert(grid_.points.end(),
                              all.begin() + std::ptrdiff_t(i + 1),
                              all.begin() + std::ptrdiff_t(end));
          grid_.first.push_back(double(grid_.points.size()));
          i = end;
        }
      }

      void keep(const std::string &name, const std::size_t n_components,
                std::vector<double> values)
      {
        if (is_cell_data_)
          grid_.cell_arrays.push_back(
              {without_codes(name), n_components, std::move(values)});
      }

      void read_field(Line &line)
      {
        line.word(); // its name
        const std::size_t n = line.count();
        for (std::size_t k = 0; k < n; ++k) {
          std::string text;
          if (!find_line(text))
            throw Refusal("it ends early, in a FIELD");
          if (text.rfind("METADATA", 0) == 0) {
            read_block(text);
            if (!find_line(text))
              throw Refusal("it ends early, in a FIELD");
          }
          std::istringstream words(text);
          std::string name, components, tuples, type;
          words >> name >> components >> tuples >> type;
          Line counts("x " + components + " " + tuples);
          const std::size_t n_components = counts.count(),
                            n_tuples = counts.count();
          keep(name, n_components,
               numbers(times(n_components, n_tuples), type_of(type, name),
                       name));
        }
      }

      void read_attribute(const std::string &keyword, Line &line)
      {
        const std::string name = line.word();
        const NumberType byte = {NumberKind::natural, 1};
        if (keyword == "SCALARS") {
          const NumberType type = type_of(line.word(), name);
          const std::size_t n = line.count(1);
          const std::size_t here = at_;
          if (next_line().rfind("LOOKUP_TABLE", 0) != 0)
            at_ = here;
          keep(name, n, numbers(times(n_tuples_, n), type, name));
        } else if (keyword == "LOOKUP_TABLE")
          numbers(times(line.count(), 4), byte, name);
        else if (keyword == "COLOR_SCALARS")
          numbers(times(n_tuples_, line.count()), byte, name);
        else if (keyword == "TEXTURE_COORDINATES") {
          const std::size_t n = line.count();
          numbers(times(n_tuples_, n), type_of(line.word(), name), name);
        } else {
          static const std::map<std::string, std::size_t> widths = {
              {"VECTORS", 3},   {"NORMALS", 3},    {"TENSORS", 9},
              {"TENSORS6", 6},  {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1},
              {"EDGE_FLAGS", 1}};
          const auto width = widths.find(keyword);
          if (width == widths.end())
            throw Refusal(
                fmt::format("`{}` is not known where a keyword is expected",
                            keyword.substr(0, 40)));
          keep(name, width->second,
               numbers(times(n_tuples_, width->second),
                       type_of(line.word(), name), name));
        }
      }

      const std::string text_;
      std::size_t at_ = 0, n_tuples_ = 0;
      bool is_binary_ = false, is_cell_data_ = false;
      Grid grid_;
    };
  } // namespace

  Grid read_legacy(const std::string &file, std::vector<std::string> &problems)
  {
    std::ifstream in(file, std::ios::binary);
    std::string text((std::istreambuf_iterator<char>(in)), {});
    try {
      return LegacyReader(std::move(text)).read();
    } catch (const Refusal &refusal) {
      problems.emplace_back(refusal.what());
      return {};
    }
  }
} // namespace nsfd::vtk
