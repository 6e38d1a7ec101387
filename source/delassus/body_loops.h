#pragma once

#include "face_traces.h"

#include <algorithm>
#include <vector>

/** Loops over bodies, class by class, with what goes in and out of a block. */
namespace nsfd
{
  /**
   * Apply a block to the bodies of @p members from @p begin to @p end, `lanes`
   * at a time. @p gather fills the inputs of a body, @p scatter takes its
   * outputs; both get (body, pointer, stride).
   */
  template <typename Gather, typename Scatter>
  void for_bodies(const Block &block, const unsigned int *members,
                  std::size_t begin, const std::size_t end,
                  const Gather &gather, const Scatter &scatter)
  {
    if (block.cols == 0)
      return;
    thread_local std::vector<double> x, y;
    x.resize(std::size_t(block.cols) * lanes);
    y.resize(std::size_t(padded(block.rows)) * lanes);
    for (; begin + 1 < end; begin += lanes) {
      const std::size_t count = std::min<std::size_t>(lanes, end - begin);
      if (count < lanes)
        std::fill(x.begin(), x.end(), 0.);
      for (std::size_t l = 0; l < count; ++l)
        gather(members[begin + l], x.data() + l, lanes);
      multiply_lanes(block.values.data(), block.rows, block.cols, x.data(),
                     y.data());
      for (std::size_t l = 0; l < count; ++l)
        scatter(members[begin + l], y.data() + l, lanes);
    }
    if (begin < end) {
      gather(members[begin], x.data(), 1u);
      multiply_one(block.values.data(), block.rows, block.cols, x.data(),
                   y.data());
      scatter(members[begin], y.data(), 1u);
    }
  }

  /** The block that @p select has for a class to all of its bodies. */
  template <typename Select, typename Gather, typename Scatter>
  void for_all_bodies(const Bodies &bodies, const Select &select,
                      const Gather &gather, const Scatter &scatter)
  {
    for (std::size_t k = 0; k < bodies.classes.size(); ++k) {
      const auto &members = bodies.classes[k].bodies;
      for_bodies(select(k), members.data(), 0, members.size(), gather, scatter);
    }
  }

  inline auto dof_gather(const Bodies &bodies, const double *v)
  {
    return [&bodies, v](const unsigned int b, double *x,
                        const unsigned int stride) {
      const std::size_t first = bodies.first_dof[b],
                        n = bodies.first_dof[b + 1] - first;
      for (std::size_t i = 0; i < n; ++i)
        x[i * stride] = v[first + i];
    };
  }

  template <bool add>
  auto dof_scatter(const Bodies &bodies, double *v)
  {
    return [&bodies, v](const unsigned int b, const double *y,
                        const unsigned int stride) {
      const std::size_t first = bodies.first_dof[b],
                        n = bodies.first_dof[b + 1] - first;
      for (std::size_t i = 0; i < n; ++i)
        if (add)
          v[first + i] += y[i * stride];
        else
          v[first + i] = y[i * stride];
    };
  }

  /** Signed sum of the Cartesian impulses at the slots of a body. */
  template <int dim>
  auto slot_gather(const Bodies &bodies, const std::vector<double> &cartesian)
  {
    return [&](const unsigned int b, double *x, const unsigned int stride) {
      const std::size_t first = bodies.first_slot[b],
                        n = bodies.first_slot[b + 1] - first;
      for (std::size_t s = 0; s < n; ++s) {
        const double *P =
            cartesian.data() + std::size_t(bodies.slot_point[first + s]) * dim;
        const double sign = bodies.slot_sign[first + s];
        for (unsigned int c = 0; c < dim; ++c)
          x[(s * dim + c) * stride] = sign * P[c];
      }
      if (!bodies.extra_points.empty())
        for (auto e = std::lower_bound(
                 bodies.extra_points.begin(), bodies.extra_points.end(),
                 std::pair<std::size_t, unsigned int>(first, 0));
             e != bodies.extra_points.end() && e->first < first + n; ++e)
          for (unsigned int c = 0; c < dim; ++c)
            x[((e->first - first) * dim + c) * stride] +=
                cartesian[std::size_t(e->second) * dim + c];
    };
  }

  template <int dim>
  auto slot_scatter(const Bodies &bodies, std::vector<double> &side_1,
                    std::vector<double> &side_2)
  {
    return
        [&](const unsigned int b, const double *y, const unsigned int stride) {
          const std::size_t first = bodies.first_slot[b],
                            n = bodies.first_slot[b + 1] - first;
          for (std::size_t s = 0; s < n; ++s) {
            const std::size_t p = bodies.slot_point[first + s];
            const double sign = bodies.slot_sign[first + s];
            double *U = (sign > 0. ? side_2 : side_1).data() + p * dim;
            for (unsigned int c = 0; c < dim; ++c)
              U[c] = sign * y[(s * dim + c) * stride];
          }
          if (!bodies.extra_points.empty())
            for (auto e = std::lower_bound(
                     bodies.extra_points.begin(), bodies.extra_points.end(),
                     std::pair<std::size_t, unsigned int>(first, 0));
                 e != bodies.extra_points.end() && e->first < first + n; ++e)
              for (unsigned int c = 0; c < dim; ++c)
                side_2[std::size_t(e->second) * dim + c] =
                    y[((e->first - first) * dim + c) * stride];
        };
  }

  /**
   * Values at the points of the bodies of @p order, complete at those that are
   * shared with other ranks; bodies that share none work while the others' are
   * on their way.
   */
  template <int dim, typename Select, typename Gather>
  void values_of_both_sides(const FaceTraces<dim> &traces,
                            const BodyOrder &order, const Select &select,
                            const Gather &gather, std::vector<double> &side_1,
                            std::vector<double> &side_2)
  {
    const auto &classes = order.classes;
    const auto scatter = slot_scatter<dim>(traces.bodies(), side_1, side_2);
    for (std::size_t k = 0; k < classes.size(); ++k)
      for_bodies(select(k), classes[k].bodies.data(), 0, classes[k].n_shared,
                 gather, scatter);
    traces.start_exchange({{side_1.data(), side_2.data()}}, dim);
    for (std::size_t k = 0; k < classes.size(); ++k)
      for_bodies(select(k), classes[k].bodies.data(), classes[k].n_shared,
                 classes[k].bodies.size(), gather, scatter);
    traces.finish_exchange({{side_1.data(), side_2.data()}}, dim);
  }
} // namespace nsfd
