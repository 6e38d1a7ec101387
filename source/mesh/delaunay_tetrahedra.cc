#include "delaunay_tetrahedra.h"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <stdexcept>

namespace nsfd
{
  namespace
  {
    using SpaceKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using SpaceVertex =
        CGAL::Triangulation_vertex_base_with_info_3<unsigned int, SpaceKernel>;
    using SpaceCell = CGAL::Delaunay_triangulation_cell_base_3<SpaceKernel>;
    using SpaceTriangulation = CGAL::Delaunay_triangulation_3<
        SpaceKernel,
        CGAL::Triangulation_data_structure_3<SpaceVertex, SpaceCell>>;
  } // namespace

  std::vector<std::array<unsigned int, 4>>
  delaunay_tetrahedra(const std::vector<std::array<double, 3>> &points)
  {
    std::vector<std::pair<SpaceKernel::Point_3, unsigned int>> places;
    places.reserve(points.size());
    for (unsigned int p = 0; p < points.size(); ++p)
      places.emplace_back(
          SpaceKernel::Point_3(points[p][0], points[p][1], points[p][2]), p);
    const SpaceTriangulation triangulation(places.begin(), places.end());
    if (triangulation.number_of_vertices() != points.size())
      throw std::runtime_error("two nodes are at one place");
    std::vector<std::array<unsigned int, 4>> corners;
    for (auto cell = triangulation.finite_cells_begin();
         cell != triangulation.finite_cells_end(); ++cell)
      corners.push_back({{cell->vertex(0)->info(), cell->vertex(1)->info(),
                          cell->vertex(2)->info(), cell->vertex(3)->info()}});
    return corners;
  }
} // namespace nsfd
