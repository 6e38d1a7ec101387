#include "vtk_bytes.h"
#include "vtk_grid.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>

namespace nsfd::vtk
{
  namespace
  {
    using Attributes = std::map<std::string, std::string>;

    struct XmlArray {
      std::string section; ///< Points, Cells, CellData
      Attributes attributes;
      std::string text;
      std::string name() const
      {
        const auto found = attributes.find("Name");
        return found == attributes.end() ? section : found->second;
      }
    };

    struct Piece {
      std::size_t n_points = 0, n_cells = 0;
      std::vector<XmlArray> arrays;
    };

    /** The tags of a file; values are still text. */
    class XmlFile
    {
    public:
      std::vector<Piece> pieces;
      Encoding encoding;
      bool appended_is_base64 = true;
      std::size_t appended_at = 0; ///< of the first value; 0: there are none

      /** Empty, or what is wrong. */
      std::string parse(const std::string &text)
      {
        parser_.reset(XML_ParserCreate(nullptr));
        XML_SetUserData(parser_.get(), this);
        XML_SetElementHandler(parser_.get(), begin, end);
        XML_SetCharacterDataHandler(parser_.get(), characters);
        // no file of VTK has one, and entities come with it
        XML_SetStartDoctypeDeclHandler(parser_.get(), doctype);
        constexpr std::size_t chunk = std::size_t(1) << 24; // a length is int
        for (std::size_t at = 0; at <= text.size() && !is_done_;) {
          const std::size_t n = std::min(chunk, text.size() - at);
          const bool is_last = at + n == text.size();
          if (XML_Parse(parser_.get(), text.data() + at, int(n), is_last) ==
                  XML_STATUS_ERROR &&
              !is_done_)
            return fmt::format(
                "line {}: it is no XML: {}",
                XML_GetCurrentLineNumber(parser_.get()),
                XML_ErrorString(XML_GetErrorCode(parser_.get())));
          if (is_last)
            break;
          at += n;
        }
        if (problem_.empty() && !is_vtk_)
          return "it has no element VTKFile";
        if (problem_.empty() && is_appended_)
          find_appended(text);
        return problem_;
      }

    private:
      struct Free {
        void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
      };

      static XmlFile &of(void *data) { return *static_cast<XmlFile *>(data); }

      static void begin(void *data, const char *name, const char **attributes)
      {
        Attributes all;
        for (; *attributes != nullptr; attributes += 2)
          all[attributes[0]] = attributes[1];
        of(data).open(name, all);
      }

      static void end(void *data, const char *name) { of(data).close(name); }

      static void characters(void *data, const char *text, const int length)
      {
        XmlFile &file = of(data);
        if (file.collects_ && file.depth_in_array_ == 0)
          file.pieces.back().arrays.back().text.append(text,
                                                       std::size_t(length));
      }

      static void doctype(void *data, const char *, const char *, const char *,
                          int)
      {
        of(data).stop("it has a DOCTYPE, which no file of VTK has");
      }

      void stop(const std::string &problem)
      {
        if (problem_.empty())
          problem_ = problem;
        is_done_ = true;
        XML_StopParser(parser_.get(), XML_FALSE);
      }

      void open(const std::string &name, const Attributes &attributes)
      {
        if (is_done_)
          return;
        if (is_in_array_) {
          ++depth_in_array_; // InformationKey
          return;
        }
        const auto value = [&](const char *key) {
          const auto found = attributes.find(key);
          return found == attributes.end() ? std::string() : found->second;
        };
        if (name == "VTKFile")
          open_file(value("type"), value("byte_order"), value("header_type"),
                    value("compressor"));
        else if (name == "Piece") {
          pieces.emplace_back();
          pieces.back().n_points = count(value("NumberOfPoints"));
          pieces.back().n_cells = count(value("NumberOfCells"));
        } else if (name == "Points" || name == "Cells" || name == "CellData" ||
                   name == "PointData" || name == "FieldData")
          section_ = name;
        else if (name == "DataArray" || name == "Array") {
          is_in_array_ = true;
          depth_in_array_ = 0;
          collects_ = !pieces.empty() && section_ != "PointData" &&
                      section_ != "FieldData" && !section_.empty();
          if (collects_)
            pieces.back().arrays.push_back({section_, attributes, ""});
        } else if (name == "AppendedData") {
          is_appended_ = true;
          appended_is_base64 = value("encoding") != "raw";
          appended_at = std::size_t(XML_GetCurrentByteIndex(parser_.get()));
          // what follows may be bytes that are no XML
          stop("");
        }
      }

