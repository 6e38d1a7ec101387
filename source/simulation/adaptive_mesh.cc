#include "adaptive_mesh.h"

#include "adaptivity/mesh_adaptor.h"
#include "adaptivity/state_transfer.h"

#include "mesh/owned_cells.h"

#include "discretization/point_places.h"
#include "nsfd/core/archive.h"

#include <deal.II/grid/cell_id.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    parallel::distributed::Triangulation<dim> &mesh_of(Model<dim> &model)
    {
      return dynamic_cast<parallel::distributed::Triangulation<dim> &>(
          *model.triangulation);
    }

    template <int dim>
    MeshState<dim> mesh_state(const Model<dim> &model, const State &state)
    {
      return {*model.discretization, *model.delassus, model.stepper->problem(),
              state};
    }

    double stored(const EnergyLines &energy)
    {
      return energy.kinetic + energy.elastic + energy.cohesive;
    }
  } // namespace

  template <int dim>
  AdaptiveMesh<dim>::AdaptiveMesh(const SceneInput &input,
                                  const Communicator &communicator,
                                  Model<dim> &model)
      : input_(input), communicator_(communicator), model_(model),
        adaptor_(std::make_unique<MeshAdaptor<dim>>(input, mesh_of(model)))
  {
    count_cells();
    using Cell = typename Triangulation<dim>::cell_iterator;
    using Status = typename Triangulation<dim>::CellStatus;
    mesh_of(model_).signals.weight.connect(
        [this](const Cell &cell, const Status) -> unsigned int {
          const auto weight = [this](const Cell &one) -> unsigned int {
            return one->is_active() &&
                           one->active_cell_index() < weights_.size()
                       ? weights_[one->active_cell_index()]
                       : 0;
          };
          return 1000 + weight(cell->has_children() ? cell->child(0) : cell);
        });
  }

  template <int dim>
  AdaptiveMesh<dim>::~AdaptiveMesh() = default;

  /**
   * A cell weighs 1000, and as much again if all points on its faces have left
   * the state they were born in: they take most of the Newton steps.
   */
  template <int dim>
  void AdaptiveMesh<dim>::weigh_cells(const State &state)
  {
    weights_.assign(mesh_of(model_).n_active_cells(), 0);
    const auto &bodies = model_.discretization->bodies();
    std::vector<unsigned int> changed(bodies.size(), 0);
    for_all_places(
        bodies, state.beta.size(),
        [&](const std::size_t body, unsigned int, const std::size_t point,
            unsigned int) { changed[body] += state.beta[point] < 1.; });
    const auto cells = owned_cells(mesh_of(model_));
    for (std::size_t b = 0; b < cells.size(); ++b)
      weights_[cells[b]->active_cell_index()] =
          1000 * changed[b] /
          std::max(1u,
                   unsigned(bodies.first_slot[b + 1] - bodies.first_slot[b]));
  }

  template <int dim>
  void AdaptiveMesh<dim>::count_cells()
  {
    largest_cells_ =
        std::max(largest_cells_, model_.discretization->cells().n_global);
  }

  template <int dim>
  State AdaptiveMesh<dim>::start()
  {
    State state = model_.stepper->initial_state();
    for (unsigned int level = 0; level < input_.adaptivity->levels; ++level) {
      if (!adaptor_->mark(mesh_state(model_, state), false))
        break;
      mesh_of(model_).execute_coarsening_and_refinement();
      model_.rebuild(input_, communicator_);
      state = model_.stepper->initial_state();
      count_cells();
    }
    return state;
  }

  template <int dim>
  State AdaptiveMesh<dim>::restore(const std::vector<std::uint32_t> &ids)
  {
    std::set<CellId> wanted;
    for (std::size_t k = 0; k + 4 <= ids.size(); k += 4) {
      CellId::binary_type binary;
      std::copy_n(ids.data() + k, 4, &binary[0]);
      wanted.insert(CellId(binary));
    }
    auto &mesh = mesh_of(model_);
    for (bool coarse = true; coarse;) {
      coarse = false;
      for (const auto &cell : owned_cells(mesh))
        if (wanted.count(cell->id()) == 0 &&
            cell->level() < int(input_.adaptivity->levels)) {
          cell->set_refine_flag();
          coarse = true;
        }
      coarse = communicator_.any(coarse);
      if (coarse)
        mesh.execute_coarsening_and_refinement();
    }
    model_.rebuild(input_, communicator_);
    count_cells();
    return model_.stepper->initial_state();
  }

  template <int dim>
  void AdaptiveMesh<dim>::serialize(Archive &archive)
  {
    const Archive::Part part(archive, "adaptive_mesh");
    archive.numbers("sums", changes_, largest_cells_, cells_sum_, steps_,
                    energy_, worst_);
    archive.numbers("looked", looked_, coarsened_);
  }

  template <int dim>
  bool AdaptiveMesh<dim>::follow(State &state, const State &next)
  {
    if (rounds_ == 0) {
      ++steps_;
      cells_sum_ += double(model_.discretization->cells().n_global);
    }
    if (!is_due(next))
      return false;
    const unsigned int every = input_.adaptivity->coarsen_every;
    const bool may_coarsen =
        rounds_ == 0 && every > 0 && next.step >= coarsened_ + every;
    if (may_coarsen)
      coarsened_ = next.step;
    looked_ = next.time;
    if (!adaptor_->mark(mesh_state(model_, next), may_coarsen))
      return false;
    ++rounds_;
    change(state);
    return true;
  }

  template <int dim>
  bool AdaptiveMesh<dim>::is_due(const State &next) const
  {
    if (rounds_ > 0) // a level per round, and one for what the finer mesh sees
      return rounds_ <= input_.adaptivity->levels;
    return looked_ < 0. ||
           next.time - looked_ >= 0.25 * model_.discretization->crossing_time();
  }

  template <int dim>
  void AdaptiveMesh<dim>::change(State &state)
  {
    const double before = stored(state.energy), damage = dissipated(state),
                 area = broken_area(state);
    StateTransfer<dim> transfer(input_, mesh_of(model_),
                                mesh_state(model_, state));
    weigh_cells(state);
    mesh_of(model_).execute_coarsening_and_refinement();
    transfer.receive();
    model_.rebuild(input_, communicator_);
    const State fresh = model_.stepper->initial_state();
    state = transfer.finish(mesh_state(model_, fresh));
    model_.stepper->complete(state);

    // points stand for other areas now
    const double more_damage = dissipated(state) - damage;
    const double lost = before - stored(state.energy);
    state.broken_area += broken_area(state) - area;
    state.energy.damage += more_damage;
    state.energy.numerical += lost - more_damage;
    energy_ += lost;
    worst_ = std::max(worst_, std::abs(lost) / state.largest_energy);
    ++changes_;
    count_cells();
  }

  /** What the points of a state have dissipated, by their history. */
  template <int dim>
  double AdaptiveMesh<dim>::dissipated(const State &state) const
  {
    const auto &problem = model_.stepper->problem();
    std::vector<double> terms(problem.n_owned, 0.);
    for (std::size_t i = 0; i < problem.n_owned; ++i) {
      const auto &law = problem.interactions[problem.interaction[i]].law;
      if (!law || law->mixed() || state.beta[i] >= 1. ||
          !(state.opening_max[i] > 0.)) // broken from the start
        continue;
      const double d = problem.opening_factor[i] * state.opening_max[i];
      const double density = state.beta[i] > 0.
                                 ? law->energy(d) - law->traction(d) * d / 2.
                                 : law->toughness();
      terms[i] = problem.weight[i] * problem.strength_factor[i] /
                 problem.opening_factor[i] * density;
    }
    return communicator_.sum(terms);
  }

  template <int dim>
  double AdaptiveMesh<dim>::broken_area(const State &state) const
  {
    const auto &problem = model_.stepper->problem();
    std::vector<double> terms(problem.n_owned, 0.);
    for (std::size_t i = 0; i < problem.n_owned; ++i)
      if (problem.interactions[problem.interaction[i]].law &&
          state.beta[i] <= 0. && state.opening_max[i] > 0.)
        terms[i] = problem.weight[i];
    return communicator_.sum(terms);
  }

  template <int dim>
  void AdaptiveMesh<dim>::fill_counters(std::map<std::string, double> &c) const
  {
    c["mesh_changes"] = changes_;
    c["largest_cells"] = double(largest_cells_);
    c["mean_cells"] = cells_sum_ / std::max(1., steps_);
    c["mesh_change_energy"] = energy_;
    c["mesh_change_energy_worst"] = worst_;
  }

  template class AdaptiveMesh<2>;
  template class AdaptiveMesh<3>;
} // namespace nsfd
