#pragma once

#include "facet_geometry.h"

#include "core/bracketed_root.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

// What happens while everything moves on straight lines, s from 0 to 1.

namespace nsfd
{
  /** From one array of coordinates to another one. */
  template <int dim>
  struct StraightWay {
    const double *from, *to;

    Place<dim> at(const unsigned int vertex, const double s) const
    {
      const Place<dim> a = place<dim>(from, vertex), b = place<dim>(to, vertex);
      // a + 1 (b - a) need not be b, and what only just touches would differ
      return s == 1. ? b : sum(a, s, difference(b, a));
    }
  };

  /** A facet at a moment of it. */
  template <int dim>
  struct FacetOnTheWay {
    FacetOnTheWay(const typename Surfaces<dim>::Facet &of,
                  const StraightWay<dim> &way, const double s)
        : facet(of)
    {
      for (unsigned int v = 0; v < of.n_vertices; ++v) {
        const Place<dim> y = way.at(of.vertex[v], s);
        std::copy(y.begin(), y.end(), x.begin() + v * dim);
        facet.vertex[v] = v;
      }
      plane = plane_of<dim>(facet, x.data());
    }

    /** In front of its plane; below zero behind it. */
    double height(const Place<dim> &y) const
    {
      return dot(plane.normal, difference(y, plane.centre));
    }
    bool is_over(const Place<dim> &y) const
    {
      return projects_into<dim>(facet, plane, x.data(), y);
    }

    typename Surfaces<dim>::Facet facet; ///< its vertices are 0, 1, ...
    std::array<double, 4 * dim> x{};
    Plane<dim> plane;
  };

  /**
   * @p visit (s, whether f comes from above) wherever the cubic @p f passes
   * zero, in order.
   */
  template <typename Function, typename Visit>
  void visit_zeros(const Function &f, const Visit &visit)
  {
    // Newton's form in 3 s; the zeros of its derivative part monotone pieces
    const std::array<double, 4> value = {
        {f(0.), f(1. / 3.), f(2. / 3.), f(1.)}};
    const double d_1 = value[1] - value[0],
                 d_2 = value[2] - 2. * value[1] + value[0],
                 d_3 = value[3] - 3. * (value[2] - value[1]) - value[0],
                 a = d_3 / 2., b = d_2 - d_3, c = d_1 - d_2 / 2. + d_3 / 3.;
    std::array<double, 4> ends = {{0., 1., 1., 1.}};
    const double square = b * b - 4. * a * c;
    if (square > 0.) {
      const double q = -0.5 * (b + std::copysign(std::sqrt(square), b));
      const auto within = [](const double s) {
        return s > 0. && s < 3. ? s / 3. : 1.; // also of what is no number
      };
      ends[1] = within(c / q);
      ends[2] = within(q / a);
      if (ends[2] < ends[1])
        std::swap(ends[1], ends[2]);
    }
    double low = f(ends[0]);
    for (unsigned int k = 0; k < 3; ++k) {
      if (!(ends[k] < ends[k + 1]))
        continue;
      const double high = f(ends[k + 1]);
      if ((low > 0.) != (high > 0.)) {
        const double sign = low > 0. ? 1. : -1.;
        visit(bracketed_root([&](const double s) { return sign * f(s); },
                             ends[k], ends[k + 1], sign * low, sign * high),
              low > 0.);
      }
      low = high;
    }
  }

  /** Where a convex @p f of s is smallest. */
  template <typename Function>
  double smallest_at(const Function &f)
  {
    const double share = 0.5 * (std::sqrt(5.) - 1.);
    double low = 0., high = 1., a = high - share, b = low + share, f_a = f(a),
           f_b = f(b);
    for (unsigned int k = 0; k < 80 && high - low > 1e-15; ++k)
      if (f_a <= f_b) {
        high = b;
        b = a;
        f_b = f_a;
        a = high - share * (high - low);
        f_a = f(a);
      } else {
        low = a;
        a = b;
        f_a = f_b;
        b = low + share * (high - low);
        f_b = f(b);
      }
    const double inside = 0.5 * (low + high);
    double best = inside;
    for (const double end : {0., 1.})
      if (f(end) < f(best))
        best = end;
    return best;
  }

  /** What is round: its gap is convex where the way is straight. */
  struct RoundContact {
    double safe = 0.;   ///< the next search finds what is no deeper
    double unseen = 0.; ///< no contact is as shallow
    double way = 0.;    ///< of both past each other, in the whole step

    /// cosine by which its normal may turn while it goes on: 3 % of the radius
    /// between the places where it came in and is
    static constexpr double same_side = 0.87;
  };

  /**
   * Where in a step of @p n_parts straight ways something came in that the next
   * search would not find there: @p gap and @p normal of (part, s). Nothing if
   * there is no such thing.
   */
  template <typename Gap, typename Normal>
  std::optional<double>
  missed_round_contact(const std::size_t n_parts, const RoundContact &contact,
                       const Gap &gap, const Normal &normal)
  {
    for (std::size_t k = 0; k < n_parts; ++k) {
      const auto g = [&](const double s) { return gap(k, s); };
      const double deepest_at = smallest_at(g);
      if (!(g(deepest_at) < -contact.unseen))
        continue;
      double enters = 0.;
      if (g(0.) > 0.)
        enters = bracketed_root(g, 0., deepest_at, g(0.), g(deepest_at));
      const bool is_found =
          gap(n_parts - 1, 1.) >= -contact.safe &&
          dot(normal(n_parts - 1, 1.), normal(k, enters)) > contact.same_side;
      if (is_found)
        return std::nullopt;
      return (double(k) + enters) / double(n_parts);
    }
    return std::nullopt;
  }
} // namespace nsfd
