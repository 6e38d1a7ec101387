// nsfd_overlaps FIELDS.h5 [DATA]: how deep bodies are in each other.
//
// Reads fields that a run with `set format = hdf5` in section `Output` has left
// and looks at all pairs of cells with different values of the cell data DATA
// (default: fragment), by separating axes: nothing of the contact search of the
// run is in it. Cells are taken as convex and straight, as they are for
// degree 1. Prints one line per time and, last, the deepest of all.
#include "../unit/separating_axes.h"

#include "core/hdf5_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace
{
  using namespace nsfd::test;
  using nsfd::stored::Handle;

  template <typename Number>
  std::vector<Number> numbers(const hid_t file, const std::string &path,
                              const hid_t type)
  {
    const Handle set(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!set) {
      fmt::print(stderr, "no {} in the file\n", path);
      std::exit(1);
    }
    const Handle space(H5Dget_space(set), H5Sclose);
    std::vector<Number> result(
        std::size_t(H5Sget_simple_extent_npoints(space)));
    H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, result.data());
    return result;
  }

  Vector3 difference(const Vector3 &a, const Vector3 &b)
  {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  }

  struct Body {
    Convex shape;
    Vector3 low, high;
    double owner = 0.;
  };

  /** The sides of a cell in the order of VTK; in the plane none. */
  std::vector<std::vector<int>> sides(const std::int64_t code)
  {
    if (code == 6)
      return {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}};
    return {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
            {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  }

  void add_normal(Convex &shape, Vector3 normal, const Vector3 &on_side)
  {
    Vector3 centre{};
    for (const auto &x : shape.corners)
      for (int d = 0; d < 3; ++d)
        centre[d] += x[d] / double(shape.corners.size());
    if (dot(normal, difference(on_side, centre)) < 0.)
      for (double &component : normal)
        component = -component;
    shape.normals.push_back(normal);
  }

  void add_sides(Convex &shape, const std::int64_t code)
  {
    const auto &x = shape.corners;
    if (code <= 5) { // in the plane, corners in a circle
      for (std::size_t k = 0; k < x.size(); ++k) {
        const Vector3 way = difference(x[(k + 1) % x.size()], x[k]);
        add_normal(shape, {way[1], -way[0], 0.}, x[k]);
      }
      return;
    }
    for (const auto &side : sides(code)) {
      add_normal(shape,
                 cross(difference(x[side[2]], x[side[0]]),
                       difference(x[side.back()], x[side[1]])),
                 x[side[0]]);
      for (std::size_t k = 0; k < side.size(); ++k)
        shape.edges.push_back(
            difference(x[side[(k + 1) % side.size()]], x[side[k]]));
    }
  }

  std::vector<Body> bodies(const hid_t file, const std::string &group,
                           const std::string &data)
  {
    const auto x = numbers<double>(file, group + "/points", H5T_NATIVE_DOUBLE);
    const auto u = numbers<double>(file, group + "/point_data/displacement",
                                   H5T_NATIVE_DOUBLE);
    const auto cells =
        numbers<std::int64_t>(file, group + "/cells", H5T_NATIVE_INT64);
    const auto owner =
        numbers<double>(file, group + "/cell_data/" + data, H5T_NATIVE_DOUBLE);
    std::vector<Body> result;
    for (std::size_t k = 0; k < cells.size();) {
      const std::int64_t code = cells[k++];
      const std::int64_t n = code == 3   ? cells[k++]
                             : code == 4 ? 3
                             : code == 9 ? 8
                                         : 4;
      Body body;
      body.owner = owner[result.size()];
      for (std::int64_t i = 0; i < n; ++i, ++k) {
        Vector3 corner;
        for (int d = 0; d < 3; ++d)
          corner[d] = x[std::size_t(cells[k]) * 3 + d] +
                      u[std::size_t(cells[k]) * 3 + d];
        body.shape.corners.push_back(corner);
      }
      body.low = body.high = body.shape.corners[0];
      for (const auto &corner : body.shape.corners)
        for (int d = 0; d < 3; ++d) {
          body.low[d] = std::min(body.low[d], corner[d]);
          body.high[d] = std::max(body.high[d], corner[d]);
        }
      add_sides(body.shape, code);
      result.push_back(body);
    }
    return result;
  }

  double deepest(std::vector<Body> all)
  {
    std::sort(all.begin(), all.end(),
              [](const Body &a, const Body &b) { return a.low[0] < b.low[0]; });
    double result = 0.;
    for (std::size_t a = 0; a < all.size(); ++a)
      for (std::size_t b = a + 1;
           b < all.size() && all[b].low[0] <= all[a].high[0]; ++b) {
        if (all[a].owner == all[b].owner || all[a].high[1] < all[b].low[1] ||
            all[b].high[1] < all[a].low[1] || all[a].high[2] < all[b].low[2] ||
            all[b].high[2] < all[a].low[2])
          continue;
        result =
            std::max(result, -separation(all[a].shape, all[b].shape).distance);
      }
    return result;
  }
} // namespace

int main(const int argc, char **argv)
{
  if (argc < 2) {
    fmt::print(stderr, "usage: nsfd_overlaps FIELDS.h5 [CELL DATA]\n");
    return 2;
  }
  const Handle file(H5Fopen(argv[1], H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file) {
    fmt::print(stderr, "cannot open {}\n", argv[1]);
    return 1;
  }
  const nsfd::stored::QuietHdf5 quiet;
  double worst = 0.;
  for (std::size_t k = 0;; ++k) {
    const std::string group = fmt::format("/{:05}", k);
    if (H5Lexists(file, group.c_str(), H5P_DEFAULT) <= 0)
      break;
    const double depth =
        deepest(bodies(file, group, argc > 2 ? argv[2] : "fragment"));
    fmt::print("{} {:.4g} m\n", group, depth);
    worst = std::max(worst, depth);
  }
  fmt::print("deepest {:.4g} m\n", worst);
}
