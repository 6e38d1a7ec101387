#include "nsfd/nonsmooth/one_step_problem.h"

namespace nsfd
{
  template <int dim>
  void OneStepProblem<dim>::resize(const std::size_t n)
  {
    n_points = n;
    kind.assign(n, PointKind::free);
    mask.assign(n, 0);
    contact.assign(n, 0);
    interaction.assign(n, 0);
    for (auto *array : {&weight, &opening_max, &compression_stiffness, &target,
                        &majorant_normal, &majorant_tangential})
      array->assign(n, 0.);
    for (auto *array : {&slip_max, &viscosity, &dilatancy, &lift_left})
      array->clear();
    for (auto *array : {&strength_factor, &opening_factor})
      array->assign(n, 1.);
    for (auto *array : {&free_velocity, &given_velocity, &jump_old, &jump_free,
                        &sliding_offset})
      array->assign(n * dim, 0.);
  }

  template struct OneStepProblem<2>;
  template struct OneStepProblem<3>;
} // namespace nsfd
