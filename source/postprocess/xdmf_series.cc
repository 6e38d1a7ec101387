#include "xdmf_series.h"

#include "core/hdf5_file.h"

#include "core/output_folder.h"
#include "nsfd/core/archive.h"
#include "visualization/markup.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;
    using stored::Handle;

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

    /**
     * Room for @p bytes more in the file, or on an empty one. HDF5 must never
     * meet a full disk: it ends the program when it cannot write what it holds.
     */
    void reserve(const std::string &name, const bool anew,
                 const std::size_t bytes)
    {
      const int file = open(name.c_str(),
                            O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC |
                                (anew ? O_TRUNC : 0),
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

    /** What a time may take in the file, with all of its headers. */
    std::size_t most_bytes(const VtuGrid &grid)
    {
      std::size_t bytes = 1 << 16;
      const auto add = [&bytes](const std::size_t n) { bytes += 8 * n + 4096; };
      add(3 * grid.points.size());
      add(grid.connectivity.size() + 2 * grid.cells.size());
      for (const auto *arrays : {&grid.point_data, &grid.cell_data})
        for (const VtuGrid::Array &array : *arrays)
          add(array.values.size());
      return bytes;
    }

    /** The HDF5 file of a series, open for one time. */
    class SeriesFile
    {
    public:
      explicit SeriesFile(const std::string &name, const bool anew)
          : name_(name),
            file_(anew ? H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT,
                                   H5P_DEFAULT)
                       : H5Fopen(name.c_str(), H5F_ACC_RDWR, H5P_DEFAULT),
                  H5Fclose)
      {
        demand(bool(file_));
      }

      void group(const std::string &path)
      {
        const Handle group(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT,
                                      H5P_DEFAULT, H5P_DEFAULT),
                           H5Gclose);
        demand(bool(group));
      }

      void write(const std::string &path, const hid_t type,
                 const std::vector<hsize_t> &shape, const void *values)
      {
        const Handle space(
            H5Screate_simple(int(shape.size()), shape.data(), nullptr),
            H5Sclose);
        const Handle set(H5Dcreate2(file_, path.c_str(), type, space,
                                    H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Dclose);
        demand(set &&
               H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
      }

      void link(const std::string &from, const std::string &to)
      {
        demand(H5Lcreate_hard(file_, from.c_str(), file_, to.c_str(),
                              H5P_DEFAULT, H5P_DEFAULT) >= 0);
      }

      bool has(const std::string &path) const
      {
        return H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0;
      }

      void remove(const std::string &path)
      {
        demand(H5Ldelete(file_, path.c_str(), H5P_DEFAULT) >= 0);
      }

      void flush() { demand(H5Fflush(file_, H5F_SCOPE_LOCAL) >= 0); }

    private:
      void demand(const bool good) const
      {
        if (!good)
          throw OutputError("Cannot write '" + name_ + "'.");
      }

      const stored::QuietHdf5 quiet_;
      const std::string name_;
      Handle file_;
    };

    std::string group_of(const std::size_t number)
    {
      return fmt::format("{:05}", number);
    }

    /** A reference from the XDMF file into the other one. */
    std::string item(const std::string &type, const std::string &shape,
                     const std::string &place)
    {
      return fmt::format("<DataItem NumberType=\"{}\" Precision=\"8\" "
                         "Dimensions=\"{}\" Format=\"HDF\">{}</DataItem>",
                         type, shape, place);
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
    reserve(path_ + ".h5", anew, most_bytes(grid));
    SeriesFile file(path_ + ".h5", anew);
    if (anew) // which has emptied it again
      reserve(path_ + ".h5", false, most_bytes(grid));
    file.group(group);
    if (same_mesh)
      for (const char *part : {"/points", "/cells"})
        file.link(mesh_ + part, group + part);
    else {
      file.write(group + "/points", H5T_NATIVE_DOUBLE, {n, 3},
                 grid.points.data());
      file.write(group + "/cells", H5T_NATIVE_INT64, {topology.size()},
                 topology.data());
    }
    const auto place = [&](const std::string &name) {
      return escape_markup(file_name + ":/" + group + "/" + name);
    };
    std::string xml = fmt::format(
        "<Grid Name=\"{}\" GridType=\"Uniform\">\n<Time Value=\"{}\"/>\n"
        "<Topology TopologyType=\"Mixed\" NumberOfElements=\"{}\">{}"
        "</Topology>\n<Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
        group, grid.time, grid.cells.size(),
        item("Int", std::to_string(topology.size()), place("cells")),
        item("Float", fmt::format("{} 3", n), place("points")));
    const auto add_data = [&](const std::vector<VtuGrid::Array> &arrays,
                              const std::string &kind,
                              const std::string &centre) {
      file.group(group + "/" + kind);
      for (const VtuGrid::Array &array : arrays) {
        const std::size_t rows = array.values.size() / array.components;
        const std::string name = kind + "/" + array.name;
        file.write(group + "/" + name, H5T_NATIVE_DOUBLE,
                   {rows, array.components}, array.values.data());
        xml += fmt::format(
            "<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}"
            "</Attribute>\n",
            escape_markup(array.name), kind_of(array.components), centre,
            item("Float", fmt::format("{} {}", rows, array.components),
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