      void open_file(const std::string &type, const std::string &byte_order,
                     const std::string &header_type,
                     const std::string &compressor)
      {
        is_vtk_ = true;
        if (type != "UnstructuredGrid")
          stop(fmt::format(
              "its data set is {}; an UnstructuredGrid is needed{}", type,
              type == "PUnstructuredGrid"
                  ? ": the pieces that it names, saved as one file"
                  : " (in ParaView the filter Append Datasets makes one)"));
        encoding.is_big_endian = byte_order == "BigEndian";
        encoding.header_size = header_type == "UInt64" ? 8 : 4;
        encoding.is_compressed = !compressor.empty();
        if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
          stop(fmt::format("it is compressed by {}; save it with zlib or "
                           "without compression",
                           compressor));
      }

      void close(const std::string &name)
      {
        if (is_in_array_ && depth_in_array_ > 0)
          --depth_in_array_;
        else if (is_in_array_)
          is_in_array_ = collects_ = false;
        else if (name == section_)
          section_.clear();
      }

      static std::size_t count(const std::string &text)
      {
        std::size_t n = 0;
        std::from_chars(text.data(), text.data() + text.size(), n);
        return n;
      }

      /** Values begin behind the first `_` of the element. */
      void find_appended(const std::string &text)
      {
        const std::size_t tag = text.find('>', appended_at);
        const std::size_t mark = text.find('_', tag);
        if (tag == std::string::npos || mark == std::string::npos)
          problem_ = "its appended data do not begin with `_`";
        appended_at = mark + 1;
      }

      std::unique_ptr<std::remove_pointer_t<XML_Parser>, Free> parser_;
      std::string problem_, section_;
      bool is_vtk_ = false, is_done_ = false, is_appended_ = false;
      bool is_in_array_ = false, collects_ = false;
      unsigned int depth_in_array_ = 0;
    };

    /** Takes the values out of the text, and puts the pieces together. */
    class GridReader
    {
    public:
      GridReader(const XmlFile &file, const std::string &text)
          : file_(file), text_(text)
      {
        constexpr std::size_t small = std::size_t(1) << 26, ratio = 200;
        allowance_ = std::max(small, ratio * text.size());
      }

      Grid read()
      {
        for (const Piece &piece : file_.pieces)
          add(piece);
        return std::move(grid_);
      }

    private:
      std::vector<double> values(const XmlArray &array)
      {
        const auto attribute = [&](const char *key) {
          const auto found = array.attributes.find(key);
          return found == array.attributes.end() ? std::string()
                                                 : found->second;
        };
        const std::string format = attribute("format");
        try {
          if (format == "ascii" || format.empty())
            return numbers_of_text(array.text, attribute("type"));
          const std::string type = attribute("type");
          std::string text = array.text, bytes;
          if (format == "appended") {
            if (file_.appended_at == 0)
              throw BadBytes("there are no appended data");
            const std::string offset = attribute("offset");
            std::size_t at = 0;
            std::from_chars(offset.data(), offset.data() + offset.size(), at);
            if (at > text_.size() - file_.appended_at)
              throw BadBytes("it ends early");
            bytes = bytes_of(text_, file_.appended_at + at,
                             file_.appended_is_base64, type, file_.encoding,
                             allowance_);
          } else if (format == "binary") {
            text.erase(std::remove_if(text.begin(), text.end(),
                                      [](const unsigned char c) {
                                        return std::isspace(c);
                                      }),
                       text.end());
            bytes = bytes_of(text, 0, true, type, file_.encoding, allowance_);
          } else
            throw BadBytes(fmt::format("its format `{}` is not known", format));
          return numbers_of(bytes, type, file_.encoding.is_big_endian);
        } catch (const BadBytes &bad) {
          throw BadBytes(
              fmt::format("the array `{}`: {}", array.name(), bad.what()));
        }
      }

