#include "facet_geometry.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    using Facet2 = Surfaces<2>::Facet;
    using Facet3 = Surfaces<3>::Facet;

    /** Twice the area, along the outward normal. */
    Place<3> doubled_area(const Facet3 &facet, const double *x)
    {
      const auto v = [&](const unsigned int i) {
        return place<3>(x, facet.vertex[i]);
      };
      return facet.n_vertices == 4
                 ? cross(difference(v(2), v(0)), difference(v(3), v(1)))
                 : cross(difference(v(1), v(0)), difference(v(2), v(0)));
    }

    Place<3> place_at(const Facet3 &facet, const double *x,
                      const std::array<double, 4> &weights)
    {
      Place<3> result{};
      for (unsigned int i = 0; i < facet.n_vertices; ++i)
        result = sum(result, weights[i], place<3>(x, facet.vertex[i]));
      return result;
    }

    /** Distance to edge i times its length, positive inside. */
    double inside_edge(const Facet3 &facet, const Place<3> &normal,
                       const double *x, const unsigned int i, const Place<3> &y)
    {
      const Place<3> a = place<3>(x, facet.vertex[i]);
      const Place<3> b =
          place<3>(x, facet.vertex[i + 1 == facet.n_vertices ? 0 : i + 1]);
      return dot(cross(difference(b, a), difference(y, a)), normal);
    }

    bool inside_edges(const Facet3 &facet, const Place<3> &normal,
                      const double *x, const Place<3> &y,
                      const double tolerance)
    {
      for (unsigned int i = 0; i < facet.n_vertices; ++i)
        if (inside_edge(facet, normal, x, i, y) < -tolerance)
          return false;
      return true;
    }

    std::array<double, 4> triangle_weights(const Facet3 &facet,
                                           const Place<3> &normal,
                                           const double *x, const Place<3> &y)
    {
      std::array<double, 4> result{};
      double total = 0.;
      for (unsigned int i = 0; i < 3; ++i) {
        result[(i + 2) % 3] = inside_edge(facet, normal, x, i, y);
        total += result[(i + 2) % 3];
      }
      for (unsigned int i = 0; i < 3; ++i)
        result[i] /= total;
      return result;
    }

    std::array<double, 4> bilinear_weights(const double s, const double t)
    {
      return {(1. - s) * (1. - t), s * (1. - t), s * t, (1. - s) * t};
    }

    /** Newton's method: one step for a parallelogram, few for other shapes. At
        most @p beyond of its sides past them. */
    std::array<double, 4> quadrilateral_weights(const Facet3 &facet,
                                                const Place<3> &normal,
                                                const double *x,
                                                const Place<3> &y,
                                                const double beyond)
    {
      const Place<3> v0 = place<3>(x, facet.vertex[0]),
                     v1 = place<3>(x, facet.vertex[1]),
                     v2 = place<3>(x, facet.vertex[2]),
                     v3 = place<3>(x, facet.vertex[3]);
      const Place<3> bottom = difference(v1, v0), top = difference(v2, v3),
                     left = difference(v3, v0), right = difference(v2, v1);
      double s = 0.5, t = 0.5;
      for (unsigned int step = 0; step < 20; ++step) {
        const Place<3> rest =
            difference(y, place_at(facet, x, bilinear_weights(s, t)));
        const Place<3> ds = sum(bottom, t, difference(top, bottom));
        const Place<3> dt = sum(left, s, difference(right, left));
        const Place<3> across_t = cross(dt, normal);
        const double area = dot(ds, across_t);
        const double step_s = dot(rest, across_t) / area;
        const double step_t = dot(rest, cross(normal, ds)) / area;
        s = std::clamp(s + step_s, -beyond, 1. + beyond);
        t = std::clamp(t + step_t, -beyond, 1. + beyond);
        // convergence is quadratic: the error left is the square of this
        if (std::abs(step_s) + std::abs(step_t) < same_length)
          break;
      }
      return bilinear_weights(s, t);
    }

    FacetPlace<3> foot_of(const Facet3 &facet, const Plane<3> &plane,
                          const double *x, const Place<3> &y,
                          const double beyond)
    {
      FacetPlace<3> result;
      result.weights =
          facet.n_vertices == 4
              ? quadrilateral_weights(facet, plane.normal, x, y, beyond)
              : triangle_weights(facet, plane.normal, x, y);
      result.place = place_at(facet, x, result.weights);
      return result;
    }

    /** 0 to 1 between the ends. */
    double share_of_line(const Plane<2> &plane, const Place<2> &y)
    {
      return 0.5 +
             dot(along(plane.normal), difference(y, plane.centre)) / plane.size;
    }

    FacetPlace<2> place_on_line(const Plane<2> &plane, const double share)
    {
      return {
          sum(plane.centre, (share - 0.5) * plane.size, along(plane.normal)),
          {1. - share, share, 0., 0.}};
    }

    FacetPlace<3> closest_on_edges(const Facet3 &facet, const double *x,
                                   const Place<3> &y)
    {
      FacetPlace<3> result;
      double shortest = 0.;
      for (unsigned int i = 0; i < facet.n_vertices; ++i) {
        const unsigned int j = i + 1 == facet.n_vertices ? 0 : i + 1;
        const Place<3> a = place<3>(x, facet.vertex[i]);
        const Place<3> edge = difference(place<3>(x, facet.vertex[j]), a);
        const double s =
            std::clamp(dot(difference(y, a), edge) / dot(edge, edge), 0., 1.);
        const Place<3> foot = sum(a, s, edge);
        const Place<3> way = difference(y, foot);
        if (i > 0 && dot(way, way) >= shortest)
          continue;
        shortest = dot(way, way);
        result.place = foot;
        result.weights = {};
        result.weights[i] = 1. - s;
        result.weights[j] = s;
      }
      return result;
    }
  } // namespace

  template <>
  Plane<2> plane_of<2>(const Facet2 &facet, const double *x)
  {
    const Place<2> a = place<2>(x, facet.vertex[0]);
    const Place<2> edge = difference(place<2>(x, facet.vertex[1]), a);
    const double length = norm(edge);
    return {{edge[1] / length, -edge[0] / length}, sum(a, 0.5, edge), length};
  }

  template <>
  Plane<3> plane_of<3>(const Facet3 &facet, const double *x)
  {
    const Place<3> area = doubled_area(facet, x);
    const double length = norm(area);
    Plane<3> result;
    for (unsigned int i = 0; i < facet.n_vertices; ++i)
      result.centre = sum(result.centre, 1. / facet.n_vertices,
                          place<3>(x, facet.vertex[i]));
    result.normal = sum(result.normal, 1. / length, area);
    result.size = std::sqrt(length / 2.);
    return result;
  }

  template <int dim>
  void set_planes(const Surfaces<dim> &surfaces, const double *x,
                  std::vector<Plane<dim>> &planes)
  {
    planes.resize(surfaces.facets.size());
    for (std::size_t f = 0; f < planes.size(); ++f)
      planes[f] = plane_of<dim>(surfaces.facets[f], x);
  }

  template <>
  bool projects_into<2>(const Facet2 &, const Plane<2> &plane, const double *,
                        const Place<2> &y)
  {
    return std::abs(dot(along(plane.normal), difference(y, plane.centre))) <=
           (0.5 + same_length) * plane.size;
  }

  template <>
  bool projects_into<3>(const Facet3 &facet, const Plane<3> &plane,
                        const double *x, const Place<3> &y)
  {
    return inside_edges(facet, plane.normal, x, y,
                        same_length * plane.size * plane.size);
  }

  template <>
  FacetPlace<2> closest_place<2>(const Facet2 &, const Plane<2> &plane,
                                 const double *, const Place<2> &y)
  {
    return place_on_line(plane, std::clamp(share_of_line(plane, y), 0., 1.));
  }

  template <>
  FacetPlace<3> closest_place<3>(const Facet3 &facet, const Plane<3> &plane,
                                 const double *x, const Place<3> &y)
  {
    if (!inside_edges(facet, plane.normal, x, y, 0.))
      return closest_on_edges(facet, x, y);
    return foot_of(facet, plane, x, y, 0.);
  }

  template <>
  FacetPlace<2> extended_place<2>(const Facet2 &, const Plane<2> &plane,
                                  const double *, const Place<2> &y)
  {
    return place_on_line(plane, share_of_line(plane, y));
  }

  template <>
  FacetPlace<3> extended_place<3>(const Facet3 &facet, const Plane<3> &plane,
                                  const double *x, const Place<3> &y)
  {
    // nodes that touch are seldom further out than their inset, see
    // touching_rules.h
    constexpr double beyond = 0.25;
    return foot_of(facet, plane, x, y, beyond);
  }

  template void set_planes<2>(const Surfaces<2> &, const double *,
                              std::vector<Plane<2>> &);
  template void set_planes<3>(const Surfaces<3> &, const double *,
                              std::vector<Plane<3>> &);
} // namespace nsfd
