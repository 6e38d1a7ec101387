#include "given_inertia.h"

#include "bodies/body_layout.h"
#include "core/gather_sums.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace space;

  template <int dim>
  std::vector<GivenInertia>
  given_inertia(const Discretization<dim> &discretization,
                const Communicator &communicator,
                const std::vector<int> &body_of_corner,
                const std::size_t n_bodies)
  {
    const SceneInput &input = discretization.input();
    const auto is_given = [&](const unsigned int material) {
      const RigidInput &of = input.materials[material].rigid_bodies;
      return of.ball || of.mass || of.inertia;
    };
    bool any = false;
    for (unsigned int m = 0; m < input.materials.size(); ++m)
      any = any || is_given(m);
    if (!any || !input.large_motion)
      return {};
    const BodyLayout<dim> layout(input, discretization);
    // sums per body: parts of it that are given, mass, mass times centre;
    // then the inertia about the centre
    constexpr std::size_t n_first = 5, n_second = 9;
    std::vector<OrderFreeSum> first(n_bodies * n_first),
        second(n_bodies * n_second);
    const auto for_parts = [&](const auto &act) {
      for (const MovingBody &part : layout.bodies())
        if (part.is_rigid())
          act(std::size_t(body_of_corner[discretization.cells()
                                             .first_node[part.cells.front()]]),
              part);
    };
    for_parts([&](const std::size_t b, const MovingBody &part) {
      const double mass = part.inertia.mass;
      first[b * n_first].add(is_given(part.material) ? 1. : 0.);
      first[b * n_first + 1].add(mass);
      for (unsigned int c = 0; c < 3; ++c)
        first[b * n_first + 2 + c].add(mass * part.centre[c]);
    });
    const auto moments = gather_sums(communicator, first);
    std::vector<GivenInertia> result(n_bodies);
    for (std::size_t b = 0; b < n_bodies; ++b) {
      const double *of_body = &moments[b * n_first];
      result[b].is_given = of_body[0] > 0.;
      result[b].inertia.mass = of_body[1];
      for (unsigned int c = 0; c < 3; ++c)
        result[b].centre[c] = of_body[2 + c] / of_body[1];
    }
    for_parts([&](const std::size_t b, const MovingBody &part) {
      const Vec3 r = part.centre - result[b].centre;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          second[b * n_second + 3 * i + j].add(
              part.inertia.inertia[i][j] +
              part.inertia.mass * ((i == j ? dot(r, r) : 0.) - r[i] * r[j]));
    });
    const auto turns = gather_sums(communicator, second);
    for (std::size_t b = 0; b < n_bodies; ++b)
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          result[b].inertia.inertia[i][j] = turns[b * n_second + 3 * i + j];
    return result;
  }

  template std::vector<GivenInertia> given_inertia(const Discretization<2> &,
                                                   const Communicator &,
                                                   const std::vector<int> &,
                                                   std::size_t);
  template std::vector<GivenInertia> given_inertia(const Discretization<3> &,
                                                   const Communicator &,
                                                   const std::vector<int> &,
                                                   std::size_t);
} // namespace nsfd
