#include "row_work.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  double round_off_of_rows(const double impulses, const double all_impulses,
                           const double energy_scale)
  {
    // some last bits: of the terms, their sum and what the sum is taken from
    constexpr double last_bits = 1e-15;
    return last_bits *
           std::sqrt(impulses * std::max(all_impulses, energy_scale));
  }

  double RowWork::round_off(const double energy_scale) const
  {
    return round_off_of_rows(impulses, all_impulses, energy_scale);
  }

  template <int dim>
  RowWork row_work(const OneStepProblem<dim> &problem,
                   const Communicator &communicator,
                   const std::vector<double> &U, const std::vector<double> &P)
  {
    const std::size_t n = owned_acting(problem);
    std::vector<double> terms(3 * n, 0.);
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t i = problem.acting[a];
      double work = 0., square = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t k = i * dim + c;
        work += P[k] * (U[k] - problem.given_velocity[k]);
        square += (c == 0 ? problem.majorant_normal
                          : problem.majorant_tangential)[i] *
                  P[k] * P[k];
      }
      terms[2 * n + a] = square;
      if (problem.kind[i] == PointKind::prescribed) {
        terms[a] = std::abs(work);
        terms[n + a] = square;
      }
    }
    const auto sums = communicator.sums(terms.data(), 3, n);
    return {sums[0], sums[1], sums[2]};
  }

  template RowWork row_work<2>(const OneStepProblem<2> &, const Communicator &,
                               const std::vector<double> &,
                               const std::vector<double> &);
  template RowWork row_work<3>(const OneStepProblem<3> &, const Communicator &,
                               const std::vector<double> &,
                               const std::vector<double> &);
} // namespace nsfd
