#include "isotropic.h"

#include "lloyd.h"
#include "relieve_cells.h"

#include "core/mix_bits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    /// more than any machine of today holds, once they are cut
    constexpr double most_triangles = 5e7;
    constexpr unsigned int no_set = std::numeric_limits<unsigned int>::max();

    double doubled_area(const PlanePoint &a, const PlanePoint &b,
                        const PlanePoint &c)
    {
      return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    }

    /** The set of each part, none where there shall be no cell. */
    std::vector<unsigned int>
    sets_of_parts(const PlaneOutline &outline, const PlaneTriangles &triangles,
                  const std::vector<PlanePoint> &nodes)
    {
      std::vector<unsigned int> sets(triangles.n_parts,
                                     outline.parts.empty() ? 0 : no_set);
      for (std::size_t t = 0; t < triangles.corners.size(); ++t) {
        if (sets[triangles.part[t]] != no_set)
          continue;
        const auto &[a, b, c] = triangles.corners[t];
        for (const auto &inside : outline.parts)
          if (doubled_area(nodes[a], nodes[b], inside.place) >= 0. &&
              doubled_area(nodes[b], nodes[c], inside.place) >= 0. &&
              doubled_area(nodes[c], nodes[a], inside.place) >= 0.)
            sets[triangles.part[t]] = inside.set;
      }
      return sets;
    }

    /** Small pieces of the domain, with the number of nodes that belong there.
     */
    class Pieces
    {
    public:
      explicit Pieces(const SizeField &size) : size_(size) {}

      /** Halves it until the size varies little in it. */
      void add(const PlanePoint &a, const PlanePoint &b, const PlanePoint &c)
      {
        struct Waiting {
          std::array<PlanePoint, 3> x;
        };
        std::vector<Waiting> waiting = {{{{a, b, c}}}};
        while (!waiting.empty()) {
          const auto x = waiting.back().x;
          waiting.pop_back();
          const PlanePoint middle = {{(x[0][0] + x[1][0] + x[2][0]) / 3.,
                                      (x[0][1] + x[1][1] + x[2][1]) / 3.}};
          const double h = size_(middle);
          // the longest edge, so that pieces do not become thin
          int longest = 0;
          double square = 0.;
          for (int i = 0; i < 3; ++i) {
            const PlanePoint &p = x[i], &q = x[(i + 1) % 3];
            const double d =
                (q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]);
            if (d > square) {
              square = d;
              longest = i;
            }
          }
          constexpr double most = 4.; // edges in sizes
          if (square > most * most * h * h) {
            const PlanePoint &p = x[longest], &q = x[(longest + 1) % 3],
                             &r = x[(longest + 2) % 3];
            const PlanePoint m = {{.5 * (p[0] + q[0]), .5 * (p[1] + q[1])}};
            waiting.push_back({{{m, q, r}}});
            waiting.push_back({{{p, m, r}}});
            continue;
          }
          if (count_ > most_triangles)
            throw std::runtime_error(fmt::format(
                "the mesh would have more than {:.2g} triangles before they "
                "are cut; write a larger `size`, or fewer `cells`",
                most_triangles));
          pieces_.push_back(x);
          area_ += .5 * doubled_area(x[0], x[1], x[2]);
          // of equilateral triangles
          count_ += .5 * doubled_area(x[0], x[1], x[2]) * 4. /
                    (std::sqrt(3.) * h * h);
          up_to_.push_back(count_);
        }
      }

      /** Triangles of the size that fill them. */
      double n_triangles() const { return count_; }
      double area() const { return area_; }

      /** @p n points, as evenly as they may lie and be random. */
      std::vector<PlanePoint> draw(const std::size_t n,
                                   const std::uint64_t seed) const
      {
        std::vector<PlanePoint> points;
        std::size_t piece = 0;
        for (std::size_t i = 0; i < n; ++i) {
          const double count =
              count_ * (double(i) + uniform(seed, 3 * i)) / double(n);
          while (piece + 1 < pieces_.size() && up_to_[piece] < count)
            ++piece;
          const auto &[a, b, c] = pieces_[piece];
          double u = uniform(seed, 3 * i + 1), v = uniform(seed, 3 * i + 2);
          if (u + v > 1.) {
            u = 1. - u;
            v = 1. - v;
          }
          points.push_back({{a[0] + u * (b[0] - a[0]) + v * (c[0] - a[0]),
                             a[1] + u * (b[1] - a[1]) + v * (c[1] - a[1])}});
        }
        return points;
      }

    private:
      const SizeField &size_;
      std::vector<std::array<PlanePoint, 3>> pieces_;
      std::vector<double> up_to_; ///< triangles in all pieces up to this one
      double count_ = 0., area_ = 0.;
    };

    Pieces pieces_of(const PlaneTriangles &triangles,
                     const std::vector<unsigned int> &sets,
                     const std::vector<PlanePoint> &points,
                     const SizeField &size)
    {
      Pieces pieces(size);
      for (std::size_t t = 0; t < triangles.corners.size(); ++t)
        if (sets[triangles.part[t]] != no_set) {
          const auto &[a, b, c] = triangles.corners[t];
          pieces.add(points[a], points[b], points[c]);
        }
      return pieces;
    }

    /** Of the triangles that are kept. */
    std::size_t count_kept(const PlaneTriangles &triangles,
                           const std::vector<unsigned int> &sets)
    {
      std::size_t n = 0;
      for (const unsigned int part : triangles.part)
        n += sets[part] != no_set;
      return n;
    }

    void store(const PlaneTriangles &triangles,
               const std::vector<unsigned int> &sets,
               const OutlineNodes &outline,
               const std::vector<PlanePoint> &nodes, NamedMesh &mesh)
    {
      // numbered as the triangles come: neighbours in the plane are near
      std::vector<unsigned int> number(nodes.size(), no_set);
      mesh.coordinates.clear();
      mesh.cells = {};
      mesh.faces = {};
      for (std::size_t t = 0; t < triangles.corners.size(); ++t) {
        if (sets[triangles.part[t]] == no_set)
          continue;
        std::vector<unsigned int> corners;
        for (const unsigned int v : triangles.corners[t]) {
          if (number[v] == no_set) {
            number[v] = unsigned(mesh.n_vertices());
            mesh.coordinates.insert(mesh.coordinates.end(),
                                    {nodes[v][0], nodes[v][1], 0.});
          }
          corners.push_back(number[v]);
        }
        mesh.cells.add(corners, sets[triangles.part[t]]);
      }
      for (std::size_t e = 0; e < outline.edges.size(); ++e) {
        const auto &[a, b] = outline.edges[e];
        if (outline.set[e] != 0 && number[a] != no_set && number[b] != no_set)
          mesh.faces.add({number[a], number[b]}, outline.set[e]);
      }
    }

    /** The side of an equilateral triangle. */
    double size_of(const double area)
    {
      return std::sqrt(4. / std::sqrt(3.) * area);
    }

    double area_of(const PlaneOutline &outline)
    {
      std::vector<std::array<unsigned int, 2>> edges;
      for (const auto &line : outline.lines)
        edges.push_back({{line.first, line.last}});
      const PlaneTriangles triangles =
          ConstrainedDelaunay(edges)(outline.points);
      const auto sets = sets_of_parts(outline, triangles, outline.points);
      double area = 0.;
      for (std::size_t t = 0; t < triangles.corners.size(); ++t)
        if (sets[triangles.part[t]] != no_set) {
          const auto &[a, b, c] = triangles.corners[t];
          area += .5 * doubled_area(outline.points[a], outline.points[b],
                                    outline.points[c]);
        }
      return area;
    }

    /** What was made, and where it is worst. */
    void add_note(NamedMesh &mesh)
    {
      double smallest = 180.,
             shortest = std::numeric_limits<double>::infinity(), sum = 0.;
      PlanePoint where{};
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        std::array<PlanePoint, 3> x;
        for (unsigned int i = 0; i < 3; ++i) {
          const std::size_t v = mesh.cells.begin(c)[i];
          x[i] = {{mesh.coordinates[3 * v], mesh.coordinates[3 * v + 1]}};
        }
        for (unsigned int i = 0; i < 3; ++i) {
          const PlanePoint &p = x[i], &q = x[(i + 1) % 3], &r = x[(i + 2) % 3];
          const double length = std::hypot(q[0] - p[0], q[1] - p[1]);
          sum += length;
          shortest = std::min(shortest, length);
          const double angle = std::atan2(doubled_area(p, q, r),
                                          (q[0] - p[0]) * (r[0] - p[0]) +
                                              (q[1] - p[1]) * (r[1] - p[1])) *
                               180. / 3.14159265358979323846;
          if (angle < smallest) {
            smallest = angle;
            where = p;
          }
        }
      }
      mesh.notes.push_back(fmt::format(
          "{} triangles before they are cut: edges {:.3g} in the mean and at "
          "least {:.3g}, angles at least {:.3g} degrees",
          mesh.cells.size(), sum / (3. * double(mesh.cells.size())), shortest,
          smallest));
      constexpr double small = 20.;
      if (smallest < small)
        mesh.notes.push_back(fmt::format(
            "the smallest angle is at ({:g}, {:g}), where lines meet or are "
            "closer than the size",
            where[0], where[1]));
    }

    struct Filling {
      std::vector<PlanePoint> nodes; ///< those of the lines come first
      PlaneTriangles triangles;
      std::vector<unsigned int> sets; ///< of parts
    };

    Filling filling(const PlaneOutline &outline, const OutlineNodes &lines,
                    const IsotropicRequest &request)
    {
      Filling result;
      std::vector<PlanePoint> &nodes = result.nodes;
      PlaneTriangles &triangles = result.triangles;
      nodes = lines.points;
      const std::size_t n_fixed = nodes.size();
      ConstrainedDelaunay delaunay(lines.edges);
      triangles = delaunay(nodes);
      result.sets = sets_of_parts(outline, triangles, nodes);
      const Pieces pieces =
          pieces_of(triangles, result.sets, nodes, request.size);
      // every node more makes two triangles more
      const double missing = .5 * (pieces.n_triangles() -
                                   double(count_kept(triangles, result.sets)));
      if (missing > 0.) {
        const auto inner =
            pieces.draw(std::size_t(std::llround(missing)), request.seed);
        nodes.insert(nodes.end(), inner.begin(), inner.end());
      }
      std::vector<double> size(nodes.size());
      const auto update = [&] {
        triangles = delaunay(nodes);
        for (std::size_t v = 0; v < nodes.size(); ++v)
          size[v] = request.size(nodes[v]);
      };
      update();
      for (unsigned int i = 0; i < request.iterations; ++i) {
        move_to_centroids<2>(nodes, n_fixed, triangles.corners, size);
        update();
      }
      std::vector<unsigned char> held(nodes.size(), 0);
      std::fill_n(held.begin(), n_fixed, 3);
      relieve_cells<2>(nodes, held, triangles.corners, size);
      result.sets = sets_of_parts(outline, triangles, nodes);
      return result;
    }

    void fill(const PlaneOutline &outline, IsotropicRequest request,
              NamedMesh &mesh, std::vector<std::string> &problems)
    {
      if (request.n_triangles > 0.)
        request.size.factor = size_of(area_of(outline) / request.n_triangles);
      const OutlineNodes lines =
          place_nodes(outline, request.size, request.seed);
      const Filling result = filling(outline, lines, request);
      if (count_kept(result.triangles, result.sets) == 0)
        problems.push_back("there is no room for a triangle");
      store(result.triangles, result.sets, lines, result.nodes, mesh);
      if (problems.empty())
        add_note(mesh);
    }
  } // namespace

  double SizeField::at(const double x, const double y, const double z) const
  {
    const double size = factor * formula(x, y, z);
    if (!(size > 0.) || !std::isfinite(size))
      throw std::runtime_error(fmt::format(
          "`size` is {:g} at ({:g}, {:g}, {:g}); it must be positive", size, x,
          y, z));
    return size;
  }

  std::vector<PlanePoint> place_inner_nodes(const OutlineNodes &lines,
                                            const IsotropicRequest &request)
  {
    return filling({}, lines, request).nodes;
  }

  void fill_isotropically(const PlaneOutline &outline,
                          const IsotropicRequest &request, NamedMesh &mesh,
                          std::vector<std::string> &problems)
  {
    try {
      fill(outline, request, mesh, problems);
    } catch (const std::runtime_error &error) {
      problems.push_back(error.what());
    }
  }
} // namespace nsfd
