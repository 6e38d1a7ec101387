#include "vtkhdf_series.h"

#include "series_file.h"

#include "core/output_folder.h"
#include "nsfd/core/archive.h"

#include <filesystem>
#include <iostream>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    const std::string root = "/VTKHDF", steps = root + "/Steps";

    /** A row of a table with an entry for each time. */
    void add_entry(SeriesFile &file, const std::string &name,
                   const std::uint64_t value, const bool is_column = false)
    {
      file.append(steps + "/" + name, H5T_STD_I64LE,
                  is_column ? std::vector<hsize_t>{1, 1}
                            : std::vector<hsize_t>{1},
                  &value, H5T_NATIVE_UINT64);
    }

    bool same_mesh(const VtuGrid &a, const VtuGrid &b)
    {
      return a.points == b.points && a.cells == b.cells &&
             a.connectivity == b.connectivity && a.offsets == b.offsets;
    }
  } // namespace

  VtkhdfSeries::VtkhdfSeries(const std::string &path) : path_(path + ".vtkhdf")
  {
  }

  void VtkhdfSeries::add(const VtuGrid &grid)
  {
    const bool anew = length_.times == 0;
    OutputFolder::instance().note(path_);
    reserve_room(path_, anew, most_bytes(grid));
    SeriesFile file(path_, anew);
    if (anew) { // which has emptied it again
      reserve_room(path_, false, most_bytes(grid));
      begin(file, grid);
    }
    if (!has_mesh_ || !same_mesh(grid, last_mesh_))
      add_mesh(file, grid);
    add_data(file, "PointData", grid.point_data, grid.points.size(),
             length_.point_rows);
    add_data(file, "CellData", grid.cell_data, grid.cells.size(),
             length_.cell_rows);
    add_step(file, grid);
    length_.point_rows += grid.points.size();
    length_.cell_rows += grid.cells.size();
    ++length_.times;
    // the last word: a reader that comes before it sees the times before
    file.integers(steps, "NSteps", {std::int64_t(length_.times)});
    file.flush();
  }

  /** Groups, and what is the same at all times. */
  void VtkhdfSeries::begin(SeriesFile &file, const VtuGrid &grid) const
  {
    file.group(root);
    file.integers(root, "Version", {2, 2});
    file.attribute(root, "Type", std::string("UnstructuredGrid"));
    file.group(steps);
    for (const char *kind : {"Point", "Cell", "Field"}) {
      file.group(root + "/" + kind + "Data");
      file.group(steps + "/" + kind + "DataOffsets");
    }
    file.group(steps + "/FieldDataSizes");
    for (const VtuGrid::Names &names : grid.names)
      file.write(root + "/FieldData/" + names.array, names.values);
  }

  void VtkhdfSeries::add_mesh(SeriesFile &file, const VtuGrid &grid)
  {
    const hsize_t n_points = grid.points.size(), n_cells = grid.cells.size(),
                  n_entries = grid.connectivity.size();
    for (const auto &[name, size] : {std::pair("NumberOfPoints", n_points),
                                     {"NumberOfCells", n_cells},
                                     {"NumberOfConnectivityIds", n_entries}}) {
      const std::int64_t value = std::int64_t(size);
      file.append(root + "/" + name, H5T_STD_I64LE, {1}, &value,
                  H5T_NATIVE_INT64);
    }
    file.append(root + "/Points", H5T_IEEE_F64LE, {n_points, 3},
                grid.points.data(), H5T_NATIVE_DOUBLE);
    file.append(root + "/Types", H5T_STD_U8LE, {n_cells}, grid.cells.data(),
                H5T_NATIVE_UINT8);
    file.append(root + "/Connectivity", H5T_STD_I64LE, {n_entries},
                grid.connectivity.data(), H5T_NATIVE_INT64);
    std::vector<std::int64_t> offsets = {0};
    offsets.insert(offsets.end(), grid.offsets.begin(), grid.offsets.end());
    file.append(root + "/Offsets", H5T_STD_I64LE, {n_cells + 1}, offsets.data(),
                H5T_NATIVE_INT64);
    ++length_.parts;
    length_.points += n_points;
    length_.cells += n_cells;
    length_.entries += n_entries;
    last_mesh_ = grid;
    last_mesh_.point_data.clear();
    last_mesh_.cell_data.clear();
    has_mesh_ = true;
  }

  void VtkhdfSeries::add_data(SeriesFile &file, const std::string &kind,
                              const std::vector<VtuGrid::Array> &arrays,
                              const std::size_t rows,
                              const std::uint64_t first) const
  {
    for (const VtuGrid::Array &array : arrays) {
      const std::string path = root + "/" + kind + "/" + array.name;
      const bool is_new = !file.has(path);
      if (is_new && length_.times > 0)
        throw std::logic_error("VTKHDF: '" + array.name +
                               "' was not there before.");
      std::vector<hsize_t> shape = {rows};
      if (array.components > 1)
        shape.push_back(array.components);
      file.append(path, stored_type(array.number), shape, array.values.data(),
                  H5T_NATIVE_DOUBLE);
      if (is_new && !array.unit.empty())
        file.attribute(path, "unit", array.unit);
      add_entry(file, kind + "Offsets/" + array.name, first);
    }
  }

  /** Where the points, cells and names of this time are. */
  void VtkhdfSeries::add_step(SeriesFile &file, const VtuGrid &grid) const
  {
    file.append(steps + "/Values", H5T_IEEE_F64LE, {1}, &grid.time,
                H5T_NATIVE_DOUBLE);
    if (length_.times == 0)
      file.attribute(steps + "/Values", "unit", std::string("s"));
    add_entry(file, "PartOffsets", length_.parts - 1);
    add_entry(file, "NumberOfParts", 1);
    add_entry(file, "PointOffsets", length_.points - grid.points.size());
    add_entry(file, "CellOffsets", length_.cells - grid.cells.size(), true);
    add_entry(file, "ConnectivityIdOffsets",
              length_.entries - grid.connectivity.size(), true);
    for (const VtuGrid::Names &names : grid.names) {
      add_entry(file, "FieldDataOffsets/" + names.array, 0);
      const std::array<std::uint64_t, 2> size = {{1, names.values.size()}};
      file.append(steps + "/FieldDataSizes/" + names.array, H5T_STD_I64LE,
                  {1, 2}, size.data(), H5T_NATIVE_UINT64);
    }
  }

  void VtkhdfSeries::serialize(Archive &archive)
  {
    std::array<std::uint64_t *, 7> all = {
        {&length_.times, &length_.parts, &length_.points, &length_.cells,
         &length_.entries, &length_.point_rows, &length_.cell_rows}};
    std::vector<double> values;
    for (const std::uint64_t *length : all)
      values.push_back(double(*length));
    archive.on_root("lengths", values);
    if (!archive.reads())
      return;
    for (std::size_t k = 0; k < all.size(); ++k)
      *all[k] = k < values.size() ? std::uint64_t(values[k]) : 0;
    if (length_.times == 0)
      return;
    has_mesh_ = false;
    try {
      cut();
    } catch (const std::runtime_error &) {
      namespace fs = std::filesystem;
      const std::string aside =
          fs::path(path_).replace_extension().string() + "_damaged.vtkhdf";
      std::error_code error;
      fs::rename(path_, aside, error);
      std::cerr << path_ << ": warning: the file was cut off while it was "
                << "written; it is kept as " << aside
                << ", and a new series begins\n";
      length_ = {};
    }
  }

  /** What is behind the lengths belongs to a run that has been cut off. */
  void VtkhdfSeries::cut() const
  {
    SeriesFile file(path_, false);
    file.integers(steps, "NSteps", {std::int64_t(length_.times)});
    for (const auto &[name, rows] :
         {std::pair("NumberOfPoints", length_.parts),
          {"NumberOfCells", length_.parts},
          {"NumberOfConnectivityIds", length_.parts},
          {"Points", length_.points},
          {"Types", length_.cells},
          {"Connectivity", length_.entries},
          {"Offsets", length_.cells + length_.parts}})
      file.cut(root + "/" + name, rows);
    for (const auto &[kind, rows] : {std::pair("PointData", length_.point_rows),
                                     {"CellData", length_.cell_rows}})
      for (const std::string &name : file.names(root + "/" + kind))
        file.cut(root + "/" + kind + "/" + name, rows);
    for (const char *name :
         {"Values", "PartOffsets", "NumberOfParts", "PointOffsets",
          "CellOffsets", "ConnectivityIdOffsets"})
      file.cut(steps + "/" + name, length_.times);
    for (const char *group : {"PointDataOffsets", "CellDataOffsets",
                              "FieldDataOffsets", "FieldDataSizes"})
      for (const std::string &name : file.names(steps + "/" + group))
        file.cut(steps + "/" + group + "/" + name, length_.times);
    file.flush();
  }
} // namespace nsfd
