#include "lloyd.h"

#include <cmath>

namespace nsfd
{
  namespace
  {
    /** A part of a simplex: its centroid, and its share of the volume. */
    template <int dim>
    struct Sample {
      std::array<double, dim + 1> weights; ///< of the corners
      double share;
    };

    template <int dim, typename Action>
    void for_each_sum(const int sum, const Action &action)
    {
      std::array<int, dim + 1> i{};
      if constexpr (dim == 2) {
        for (i[0] = 0; i[0] <= sum; ++i[0])
          for (i[1] = 0; i[0] + i[1] <= sum; ++i[1]) {
            i[2] = sum - i[0] - i[1];
            action(i);
          }
      } else
        for (i[0] = 0; i[0] <= sum; ++i[0])
          for (i[1] = 0; i[0] + i[1] <= sum; ++i[1])
            for (i[2] = 0; i[0] + i[1] + i[2] <= sum; ++i[2]) {
              i[3] = sum - i[0] - i[1] - i[2];
              action(i);
            }
    }

    /**
     * Edges in @p n parts: upright simplices, turned ones, and in space the
     * octahedra between them, four times as large.
     */
    template <int dim>
    std::vector<Sample<dim>> samples(const int n)
    {
      std::vector<Sample<dim>> result;
      const double volume = std::pow(n, dim);
      for (int kind = 0; kind < dim; ++kind)
        for_each_sum<dim>(n - 1 - kind, [&](const std::array<int, dim + 1> &i) {
          Sample<dim> sample;
          const double offset = double(kind + 1) / (dim + 1);
          for (int c = 0; c <= dim; ++c)
            sample.weights[std::size_t(c)] =
                (double(i[std::size_t(c)]) + offset) / n;
          sample.share = (dim == 3 && kind == 1 ? 4. : 1.) / volume;
          result.push_back(sample);
        });
      return result;
    }

    template <int dim>
    double volume(const std::array<std::array<double, dim>, dim + 1> &x)
    {
      std::array<std::array<double, dim>, dim> e;
      for (int i = 0; i < dim; ++i)
        for (int d = 0; d < dim; ++d)
          e[i][d] = x[i + 1][d] - x[0][d];
      if constexpr (dim == 2)
        return .5 * std::abs(e[0][0] * e[1][1] - e[0][1] * e[1][0]);
      else
        return std::abs(e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
                        e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
                        e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
               6.;
    }
  } // namespace

  template <int dim>
  void move_to_centroids(
      std::vector<std::array<double, dim>> &nodes, const std::size_t first,
      const std::vector<std::array<unsigned int, dim + 1>> &corners,
      const std::vector<double> &size)
  {
    static const std::vector<Sample<dim>> all_samples = samples<dim>(4);
    std::vector<std::array<double, dim + 1>> sums(nodes.size());
    std::vector<double> density(nodes.size());
    for (std::size_t v = 0; v < nodes.size(); ++v) {
      const double s = 1. / size[v], s2 = s * s;
      density[v] = dim == 2 ? s2 * s2 : s2 * s2 * s;
    }
    for (const auto &cell : corners) {
      std::array<std::array<double, dim>, dim + 1> x;
      for (int c = 0; c <= dim; ++c)
        x[c] = nodes[cell[c]];
      const double whole = volume<dim>(x);
      for (const Sample<dim> &sample : all_samples) {
        std::array<double, dim> p{};
        double weight = 0.;
        for (int c = 0; c <= dim; ++c) {
          for (int d = 0; d < dim; ++d)
            p[d] += sample.weights[c] * x[c][d];
          weight += sample.weights[c] * density[cell[c]];
        }
        weight *= sample.share * whole;
        int nearest = 0;
        double least = 0.;
        for (int c = 0; c <= dim; ++c) {
          double square = 0.;
          for (int d = 0; d < dim; ++d)
            square += (p[d] - x[c][d]) * (p[d] - x[c][d]);
          if (c == 0 || square < least) {
            least = square;
            nearest = c;
          }
        }
        auto &sum = sums[cell[nearest]];
        for (int d = 0; d < dim; ++d)
          sum[d] += weight * p[d];
        sum[dim] += weight;
      }
    }
    for (std::size_t v = first; v < nodes.size(); ++v)
      if (sums[v][dim] > 0.)
        for (int d = 0; d < dim; ++d)
          nodes[v][d] = sums[v][d] / sums[v][dim];
  }

  template void
  move_to_centroids<2>(std::vector<std::array<double, 2>> &, std::size_t,
                       const std::vector<std::array<unsigned int, 3>> &,
                       const std::vector<double> &);
  template void
  move_to_centroids<3>(std::vector<std::array<double, 3>> &, std::size_t,
                       const std::vector<std::array<unsigned int, 4>> &,
                       const std::vector<double> &);
} // namespace nsfd
