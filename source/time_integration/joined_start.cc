#include "joined_start.h"

#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace nsfd
{
  namespace
  {
    /**
     * By its law from the start on: between two rigid bodies, and in a fault,
     * where it is the force at a node that decides. A node of common nodes
     * comes apart only when all faces at it have been released, the last of
     * them by the traction of the cells ahead, which is below that of the node.
     */
    template <int dim>
    bool is_held(const Discretization<dim> &discretization,
                 const typename InterfacePoints<dim>::Face &face)
    {
      const auto &block =
          discretization.input()
              .interfaces[discretization.origins()[face.first].block];
      if (!block.law)
        return false;
      if (block.law->friction_exponent() == 0.)
        return true;
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

  template <int dim>
  std::vector<std::uint8_t>
  joined_points(const Discretization<dim> &discretization, State &state)
  {
    const auto &origins = discretization.origins();
    std::vector<std::uint8_t> intact(origins.size(), 0);
    for (const auto &face : discretization.points().faces) {
      if (face.count == 0 || face.boundary ||
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

  template <int dim>
  std::vector<unsigned int> points_between_groups(
      const Discretization<dim> &discretization, const JoinedMesh<dim> &mesh,
      const HangingNodes<dim> &hanging, const std::vector<std::uint8_t> &intact)
  {
    const auto &origins = discretization.origins();
    std::vector<unsigned int> result;
    for (std::size_t i = 0; i < intact.size(); ++i)
      if (!intact[i] && origins[i].kind != PointOrigin::Kind::motion &&
          mesh.is_whole(mesh.node_of_point(i)) &&
          !hanging.hangs(mesh.a_corner(i)))
        result.push_back(unsigned(i));
    return result;
  }

  template <int dim>
  void set_jumps(const Discretization<dim> &discretization,
                 const JoinedMesh<dim> &mesh, State &state)
  {
    const auto &points = discretization.points();
    state.jump.assign(points.n_points * dim, 0.);
    state.relative_velocity.assign(points.n_points * dim, 0.);
    for (std::size_t i = 0; i < points.n_points; ++i) {
      if (mesh.between_sizes(i))
        continue; // one follows the other
      for (unsigned int side = 0; side < 2; ++side) {
        const unsigned int corner = mesh.corners(i)[side];
        if (corner == JoinedMesh<dim>::none)
          continue;
        for (unsigned int r = 0; r < dim; ++r)
          for (unsigned int c = 0; c < dim; ++c) {
            const double share =
                (side == 0 ? -1. : 1.) * points.axes(i)[r * dim + c];
            state.jump[i * dim + r] +=
                share * state.displacement[corner * dim + c];
            state.relative_velocity[i * dim + r] +=
                share * state.velocity[corner * dim + c];
          }
      }
    }
  }

  namespace
  {
    /** Of what hangs nothing is prescribed that is not where it hangs from. */
    template <int dim>
    bool moves_differ(const HangingNodes<dim> &hanging,
                      const CornerGroups<dim> &groups,
                      const std::vector<std::uint8_t> &mask)
    {
      bool differ = false;
      for (const auto &tie : hanging.ties()) {
        if (!hanging.is_own(tie)) // all of its nodes are whole on its rank
          continue;
        unsigned int common = ~0u;
        for (std::size_t k = tie.first; k < tie.last; ++k)
          common &= mask[groups.of(hanging.master(k))];
        differ = differ || (mask[tie.group] & ~common) != 0;
      }
      return differ;
    }

    /** A rigid body takes a node along that hangs, or that is followed. */
    template <int dim>
    bool touch_rigid(const HangingNodes<dim> &hanging,
                     const Discretization<dim> &discretization,
                     const JoinedMesh<dim> &mesh)
    {
      const Cells<dim> &cells = discretization.cells();
      const std::size_t n_nodes = cells.element->n_dofs_per_cell();
      const auto is_rigid = [&](const std::size_t corner) {
        const auto all = mesh.corners_of_node(mesh.node(corner));
        return std::any_of(all.begin(), all.end(), [&](const unsigned int i) {
          return cells.body_class(i / n_nodes).undeformed;
        });
      };
      bool rigid = false;
      for (const auto &point : mesh.hanging())
        rigid = rigid || is_rigid(point.corner);
      for (const auto &tie : hanging.ties())
        for (std::size_t k = tie.first; k < tie.last; ++k)
          rigid = rigid || is_rigid(hanging.master(k));
      return rigid;
    }
  } // namespace

  template <int dim>
  void check_hanging(const Communicator &communicator,
                     const Discretization<dim> &discretization,
                     const JoinedMesh<dim> &mesh, State &state,
                     HangingNodes<dim> &hanging,
                     PrescribedGroups<dim> &supports)
  {
    const auto refuse = [&](const bool here, const std::string &what) {
      if (communicator.any(here))
        throw std::runtime_error(
            "scheme = explicit joins cells of two sizes: " + what);
    };
    const auto &origins = discretization.origins();
    const auto joined = joined_points(discretization, state);
    CornerGroups<dim> groups(mesh, joined);
    const bool tied = hanging.tie(groups);
    refuse(
        touch_rigid(hanging, discretization, mesh),
        "a node in the middle of a larger face is at a rigid cell, or follows "
        "a node that is; let cells of one size be around rigid ones");
    bool open = false, springs = false;
    for (std::size_t i = 0; i < origins.size(); ++i) {
      if (joined[i] || origins[i].kind != PointOrigin::Kind::interface)
        continue;
      open |= mesh.between_sizes(i);
      springs |=
          hanging.hangs(mesh.a_corner(i)) && state.kind[i] != PointKind::free;
    }
    refuse(open, "the law of a face between them must be extrinsic or joined, "
                 "and the face not be broken from the start; or let cells of "
                 "one size be on both sides");
    refuse(springs, "a node in the middle of a larger face lies on a face with "
                    "springs; take an extrinsic law there, or cells of one "
                    "size");
    refuse(!tied,
           "those that are larger meet at an edge of smaller ones without "
           "being joined there; refine them, too, or take degree <= 2");
    refuse(std::isinf(hanging.mass_share()),
           "the smaller ones are so much heavier that nodes of larger ones "
           "have no positive mass; refine where the density jumps");
    supports.find(groups, {});
    refuse(moves_differ(hanging, groups, supports.mask()),
           "a prescribed motion ends at an edge between them; let it hold on "
           "both sides, or for cells of one size");
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::vector<unsigned int> points_between_groups(                    \
      const Discretization<dim> &, const JoinedMesh<dim> &,                    \
      const HangingNodes<dim> &, const std::vector<std::uint8_t> &);           \
  template std::vector<std::uint8_t> joined_points(                            \
      const Discretization<dim> &, State &);                                   \
  template void set_jumps(const Discretization<dim> &,                         \
                          const JoinedMesh<dim> &, State &);                   \
  template void check_hanging(const Communicator &,                            \
                              const Discretization<dim> &,                     \
                              const JoinedMesh<dim> &, State &,                \
                              HangingNodes<dim> &, PrescribedGroups<dim> &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
