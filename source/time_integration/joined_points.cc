#include "joined_points.h"

#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    bool is_joined(const PointKind kind)
    {
      return kind == PointKind::bonded || kind == PointKind::rigid ||
             kind == PointKind::prescribed;
    }

    /** A law between two rigid bodies. */
    template <int dim>
    bool is_held(const Discretization<dim> &discretization,
                 const typename InterfacePoints<dim>::Face &face)
    {
      const auto &block =
          discretization.input()
              .interfaces[discretization.origins()[face.first].block];
      if (!block.law)
        return false;
      const BodyClass *classes[2];
      for (unsigned int side = 0; side < 2; ++side) {
        const int b = face.bodies[side];
        if (b < 0)
          return false;
        classes[side] = &discretization.cells().body_class(std::size_t(b));
      }
      return classes[0]->undeformed && classes[1]->undeformed &&
             classes[0]->material != classes[1]->material;
    }
  } // namespace

  bool has_rigid_cells(const SceneInput &input)
  {
    return std::any_of(
        input.materials.begin(), input.materials.end(),
        [](const MaterialInput &material) { return material.rigid; });
  }

  template <int dim>
  std::vector<std::uint8_t>
  joined_points(const Discretization<dim> &discretization, State &state)
  {
    const auto &origins = discretization.origins();
    std::vector<std::uint8_t> intact(origins.size(), 0);
    for (const auto &face : discretization.points().faces) {
      if (face.count == 0 ||
          origins[face.first].kind != PointOrigin::Kind::interface)
        continue;
      const bool held = is_held(discretization, face);
      for (unsigned int i = face.first; i < face.first + face.count; ++i) {
        if (!is_joined(state.kind[i]))
          continue;
        intact[i] = !held;
        state.kind[i] = held ? PointKind::rigid : PointKind::bonded;
      }
    }
    return intact;
  }

  template std::vector<std::uint8_t> joined_points(const Discretization<2> &,
                                                   State &);
  template std::vector<std::uint8_t> joined_points(const Discretization<3> &,
                                                   State &);
} // namespace nsfd
