#include "constrained_delaunay.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/spatial_sort.h>

#include <limits>
#include <numeric>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using VertexBase =
        CGAL::Triangulation_vertex_base_with_info_2<unsigned int, Kernel>;
    using FaceBase = CGAL::Constrained_triangulation_face_base_2<
        Kernel,
        CGAL::Triangulation_face_base_with_info_2<unsigned int, Kernel>>;
    using Structure =
        CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
    using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
        Kernel, Structure, CGAL::No_constraint_intersection_tag>;
    using Face = Triangulation::Face_handle;

    constexpr unsigned int unseen = std::numeric_limits<unsigned int>::max();
    constexpr unsigned int outside = unseen - 1;

    /** All that can be reached from @p start without crossing an edge. */
    void mark(const Face &start, const unsigned int part)
    {
      std::vector<Face> waiting = {start};
      start->info() = part;
      while (!waiting.empty()) {
        const Face face = waiting.back();
        waiting.pop_back();
        for (int i = 0; i < 3; ++i) {
          const Face other = face->neighbor(i);
          if (face->is_constrained(i) || other->info() != unseen)
            continue;
          other->info() = part;
          waiting.push_back(other);
        }
      }
    }

    /** Along a curve that stays near where it has been. */
    std::vector<std::size_t>
    spatial_order(const std::vector<Kernel::Point_2> &points)
    {
      std::vector<std::size_t> order(points.size());
      std::iota(order.begin(), order.end(), std::size_t(0));
      const auto place = CGAL::make_property_map(points);
      using Traits =
          CGAL::Spatial_sort_traits_adapter_2<Kernel, decltype(place)>;
      CGAL::spatial_sort(order.begin(), order.end(), Traits(place));
      return order;
    }
  } // namespace

  ConstrainedDelaunay::ConstrainedDelaunay(
      const std::vector<std::array<unsigned int, 2>> &edges)
      : edges_(edges)
  {
  }

  PlaneTriangles
  ConstrainedDelaunay::operator()(const std::vector<PlanePoint> &points)
  {
    std::vector<Kernel::Point_2> places;
    places.reserve(points.size());
    for (const PlanePoint &p : points)
      places.emplace_back(p[0], p[1]);
    if (order_.size() != points.size())
      order_ = spatial_order(places);

    Triangulation triangulation;
    std::vector<Triangulation::Vertex_handle> vertices(points.size());
    Face hint;
    for (const std::size_t p : order_) {
      vertices[p] = triangulation.insert(places[p], hint);
      vertices[p]->info() = unsigned(p);
      hint = vertices[p]->face();
    }
    if (triangulation.number_of_vertices() != points.size())
      throw std::runtime_error(
          "two lines have a point at one place that is not the "
          "same point; `merge vertices = true` joins them");
    try {
      for (const auto &edge : edges_)
        triangulation.insert_constraint(vertices[edge[0]], vertices[edge[1]]);
    } catch (const Triangulation::Intersection_of_constraints_exception &) {
      throw std::runtime_error("two lines cross between their nodes; write a "
                               "smaller `size`");
    }

    for (const Face face : triangulation.all_face_handles())
      face->info() = unseen;
    mark(triangulation.infinite_face(), outside);
    PlaneTriangles result;
    for (const Face face : triangulation.finite_face_handles()) {
      if (face->info() == unseen)
        mark(face, result.n_parts++);
      if (face->info() == outside)
        continue;
      result.corners.push_back(
          {{face->vertex(0)->info(), face->vertex(1)->info(),
            face->vertex(2)->info()}});
      result.part.push_back(face->info());
    }
    return result;
  }
} // namespace nsfd
