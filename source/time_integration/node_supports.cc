#include "node_supports.h"

#include "discretization/discretization.h"

namespace nsfd
{
  template <int dim>
  void NodeSupports<dim>::prescribe_once(
      JoinedDelassus<dim> &bonded, const std::vector<PointOrigin> &origins,
      const bool others, OneStepProblem<dim> &problem)
  {
    auto &masks = problem.mask;
    std::vector<std::uint8_t> given(masks.size(), 0);
    for (std::size_t i = 0; i < given.size(); ++i)
      if (origins[i].kind == PointOrigin::Kind::motion)
        given[i] = masks[i];
    if (bonded.communicator().any(others || given != given_)) {
      once_ = bonded.once_per_node(given);
      given_ = given;
    }
    for (std::size_t i = 0; i < given.size(); ++i)
      if (given[i])
        masks[i] = once_[i];
  }

  template class NodeSupports<2>;
  template class NodeSupports<3>;
} // namespace nsfd
