#include "mesh_builder.h"

#include "core/communicator.h"

#include "coarse_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    double area(const std::vector<Point<2>> &line)
    {
      return line[0].distance(line[1]);
    }

    /** Exact for triangles and plane quads, 2 x 2 Gauss points otherwise. */
    double area(const std::vector<Point<3>> &face)
    {
      if (face.size() == 3)
        return .5 *
               cross_product_3d(face[1] - face[0], face[2] - face[0]).norm();
      double sum = 0.;
      const double half = .5 / std::sqrt(3.);
      for (const double s : {.5 - half, .5 + half})
        for (const double t : {.5 - half, .5 + half}) {
          const Tensor<1, 3> along_s = (1. - t) * (face[1] - face[0]) +
                                       t * (face[3] - face[2]),
                             along_t = (1. - s) * (face[2] - face[0]) +
                                       s * (face[3] - face[1]);
          sum += .25 * cross_product_3d(along_s, along_t).norm();
        }
      return sum;
    }
    double circumscribed_radius(const std::vector<Point<2>> &triangle,
                                const double volume)
    {
      return area({triangle[0], triangle[1]}) *
             area({triangle[1], triangle[2]}) *
             area({triangle[2], triangle[0]}) / (4. * volume);
    }

    double circumscribed_radius(const std::vector<Point<3>> &tetrahedron,
                                const double volume)
    {
      const Tensor<1, 3> a = tetrahedron[1] - tetrahedron[0],
                         b = tetrahedron[2] - tetrahedron[0],
                         c = tetrahedron[3] - tetrahedron[0];
      return (a.norm_square() * cross_product_3d(b, c) +
              b.norm_square() * cross_product_3d(c, a) +
              c.norm_square() * cross_product_3d(a, b))
                 .norm() /
             (12. * volume);
    }
  } // namespace

  template <int dim>
  MeshReport mesh_report(const Triangulation<dim> &triangulation)
  {
    const Communicator communicator(triangulation.get_communicator());
    constexpr double huge = std::numeric_limits<double>::max();
    // smallest edge, height, angle, Jacobian, ratio of radii and minus largest
    // edge, angle
    std::array<double, 7> least;
    least.fill(huge);
    std::vector<double> volumes, inner_areas;
    std::vector<Point<dim>> corners, face_corners;
    for (const auto &cell : triangulation.active_cell_iterators()) {
      if (!cell->is_locally_owned())
        continue;
      corners.clear();
      for (const unsigned int v : cell->vertex_indices())
        corners.push_back(cell->vertex(v));
      double largest_face = 0., surface = 0.;
      for (const unsigned int f : cell->face_indices()) {
        const auto face = cell->face(f);
        face_corners.clear();
        for (const unsigned int v : face->vertex_indices())
          face_corners.push_back(face->vertex(v));
        const double face_area = area(face_corners);
        largest_face = std::max(largest_face, face_area);
        surface += face_area;
        // half of a face between two cells; the finer side of a hanging one
        if (!face->at_boundary() && !face->has_children())
          inner_areas.push_back(cell->neighbor_is_coarser(f) ? face_area
                                                             : .5 * face_area);
      }
      const double volume = cell->measure();
      volumes.push_back(volume);
      const bool simplex = corners.size() == dim + 1;
      const CellShape shape = cell_shape(corners);
      // the inscribed radius is dim * volume / surface
      const double radius_ratio =
          simplex ? dim * dim * volume / surface /
                        circumscribed_radius(corners, volume)
                  : 0.;
      const std::array<double, 7> values = {
          {shape.shortest_edge, (simplex ? dim : 1) * volume / largest_face,
           shape.smallest_angle, shape.scaled_jacobian, radius_ratio,
           -shape.longest_edge, -shape.largest_angle}};
      for (unsigned int i = 0; i < values.size(); ++i)
        least[i] = std::min(least[i], values[i]);
    }
    MPI_Allreduce(MPI_IN_PLACE, least.data(), int(least.size()), MPI_DOUBLE,
                  MPI_MIN, communicator.mpi());
    MeshReport report;
    report.n_cells = triangulation.n_global_active_cells();
    report.smallest_edge = least[0];
    report.smallest_height = least[1];
    report.smallest_angle = least[2];
    report.smallest_scaled_jacobian = least[3];
    report.smallest_radius_ratio = least[4];
    report.largest_edge = -least[5];
    report.largest_angle = -least[6];
    report.volume = communicator.sum(volumes);
    report.inner_face_area = communicator.sum(inner_areas);
    report.interface_density = report.inner_face_area / report.volume;
    return report;
  }

  template MeshReport mesh_report(const Triangulation<2> &);
  template MeshReport mesh_report(const Triangulation<3> &);
} // namespace nsfd
