#include "xdmf_series.h"

#include "series_file.h"

#include "core/output_folder.h"
#include "nsfd/core/archive.h"
#include "visualization/markup.h"

#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;

    /** Shapes with any number of corners are followed by that number. */
    struct XdmfShape {
      int code;
      bool counted;
    };

    XdmfShape shape_of(const VtuCell cell)
    {
      switch (cell) {
      case VtuCell::vertex:
      case VtuCell::polyvertex:
        return {1, true};
      case VtuCell::line:
        return {2, true};
      case VtuCell::triangle:
        return {4, false};
      case VtuCell::polygon:
        return {3, true};
      case VtuCell::quadrilateral:
        return {5, false};
      case VtuCell::tetrahedron:
        return {6, false};
      default:
        return {9, false}; // hexahedron; corners in the order of VTK
      }
    }

    /** Of XDMF: shape, corners, shape, corners, ... */
    std::vector<std::int64_t> mixed_topology(const VtuGrid &grid)
    {
      std::vector<std::int64_t> topology;
      std::int64_t begin = 0;
      for (std::size_t c = 0; c < grid.cells.size(); ++c) {
        const XdmfShape shape = shape_of(grid.cells[c]);
        topology.push_back(shape.code);
        if (shape.counted)
          topology.push_back(grid.offsets[c] - begin);
        for (; begin < grid.offsets[c]; ++begin)
          topology.push_back(grid.connectivity[begin]);
      }
      return topology;
    }

    const char *kind_of(const unsigned int components)
    {
      switch (components) {
      case 1:
        return "Scalar";
      case 3:
        return "Vector";
      case 6:
        return "Tensor6";
      case 9:
        return "Tensor";
      default:
        return "Matrix";
      }
    }

    std::string group_of(const std::size_t number)
    {
      return fmt::format("{:05}", number);
    }

    /** A reference from the XDMF file into the other one. */
    std::string item(const std::string &type, const unsigned int bytes,
                     const std::string &shape, const std::string &place)
    {
      return fmt::format("<DataItem NumberType=\"{}\" Precision=\"{}\" "
                         "Dimensions=\"{}\" Format=\"HDF\">{}</DataItem>",
                         type, bytes, shape, place);
    }
    std::string item(const VtuNumber number, const std::string &shape,
                     const std::string &place)
    {
      return number == VtuNumber::real      ? item("Float", 8, shape, place)
             : number == VtuNumber::integer ? item("Int", 4, shape, place)
                                            : item("UChar", 1, shape, place);
    }
  } // namespace

  XdmfSeries::XdmfSeries(const std::string &path) : path_(path) {}

  void XdmfSeries::add(const VtuGrid &grid)
  {
    const std::string group = group_of(entries_.size()),
                      file_name = fs::path(path_).filename().string() + ".h5";
    const std::size_t n = grid.points.size();
    const auto topology = mixed_topology(grid);
    const bool same_mesh = !mesh_.empty() && grid.points == last_mesh_.points &&
                           grid.cells == last_mesh_.cells &&
                           grid.connectivity == last_mesh_.connectivity &&
                           grid.offsets == last_mesh_.offsets;
    const bool anew = entries_.empty();
    OutputFolder::instance().note(path_ + ".h5");
    reserve_room(path_ + ".h5", anew, most_bytes(grid));
    SeriesFile file(path_ + ".h5", anew);
    if (anew) { // which has emptied it again
      reserve_room(path_ + ".h5", false, most_bytes(grid));
      file.group("names");
      for (const VtuGrid::Names &names : grid.names)
        file.write("names/" + names.array, names.values);
    }
    file.group(group);
    file.attribute(group, "time", grid.time);
    file.attribute(group, "unit", std::string("s"));
    if (same_mesh)
      for (const char *part : {"/points", "/cells"})
        file.link(mesh_ + part, group + part);
    else {
      file.write(group + "/points", H5T_IEEE_F64LE, {n, 3}, grid.points.data(),
                 H5T_NATIVE_DOUBLE);
      file.write(group + "/cells", H5T_STD_I64LE, {topology.size()},
                 topology.data(), H5T_NATIVE_INT64);
    }
    const auto place = [&](const std::string &name) {
      return escape_markup(file_name + ":/" + group + "/" + name);
    };
    std::string xml = fmt::format(
        "<Grid Name=\"{}\" GridType=\"Uniform\">\n<Time Value=\"{}\"/>\n"
        "<Topology TopologyType=\"Mixed\" NumberOfElements=\"{}\">{}"
        "</Topology>\n<Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
        group, grid.time, grid.cells.size(),
        item("Int", 8, std::to_string(topology.size()), place("cells")),
        item("Float", 8, fmt::format("{} 3", n), place("points")));
    const auto add_data = [&](const std::vector<VtuGrid::Array> &arrays,
                              const std::string &kind,
                              const std::string &centre) {
      file.group(group + "/" + kind);
      for (const VtuGrid::Array &array : arrays) {
        const std::size_t rows = array.values.size() / array.components;
        const std::string name = kind + "/" + array.name;
        file.write(group + "/" + name, stored_type(array.number),
                   {rows, array.components}, array.values.data(),
                   H5T_NATIVE_DOUBLE);
        if (!array.unit.empty())
          file.attribute(group + "/" + name, "unit", array.unit);
        xml += fmt::format(
            "<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}"
            "</Attribute>\n",
            escape_markup(array.name), kind_of(array.components), centre,
            item(array.number, fmt::format("{} {}", rows, array.components),
                 place(name)));
      }
    };
    add_data(grid.point_data, "point_data", "Node");
    add_data(grid.cell_data, "cell_data", "Cell");
    file.flush();
    if (!same_mesh) {
      mesh_ = group;
      last_mesh_ = grid;
      last_mesh_.point_data.clear();
      last_mesh_.cell_data.clear();
    }
    entries_.push_back({grid.time, xml + "</Grid>\n"});
    write_xdmf();
  }

  void XdmfSeries::write_xdmf() const
  {
    std::string xml = "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n"
                      "<Domain>\n<Grid Name=\"series\" "
                      "GridType=\"Collection\" CollectionType=\"Temporal\">\n";
    for (const Entry &entry : entries_)
      xml += entry.text;
    write_file_atomically(path_ + ".xdmf", xml + "</Grid>\n</Domain>\n"
                                                 "</Xdmf>\n");
  }

  void XdmfSeries::serialize(Archive &archive)
  {
    std::vector<double> times, lengths;
    std::string texts;
    for (const Entry &entry : entries_) {
      times.push_back(entry.time);
      lengths.push_back(double(entry.text.size()));
      texts += entry.text;
    }
    archive.on_root("times", times);
    archive.on_root("lengths", lengths);
    archive.on_root("texts", texts);
    if (!archive.reads())
      return;
    entries_.clear();
    std::size_t begin = 0;
    for (std::size_t k = 0; k < times.size(); ++k) {
      const auto length = std::size_t(lengths.at(k));
      entries_.push_back({times[k], texts.substr(begin, length)});
      begin += length;
    }
    mesh_.clear();
    if (entries_.empty())
      return;
    const std::string name = path_ + ".h5";
    try {
      cut(entries_.size());
      write_xdmf();
    } catch (const std::runtime_error &) {
      std::error_code error;
      fs::rename(name, path_ + "_damaged.h5", error);
      std::cerr << name << ": warning: the file was cut off while it was "
                << "written; it is kept as " << path_
                << "_damaged.h5, and a new series begins\n";
      entries_.clear();
    }
  }

  /** Groups from @p n on belong to a run that has been cut off. */
  void XdmfSeries::cut(const std::size_t n) const
  {
    SeriesFile file(path_ + ".h5", false);
    for (std::size_t k = n; file.has(group_of(k)); ++k)
      file.remove(group_of(k));
    file.flush();
  }
} // namespace nsfd
