#include "check_cells.h"

#include "cell_shapes.h"
#include "vectors.h"

#include "named_mesh.h"

#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    using namespace mesh_vectors;

    /** Says no more than three of a kind, and how many there are. */
    class Counted
    {
    public:
      Counted(const std::string &what, std::vector<std::string> &problems)
          : what_(what), problems_(problems)
      {
      }
      ~Counted()
      {
        if (n_ > most)
          problems_.push_back(fmt::format("and {} more {}", n_ - most, what_));
      }
      Counted(const Counted &) = delete;
      Counted &operator=(const Counted &) = delete;

      template <typename Sentence>
      void add(const Sentence &sentence)
      {
        if (++n_ <= most)
          problems_.push_back(sentence());
      }

    private:
      static constexpr std::size_t most = 3;
      std::string what_;
      std::vector<std::string> &problems_;
      std::size_t n_ = 0;
    };

    /** No more than a hex needs, without a memory of its own. */
    template <std::size_t most>
    class Vectors
    {
    public:
      void push_back(const MeshVector &v) { values_[size_++] = v; }
      std::size_t size() const { return size_; }
      const MeshVector &operator[](const std::size_t i) const
      {
        return values_[i];
      }
      const MeshVector &back() const { return values_[size_ - 1]; }
      const MeshVector *begin() const { return values_.data(); }
      const MeshVector *end() const { return values_.data() + size_; }

    private:
      std::array<MeshVector, most> values_;
      std::size_t size_ = 0;
    };

    /** A cell with what separates it from others. */
    struct Body {
      Vectors<8> x;
      Vectors<6> normals; ///< of length 1
      MeshVector centre{};
      double width = 0.; ///< the smallest along a normal

      Body(const NamedMesh &mesh, const std::size_t c)
      {
        const unsigned int n = mesh.cells.n_vertices(c);
        const unsigned int *v = mesh.cells.begin(c);
        for (unsigned int i = 0; i < n; ++i) {
          x.push_back(position(mesh, v[i]));
          for (unsigned int d = 0; d < 3; ++d)
            centre[d] += x.back()[d] / n;
        }
        const auto *shape = find_cell_shape(mesh.dimension, n);
        width = std::numeric_limits<double>::max();
        for (const auto &face : shape->faces) {
          add_normal(normal(face));
          const auto [lower, upper] = range(normals.back());
          width = std::min(width, upper - lower);
        }
      }

      /** Not of length 1. */
      MeshVector normal(const std::vector<unsigned int> &face) const
      {
        if (face.size() == 2) {
          const MeshVector along = x[face[1]] - x[face[0]];
          return {{along[1], -along[0], 0.}};
        }
        // corners of a quad go row by row
        return face.size() == 3
                   ? cross(x[face[1]] - x[face[0]], x[face[2]] - x[face[0]])
                   : cross(x[face[3]] - x[face[0]], x[face[2]] - x[face[1]]);
      }

      void add_normal(const MeshVector &n)
      {
        const double length = norm(n);
        normals.push_back({{n[0] / length, n[1] / length, n[2] / length}});
      }

      std::pair<double, double> range(const MeshVector &axis) const
      {
        std::pair<double, double> result(std::numeric_limits<double>::max(),
                                         -std::numeric_limits<double>::max());
        for (const MeshVector &p : x) {
          const double s = dot(axis, p);
          result.first = std::min(result.first, s);
          result.second = std::max(result.second, s);
        }
        return result;
      }
    };

    /// of the thinner cell: by this much, two cells may overlap
    constexpr double tolerated_share = .1;

    bool is_separated_by(const Body &a, const Body &b, const MeshVector &axis,
                         const double depth)
    {
      const auto of_a = a.range(axis), of_b = b.range(axis);
      return std::min(of_a.second, of_b.second) -
                 std::max(of_a.first, of_b.first) <=
             depth;
    }

    Vectors<12> edges(const NamedMesh &mesh, const Body &body)
    {
      Vectors<12> result;
      const auto *shape =
          find_cell_shape(mesh.dimension, unsigned(body.x.size()));
      for (unsigned int i = 0; i < shape->n_corners; ++i)
        for (const unsigned int j : shape->edges[i])
          if (i < j)
            result.push_back(body.x[j] - body.x[i]);
      return result;
    }

    /**
     * Two convex bodies are apart if a plane is between them: parallel to a
     * face of one of them, or to an edge of each.
     */
    bool overlap(const NamedMesh &mesh, const Body &a, const Body &b)
    {
      const double depth = tolerated_share * std::min(a.width, b.width);
      for (const Body *body : {&a, &b})
        for (const MeshVector &axis : body->normals)
          if (is_separated_by(a, b, axis, depth))
            return false;
      if (mesh.dimension == 2)
        return true;
      const auto of_a = edges(mesh, a), of_b = edges(mesh, b);
      for (const MeshVector &e : of_a)
        for (const MeshVector &f : of_b) {
          MeshVector axis = cross(e, f);
          const double length = norm(axis);
          // parallel edges: the faces have said it
          if (!(length > 1e-8 * norm(e) * norm(f)))
            continue;
          for (double &component : axis)
            component /= length;
          if (is_separated_by(a, b, axis, depth))
            return false;
        }
      return true;
    }

    void check_corners(const NamedMesh &mesh,
                       std::vector<std::string> &problems)
    {
      Counted bad("cells are inverted or degenerate", problems),
          long_ones("cells are too long for their width", problems);
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const unsigned int *v = mesh.cells.begin(c);
        const auto *shape =
            find_cell_shape(mesh.dimension, mesh.cells.n_vertices(c));
        double smallest = std::numeric_limits<double>::max();
        double shortest = smallest, longest = 0.;
        for (unsigned int i = 0; i < shape->n_corners; ++i) {
          const MeshVector origin = position(mesh, v[i]);
          std::array<MeshVector, 3> edge = {
              {{{0., 0., 0.}}, {{0., 0., 0.}}, {{0., 0., 1.}}}};
          double lengths = 1.;
          for (unsigned int d = 0; d < mesh.dimension; ++d) {
            edge[d] = position(mesh, v[shape->edges[i][d]]) - origin;
            const double length = norm(edge[d]);
            lengths *= length;
            shortest = std::min(shortest, length);
            longest = std::max(longest, length);
          }
          const double volume = dot(cross(edge[0], edge[1]), edge[2]);
          smallest = std::min(smallest, lengths > 0. ? volume / lengths : 0.);
        }
        // slivers of any angle are cells; what rounding leaves is not
        constexpr double rounding = 1e-14;
        if (!(smallest > rounding))
          bad.add([&] {
            return fmt::format("{} is {} (smallest scaled corner Jacobian "
                               "{:.3g})",
                               cell_text(mesh, c),
                               smallest < -rounding ? "inverted" : "degenerate",
                               smallest);
          });
        // shapes are rounded to 2^-42 of their size: places on a face must
        // agree with those of the cell behind it
        constexpr double largest_ratio = 1e6;
        if (longest > largest_ratio * shortest)
          long_ones.add([&] {
            return fmt::format("{} has edges of {:.3g} and of {:.3g}, and none "
                               "may be longer than {:g} times another",
                               cell_text(mesh, c), longest, shortest,
                               largest_ratio);
          });
      }
    }

    struct FaceOfCell {
      std::array<unsigned int, 4> vertices; ///< sorted
      std::size_t cell;
      unsigned int number;

      bool operator<(const FaceOfCell &other) const
      {
        return vertices < other.vertices ||
               (vertices == other.vertices && cell < other.cell);
      }
    };

    std::vector<FaceOfCell> faces_of_cells(const NamedMesh &mesh)
    {
      std::vector<FaceOfCell> faces;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const auto *shape =
            find_cell_shape(mesh.dimension, mesh.cells.n_vertices(c));
        for (unsigned int f = 0; f < shape->faces.size(); ++f) {
          FaceOfCell face;
          face.vertices.fill(std::numeric_limits<unsigned int>::max());
          for (unsigned int i = 0; i < shape->faces[f].size(); ++i)
            face.vertices[i] = mesh.cells.begin(c)[shape->faces[f][i]];
          std::sort(face.vertices.begin(), face.vertices.end());
          face.cell = c;
          face.number = f;
          faces.push_back(face);
        }
      }
      std::sort(faces.begin(), faces.end());
      return faces;
    }

    /** The two cells of a face must be on its two sides. */
    void check_folds(const NamedMesh &mesh,
                     const std::vector<FaceOfCell> &faces,
                     std::vector<std::string> &problems)
    {
      Counted folds("faces have both cells on one side", problems);
      for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
        if (faces[i].vertices != faces[i + 1].vertices)
          continue;
        const Body a(mesh, faces[i].cell), b(mesh, faces[i + 1].cell);
        const auto &face = find_cell_shape(mesh.dimension, unsigned(a.x.size()))
                               ->faces[faces[i].number];
        const MeshVector &normal = a.normals[faces[i].number];
        MeshVector middle{};
        for (const unsigned int j : face)
          for (unsigned int d = 0; d < 3; ++d)
            middle[d] += a.x[j][d] / double(face.size());
        // on warped faces, the centre of a cell may be near the plane
        const double s = dot(normal, a.centre - middle),
                     t = dot(normal, b.centre - middle);
        constexpr double share = 1e-3;
        if (s * t > 0. && std::abs(s) > share * a.width &&
            std::abs(t) > share * b.width)
          folds.add([&] {
            return fmt::format("{} and {} are on the same side of the face "
                               "that they share: the mesh is folded there",
                               cell_text(mesh, faces[i].cell),
                               cell_text(mesh, faces[i + 1].cell));
          });
      }
    }

    namespace geometry = boost::geometry;
    using Place = geometry::model::point<double, 3, geometry::cs::cartesian>;
    using Box = geometry::model::box<Place>;
    using Entry = std::pair<Box, std::size_t>;

    Box box_of(const Body &body)
    {
      MeshVector lower = body.x[0], upper = body.x[0];
      for (const MeshVector &p : body.x)
        for (unsigned int d = 0; d < 3; ++d) {
          lower[d] = std::min(lower[d], p[d]);
          upper[d] = std::max(upper[d], p[d]);
        }
      return {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
    }

    /** By no more than @p depth along an axis: they cannot overlap by more. */
    bool are_apart(const Box &a, const Box &b, const double depth,
                   const unsigned int dimension)
    {
      const auto &a0 = a.min_corner(), &a1 = a.max_corner(),
                 &b0 = b.min_corner(), &b1 = b.max_corner();
      const auto least = [](const double s, const double t, const double u,
                            const double v) {
        return std::min(s, t) - std::max(u, v);
      };
      double common =
          std::min(least(a1.get<0>(), b1.get<0>(), a0.get<0>(), b0.get<0>()),
                   least(a1.get<1>(), b1.get<1>(), a0.get<1>(), b0.get<1>()));
      if (dimension == 3)
        common = std::min(
            common, least(a1.get<2>(), b1.get<2>(), a0.get<2>(), b0.get<2>()));
      return common <= depth;
    }

    bool share_a_face(const std::vector<std::vector<std::size_t>> &neighbours,
                      const std::size_t a, const std::size_t b)
    {
      return std::find(neighbours[a].begin(), neighbours[a].end(), b) !=
             neighbours[a].end();
    }

    void check_overlaps(const NamedMesh &mesh,
                        const std::vector<FaceOfCell> &faces,
                        std::vector<std::string> &problems)
    {
      // on warped faces, cells that share one are no convex bodies
      std::vector<std::vector<std::size_t>> neighbours(mesh.cells.size());
      for (std::size_t i = 0; i + 1 < faces.size(); ++i)
        if (faces[i].vertices == faces[i + 1].vertices)
          neighbours[faces[i].cell].push_back(faces[i + 1].cell);
      std::vector<Entry> entries;
      std::vector<double> width;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const Body body(mesh, c);
        entries.emplace_back(box_of(body), c);
        width.push_back(body.width);
      }
      constexpr unsigned int entries_of_a_node = 16;
      const geometry::index::rtree<Entry,
                                   geometry::index::rstar<entries_of_a_node>>
          tree(entries.begin(), entries.end());
      Counted overlaps("pairs of cells overlap", problems);
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const Body body(mesh, c);
        for (auto found =
                 tree.qbegin(geometry::index::intersects(entries[c].first));
             found != tree.qend(); ++found) {
          const std::size_t other = found->second;
          const double depth =
              tolerated_share * std::min(width[c], width[other]);
          if (other <= c ||
              are_apart(entries[c].first, found->first, depth,
                        mesh.dimension) ||
              share_a_face(neighbours, c, other) ||
              !overlap(mesh, body, Body(mesh, other)))
            continue;
          overlaps.add([&] {
            return fmt::format("{} and {} overlap", cell_text(mesh, c),
                               cell_text(mesh, other));
          });
        }
      }
    }
  } // namespace

  std::string cell_text(const NamedMesh &mesh, const std::size_t cell)
  {
    const unsigned int n = mesh.cells.n_vertices(cell);
    MeshVector centre{};
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int d = 0; d < 3; ++d)
        centre[d] += position(mesh, mesh.cells.begin(cell)[i])[d] / n;
    const std::string name =
        mesh.cells.numbers.empty()
            ? "the cell"
            : fmt::format("cell {}", mesh.cells.numbers[cell]);
    return mesh.dimension == 2
               ? fmt::format("{} at ({:g}, {:g})", name, centre[0], centre[1])
               : fmt::format("{} at ({:g}, {:g}, {:g})", name, centre[0],
                             centre[1], centre[2]);
  }

  void check_cells(const NamedMesh &mesh, std::vector<std::string> &problems)
  {
    const std::size_t n_before = problems.size();
    check_corners(mesh, problems);
    // of inverted cells, nothing more can be said
    if (problems.size() > n_before)
      return;
    const std::vector<FaceOfCell> faces = faces_of_cells(mesh);
    check_folds(mesh, faces, problems);
    check_overlaps(mesh, faces, problems);
  }
} // namespace nsfd
