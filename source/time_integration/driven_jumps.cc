#include "driven_jumps.h"

#include "step_data.h"

#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  void DrivenJumps<dim>::set(const State &old, const double time,
                             const double duration)
  {
    jump_ = old.jump;
    for (std::size_t i = 0; i < old.kind.size(); ++i) {
      const PointOrigin origin = discretization_.origins()[i];
      if (origin.kind != PointOrigin::Kind::motion)
        continue;
      const auto &boundary = input_.boundaries[origin.block];
      const auto x = position_of(discretization_.points(), i);
      const double its_time = old.clock.at(origin.block, time);
      for (unsigned int c = 0; c < dim; ++c)
        if (boundary.displacement[c])
          jump_[i * dim + c] = boundary.displacement[c]->at(x, its_time);
        else if (boundary.velocity[c] && duration != 0. &&
                 !old.clock.rests(origin.block, time))
          jump_[i * dim + c] +=
              duration * boundary.velocity[c]->at(x, time - duration / 2.);
    }
  }

  template <int dim>
  double DrivenJumps<dim>::largest() const
  {
    double largest = 0.;
    const auto &origins = discretization_.origins();
    for (std::size_t i = 0; i < jump_.size() / dim; ++i)
      if (origins[i].kind == PointOrigin::Kind::motion)
        for (unsigned int c = 0; c < dim; ++c)
          largest = std::max(largest, std::abs(at(i, c)));
    return largest;
  }

  template class DrivenJumps<2>;
  template class DrivenJumps<3>;
} // namespace nsfd
