#include "contact_problem.h"

#include "contact_cone.h"
#include "nonsmooth/natural_map.h"

namespace nsfd
{
  namespace
  {
    double squared(const std::vector<double> &x)
    {
      double sum = 0.;
      for (const double value : x)
        sum += value * value;
      return sum;
    }
  } // namespace

  void relative_velocity(const ContactProblem &problem,
                         const std::vector<double> &impulse,
                         std::vector<double> &velocity)
  {
    velocity = problem.q;
    if (std::all_of(impulse.begin(), impulse.end(),
                    [](const double x) { return x == 0.; }))
      return;
    for (std::size_t i = 0; i < problem.n_rows(); ++i) {
      double sum = 0.;
      for (int k = problem.row_start[i]; k < problem.row_start[i + 1]; ++k)
        sum += problem.value[k] * impulse[problem.column[k]];
      velocity[i] += sum;
    }
  }

  double natural_map_error(const ContactProblem &problem,
                           const std::vector<double> &impulse,
                           const std::vector<double> &velocity)
  {
    const unsigned int d = problem.dimension;
    double sum = 0.;
    for (std::size_t i = 0; i < problem.n_contacts(); ++i) {
      const double *r = &impulse[d * i], *u = &velocity[d * i];
      const double mu = problem.friction[i];
      sum += d == 2 ? stored::squared_natural_map<2>(r, u, mu)
                    : stored::squared_natural_map<3>(r, u, mu);
    }
    const double scale = std::sqrt(
        std::max({squared(problem.q), squared(impulse), squared(velocity)}));
    return relative_natural_map(std::sqrt(sum), scale < 2.2e-16 ? 1. : scale);
  }

  double natural_map_error(const ContactProblem &problem,
                           const std::vector<double> &impulse)
  {
    std::vector<double> u;
    relative_velocity(problem, impulse, u);
    return natural_map_error(problem, impulse, u);
  }
} // namespace nsfd
