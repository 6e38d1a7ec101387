#include "rigid_clusters.h"

#include "connected_cells.h"

#include "core/gather.h"
#include "discretization/cells.h"

#include <algorithm>
#include <unordered_map>

namespace nsfd
{
  template <int dim>
  std::vector<int> rigid_clusters(const Discretization<dim> &discretization,
                                  const JoinedMesh<dim> &mesh,
                                  const Communicator &communicator,
                                  const GhostCells *ghosts,
                                  const std::vector<std::uint8_t> &intact)
  {
    const Cells<dim> &cells = discretization.cells();
    const auto is_rigid = [&](const int b) {
      return b >= 0 && cells.body_class(std::size_t(b)).undeformed;
    };
    ConnectedCells<dim> bodies(discretization, communicator, ghosts);
    bodies.connect([&](const auto &face) {
      return is_rigid(face.bodies[0]) && is_rigid(face.bodies[1]) &&
             face.count > 0 && intact[face.first];
    });

    struct RigidCell {
      std::array<unsigned int, 4> id; // alike on all ranks
      std::uint64_t body;
    };
    std::vector<RigidCell> own;
    for (std::size_t b = 0; b < cells.bodies.size(); ++b)
      if (is_rigid(int(b)) && !(ghosts && ghosts->is_ghost(b)))
        own.push_back({cells.cell_id[b], bodies.name(b)});
    auto all = gather_all(communicator, own);
    std::sort(all.begin(), all.end(),
              [](const auto &a, const auto &b) { return a.id < b.id; });
    std::unordered_map<std::uint64_t, int> number; // by their first cells
    for (const RigidCell &cell : all)
      number.emplace(cell.body, int(number.size()));

    std::vector<int> of_corners(mesh.n_corners(), -1);
    for (std::size_t b = 0; b < cells.bodies.size(); ++b)
      if (is_rigid(int(b)))
        std::fill(of_corners.begin() + long(cells.first_node[b]),
                  of_corners.begin() + long(cells.first_node[b + 1]),
                  number.at(bodies.name(b)));
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
