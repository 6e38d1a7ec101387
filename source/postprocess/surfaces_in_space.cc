#include "visualization/body_view.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nsfd
{
  namespace
  {
    using Key = std::array<long long, 6>;

    struct Side {
      Key key; ///< undeformed ends on the grid, in order
      Vector3 normal;
      std::array<Vector3, 2> ends; ///< deformed
    };

    using GridPlace = std::array<long long, 3>;

    /** Undeformed places on a grid much finer than the cells. */
    class Grid
    {
    public:
      explicit Grid(const Snapshot &snapshot)
      {
        Box box;
        for (const auto &polygon : snapshot.polygons)
          for (const Vector3 &x : polygon.reference)
            if (is_finite(x))
              box.add(x);
        spacing_ = box.empty() || box.size() == 0. ? 1. : 1e-6 * box.size();
      }

      GridPlace place(const Vector3 &x) const
      {
        // shifted, so that corners of a regular mesh are not on the border
        GridPlace result;
        for (unsigned int d = 0; d < 3; ++d)
          result[d] = std::llround(x[d] / spacing_ + 0.1234567);
        return result;
      }

      Key edge(const Vector3 &a, const Vector3 &b) const
      {
        const auto [p, q] = std::minmax(place(a), place(b));
        return {p[0], p[1], p[2], q[0], q[1], q[2]};
      }

    private:
      double spacing_;
    };

    /** Unit normal of a polygon that is flat enough. */
    Vector3 normal_of(const std::vector<Vector3> &corners)
    {
      Vector3 normal{};
      for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        for (unsigned int d = 0; d < 3; ++d) {
          const unsigned int e = (d + 1) % 3, f = (d + 2) % 3;
          normal[d] += (corners[i][e] - corners[0][e]) *
                           (corners[i + 1][f] - corners[0][f]) -
                       (corners[i][f] - corners[0][f]) *
                           (corners[i + 1][e] - corners[0][e]);
        }
      const double length = std::hypot(normal[0], normal[1], normal[2]);
      for (double &component : normal)
        component /= length > 0. ? length : 1.;
      return normal;
    }

    bool is_sharp(const Vector3 &a, const Vector3 &b)
    {
      const double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
      return std::abs(cosine) < std::cos(M_PI / 6.);
    }
  } // namespace

  std::vector<Vector3> corners_to_eye(const Snapshot::Polygon &polygon,
                                      const Projection &projection,
                                      const Seen seen)
  {
    auto corners = deformed_corners(polygon, projection);
    double area = 0.;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector3 p = projection.to_plane(corners[i]),
                    q = projection.to_plane(corners[(i + 1) % corners.size()]);
      area += p[0] * q[1] - p[1] * q[0];
    }
    if (area < 0. && seen == Seen::front)
      return {};
    if (area < 0.)
      std::reverse(corners.begin(), corners.end());
    return corners;
  }

  std::vector<char> crack_flanks(const Snapshot &snapshot)
  {
    const Grid grid(snapshot);
    std::vector<std::pair<std::vector<GridPlace>, std::size_t>> polygons;
    for (std::size_t p = 0; p < snapshot.polygons.size(); ++p) {
      std::vector<GridPlace> corners;
      for (const Vector3 &x : snapshot.polygons[p].reference)
        if (is_finite(x))
          corners.push_back(grid.place(x));
      std::sort(corners.begin(), corners.end());
      polygons.emplace_back(std::move(corners), p);
    }
    std::sort(polygons.begin(), polygons.end());
    std::vector<char> flank(polygons.size(), 0);
    for (std::size_t i = 1; i < polygons.size(); ++i)
      if (polygons[i].first == polygons[i - 1].first)
        flank[polygons[i].second] = flank[polygons[i - 1].second] = 1;
    return flank;
  }

  std::vector<std::array<Vector3, 2>>
  sharp_edges(const Snapshot &snapshot, const std::vector<char> &flank,
              const Projection &projection)
  {
    const Grid grid(snapshot);
    std::vector<Side> sides;
    for (std::size_t p = 0; p < snapshot.polygons.size(); ++p) {
      const auto &polygon = snapshot.polygons[p];
      const auto corners = deformed_corners(polygon, projection);
      if (flank[p] || corners.empty())
        continue;
      const Vector3 normal = normal_of(polygon.reference);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const std::size_t j = (i + 1) % corners.size();
        sides.push_back({grid.edge(polygon.reference[i], polygon.reference[j]),
                         normal,
                         {{corners[i], corners[j]}}});
      }
    }
    std::stable_sort(
        sides.begin(), sides.end(),
        [](const Side &a, const Side &b) { return a.key < b.key; });
    std::vector<std::array<Vector3, 2>> edges;
    for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
      bool sharp = false;
      for (; end < sides.size() && sides[end].key == sides[begin].key; ++end)
        sharp = sharp || is_sharp(sides[begin].normal, sides[end].normal);
      if (sharp)
        for (std::size_t i = begin; i < end; ++i)
          edges.push_back(sides[i].ends);
    }
    return edges;
  }
} // namespace nsfd
