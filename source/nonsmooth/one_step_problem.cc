#include "one_step_problem.h"

#include <numeric>

namespace nsfd
{
  template <int dim>
  void resize(OneStepProblem<dim> &problem, const std::size_t n)
  {
    problem.n_points = n;
    problem.acting.resize(n);
    std::iota(problem.acting.begin(), problem.acting.end(), 0u);
    problem.kind.assign(n, PointKind::free);
    problem.mask.assign(n, 0);
    problem.contact.assign(n, 0);
    problem.interaction.assign(n, 0);
    for (auto *array : {&problem.weight, &problem.opening_max,
                        &problem.compression_stiffness, &problem.target,
                        &problem.majorant_normal, &problem.majorant_tangential})
      array->assign(n, 0.);
    for (auto *array :
         {&problem.slip_max, &problem.viscosity, &problem.dilatancy,
          &problem.lift_left, &problem.friction_factor})
      array->clear();
    for (auto *array : {&problem.strength_factor, &problem.opening_factor})
      array->assign(n, 1.);
    for (auto *array :
         {&problem.free_velocity, &problem.given_velocity, &problem.jump_old,
          &problem.jump_free, &problem.sliding_offset})
      array->assign(n * dim, 0.);
  }

  template void resize(OneStepProblem<2> &, std::size_t);
  template void resize(OneStepProblem<3> &, std::size_t);
} // namespace nsfd
