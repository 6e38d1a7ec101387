#pragma once

#include "gathered_series.h"

#include <cstdint>
#include <string>

namespace nsfd
{
  class SeriesFile;

  /**
   * NAME.vtkhdf: all times of a series in one file, as an unstructured grid of
   * the VTKHDF format, version 2.2 (docs.vtk.org, "VTKHDF File Format"). Points
   * and cells that stay what they were are stored once. The file is complete
   * after every add(). One process.
   */
  class VtkhdfSeries final : public GatheredSeries
  {
  public:
    /** @p path without its extension. Nothing is written yet. */
    explicit VtkhdfSeries(const std::string &path);

    /** Also @throws std::logic_error if the arrays are not those before. */
    void add(const VtuGrid &grid) override;
    void serialize(Archive &archive) override;

  private:
    /// times; then of all meshes in the file: how many, points, cells, entries
    /// of the connectivity; rows of point and cell data, rows of names
    struct Lengths {
      std::uint64_t times = 0, parts = 0, points = 0, cells = 0, entries = 0,
                    point_rows = 0, cell_rows = 0;
    };
    void begin(SeriesFile &file, const VtuGrid &grid) const;
    void add_mesh(SeriesFile &file, const VtuGrid &grid);
    void add_data(SeriesFile &file, const std::string &kind,
                  const std::vector<VtuGrid::Array> &arrays, std::size_t rows,
                  std::uint64_t first) const;
    void add_step(SeriesFile &file, const VtuGrid &grid) const;
    void cut() const;

    const std::string path_;
    Lengths length_;
    VtuGrid last_mesh_; ///< without data
    bool has_mesh_ = false;
  };
} // namespace nsfd
