#include "delassus_cost.h"

#include "core/stopwatch.h"

#include <algorithm>
#include <cstring>

namespace nsfd
{
  template <int dim>
  DelassusCost count_delassus(const DelassusOperator<dim> &delassus)
  {
    const double number = sizeof(double);
    const auto &bodies = delassus.bodies();
    const auto &blocks = delassus.class_blocks();
    DelassusCost cost;
    double most = -1.;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const Block &W = blocks[k].delassus;
      const double members = double(bodies.classes[k].bodies.size());
      const double flops = 2. * members * W.rows * W.cols;
      cost.flops += flops;
      cost.bytes += number * double(W.values.size());
      if (flops > most) {
        most = flops;
        cost.rows = W.rows;
      }
    }
    // per slot: impulse read, velocity of the side written, point and sign
    const double slots = double(bodies.slot_point.size());
    cost.bytes += slots * (2. * dim * number + sizeof(unsigned int) + 1.);
    // per point: frame twice, impulse, both sides and the result, and what is
    // kept in Cartesian components
    const double points = double(delassus.points().n_points);
    cost.bytes += points * number * (2. * dim * dim + 5. * dim);
    cost.flops += points * (2. * (2. * dim - 1.) * dim + dim);
    return cost;
  }

  MachineLimits measure_machine(const DelassusCost &cost)
  {
    // the least of several short measurements: whatever else runs on the
    // machine only makes them longer; long enough for other ranks to join in
    const auto fastest = [](const auto &work) {
      unsigned int repeats = 1;
      double best = 0.;
      const double begin = wall_seconds();
      for (unsigned int round = 0; round < 8 || wall_seconds() - begin < 0.02;
           ++round) {
        double seconds = 0.;
        for (;;) {
          const double start = wall_seconds();
          for (unsigned int r = 0; r < repeats; ++r)
            work();
          seconds = wall_seconds() - start;
          if (seconds > 2e-4)
            break;
          repeats *= 2;
        }
        seconds /= repeats;
        best = round == 0 ? seconds : std::min(best, seconds);
      }
      return best;
    };

    MachineLimits limits;
    const std::size_t n = std::max<std::size_t>(
        64, std::size_t(cost.bytes / 2. / sizeof(double)));
    std::vector<double> from(n, 1.), to(n, 0.);
    limits.copy_bytes_per_second =
        2. * double(n) * sizeof(double) / fastest([&]() {
          std::memcpy(to.data(), from.data(), n * sizeof(double));
          from.swap(to); // so that no copy can be left out
        });

    const unsigned int rows = std::max(cost.rows, 1u);
    const std::vector<double> A(std::size_t(padded(rows)) * rows, 1e-3),
        X(std::size_t(rows) * lanes, 1.);
    std::vector<double> Y(std::size_t(padded(rows)) * lanes);
    limits.product_flops_per_second =
        2. * double(rows) * rows * lanes / fastest([&]() {
          multiply_lanes(A.data(), rows, rows, X.data(), Y.data());
        });
    return limits;
  }

  template DelassusCost count_delassus<2>(const DelassusOperator<2> &);
  template DelassusCost count_delassus<3>(const DelassusOperator<3> &);
} // namespace nsfd
