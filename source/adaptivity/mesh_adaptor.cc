#include "mesh_adaptor.h"

#include "discretization/cells.h"
#include "family.h"
#include "mesh/owned_cells.h"
#include "spring_shift.h"

#include "discretization/point_places.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <limits>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /// sizes are lengths that were halved and compared: round-off
    constexpr double margin = 1. + 1e-6;

    /** The point is not as it was born. */
    template <int dim>
    bool has_history(const MeshState<dim> &mesh, const std::size_t i)
    {
      const State &state = mesh.state;
      const auto &law =
          mesh.problem.interactions[mesh.problem.interaction[i]].law;
      return (state.beta[i] < 1. && law) || state.slip[i] > 0. ||
             state.released_overlap[i] > 0. || state.approach[i] > 0. ||
             (law && law->extrinsic() && state.kind[i] == PointKind::cohesive);
    }

    template <int dim>
    std::vector<bool> bodies_with_history(const MeshState<dim> &mesh)
    {
      const auto &bodies = mesh.discretization.bodies();
      std::vector<bool> result(bodies.size(), false);
      for_all_places(bodies, mesh.discretization.points().n_points,
                     [&](const std::size_t body, unsigned int,
                         const std::size_t point, unsigned int) {
                       if (has_history(mesh, point))
                         result[body] = true;
                     });
      return result;
    }
  } // namespace

  template <int dim>
  MeshAdaptor<dim>::MeshAdaptor(
      const SceneInput &input,
      parallel::distributed::Triangulation<dim> &triangulation)
      : input_(input), triangulation_(triangulation)
  {
  }

  template <int dim>
  bool MeshAdaptor<dim>::mark(const MeshState<dim> &mesh,
                              const bool may_coarsen)
  {
    const auto &communicator = mesh.delassus.communicator();
    const auto cells = owned_cells(triangulation_);
    std::vector<unsigned int> levels;
    for (const auto &cell : cells)
      levels.push_back(unsigned(cell->level()));
    const StateView<dim> view(input_, mesh, levels);
    std::vector<double> size(levels.size(), std::numeric_limits<double>::max());
    for (const auto &indicator : input_.adaptivity->indicators)
      indicator->limit(view, size);
    const auto history =
        may_coarsen ? bodies_with_history(mesh) : std::vector<bool>();

    for (std::size_t b = 0; b < cells.size(); ++b) {
      const auto &cell = cells[b];
      const auto &body = view.bodies()[b];
      cell->clear_refine_flag();
      cell->clear_coarsen_flag();
      if (body.size > size[b] * margin) {
        if (body.level < input_.adaptivity->levels)
          cell->set_refine_flag();
      } else if (may_coarsen && body.level > 0 && !history[b] &&
                 2. * body.size <= size[b] * margin)
        cell->set_coarsen_flag();
    }
    if (may_coarsen)
      keep_rough_families(mesh);
    triangulation_.prepare_coarsening_and_refinement();
    if (will_change(communicator))
      return true;
    for (const auto &cell : triangulation_.active_cell_iterators())
      cell->clear_coarsen_flag();
    return false;
  }

  /** Takes flags away. The energies of the rest change by 2e-4 at most. */
  template <int dim>
  void MeshAdaptor<dim>::keep_rough_families(const MeshState<dim> &mesh)
  {
    constexpr double share = 1e-4;
    const auto &energy = mesh.state.energy;
    const double mean = (energy.kinetic + energy.elastic) /
                        double(mesh.discretization.cells().n_global);
    const auto body_of = bodies_of_cells(triangulation_);
    const SpringShift<dim> shift(input_, mesh);
    for (const auto &cell : owned_cells(triangulation_)) {
      if (cell->level() == 0 || cell != cell->parent()->child(0))
        continue;
      std::vector<unsigned int> bodies;
      for (unsigned int c = 0; c < cell->parent()->n_children(); ++c) {
        const auto child = cell->parent()->child(c);
        if (!child->is_active() || !child->is_locally_owned() ||
            !child->coarsen_flag_set())
          break;
        bodies.push_back(unsigned(body_of[child->active_cell_index()]));
      }
      if (bodies.size() < cell->parent()->n_children())
        continue;
      const auto translations = shift.of_family(bodies, cell->level());
      Family family;
      for (unsigned int c = 0; c < bodies.size(); ++c)
        family.add(mesh.discretization.bodies(), mesh.state, bodies[c],
                   &translations[c * dim], dim);
      const FamilyEnergy of_family =
          energy_of_family<dim>(*mesh.discretization.cells().element, family);
      if (of_family.change >
          share * std::max(of_family.now, double(family.classes.size()) * mean))
        for (unsigned int c = 0; c < cell->parent()->n_children(); ++c)
          cell->parent()->child(c)->clear_coarsen_flag();
    }
  }

  /** Cells are only made larger together with all their siblings. */
  template <int dim>
  bool MeshAdaptor<dim>::will_change(const Communicator &communicator)
  {
    bool any = false;
    for (const auto &cell : triangulation_.active_cell_iterators()) {
      if (!cell->is_locally_owned())
        continue;
      any = any || cell->refine_flag_set();
      if (cell->level() == 0 || cell != cell->parent()->child(0))
        continue;
      bool all = true;
      for (unsigned int c = 0; c < cell->parent()->n_children(); ++c) {
        const auto sibling = cell->parent()->child(c);
        all = all && sibling->is_active() && sibling->coarsen_flag_set();
      }
      any = any || all;
    }
    return communicator.any(any);
  }

  template class MeshAdaptor<2>;
  template class MeshAdaptor<3>;
} // namespace nsfd
