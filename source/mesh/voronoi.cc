#include "voronoi.h"

#include "core/mix_bits.h"
#include "gmsh_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    struct PlaneVector {
      double x = 0., y = 0.;
    };
    PlaneVector operator+(const PlaneVector a, const PlaneVector b)
    {
      return {a.x + b.x, a.y + b.y};
    }
    PlaneVector operator-(const PlaneVector a, const PlaneVector b)
    {
      return {a.x - b.x, a.y - b.y};
    }
    PlaneVector operator*(const double s, const PlaneVector a)
    {
      return {s * a.x, s * a.y};
    }
    double dot(const PlaneVector a, const PlaneVector b)
    {
      return a.x * b.x + a.y * b.y;
    }
    double cross(const PlaneVector a, const PlaneVector b)
    {
      return a.x * b.y - a.y * b.x;
    }
    double norm(const PlaneVector a) { return std::sqrt(dot(a, a)); }

    using Polygon = std::vector<PlaneVector>;

    /** Sutherland and Hodgman: what has dot(x, n) <= c. */
    Polygon clipped(const Polygon &polygon, const PlaneVector n, const double c)
    {
      Polygon result;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const PlaneVector a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        const double f_a = dot(a, n) - c, f_b = dot(b, n) - c;
        if (f_a <= 0.)
          result.push_back(a);
        if ((f_a < 0. && f_b > 0.) || (f_a > 0. && f_b < 0.))
          result.push_back(a + (f_a / (f_a - f_b)) * (b - a));
      }
      return result;
    }

    double area(const Polygon &polygon)
    {
      double sum = 0.;
      for (std::size_t i = 0; i < polygon.size(); ++i)
        sum += .5 * cross(polygon[i] - polygon[0],
                          polygon[(i + 1) % polygon.size()] - polygon[0]);
      return sum;
    }

    PlaneVector centroid(const Polygon &polygon)
    {
      PlaneVector sum;
      double twice_area = 0.;
      for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const PlaneVector a = polygon[i] - polygon[0],
                          b = polygon[i + 1] - polygon[0];
        const double part = cross(a, b);
        twice_area += part;
        sum = sum + (part / 3.) * (a + b);
      }
      return polygon[0] + (1. / twice_area) * sum;
    }

    /** The part of the box that is nearest to each seed. */
    std::vector<Polygon> diagram(const std::vector<PlaneVector> &seeds,
                                 const Polygon &box)
    {
      std::vector<Polygon> grains;
      std::vector<std::pair<double, std::size_t>> others;
      for (std::size_t s = 0; s < seeds.size(); ++s) {
        others.clear();
        for (std::size_t t = 0; t < seeds.size(); ++t)
          if (t != s)
            others.emplace_back(norm(seeds[t] - seeds[s]), t);
        std::sort(others.begin(), others.end());
        Polygon grain = box;
        for (const auto &[distance, t] : others) {
          double reach = 0.;
          for (const PlaneVector p : grain)
            reach = std::max(reach, norm(p - seeds[s]));
          if (distance > 2. * reach)
            break; // the bisectors of all others are farther away
          grain =
              clipped(grain, seeds[t] - seeds[s],
                      .5 * (dot(seeds[t], seeds[t]) - dot(seeds[s], seeds[s])));
        }
        grains.push_back(grain);
      }
      return grains;
    }

    /** Grains that share their corners, and which sides those are on. */
    class Network
    {
    public:
      Network(const std::vector<Polygon> &grains, const PlaneVector size)
          : size_(size)
      {
        // corners of different grains are the same point up to rounding
        constexpr double same = 1e-9;
        for (const Polygon &grain : grains) {
          auto &corners = corners_.emplace_back();
          for (const PlaneVector p : grain) {
            const auto near = std::find_if(
                points_.begin(), points_.end(), [&](const PlaneVector q) {
                  return std::abs(p.x - q.x) < same &&
                         std::abs(p.y - q.y) < same;
                });
            corners.push_back(unsigned(near - points_.begin()));
            if (near == points_.end())
              points_.push_back(p);
          }
          drop_repeated(corners);
        }
        for (PlaneVector &p : points_)
          sides_.push_back(sides_of(p));
      }

      /** Until no side that may go is shorter than @p length. */
      void collapse(const double length)
      {
        for (;;) {
          double shortest = length;
          std::pair<unsigned int, unsigned int> found;
          for (const auto &corners : corners_)
            for (std::size_t i = 0; i < corners.size(); ++i) {
              const unsigned int a = corners[i],
                                 b = corners[(i + 1) % corners.size()];
              const double l = norm(points_[b] - points_[a]);
              if (a < b && l < shortest && may_join(a, b)) {
                shortest = l;
                found = {a, b};
              }
            }
          if (shortest == length)
            return;
          join(found.first, found.second);
        }
      }

      PlaneRegions regions(const PlaneVector origin, const double scale,
                           std::vector<std::string> &problems) const
      {
        PlaneRegions result;
        std::vector<unsigned int> number(points_.size(), unused);
        for (std::size_t g = 0; g < corners_.size(); ++g) {
          Polygon grain;
          for (const unsigned int v : corners_[g])
            grain.push_back(points_[v]);
          if (grain.size() < 3 || !(area(grain) > 0.)) {
            problems.push_back(fmt::format(
                "grain {} vanishes at this element size; write a smaller "
                "`element size`, or more steps of `relaxation`",
                g + 1));
            return {};
          }
          auto &corners = result.corners.emplace_back();
          for (const unsigned int v : corners_[g]) {
            if (number[v] == unused) {
              number[v] = unsigned(result.x.size());
              result.x.push_back(origin.x + scale * points_[v].x);
              result.y.push_back(origin.y + scale * points_[v].y);
            }
            corners.push_back(number[v]);
          }
          result.names.push_back(fmt::format("grain {}", g + 1));
        }
        result.borders = "grain boundaries";
        return result;
      }

    private:
      static constexpr unsigned int unused =
          std::numeric_limits<unsigned int>::max();

      /** Bits for left, right, bottom, top; puts the point exactly there. */
      unsigned int sides_of(PlaneVector &p) const
      {
        unsigned int bits = 0;
        const auto touch = [&](double &x, const double side,
                               const unsigned int bit) {
          if (std::abs(x - side) < 1e-9) {
            x = side;
            bits |= bit;
          }
        };
        touch(p.x, 0., 1);
        touch(p.x, size_.x, 2);
        touch(p.y, 0., 4);
        touch(p.y, size_.y, 8);
        return bits;
      }

      /** One of the two must be on all sides that the other one is on. */
      bool may_join(const unsigned int a, const unsigned int b) const
      {
        const unsigned int both = sides_[a] | sides_[b];
        return both == sides_[a] || both == sides_[b];
      }

      void join(const unsigned int a, const unsigned int b)
      {
        if (sides_[a] == sides_[b])
          points_[a] = .5 * (points_[a] + points_[b]);
        else if (sides_[b] > sides_[a])
          points_[a] = points_[b];
        sides_[a] |= sides_[b];
        for (auto &corners : corners_) {
          std::replace(corners.begin(), corners.end(), b, a);
          drop_repeated(corners);
        }
      }

      static void drop_repeated(std::vector<unsigned int> &corners)
      {
        corners.erase(std::unique(corners.begin(), corners.end()),
                      corners.end());
        while (corners.size() > 1 && corners.front() == corners.back())
          corners.pop_back();
      }

      PlaneVector size_;
      std::vector<PlaneVector> points_;
      std::vector<unsigned int> sides_;
      std::vector<std::vector<unsigned int>> corners_; ///< of every grain
    };

    /** The mean size of a grain: the diagram is made for grains of size 1. */
    double grain_size(const VoronoiRequest &request)
    {
      return std::sqrt((request.upper[0] - request.lower[0]) *
                       (request.upper[1] - request.lower[1]) / request.grains);
    }

    PlaneRegions grains_of_size_one(const VoronoiRequest &request,
                                    std::vector<std::string> &problems)
    {
      const double scale = grain_size(request);
      const PlaneVector size = {(request.upper[0] - request.lower[0]) / scale,
                                (request.upper[1] - request.lower[1]) / scale};
      const Polygon box = {{0., 0.}, {size.x, 0.}, size, {0., size.y}};
      std::vector<PlaneVector> seeds;
      for (unsigned int s = 0; s < request.grains; ++s)
        seeds.push_back({uniform(request.seed, 2 * s) * size.x,
                         uniform(request.seed, 2 * s + 1) * size.y});
      std::vector<Polygon> grains = diagram(seeds, box);
      for (unsigned int i = 0; i < request.relaxation; ++i) {
        for (std::size_t s = 0; s < seeds.size(); ++s)
          seeds[s] = centroid(grains[s]);
        grains = diagram(seeds, box);
      }
      Network network(grains, size);
      // a cell's edge there, unless the cells are as large as the grains
      network.collapse(std::min(request.element_size / scale, .25));
      return network.regions({0., 0.}, 1., problems);
    }

    PlaneVector in_units(const VoronoiRequest &request, const double x,
                         const double y)
    {
      const double scale = grain_size(request);
      return {request.lower[0] + scale * x, request.lower[1] + scale * y};
    }
  } // namespace

  PlaneRegions voronoi_grains(const VoronoiRequest &request,
                              std::vector<std::string> &problems)
  {
    PlaneRegions regions = grains_of_size_one(request, problems);
    for (std::size_t v = 0; v < regions.x.size(); ++v) {
      const PlaneVector p = in_units(request, regions.x[v], regions.y[v]);
      regions.x[v] = p.x;
      regions.y[v] = p.y;
    }
    return regions;
  }

  NamedMesh voronoi_mesh(const VoronoiRequest &request,
                         std::vector<std::string> &problems)
  {
    const PlaneRegions regions = grains_of_size_one(request, problems);
    if (!problems.empty())
      return {};
    const double scale = grain_size(request);
    // Gmsh knows absolute tolerances: it sees grains of size 1
    NamedMesh mesh = mesh_regions(regions, request.element_size / scale,
                                  request.seconds, problems);
    for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
      double *p = mesh.coordinates.data() + 3 * v;
      const PlaneVector x = in_units(request, p[0], p[1]);
      p[0] = x.x;
      p[1] = x.y;
    }
    return mesh;
  }
} // namespace nsfd
