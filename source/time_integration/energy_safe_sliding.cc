#include "energy_safe_sliding.h"

#include "nonsmooth/point_law.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    bool has_friction(const SceneInput &input)
    {
      const auto rubs = [](const auto &block) { return block.friction > 0.; };
      return std::any_of(input.interfaces.begin(), input.interfaces.end(),
                         rubs) ||
             std::any_of(input.obstacles.begin(), input.obstacles.end(),
                         rubs) ||
             std::any_of(input.contacts.begin(), input.contacts.end(), rubs);
    }
  } // namespace

  template <int dim>
  double friction_work(const OneStepProblem<dim> &problem, const std::size_t i,
                       const LocalSolution<dim> &solution,
                       const double *impulse, const double *velocity,
                       const double *old_velocity, const double theta)
  {
    std::array<double, dim> U;
    std::copy_n(velocity, dim, U.begin());
    const auto energies = point_energies<dim>(problem, i, U, solution.frozen);
    const double wh = problem.weight[i] * problem.time_step;
    double work = 0.;
    for (unsigned int c = 1; c < dim; ++c)
      work += (impulse[c] + wh * energies.cohesive_traction[c]) *
              (theta * U[c] + (1. - theta) * old_velocity[c]);
    return work;
  }

  template <int dim>
  EnergySafeSliding<dim>::EnergySafeSliding(const SceneInput &input)
      : theta_(input.time.theta),
        always_(input.time.sliding == Sliding::increment),
        chooses_(input.time.sliding == Sliding::energy_safe && theta_ < 1. &&
                 has_friction(input))
  {
  }

  template <int dim>
  void EnergySafeSliding<dim>::begin()
  {
    mean_.clear();
  }

  template <int dim>
  void EnergySafeSliding<dim>::apply(const std::vector<double> &old_velocity,
                                     OneStepProblem<dim> &problem) const
  {
    std::fill(problem.sliding_offset.begin(), problem.sliding_offset.end(), 0.);
    if (!always_ && mean_.empty())
      return;
    const double factor = (1. - theta_) / theta_;
    for (std::size_t i = 0; i < problem.n_points; ++i)
      if (always_ || mean_[i])
        for (unsigned int c = 1; c < dim; ++c)
          problem.sliding_offset[i * dim + c] =
              factor * old_velocity[i * dim + c];
  }

  template <int dim>
  bool EnergySafeSliding<dim>::revise(const Communicator &communicator,
                                      const LawEvaluation<dim> &evaluation,
                                      const std::vector<double> &impulse,
                                      const std::vector<double> &old_velocity,
                                      const double energy,
                                      OneStepProblem<dim> &problem)
  {
    if (!chooses_)
      return false;
    double given = 0., most = 0.;
    std::vector<double> work(problem.n_points, 0.);
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      const LocalSolution<dim> &solution = evaluation.solutions[i];
      if (!(solution.frozen.threshold > 0.) || (!mean_.empty() && mean_[i]))
        continue;
      work[i] = friction_work<dim>(problem, i, solution, &impulse[i * dim],
                                   &evaluation.velocity[i * dim],
                                   &old_velocity[i * dim], theta_);
      most = std::max(most, work[i]);
      if (i < problem.n_owned && work[i] > 0.)
        given += work[i];
    }
    most = communicator.max(most);
    if (!(communicator.sum(&given, 1) > 1e-13 * energy))
      return false;
    // what is a thousandth of the worst is left to the next round
    mean_.resize(problem.n_points, 0);
    for (std::size_t i = 0; i < problem.n_points; ++i)
      if (work[i] > 1e-3 * most)
        mean_[i] = 1;
    apply(old_velocity, problem);
    return true;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template double friction_work<dim>(                                          \
      const OneStepProblem<dim> &, std::size_t, const LocalSolution<dim> &,    \
      const double *, const double *, const double *, double)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
  template class EnergySafeSliding<2>;
  template class EnergySafeSliding<3>;
} // namespace nsfd
