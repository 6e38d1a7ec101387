#pragma once

#include "nsfd/dynamics/bodies.h"

#include <algorithm>
#include <vector>

/** Loops over bodies, class by class, with what goes in and out of a block. */
namespace nsfd
{
  /**
   * Apply one block of every class to all of its bodies, `lanes` at a time.
   * @p gather fills the inputs of a body, @p scatter takes its outputs; both
   * get (body, pointer, stride).
   */
  template <typename Select, typename Gather, typename Scatter>
  void for_all_bodies(const Bodies &bodies,
                      const Select &select,
                      const Gather &gather,
                      const Scatter &scatter)
  {
    thread_local std::vector<double> x, y;
    for (std::size_t k = 0; k < bodies.classes.size(); ++k) {
      const Block &block = select(k);
      if (block.cols == 0)
        continue;
      const auto &members = bodies.classes[k].bodies;
      x.resize(std::size_t(block.cols) * lanes);
      y.resize(std::size_t(padded(block.rows)) * lanes);
      std::size_t begin = 0;
      for (; begin + 1 < members.size(); begin += lanes) {
        const std::size_t count =
          std::min<std::size_t>(lanes, members.size() - begin);
        if (count < lanes)
          std::fill(x.begin(), x.end(), 0.);
        for (std::size_t l = 0; l < count; ++l)
          gather(members[begin + l], x.data() + l, lanes);
        multiply_lanes(block.values.data(), block.rows, block.cols, x.data(),
                       y.data());
        for (std::size_t l = 0; l < count; ++l)
          scatter(members[begin + l], y.data() + l, lanes);
      }
      if (begin < members.size()) {
        gather(members[begin], x.data(), 1u);
        multiply_one(block.values.data(), block.rows, block.cols, x.data(),
                     y.data());
        scatter(members[begin], y.data(), 1u);
      }
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
  auto slot_scatter(const Bodies &bodies,
                    std::vector<double> &side_1,
                    std::vector<double> &side_2)
  {
    return [&](const unsigned int b, const double *y,
               const unsigned int stride) {
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
} // namespace nsfd