      void demand(const XmlArray &array, const std::size_t is,
                  const std::size_t should_be)
      {
        if (is != should_be)
          throw BadBytes(fmt::format("the array `{}` has {} values instead of "
                                     "{}",
                                     array.name(), is, should_be));
      }

      void add(const Piece &piece)
      {
        const double first_point = double(grid_.coordinates.size() / 3);
        const double first_corner = double(grid_.points.size());
        const std::size_t first_cell = grid_.types.size();
        // counts that no file of this size has would overflow below
        if (piece.n_points > text_.size() * 400 ||
            piece.n_cells > text_.size() * 400)
          throw BadBytes(fmt::format("a piece of {} points and {} cells is "
                                     "more than the file can hold",
                                     piece.n_points, piece.n_cells));
        for (const XmlArray &array : piece.arrays) {
          if (array.section == "Points") {
            const std::vector<double> x = values(array);
            demand(array, x.size(), 3 * piece.n_points);
            append(grid_.coordinates, x, 0.);
          } else if (array.section == "Cells") {
            if (array.name() == "connectivity")
              append(grid_.points, values(array), first_point);
            else if (array.name() == "offsets")
              append(grid_.first, values(array), first_corner);
            else if (array.name() == "types")
              append(grid_.types, values(array), 0.);
          } else
            add_values(array, piece.n_cells, first_cell);
        }
        if (grid_.types.size() != first_cell + piece.n_cells ||
            grid_.first.size() != grid_.types.size() + 1)
          throw BadBytes(fmt::format("its arrays `types` and `offsets` have "
                                     "{} and {} values for {} cells",
                                     grid_.types.size() - first_cell,
                                     grid_.first.size() - 1 - first_cell,
                                     piece.n_cells));
      }

      static void append(std::vector<double> &all,
                         const std::vector<double> &more, const double offset)
      {
        for (const double value : more)
          all.push_back(value + offset);
      }

      void add_values(const XmlArray &array, const std::size_t n_cells,
                      const std::size_t first_cell)
      {
        const auto type = array.attributes.find("type");
        if (type == array.attributes.end() || type->second == "String")
          return; // no numbers
        std::size_t n = 1;
        const auto components = array.attributes.find("NumberOfComponents");
        if (components != array.attributes.end())
          std::from_chars(components->second.data(),
                          components->second.data() + components->second.size(),
                          n);
        const std::vector<double> more = values(array);
        if (n == 0 || more.size() / n != n_cells || more.size() % n != 0)
          throw BadBytes(fmt::format("the array `{}` has {} values of {} "
                                     "components for {} cells",
                                     array.name(), more.size(), n, n_cells));
        auto known = std::find_if(
            grid_.cell_arrays.begin(), grid_.cell_arrays.end(),
            [&](const Array &other) { return other.name == array.name(); });
        if (known == grid_.cell_arrays.end()) {
          grid_.cell_arrays.push_back({array.name(), n, {}});
          known = grid_.cell_arrays.end() - 1;
        }
        if (known->n_components != n || known->values.size() != first_cell * n)
          throw BadBytes(fmt::format("the array `{}` is not the same in all "
                                     "pieces",
                                     array.name()));
        append(known->values, more, 0.);
      }

      const XmlFile &file_;
      const std::string &text_;
      Allowance allowance_ = 0;
      Grid grid_;
    };
  } // namespace

  Grid read_xml(const std::string &file, std::vector<std::string> &problems)
  {
    std::ifstream in(file, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    XmlFile xml;
    const std::string problem = xml.parse(text);
    if (!problem.empty()) {
      problems.push_back(problem);
      return {};
    }
    try {
      return GridReader(xml, text).read();
    } catch (const BadBytes &bad) {
      problems.emplace_back(bad.what());
      return {};
    }
  }
} // namespace nsfd::vtk
