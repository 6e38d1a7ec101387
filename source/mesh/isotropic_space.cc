#include "isotropic_space.h"

#include "delaunay_tetrahedra.h"
#include "lloyd.h"
#include "relieve_cells.h"

#include "core/mix_bits.h"
#include "nsfd/core/space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    using Tetrahedron = std::array<unsigned int, 4>;

    /// more than any machine of today holds, once they are cut
    constexpr double most_tetrahedra = 2e7;

    /** Of a regular tetrahedron of side @p h. */
    double regular_volume(const double h)
    {
      return h * h * h / (6. * std::sqrt(2.));
    }

    /** A size in the coordinates of a line or a plane in space. */
    SizeField
    restricted(const SizeField &size,
               const std::function<Vec3(double, double)> &place_in_space)
    {
      SizeField result;
      result.formula =
          Expression([&size, place_in_space](
                         const double u, const double v, double,
                         double) { return size(place_in_space(u, v)); },
                     size.formula.text(), false);
      return result;
    }

    unsigned int seed_of(const unsigned int seed, const unsigned int part)
    {
      return unsigned(mixed(mixed(seed) + part));
    }

    /** Puts nodes on the surface of a box. */
    class BoxSurface
    {
    public:
      BoxSurface(const Vec3 &lower, const Vec3 &upper,
                 const IsotropicRequest &request)
          : ends_{{lower, upper}}, request_(request)
      {
        for (unsigned int c = 0; c < 8; ++c)
          add({{ends_[c & 1u][0], ends_[c >> 1 & 1u][1],
                ends_[c >> 2 & 1u][2]}},
              7);
        for (unsigned int d = 0; d < 3; ++d)
          for (unsigned int c = 0; c < 8; ++c)
            if ((c >> d & 1u) == 0)
              edges_[d][c] = nodes_of_edge(d, c);
        for (unsigned int d = 0; d < 3; ++d)
          for (unsigned int side = 0; side < 2; ++side)
            add_side(d, side);
      }

      const std::vector<Vec3> &nodes() const { return nodes_; }
      /** Bits of the coordinates that are those of a side, per node. */
      const std::vector<unsigned char> &held() const { return held_; }

    private:
      void add(const Vec3 &node, const unsigned int held)
      {
        nodes_.push_back(node);
        held_.push_back((unsigned char)(held));
      }

      /** In direction @p d from corner @p c on, without its ends. */
      std::vector<unsigned int> nodes_of_edge(const unsigned int d,
                                              const unsigned int c)
      {
        const Vec3 start = nodes_[c];
        const double length = ends_[1][d] - ends_[0][d];
        PlaneOutline line;
        line.points = {{{0., 0.}}, {{length, 0.}}};
        line.lines = {{0, 1, 0}};
        const auto place = [start, d](const double u, double) {
          Vec3 p = start;
          p[d] += u;
          return p;
        };
        const OutlineNodes found =
            place_nodes(line, restricted(request_.size, place),
                        seed_of(request_.seed, 8 * d + c));
        std::vector<unsigned int> result;
        for (std::size_t i = 1; i + 1 < found.points.size(); ++i) {
          result.push_back(unsigned(nodes_.size()));
          add(place(found.points[i][0], 0.), 7u & ~(1u << d));
        }
        return result;
      }

      void add_side(const unsigned int d, const unsigned int side)
      {
        const unsigned int e = (d + 1) % 3, f = (d + 2) % 3;
        const unsigned int origin = side << d;
        // round the side, edge by edge
        std::vector<unsigned int> round;
        const auto append = [&](const unsigned int corner,
                                std::vector<unsigned int> edge,
                                const bool backwards) {
          round.push_back(corner);
          if (backwards)
            std::reverse(edge.begin(), edge.end());
          round.insert(round.end(), edge.begin(), edge.end());
        };
        const unsigned int at_e = origin | 1u << e, at_f = origin | 1u << f;
        append(origin, edges_[e].at(origin), false);
        append(at_e, edges_[f].at(at_e), false);
        append(at_e | 1u << f, edges_[e].at(at_f), true);
        append(at_f, edges_[f].at(origin), true);
        OutlineNodes lines;
        for (std::size_t i = 0; i < round.size(); ++i) {
          lines.points.push_back({{nodes_[round[i]][e], nodes_[round[i]][f]}});
          lines.edges.push_back(
              {{unsigned(i), unsigned((i + 1) % round.size())}});
          lines.set.push_back(0);
        }
        const double level = ends_[side][d];
        const auto place = [d, e, f, level](const double u, const double v) {
          Vec3 p{};
          p[d] = level;
          p[e] = u;
          p[f] = v;
          return p;
        };
        IsotropicRequest request = request_;
        request.size = restricted(request_.size, place);
        request.seed = seed_of(request_.seed, 24 + 2 * d + side);
        const std::vector<PlanePoint> points =
            place_inner_nodes(lines, request);
        for (std::size_t i = lines.points.size(); i < points.size(); ++i)
          add(place(points[i][0], points[i][1]), 1u << d);
      }

      std::array<Vec3, 2> ends_;
      const IsotropicRequest &request_;
      std::vector<Vec3> nodes_;
      std::vector<unsigned char> held_;
      std::array<std::map<unsigned int, std::vector<unsigned int>>, 3>
          edges_; ///< by direction and corner
    };

    /** Small boxes, with the number of tetrahedra that fill them. */
    class BoxPieces
    {
    public:
      BoxPieces(const Vec3 &lower, const Vec3 &upper, const SizeField &size)
      {
        std::vector<std::array<Vec3, 2>> waiting = {{{lower, upper}}};
        while (!waiting.empty()) {
          const auto box = waiting.back();
          waiting.pop_back();
          Vec3 middle{};
          unsigned int longest = 0;
          for (unsigned int d = 0; d < 3; ++d) {
            middle[d] = .5 * (box[0][d] + box[1][d]);
            if (box[1][d] - box[0][d] > box[1][longest] - box[0][longest])
              longest = d;
          }
          const double h = size(middle);
          constexpr double most = 3.; // edges in sizes
          if (box[1][longest] - box[0][longest] > most * h) {
            auto parts = std::array<std::array<Vec3, 2>, 2>{{box, box}};
            parts[0][1][longest] = parts[1][0][longest] = middle[longest];
            waiting.insert(waiting.end(), parts.begin(), parts.end());
            continue;
          }
          if (count_ > most_tetrahedra)
            throw std::runtime_error(fmt::format(
                "the mesh would have more than {:.2g} tetrahedra before they "
                "are cut; write a larger `size`, or fewer `cells`",
                most_tetrahedra));
          const double volume = (box[1][0] - box[0][0]) *
                                (box[1][1] - box[0][1]) *
                                (box[1][2] - box[0][2]);
          count_ += volume / regular_volume(h);
          pieces_.push_back(box);
          up_to_.push_back(count_);
        }
      }

      double n_tetrahedra() const { return count_; }

      /** @p n points, as evenly as they may lie and be random. */
      void draw(const std::size_t n, const unsigned int seed,
                std::vector<Vec3> &nodes) const
      {
        std::size_t piece = 0;
        for (std::size_t i = 0; i < n; ++i) {
          const double count =
              count_ * (double(i) + uniform(seed, 4 * i)) / double(n);
          while (piece + 1 < pieces_.size() && up_to_[piece] < count)
            ++piece;
          Vec3 p{};
          for (unsigned int d = 0; d < 3; ++d)
            p[d] = pieces_[piece][0][d] +
                   (pieces_[piece][1][d] - pieces_[piece][0][d]) *
                       uniform(seed, 4 * i + d + 1);
          nodes.push_back(p);
        }
      }

    private:
      std::vector<std::array<Vec3, 2>> pieces_;
      std::vector<double> up_to_; ///< tetrahedra in all up to this one
      double count_ = 0.;
    };

    double six_volumes(const std::vector<Vec3> &nodes, const Tetrahedron &cell)
    {
      using namespace space;
      return dot(nodes[cell[1]] - nodes[cell[0]],
                 cross(nodes[cell[2]] - nodes[cell[0]],
                       nodes[cell[3]] - nodes[cell[0]]));
    }

    void store(const std::vector<Vec3> &nodes,
               const std::vector<Tetrahedron> &cells, NamedMesh &mesh)
    {
      mesh.dimension = 3;
      double lowest = std::numeric_limits<double>::infinity(),
             shortest = lowest, sum = 0.;
      for (const Vec3 &p : nodes)
        mesh.coordinates.insert(mesh.coordinates.end(), p.begin(), p.end());
      for (const Tetrahedron &cell : cells) {
        using namespace space;
        mesh.cells.add({cell[0], cell[1], cell[2], cell[3]}, 0);
        double largest = 0.;
        for (unsigned int i = 0; i < 4; ++i) {
          const Vec3 &a = nodes[cell[(i + 1) % 4]],
                     &b = nodes[cell[(i + 2) % 4]],
                     &c = nodes[cell[(i + 3) % 4]];
          largest = std::max(largest, norm(cross(b - a, c - a)));
          for (unsigned int j = 0; j < i; ++j) {
            const double length = norm(nodes[cell[i]] - nodes[cell[j]]);
            shortest = std::min(shortest, length);
            sum += length;
          }
        }
        lowest = std::min(lowest, six_volumes(nodes, cell) / largest);
      }
      mesh.notes.push_back(fmt::format(
          "{} tetrahedra before they are cut: edges {:.3g} in the mean and at "
          "least {:.3g}, heights at least {:.3g}",
          cells.size(), sum / (6. * double(cells.size())), shortest, lowest));
    }

    void fill(const Vec3 &lower, const Vec3 &upper,
              const IsotropicRequest &request, NamedMesh &mesh)
    {
      const BoxSurface surface(lower, upper, request);
      std::vector<Vec3> nodes = surface.nodes();
      const std::size_t n_fixed = nodes.size();
      const BoxPieces pieces(lower, upper, request.size);
      std::vector<Tetrahedron> cells;
      std::vector<double> size;
      const auto update = [&] {
        cells = delaunay_tetrahedra(nodes);
        for (std::size_t v = 0; v < nodes.size(); ++v)
          size[v] = request.size(nodes[v]);
      };
      const auto relax = [&](const unsigned int n_steps) {
        update();
        for (unsigned int i = 0; i < n_steps; ++i) {
          move_to_centroids<3>(nodes, n_fixed, cells, size);
          update();
        }
      };
      // counted: 6.4 tetrahedra per node inside, and 3 per node of the surface,
      // less along edges; a few steps tell by how much
      constexpr double per_node = 6.4, per_node_of_surface = 3.;
      double n_inside =
          (pieces.n_tetrahedra() - per_node_of_surface * double(n_fixed)) /
          per_node;
      const auto draw = [&] {
        nodes.resize(n_fixed);
        if (n_inside > 0.)
          pieces.draw(std::size_t(std::llround(n_inside)), request.seed, nodes);
        size.resize(nodes.size());
      };
      draw();
      relax(std::min(request.iterations, 5u));
      n_inside += (pieces.n_tetrahedra() - double(cells.size())) / per_node;
      draw();
      relax(request.iterations);
      std::vector<unsigned char> held = surface.held();
      held.resize(nodes.size(), 0);
      // flat ones first; what changes by that is looked at again
      relieve_cells<3>(nodes, held, cells, size);
      update();
      relieve_cells<3>(nodes, held, cells, size);
      store(nodes, cells, mesh);
    }
  } // namespace

  void fill_box_isotropically(const std::array<double, 3> &lower,
                              const std::array<double, 3> &upper,
                              IsotropicRequest request, NamedMesh &mesh,
                              std::vector<std::string> &problems)
  {
    if (request.n_triangles > 0.) {
      double volume = 1.;
      for (unsigned int d = 0; d < 3; ++d)
        volume *= upper[d] - lower[d];
      request.size.factor =
          std::cbrt(volume / request.n_triangles / regular_volume(1.));
    }
    try {
      fill(lower, upper, request, mesh);
    } catch (const std::runtime_error &error) {
      problems.push_back(error.what());
    }
  }
} // namespace nsfd
