#include "cell_fields.h"

#include "named_mesh.h"
#include "vectors.h"

#include <boost/geometry/algorithms/disjoint.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace nsfd
{
  namespace
  {
    using namespace mesh_vectors;

    /** Weights of the corners of a cell at a place in its own coordinates, and
        their derivatives, in deal.II's order of corners. */
    struct CornerWeights {
      std::array<double, 8> value{};
      std::array<MeshVector, 8> slope{};
    };

    CornerWeights corner_weights(const unsigned int dimension,
                                 const unsigned int n_corners,
                                 const MeshVector &r)
    {
      CornerWeights w;
      const bool is_simplex = n_corners == dimension + 1;
      const bool is_prism = dimension == 3 && n_corners == 6;
      if (is_simplex || is_prism) {
        // a triangle or tetrahedron, in a prism times a line
        const unsigned int d = is_prism ? 2 : dimension;
        for (unsigned int layer = 0; layer < (is_prism ? 2u : 1u); ++layer) {
          const double along = !is_prism ? 1. : layer == 1 ? r[2] : 1. - r[2];
          for (unsigned int i = 0; i <= d; ++i) {
            const unsigned int k = layer * 3 + i;
            double flat = i == 0 ? 1. : r[i - 1];
            for (unsigned int j = 0; i == 0 && j < d; ++j)
              flat -= r[j];
            w.value[k] = flat * along;
            for (unsigned int j = 0; j < d; ++j)
              w.slope[k][j] = (i == 0 ? -1. : i == j + 1 ? 1. : 0.) * along;
            if (is_prism)
              w.slope[k][2] = layer == 1 ? flat : -flat;
          }
        }
        return w;
      }
      for (unsigned int k = 0; k < n_corners; ++k) {
        w.value[k] = 1.;
        for (unsigned int d = 0; d < dimension; ++d)
          w.value[k] *= (k >> d & 1u) != 0 ? r[d] : 1. - r[d];
        for (unsigned int j = 0; j < dimension; ++j) {
          w.slope[k][j] = (k >> j & 1u) != 0 ? 1. : -1.;
          for (unsigned int d = 0; d < dimension; ++d)
            if (d != j)
              w.slope[k][j] *= (k >> d & 1u) != 0 ? r[d] : 1. - r[d];
        }
      }
      return w;
    }

    /** How far the own coordinates of a place are outside those of the cell. */
    double excess(const unsigned int dimension, const unsigned int n_corners,
                  const MeshVector &r)
    {
      const bool is_simplex = n_corners == dimension + 1;
      const bool is_prism = dimension == 3 && n_corners == 6;
      double most = 0., sum = 0.;
      for (unsigned int d = 0; d < dimension; ++d) {
        most = std::max(most, -r[d]);
        if (is_simplex || (is_prism && d < 2))
          sum += r[d];
        else
          most = std::max(most, r[d] - 1.);
      }
      return std::max(most, sum - 1.);
    }

    /**
     * Newton's method for the own coordinates of a place, exact after one step
     * in simplices. Infinite if it does not converge.
     */
    double distance_from(const NamedMesh &mesh, const std::size_t cell,
                         const MeshVector &x)
    {
      const unsigned int dim = mesh.dimension;
      const unsigned int n = mesh.cells.n_vertices(cell);
      const bool is_simplex = n == dim + 1;
      const bool is_prism = dim == 3 && n == 6;
      MeshVector r{};
      for (unsigned int d = 0; d < dim; ++d)
        r[d] = is_simplex || (is_prism && d < 2) ? 1. / (dim + 1.) : .5;
      constexpr unsigned int most_steps = 25;
      constexpr double far = 10., small = 1e-12,
                       rounding = 1e-6; // of the size of the cell
      double before = std::numeric_limits<double>::infinity();
      for (unsigned int step = 0; step < most_steps; ++step) {
        const CornerWeights w = corner_weights(dim, n, r);
        MeshVector rest = x;
        std::array<MeshVector, 3> column{};
        column[2] = {{0., 0., 1.}};
        for (unsigned int d = 0; d < dim; ++d)
          column[d] = {};
        for (unsigned int k = 0; k < n; ++k) {
          const MeshVector p = position(mesh, mesh.cells.begin(cell)[k]);
          rest = rest - w.value[k] * p;
          for (unsigned int d = 0; d < dim; ++d)
            column[d] = column[d] + w.slope[k][d] * p;
        }
        if (dim == 2)
          rest[2] = 0.;
        const double volume = determinant(column[0], column[1], column[2]);
        const MeshVector change = {
            {determinant(rest, column[1], column[2]) / volume,
             determinant(column[0], rest, column[2]) / volume,
             determinant(column[0], column[1], rest) / volume}};
        double largest = 0.;
        for (unsigned int d = 0; d < dim; ++d) {
          r[d] += change[d];
          largest = std::max(largest, std::abs(change[d]));
        }
        if (!(largest < far)) // nor if it is not a number
          break;
        // where cells are far smaller than their distance from the origin,
        // rounding is all that moves in the end
        const bool is_rounding = largest < rounding && largest > .5 * before;
        if (largest < small || is_rounding || is_simplex)
          return excess(dim, n, r);
        before = largest;
      }
      return std::numeric_limits<double>::infinity();
    }
  } // namespace

  /** Boxes of cells. */
  class CellFields::Search
  {
  public:
    explicit Search(const NamedMesh &mesh) : tree_(boxes_of(mesh)) {}

    /** Cells whose box holds a place. */
    void find(const MeshVector &x, std::vector<std::size_t> &cells) const
    {
      cells.clear();
      const Point place(x[0], x[1], x[2]);
      for (auto at = tree_.qbegin(boost::geometry::index::intersects(place));
           at != tree_.qend(); ++at)
        cells.push_back(at->second);
      std::sort(cells.begin(), cells.end());
    }

  private:
    using Point = boost::geometry::model::point<double, 3,
                                                boost::geometry::cs::cartesian>;
    using Box = boost::geometry::model::box<Point>;
    using Entry = std::pair<Box, std::size_t>;

    static std::vector<Entry> boxes_of(const NamedMesh &mesh)
    {
      std::vector<Entry> boxes;
      boxes.reserve(mesh.cells.size());
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        MeshVector lower = position(mesh, mesh.cells.begin(c)[0]);
        MeshVector upper = lower;
        for (unsigned int i = 1; i < mesh.cells.n_vertices(c); ++i) {
          const MeshVector p = position(mesh, mesh.cells.begin(c)[i]);
          for (unsigned int d = 0; d < 3; ++d) {
            lower[d] = std::min(lower[d], p[d]);
            upper[d] = std::max(upper[d], p[d]);
          }
        }
        // what rounding moves out of a box is still next to its cell
        const double margin = 1e-6 * norm(upper - lower);
        boxes.emplace_back(
            Box(Point(lower[0] - margin, lower[1] - margin, lower[2] - margin),
                Point(upper[0] + margin, upper[1] + margin, upper[2] + margin)),
            c);
      }
      return boxes;
    }

    boost::geometry::index::rtree<Entry, boost::geometry::index::quadratic<16>>
        tree_;
  };

  CellFields::CellFields(std::shared_ptr<const NamedMesh> mesh)
      : mesh_(std::move(mesh))
  {
    for (const auto &[name, values] : mesh_->fields)
      values_.push_back(&values);
  }

  CellFields::~CellFields() = default;

  void CellFields::find(const double x, const double y, const double z,
                        std::vector<std::size_t> &cells) const
  {
    if (!search_)
      search_ = std::make_unique<Search>(*mesh_);
    const MeshVector place = {{x, y, mesh_->dimension == 3 ? z : 0.}};
    search_->find(place, cells);
    // own coordinates are of the size of 1 in every cell, however small it is;
    // points on faces are computed to some 1e-12 of them
    constexpr double tolerance = 1e-7;
    std::size_t n = 0;
    for (const std::size_t cell : cells)
      if (distance_from(*mesh_, cell, place) <= tolerance)
        cells[n++] = cell;
    cells.resize(n);
  }

  double CellFields::value(const std::size_t field,
                           const std::size_t cell) const
  {
    return (*values_[field])[cell];
  }
} // namespace nsfd
