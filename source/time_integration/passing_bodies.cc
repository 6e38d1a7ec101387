#include "passing_bodies.h"

#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace nsfd
{
  template <int dim>
  StepRejected passing_bodies(const SceneInput &input, const BodyTable &table,
                              const MissedContact<dim> &missed,
                              const double time, const double h)
  {
    const auto name = [&](const unsigned int body) {
      constexpr unsigned int first = MissedContact<dim>::first_obstacle;
      return body >= first
                 ? input.obstacles[body - first].name
                 : "a body of " +
                       input.materials[table.bodies[body].material].name;
    };
    return StepRejected(
        fmt::format("in the step of {:.4g} s at t = {:.6g} s {} would fly "
                    "through {}, near ({:.4g}) m; a step of {:.2g} s would not "
                    "miss it",
                    h, time, name(missed.body_2), name(missed.body_1),
                    fmt::join(missed.place, ", "), missed.share * h),
        StepRejected::Cure::shorter_step, missed.share);
  }

  template StepRejected passing_bodies(const SceneInput &, const BodyTable &,
                                       const MissedContact<2> &, double,
                                       double);
  template StepRejected passing_bodies(const SceneInput &, const BodyTable &,
                                       const MissedContact<3> &, double,
                                       double);
} // namespace nsfd
