#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  class Archive;

  /** Cell shapes by their number in the VTK format. */
  enum class VtuCell : std::uint8_t {
    vertex = 1,
    polyvertex = 2,
    line = 3,
    triangle = 5,
    polygon = 7,
    quadrilateral = 9,
    tetrahedron = 10,
    hexahedron = 12
  };

  /** What the numbers of an array are in files. */
  enum class VtuNumber : std::uint8_t {
    real,    ///< double
    integer, ///< 32 bits
    code     ///< 0 to 255
  };

  /** One piece (rank) of an unstructured grid with data at one time. */
  struct VtuGrid {
    struct Array {
      std::string name;
      unsigned int components = 1;
      std::vector<double> values; ///< components are contiguous
      std::string unit = "";      ///< SI
      VtuNumber number = VtuNumber::real;
    };
    /** What the numbers 0, 1, ... of an array of integers mean. */
    struct Names {
      std::string array; ///< "kind_names"
      std::vector<std::string> values;
    };

    double time = 0.;
    std::vector<std::array<double, 3>> points;
    std::vector<VtuCell> cells;
    std::vector<std::int64_t> connectivity;
    std::vector<std::int64_t> offsets; ///< end of each cell in connectivity
    std::vector<Array> point_data, cell_data;
    std::vector<Names> names; ///< the same at all times

    void add_cell(VtuCell shape, const std::vector<std::int64_t> &corners);
    /** Room for so many, also in the arrays that there are. */
    void reserve(std::size_t n_points, std::size_t n_cells,
                 std::size_t n_corners);
  };

  /** interfaces_00012.vtu; with several ranks interfaces_00012.0003.vtu */
  std::string vtu_name(const std::string &base, unsigned int number,
                       unsigned int rank, unsigned int n_ranks);

  /** Binary, not compressed. Sizes are checked (std::logic_error). */
  void write_vtu(const std::string &path, const VtuGrid &grid);

  /**
   * Ties the pieces of all ranks together. @p grid is any of them: only the
   * names and components of its arrays are read. Pieces are named relative
   * to the file.
   */
  void write_pvtu(const std::string &path, const VtuGrid &grid,
                  const std::vector<std::string> &pieces);

  /**
   * A .pvd file: the time series of .vtu or .pvtu files. Complete and
   * readable after every add().
   */
  class PvdSeries
  {
  public:
    explicit PvdSeries(const std::string &path);

    /** @p file is relative to the .pvd file. */
    void add(double time, const std::string &file);

    /** Its entries; the file is written again when they have been read. */
    void serialize(Archive &archive);

  private:
    void write() const;

    std::string path_;
    std::vector<std::pair<double, std::string>> entries_;
  };
} // namespace nsfd
