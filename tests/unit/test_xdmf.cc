#include "core/communicator.h"
#include "core/hdf5_file.h"
#include "postprocess/xdmf_series.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

namespace test_xdmf
{
  using namespace nsfd;
  namespace fs = std::filesystem;

  /** A quadrilateral, a pentagon and a vertex, moved by @p shift. */
  VtuGrid small_grid(const double time, const double shift)
  {
    VtuGrid grid;
    grid.time = time;
    for (unsigned int i = 0; i < 10; ++i)
      grid.points.push_back({{i + shift, 0.1 * i, 0.}});
    grid.add_cell(VtuCell::quadrilateral, {0, 1, 2, 3});
    grid.add_cell(VtuCell::polygon, {4, 5, 6, 7, 8});
    grid.add_cell(VtuCell::vertex, {9});
    grid.point_data.push_back({"velocity", 3, {}});
    for (unsigned int k = 0; k < 30; ++k)
      grid.point_data[0].values.push_back(time + k / 7.);
    grid.cell_data.push_back({"beta < 1", 1, {1., 0.5, time}});
    return grid;
  }

  std::string read_text(const fs::path &file)
  {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }

  /** Every element is closed by its own name. */
  bool is_well_formed(const std::string &xml)
  {
    const std::regex tag("<(/?)([A-Za-z]+)([^<>]*?)(/?)>");
    std::vector<std::string> open;
    for (std::sregex_iterator match(xml.begin(), xml.end(), tag), end;
         match != end; ++match) {
      if ((*match)[1] == "/") {
        if (open.empty() || open.back() != (*match)[2])
          return false;
        open.pop_back();
      } else if ((*match)[4] != "/")
        open.push_back((*match)[2]);
    }
    return open.empty();
  }

  class XdmfTest : public testing::Test
  {
  protected:
    void SetUp() override
    {
      folder_ =
          fs::temp_directory_path() / ("nsfd_xdmf_" + std::to_string(getpid()));
      fs::remove_all(folder_);
      fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::vector<double> values(const std::string &path,
                               std::vector<hsize_t> &shape) const
    {
      const stored::Handle file(
          H5Fopen((folder_ / "series.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
          H5Fclose);
      const stored::Handle set(H5Dopen2(file, path.c_str(), H5P_DEFAULT),
                               H5Dclose);
      if (!set)
        return {};
      const stored::Handle space(H5Dget_space(set), H5Sclose);
      shape.resize(H5Sget_simple_extent_ndims(space));
      H5Sget_simple_extent_dims(space, shape.data(), nullptr);
      std::vector<double> result(H5Sget_simple_extent_npoints(space));
      H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
              result.data());
      return result;
    }

    fs::path folder_;
  };

  // What the XDMF file says of a data set is what the HDF5 file holds.
  TEST_F(XdmfTest, NamesWhatIsThere)
  {
    XdmfSeries series((folder_ / "series").string());
    series.add(small_grid(0., 0.));
    series.add(small_grid(0.5, 0.));
    series.add(small_grid(1., 0.25));
    const std::string xml = read_text(folder_ / "series.xdmf");
    EXPECT_TRUE(is_well_formed(xml)) << xml;
    const std::regex item(
        "Dimensions=\"([0-9 ]+)\" Format=\"HDF\">series.h5:([^<]+)<");
    unsigned int count = 0;
    for (std::sregex_iterator match(xml.begin(), xml.end(), item), end;
         match != end; ++match, ++count) {
      std::string path = (*match)[2];
      path = std::regex_replace(path, std::regex("&lt;"), "<");
      std::vector<hsize_t> shape;
      values(path, shape);
      std::string text;
      for (const hsize_t n : shape)
        text += (text.empty() ? "" : " ") + std::to_string(n);
      EXPECT_EQ(text, (*match)[1]) << path;
    }
    EXPECT_EQ(count, 3u * 4u);
    std::vector<hsize_t> shape;
    EXPECT_EQ(values("/00001/point_data/velocity", shape),
              small_grid(0.5, 0.).point_data[0].values);
    // shape, corners; polygons and points with their number of corners
    EXPECT_EQ(
        values("/00002/cells", shape),
        (std::vector<double>{5, 0, 1, 2, 3, 3, 5, 4, 5, 6, 7, 8, 1, 1, 9}));
    EXPECT_EQ(values("/00000/points", shape)[3], 1.);
    EXPECT_EQ(values("/00002/points", shape)[3], 1.25);
  }

  // Points and cells that do not change take room once.
  TEST_F(XdmfTest, StoresAMeshOnce)
  {
    VtuGrid grid = small_grid(0., 0.);
    grid.points.resize(20000); // 480 kB
    grid.point_data.clear();
    XdmfSeries series((folder_ / "series").string());
    series.add(grid);
    const auto one = fs::file_size(folder_ / "series.h5");
    for (unsigned int k = 1; k < 4; ++k) {
      grid.time = k;
      series.add(grid);
    }
    EXPECT_GT(one, 480000u);
    EXPECT_LT(fs::file_size(folder_ / "series.h5"), one + 50000u);
  }

  // All pieces as one: corners and data belong together.
  TEST_F(XdmfTest, GathersThePieces)
  {
    const Communicator communicator(MPI_COMM_WORLD);
    const double rank = communicator.rank();
    const VtuGrid all =
        gather_grid(communicator, small_grid(rank, 100. * rank));
    if (!communicator.is_root())
      return;
    ASSERT_EQ(all.cells.size(), 3u * unsigned(communicator.size()));
    for (int r = 0; r < communicator.size(); ++r) {
      const std::size_t c = 3 * std::size_t(r) + 1;
      EXPECT_EQ(all.offsets[c] - all.offsets[c - 1], 5);
      EXPECT_EQ(all.points[all.connectivity[all.offsets[c - 1]]][0],
                4. + 100. * r);
      EXPECT_EQ(all.cell_data[0].values[c + 1], double(r));
    }
  }
} // namespace test_xdmf
