#include "rigid_clusters.h"

#include "core/disjoint_sets.h"
#include "core/gather.h"
#include "discretization/cells.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  std::vector<int> rigid_clusters(const Discretization<dim> &discretization,
                                  const JoinedMesh<dim> &mesh,
                                  const Communicator &communicator,
                                  const GhostCells *ghosts,
                                  const std::vector<std::uint8_t> &intact)
  {
    using Id = std::array<unsigned int, 4>; // alike on all ranks
    const Cells<dim> &cells = discretization.cells();
    const auto is_rigid = [&](const int b) {
      return b >= 0 && cells.body_class(std::size_t(b)).undeformed;
    };
    std::vector<Id> own;
    std::vector<std::array<Id, 2>> own_pairs;
    for (std::size_t b = 0; b < cells.bodies.size(); ++b)
      if (is_rigid(int(b)) && !(ghosts && ghosts->is_ghost(b)))
        own.push_back(cells.cell_id[b]);
    for (const auto &face : discretization.points().faces)
      if (!face.boundary && is_rigid(face.bodies[0]) &&
          is_rigid(face.bodies[1]) && face.count > 0 && intact[face.first])
        own_pairs.push_back({cells.cell_id[std::size_t(face.bodies[0])],
                             cells.cell_id[std::size_t(face.bodies[1])]});

    auto all = gather_all(communicator, own);
    std::sort(all.begin(), all.end());
    const auto number = [&all](const Id &id) {
      return unsigned(std::lower_bound(all.begin(), all.end(), id) -
                      all.begin());
    };
    DisjointSets bodies(all.size());
    for (const auto &pair : gather_all(communicator, own_pairs))
      bodies.join(number(pair[0]), number(pair[1]));
    unsigned int n_bodies = 0;
    const auto body = bodies.numbers(n_bodies);

    std::vector<int> of_corners(mesh.n_corners(), -1);
    for (std::size_t b = 0; b < cells.bodies.size(); ++b)
      if (is_rigid(int(b)))
        std::fill(of_corners.begin() + long(cells.first_node[b]),
                  of_corners.begin() + long(cells.first_node[b + 1]),
                  int(body[number(cells.cell_id[b])]));
    return of_corners;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::vector<int> rigid_clusters(                                    \
      const Discretization<dim> &, const JoinedMesh<dim> &,                    \
      const Communicator &, const GhostCells *,                                \
      const std::vector<std::uint8_t> &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
