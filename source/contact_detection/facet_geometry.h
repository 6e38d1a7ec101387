#pragma once

#include "surface_search.h"

#include <array>
#include <cmath>
#include <vector>

namespace nsfd
{
  template <int dim>
  using Place = std::array<double, dim>;

  /** Lengths that differ by less, relative to a facet, are the same: far from
   * the origin coordinates carry that much rounding. */
  constexpr double same_length = 1e-8;

  template <int dim>
  inline Place<dim> place(const double *x, const unsigned int vertex)
  {
    Place<dim> result;
    for (int d = 0; d < dim; ++d)
      result[d] = x[std::size_t(vertex) * dim + d];
    return result;
  }

  template <std::size_t dim>
  inline double dot(const std::array<double, dim> &a,
                    const std::array<double, dim> &b)
  {
    double result = a[0] * b[0];
    for (std::size_t d = 1; d < dim; ++d)
      result += a[d] * b[d];
    return result;
  }

  template <std::size_t dim>
  inline double norm(const std::array<double, dim> &a)
  {
    return std::sqrt(dot(a, a));
  }

  /** a + factor b */
  template <std::size_t dim>
  inline std::array<double, dim> sum(const std::array<double, dim> &a,
                                     const double factor,
                                     const std::array<double, dim> &b)
  {
    std::array<double, dim> result;
    for (std::size_t d = 0; d < dim; ++d)
      result[d] = a[d] + factor * b[d];
    return result;
  }

  template <std::size_t dim>
  inline std::array<double, dim> difference(const std::array<double, dim> &a,
                                            const std::array<double, dim> &b)
  {
    return sum(a, -1., b);
  }

  inline Place<3> cross(const Place<3> &a, const Place<3> &b)
  {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0]};
  }

  /** The direction of a -> b in the plane with the outward normal n. */
  inline Place<2> along(const Place<2> &n) { return {-n[1], n[0]}; }

  template <int dim>
  Plane<dim> plane_of(const typename Surfaces<dim>::Facet &facet,
                      const double *x);

  template <int dim>
  void set_planes(const Surfaces<dim> &surfaces, const double *x,
                  std::vector<Plane<dim>> &planes);

  /** Whether y lies over the facet along its normal, ends included. */
  template <int dim>
  bool projects_into(const typename Surfaces<dim>::Facet &facet,
                     const Plane<dim> &plane, const double *x,
                     const Place<dim> &y);

  template <int dim>
  struct FacetPlace {
    Place<dim> place{};
    std::array<double, 4> weights{};
  };

  /**
   * The foot of y along the normal where there is one, otherwise the closest
   * place on the edges. The surface of a quadrilateral is bilinear.
   */
  template <int dim>
  FacetPlace<dim> closest_place(const typename Surfaces<dim>::Facet &facet,
                                const Plane<dim> &plane, const double *x,
                                const Place<dim> &y);

  /**
   * The foot of y along the normal, also where it is past the ends of the
   * facet: then some weights are negative. A node a little past an end gives
   * and gets its impulse at one place, and its distance changes with the
   * velocities that these weights say.
   */
  template <int dim>
  FacetPlace<dim> extended_place(const typename Surfaces<dim>::Facet &facet,
                                 const Plane<dim> &plane, const double *x,
                                 const Place<dim> &y);
} // namespace nsfd
