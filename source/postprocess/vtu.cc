#include "vtu.h"

#include "core/output_folder.h"
#include "nsfd/core/archive.h"
#include "visualization/markup.h"

#include <fmt/format.h>

#include <cstring>
#include <deque>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace nsfd
{
  namespace
  {
    /** The binary blocks at the end of the file and where each starts. They
        stay where they are: pictures are the largest of all there is. */
    class AppendedData
    {
    public:
      /** Returns the offset attribute of the block. */
      std::size_t add(const void *data, const std::uint64_t n_bytes)
      {
        const std::size_t offset = length_;
        sizes_.push_back(n_bytes);
        parts_.push_back(view(&sizes_.back(), sizeof(n_bytes)));
        parts_.push_back(view(data, n_bytes));
        length_ += sizeof(n_bytes) + n_bytes;
        return offset;
      }

      /** Kept as long as the data. */
      const char *keep(std::string bytes)
      {
        return kept_.emplace_back(std::move(bytes)).data();
      }

      const std::vector<std::string_view> &parts() const { return parts_; }

    private:
      static std::string_view view(const void *data, const std::uint64_t n)
      {
        return {static_cast<const char *>(data), n};
      }

      std::deque<std::uint64_t> sizes_; ///< none of them ever moves
      std::deque<std::string> kept_;
      std::vector<std::string_view> parts_;
      std::size_t length_ = 0;
    };

    std::string data_array(const std::string &name,
                           const unsigned int components, const char *type,
                           const void *values, const std::size_t n_bytes,
                           AppendedData &data)
    {
      return fmt::format("<DataArray type=\"{}\" Name=\"{}\" "
                         "NumberOfComponents=\"{}\" format=\"appended\" "
                         "offset=\"{}\"/>\n",
                         type, escape_markup(name), components,
                         data.add(values, n_bytes));
    }

    const char *vtk_type(const VtuNumber number)
    {
      return number == VtuNumber::real      ? "Float64"
             : number == VtuNumber::integer ? "Int32"
                                            : "UInt8";
    }

    /** Numbers one after the other, as they are in the file. */
    template <typename Number>
    std::string converted(const std::vector<double> &values)
    {
      std::string bytes(values.size() * sizeof(Number), '\0');
      for (std::size_t i = 0; i < values.size(); ++i) {
        const auto value = static_cast<Number>(values[i]);
        std::memcpy(&bytes[i * sizeof(Number)], &value, sizeof(Number));
      }
      return bytes;
    }

    std::string data_array(const VtuGrid::Array &array, AppendedData &data)
    {
      const void *values = array.values.data();
      std::size_t size = sizeof(double);
      if (array.number == VtuNumber::integer) {
        size = sizeof(std::int32_t);
        values = data.keep(converted<std::int32_t>(array.values));
      } else if (array.number == VtuNumber::code) {
        size = sizeof(std::uint8_t);
        values = data.keep(converted<std::uint8_t>(array.values));
      }
      return data_array(array.name, array.components, vtk_type(array.number),
                        values, array.values.size() * size, data);
    }

    std::string data_section(const char *tag,
                             const std::vector<VtuGrid::Array> &arrays,
                             AppendedData &data)
    {
      std::string xml = fmt::format("<{}>\n", tag);
      for (const auto &array : arrays)
        xml += data_array(array, data);
      return xml + fmt::format("</{}>\n", tag);
    }

    /** Texts are the numbers of their bytes, each with a zero behind it. */
    std::string text_array(const VtuGrid::Names &names)
    {
      std::string xml =
          fmt::format("<DataArray type=\"String\" Name=\"{}\" "
                      "NumberOfTuples=\"{}\" format=\"ascii\">",
                      escape_markup(names.array), names.values.size());
      for (const std::string &value : names.values) {
        for (const char c : value)
          xml += fmt::format("{} ", static_cast<unsigned char>(c));
        xml += "0 ";
      }
      return xml + "</DataArray>\n";
    }

    void check_sizes(const VtuGrid &grid)
    {
      const auto check = [](const bool holds, const std::string &what) {
        if (!holds)
          throw std::logic_error("VTU: " + what + '.');
      };
      check(grid.offsets.size() == grid.cells.size(), "one offset per cell");
      check(grid.offsets.empty()
                ? grid.connectivity.empty()
                : grid.offsets.back() ==
                      static_cast<std::int64_t>(grid.connectivity.size()),
            "the last offset is the length of the connectivity");
      for (const auto &array : grid.point_data)
        check(array.values.size() == array.components * grid.points.size(),
              "size of point data '" + array.name + "'");
      for (const auto &array : grid.cell_data)
        check(array.values.size() == array.components * grid.cells.size(),
              "size of cell data '" + array.name + "'");
    }

    std::string opening(const char *type)
    {
      return fmt::format("<?xml version=\"1.0\"?>\n"
                         "<VTKFile type=\"{}\" version=\"1.0\" "
                         "byte_order=\"LittleEndian\" "
                         "header_type=\"UInt64\">\n",
                         type);
    }

    std::string parallel_arrays(const char *tag,
                                const std::vector<VtuGrid::Array> &arrays)
    {
      std::string xml = fmt::format("<{}>\n", tag);
      for (const auto &array : arrays)
        xml += fmt::format("<PDataArray type=\"{}\" Name=\"{}\" "
                           "NumberOfComponents=\"{}\"/>\n",
                           vtk_type(array.number), escape_markup(array.name),
                           array.components);
      return xml + fmt::format("</{}>\n", tag);
    }
  } // namespace

  void VtuGrid::add_cell(const VtuCell shape,
                         const std::vector<std::int64_t> &corners)
  {
    cells.push_back(shape);
    connectivity.insert(connectivity.end(), corners.begin(), corners.end());
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
  }

  void VtuGrid::reserve(const std::size_t n_points, const std::size_t n_cells,
                        const std::size_t n_corners)
  {
    points.reserve(n_points);
    cells.reserve(n_cells);
    connectivity.reserve(n_corners);
    offsets.reserve(n_cells);
    for (Array &array : point_data)
      array.values.reserve(n_points * array.components);
    for (Array &array : cell_data)
      array.values.reserve(n_cells * array.components);
  }

  std::string vtu_name(const std::string &base, const unsigned int number,
                       const unsigned int rank, const unsigned int n_ranks)
  {
    return n_ranks == 1 ? fmt::format("{}_{:05}.vtu", base, number)
                        : fmt::format("{}_{:05}.{:04}.vtu", base, number, rank);
  }

  void write_vtu(const std::string &path, const VtuGrid &grid)
  {
    check_sizes(grid);

    AppendedData data;
    std::string xml = opening("UnstructuredGrid");
    xml += "<UnstructuredGrid>\n<FieldData>\n";
    xml += fmt::format("<DataArray type=\"Float64\" Name=\"TimeValue\" "
                       "NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n",
                       grid.time);
    for (const VtuGrid::Names &names : grid.names)
      xml += text_array(names);
    xml += "</FieldData>\n";
    xml += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
                       grid.points.size(), grid.cells.size());
    xml += "<Points>\n";
    xml += data_array("Points", 3, "Float64", grid.points.data(),
                      3 * sizeof(double) * grid.points.size(), data);
    xml += "</Points>\n<Cells>\n";
    for (const auto &[name, numbers] :
         {std::pair("connectivity", &grid.connectivity),
          {"offsets", &grid.offsets}})
      xml += data_array(name, 1, "Int64", numbers->data(),
                        sizeof(std::int64_t) * numbers->size(), data);
    xml += data_array("types", 1, "UInt8", grid.cells.data(), grid.cells.size(),
                      data);
    xml += "</Cells>\n";
    xml += data_section("PointData", grid.point_data, data);
    xml += data_section("CellData", grid.cell_data, data);
    xml += "</Piece>\n</UnstructuredGrid>\n";
    xml += "<AppendedData encoding=\"raw\">\n_";
    std::vector<std::string_view> parts = {xml};
    parts.insert(parts.end(), data.parts().begin(), data.parts().end());
    parts.emplace_back("\n</AppendedData>\n</VTKFile>\n");
    write_file_atomically(path, parts);
  }

  void write_pvtu(const std::string &path, const VtuGrid &grid,
                  const std::vector<std::string> &pieces)
  {
    std::string xml = opening("PUnstructuredGrid");
    xml += "<PUnstructuredGrid GhostLevel=\"0\">\n<PPoints>\n";
    xml += "<PDataArray type=\"Float64\" Name=\"Points\" "
           "NumberOfComponents=\"3\"/>\n</PPoints>\n";
    xml += parallel_arrays("PPointData", grid.point_data);
    xml += parallel_arrays("PCellData", grid.cell_data);
    for (const auto &piece : pieces)
      xml += fmt::format("<Piece Source=\"{}\"/>\n", escape_markup(piece));
    xml += "</PUnstructuredGrid>\n</VTKFile>\n";
    write_file_atomically(path, xml);
  }

  PvdSeries::PvdSeries(const std::string &path) : path_(path) {}

  void PvdSeries::add(const double time, const std::string &file)
  {
    entries_.emplace_back(time, file);
    write();
  }

  void PvdSeries::serialize(Archive &archive)
  {
    std::vector<double> times;
    std::string names;
    for (const auto &[time, name] : entries_) {
      times.push_back(time);
      names += name + '\n';
    }
    archive.on_root("times", times);
    archive.on_root("names", names);
    if (!archive.reads())
      return;
    entries_.clear();
    std::istringstream lines(names);
    std::string name;
    for (std::size_t k = 0; k < times.size() && std::getline(lines, name); ++k)
      entries_.emplace_back(times[k], name);
    if (!entries_.empty())
      write();
  }

  void PvdSeries::write() const
  {
    std::string xml = opening("Collection") + "<Collection>\n";
    for (const auto &[t, name] : entries_)
      xml += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n",
                         t, escape_markup(name));
    xml += "</Collection>\n</VTKFile>\n";
    write_file_atomically(path_, xml);
  }
} // namespace nsfd
