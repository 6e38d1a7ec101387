#include "plane_outline.h"

#include "cell_shapes.h"
#include "named_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace nsfd
{
  namespace
  {
    using Edge = std::array<unsigned int, 2>;

    std::string text(const PlanePoint &p)
    {
      return fmt::format("({:g}, {:g})", p[0], p[1]);
    }

    PlanePoint minus(const PlanePoint &a, const PlanePoint &b)
    {
      return {{a[0] - b[0], a[1] - b[1]}};
    }

    double cross(const PlanePoint &a, const PlanePoint &b)
    {
      return a[0] * b[1] - a[1] * b[0];
    }

    double dot(const PlanePoint &a, const PlanePoint &b)
    {
      return a[0] * b[0] + a[1] * b[1];
    }

    /** Divides lines where they cross or touch. */
    class Arrangement
    {
    public:
      explicit Arrangement(const double size) : same_(1e-9 * size) {}

      unsigned int point(const PlanePoint &p)
      {
        for (unsigned int v = 0; v < points_.size(); ++v)
          if (std::hypot(points_[v][0] - p[0], points_[v][1] - p[1]) <= same_)
            return v;
        points_.push_back(p);
        return unsigned(points_.size() - 1);
      }

      void add(const PlanePoint &a, const PlanePoint &b, const unsigned int set,
               const std::string &name)
      {
        const unsigned int first = point(a), last = point(b);
        if (first != last)
          lines_.push_back({first, last, set, name, {}});
      }

      /** @p are_meeting(i, j, place): lines i and j cross there. */
      template <typename Action>
      void divide(const Action &are_crossing)
      {
        for (std::size_t i = 0; i < lines_.size(); ++i)
          for (std::size_t j = 0; j < i; ++j) {
            bool do_touch = false;
            for (const auto &[line, other] : {std::pair(i, j), std::pair(j, i)})
              for (const unsigned int p :
                   {lines_[other].first, lines_[other].last})
                do_touch = touch(lines_[line], p) || do_touch;
            if (!do_touch)
              cross_at(i, j, are_crossing);
          }
      }

      PlaneOutline outline() const
      {
        PlaneOutline result;
        result.points = points_;
        std::map<Edge, std::size_t> number;
        for (const Line &line : lines_) {
          std::vector<std::pair<double, unsigned int>> stops = line.stops;
          stops.emplace_back(0., line.first);
          stops.emplace_back(1., line.last);
          std::sort(stops.begin(), stops.end());
          for (std::size_t s = 1; s < stops.size(); ++s) {
            const unsigned int a = stops[s - 1].second, b = stops[s].second;
            if (a == b)
              continue;
            const auto [entry, is_new] = number.emplace(
                Edge{{std::min(a, b), std::max(a, b)}}, result.lines.size());
            if (is_new)
              result.lines.push_back({a, b, line.set});
            else if (line.set != 0) // a group on the boundary
              result.lines[entry->second].set = line.set;
          }
        }
        return result;
      }

      const std::string &name(const std::size_t line) const
      {
        return lines_[line].name;
      }

    private:
      struct Line {
        unsigned int first, last, set;
        std::string name;
        std::vector<std::pair<double, unsigned int>> stops;
      };

      /** The point is on the line, or an end of it. */
      bool touch(Line &line, const unsigned int p)
      {
        if (p == line.first || p == line.last)
          return true;
        const PlanePoint along = minus(points_[line.last], points_[line.first]);
        const PlanePoint to = minus(points_[p], points_[line.first]);
        const double square = dot(along, along), t = dot(to, along) / square;
        if (!(t > 0. && t < 1.) ||
            std::abs(cross(along, to)) > same_ * std::sqrt(square))
          return false;
        line.stops.emplace_back(t, p);
        return true;
      }

      template <typename Action>
      void cross_at(const std::size_t i, const std::size_t j,
                    const Action &are_crossing)
      {
        const PlanePoint a = points_[lines_[i].first],
                         u = minus(points_[lines_[i].last], a),
                         b = points_[lines_[j].first],
                         v = minus(points_[lines_[j].last], b);
        const double area = cross(u, v);
        if (area == 0.)
          return;
        const double t = cross(minus(b, a), v) / area,
                     s = cross(minus(b, a), u) / area;
        if (!(t > 0. && t < 1. && s > 0. && s < 1.))
          return;
        const PlanePoint place = {{a[0] + t * u[0], a[1] + t * u[1]}};
        const unsigned int p = point(place);
        lines_[i].stops.emplace_back(t, p);
        lines_[j].stops.emplace_back(s, p);
        are_crossing(i, j, place);
      }

      double same_; ///< m, for points at one place
      std::vector<PlanePoint> points_;
      std::vector<Line> lines_;
    };

    double diagonal(const std::vector<PlanePoint> &points)
    {
      PlanePoint lower = points[0], upper = points[0];
      for (const PlanePoint &p : points)
        for (unsigned int d = 0; d < 2; ++d) {
          lower[d] = std::min(lower[d], p[d]);
          upper[d] = std::max(upper[d], p[d]);
        }
      return std::hypot(upper[0] - lower[0], upper[1] - lower[1]);
    }

    /** By the sides that a ray to the right crosses. */
    bool is_inside(const std::vector<PlanePoint> &polygon, const PlanePoint &p)
    {
      bool inside = false;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const PlanePoint &a = polygon[i],
                         &b = polygon[(i + 1) % polygon.size()];
        if ((a[1] > p[1]) != (b[1] > p[1]) &&
            p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
          inside = !inside;
      }
      return inside;
    }

    double distance_to_sides(const std::vector<PlanePoint> &polygon,
                             const PlanePoint &p)
    {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const PlanePoint along =
            minus(polygon[(i + 1) % polygon.size()], polygon[i]);
        const PlanePoint to = minus(p, polygon[i]);
        const double t = std::clamp(dot(to, along) / dot(along, along), 0., 1.);
        least = std::min(
            least, std::hypot(to[0] - t * along[0], to[1] - t * along[1]));
      }
      return least;
    }
  } // namespace

  PlaneOutline outline_of(const PlaneDrawing &drawing,
                          std::vector<std::string> &problems)
  {
    const auto &corners = drawing.boundary;
    if (corners.size() < 3) {
      problems.push_back("the boundary has fewer than three corners");
      return {};
    }
    const double size = diagonal(corners);
    Arrangement arrangement(size);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const std::size_t next = (i + 1) % corners.size();
      const PlanePoint along = minus(corners[next], corners[i]);
      if (!(std::hypot(along[0], along[1]) > 1e-9 * size)) {
        problems.push_back(fmt::format("corners {} and {} of the boundary are "
                                       "at one place, {}",
                                       i + 1, next + 1, text(corners[i])));
        return {};
      }
      arrangement.add(corners[i], corners[next], 0, "");
    }
    const std::size_t n_sides = corners.size();
    for (const PlaneDrawing::Path &path : drawing.paths)
      for (std::size_t i = 1; i < path.points.size(); ++i)
        arrangement.add(path.points[i - 1], path.points[i], path.set,
                        path.name);
    arrangement.divide([&](const std::size_t i, const std::size_t j,
                           const PlanePoint &place) {
      if (i < n_sides && j < n_sides)
        problems.push_back(
            fmt::format("the boundary crosses itself at {}", text(place)));
      else if (i < n_sides || j < n_sides)
        problems.push_back(fmt::format("line `{}` crosses the boundary at {}",
                                       arrangement.name(std::max(i, j)),
                                       text(place)));
    });
    for (const PlaneDrawing::Path &path : drawing.paths)
      for (const PlanePoint &p : path.points)
        if (!is_inside(corners, p) &&
            distance_to_sides(corners, p) > 1e-9 * size)
          problems.push_back(fmt::format("line `{}` has a point outside of the "
                                         "mesh, {}",
                                         path.name, text(p)));
    PlaneOutline outline = arrangement.outline();
    outline.keeps_straight_points = true;
    return outline;
  }

  namespace
  {
    /** An edge between cells, and what it has on its two sides. */
    struct Side {
      Edge edge;
      std::size_t cell;
      bool operator<(const Side &other) const
      {
        return edge != other.edge ? edge < other.edge : cell < other.cell;
      }
    };

    Edge sorted(const unsigned int a, const unsigned int b)
    {
      return {{std::min(a, b), std::max(a, b)}};
    }

    std::vector<Side> sorted_sides(const NamedMesh &mesh)
    {
      std::vector<Side> sides;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const unsigned int *v = mesh.cells.begin(c);
        for (const auto &face :
             find_cell_shape(2, mesh.cells.n_vertices(c))->faces)
          sides.push_back({sorted(v[face[0]], v[face[1]]), c});
      }
      std::sort(sides.begin(), sides.end());
      return sides;
    }

    /** Cells that no line separates have one number. */
    class Joined
    {
    public:
      explicit Joined(const std::size_t n) : of_(n)
      {
        for (std::size_t c = 0; c < n; ++c)
          of_[c] = c;
      }
      std::size_t operator()(std::size_t c)
      {
        while (of_[c] != c)
          c = of_[c] = of_[of_[c]];
        return c;
      }
      void join(const std::size_t a, const std::size_t b)
      {
        of_[std::max((*this)(a), (*this)(b))] =
            std::min((*this)(a), (*this)(b));
      }

    private:
      std::vector<std::size_t> of_;
    };

    /** The middle of the largest cell of each part. */
    std::vector<PlaneOutline::Inside>
    insides(const NamedMesh &mesh, const PlaneOutline &outline, Joined &joined)
    {
      std::map<std::size_t, std::pair<double, std::size_t>> largest;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const unsigned int *v = mesh.cells.begin(c);
        // of a quad, in the order of deal.II, that of its diagonals
        const bool is_quad = mesh.cells.n_vertices(c) == 4;
        const auto &x = outline.points;
        const double area =
            is_quad ? cross(minus(x[v[3]], x[v[0]]), minus(x[v[2]], x[v[1]]))
                    : cross(minus(x[v[1]], x[v[0]]), minus(x[v[2]], x[v[0]]));
        auto &entry = largest[joined(c)];
        if (area > entry.first)
          entry = {area, c};
      }
      std::vector<PlaneOutline::Inside> result;
      for (const auto &[part, entry] : largest) {
        const std::size_t c = entry.second;
        const unsigned int n = mesh.cells.n_vertices(c);
        PlanePoint middle{};
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int d = 0; d < 2; ++d)
            middle[d] += outline.points[mesh.cells.begin(c)[i]][d] / n;
        result.push_back({middle, mesh.cells.set[c]});
      }
      return result;
    }
  } // namespace

  PlaneOutline outline_of(const NamedMesh &mesh)
  {
    PlaneOutline outline;
    for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
      outline.points.push_back(
          {{mesh.coordinates[3 * v], mesh.coordinates[3 * v + 1]}});
    std::map<Edge, unsigned int> set_of_face;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
      set_of_face[sorted(mesh.faces.begin(f)[0], mesh.faces.begin(f)[1])] =
          mesh.faces.set[f];
    const std::vector<Side> sides = sorted_sides(mesh);
    Joined joined(mesh.cells.size());
    for (std::size_t s = 0, n = 0; s < sides.size(); s += n) {
      for (n = 1; s + n < sides.size() && sides[s + n].edge == sides[s].edge;)
        ++n;
      const auto face = set_of_face.find(sides[s].edge);
      const unsigned int set = face == set_of_face.end() ? 0 : face->second;
      if (n == 1 || set != 0 ||
          mesh.cells.set[sides[s].cell] != mesh.cells.set[sides[s + 1].cell])
        outline.lines.push_back({sides[s].edge[0], sides[s].edge[1], set});
      else
        joined.join(sides[s].cell, sides[s + 1].cell);
    }
    outline.parts = insides(mesh, outline, joined);
    return outline;
  }
} // namespace nsfd
