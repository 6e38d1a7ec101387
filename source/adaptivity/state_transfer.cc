#include "state_transfer.h"

#include "family.h"

#include "cohesive_laws/stiffened_law.h"
#include "discretization/cells.h"
#include "mesh/owned_cells.h"
#include "time_integration/initial_state.h"

#include "discretization/point_places.h"
#include "nonsmooth/point_law.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/fe/fe.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** What belongs to no body and no point: sums, times, extremes. */
    void take_sums(const State &from, State &to)
    {
      to.step = from.step;
      to.time = from.time;
      to.last_step = from.last_step;
      to.kept_step = from.kept_step;
      to.clock = from.clock;
      to.growth_step = from.growth_step;
      to.viscous_traction = from.viscous_traction;
      to.energy = from.energy;
      to.initial_energy = from.initial_energy;
      to.largest_energy = from.largest_energy;
      to.penetration = from.penetration;
      to.penetration_excess = from.penetration_excess;
      to.rigid_drift = from.rigid_drift;
      to.positive_friction_work = from.positive_friction_work;
      to.broken_area = from.broken_area;
      to.pressure_work = from.pressure_work;
    }

    /** jump - H q - gap at the start: what laws have put there. */
    template <int dim>
    std::vector<double> beyond_motion(const SceneInput &input,
                                      const MeshState<dim> &mesh)
    {
      std::vector<double> result(mesh.state.jump.size());
      mesh.delassus.relative_velocity(mesh.state.displacement.data(),
                                      result.data());
      for (std::size_t k = 0; k < result.size(); ++k)
        result[k] = mesh.state.jump[k] - result[k];
      for (std::size_t i = 0; i < result.size() / dim; ++i)
        result[i * dim] -= initial_gap(input, mesh.discretization, i);
      return result;
    }

    Block inverse_of(const Block &mass)
    {
      Block identity(mass.rows, mass.rows);
      for (unsigned int i = 0; i < mass.rows; ++i)
        identity(i, i) = 1.;
      return gram(forward_solve(cholesky(mass), identity));
    }
  } // namespace

  template <int dim>
  StateTransfer<dim>::StateTransfer(const SceneInput &input,
                                    Mesh &triangulation,
                                    const MeshState<dim> &mesh)
      : input_(input), triangulation_(triangulation), history_(input),
        shift_(input, mesh), old_(mesh),
        body_of_(bodies_of_cells(triangulation)),
        offset_(beyond_motion(input, mesh)),
        points_of_(mesh.discretization.bodies().size())
  {
    for_all_places(mesh.discretization.bodies(),
                   mesh.discretization.points().n_points,
                   [&](const std::size_t body, const unsigned int slot,
                       const std::size_t point, unsigned int) {
                     points_of_[body].emplace_back(slot, unsigned(point));
                   });
    handle_ = triangulation.register_data_attach(
        [this](const Cell &cell, const Status status) {
          return pack(cell, status);
        },
        true);
  }

  template <int dim>
  std::vector<char> StateTransfer<dim>::pack(const Cell &cell,
                                             const Status status) const
  {
    const Parcel parcel =
        status == Mesh::CELL_COARSEN
            ? pack_children(cell)
            : pack_one(unsigned(body_of_[cell->active_cell_index()]),
                       status == Mesh::CELL_REFINE ? cell->level() + 1 : 0);
    std::vector<char> bytes(parcel.size() * sizeof(double));
    std::memcpy(bytes.data(), parcel.data(), bytes.size());
    return bytes;
  }

  /** The points on the faces of a body, or on those of its parent only. */
  template <int dim>
  void StateTransfer<dim>::add_memories(const unsigned int body,
                                        const unsigned int child,
                                        Parcel &parcel,
                                        const bool all_faces) const
  {
    for (const auto &[slot, point] : points_of_[body]) {
      const unsigned int face_no =
          old_.discretization.cells().class_shape(body).slot_faces[slot];
      if (!all_faces && !lies_on_face(child, face_no))
        continue;
      const std::size_t first = parcel.size();
      parcel.resize(first + history_.size());
      history_.store(old_.discretization, old_.state, point,
                     &offset_[point * dim], &parcel[first]);
      parcel[first + PointHistory<dim>::face] = face_no;
    }
  }

  template <int dim>
  typename StateTransfer<dim>::Parcel
  StateTransfer<dim>::pack_one(const unsigned int body,
                               const int level_of_children) const
  {
    const auto &bodies = old_.discretization.bodies();
    const std::size_t first = bodies.first_dof[body],
                      end = bodies.first_dof[body + 1];
    Parcel parcel = {double(end - first)};
    for (const auto *vector : {&old_.state.displacement, &old_.state.velocity})
      parcel.insert(parcel.end(), vector->begin() + std::ptrdiff_t(first),
                    vector->begin() + std::ptrdiff_t(end));
    const auto translations = level_of_children > 0
                                  ? shift_.of_children(body, level_of_children)
                                  : std::vector<double>(n_translations, 0.);
    parcel.insert(parcel.end(), translations.begin(), translations.end());
    add_memories(body, 0, parcel, true);
    return parcel;
  }

  /** Displacement of the parent, and sum over children of P^T M v. */
  template <int dim>
  typename StateTransfer<dim>::Parcel
  StateTransfer<dim>::pack_children(const Cell &parent) const
  {
    std::vector<unsigned int> bodies;
    for (unsigned int c = 0; c < parent->n_children(); ++c)
      bodies.push_back(
          unsigned(body_of_[parent->child(c)->active_cell_index()]));
    const auto translations = shift_.of_family(bodies, parent->level() + 1);
    Family family;
    for (unsigned int c = 0; c < bodies.size(); ++c)
      family.add(old_.discretization.bodies(), old_.state, bodies[c],
                 &translations[c * dim], dim);
    const ParentMotion motion =
        motion_of_parent<dim>(*old_.discretization.cells().element, family);
    Parcel parcel = {double(motion.momentum.size())};
    parcel.insert(parcel.end(), motion.displacement.begin(),
                  motion.displacement.end());
    parcel.insert(parcel.end(), motion.momentum.begin(), motion.momentum.end());
    parcel.insert(parcel.end(), n_translations, 0.);
    for (unsigned int c = 0; c < bodies.size(); ++c)
      add_memories(bodies[c], c, parcel, false);
    return parcel;
  }

  template <int dim>
  void StateTransfer<dim>::receive()
  {
    const std::vector<int> body_of = bodies_of_cells(triangulation_);
    received_.resize(triangulation_.n_locally_owned_active_cells());
    triangulation_.notify_ready_to_unpack(
        handle_,
        [&](const Cell &cell, const Status status,
            const boost::iterator_range<std::vector<char>::const_iterator>
                &bytes) {
          auto parcel = std::make_shared<Parcel>(bytes.size() / sizeof(double));
          if (!bytes.empty())
            std::memcpy(parcel->data(), &*bytes.begin(), bytes.size());
          if (status != Mesh::CELL_REFINE) {
            received_[body_of[cell->active_cell_index()]] = {parcel, status, 0};
            return;
          }
          for (unsigned int c = 0; c < cell->n_children(); ++c)
            received_[body_of[cell->child(c)->active_cell_index()]] = {
                parcel, status, c};
        });
  }

  /** q and v of the bodies. */
  template <int dim>
  void StateTransfer<dim>::set_motion(const MeshState<dim> &fresh,
                                      State &state) const
  {
    const auto &bodies = fresh.discretization.bodies();
    const auto &element = *fresh.discretization.cells().element;
    state.displacement.resize(bodies.n_dofs());
    state.velocity.resize(bodies.n_dofs());
    std::vector<Block> inverse(bodies.classes.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Received &received = received_[b];
      const Parcel &parcel = *received.parcel;
      const auto n = unsigned(parcel[0]);
      const std::array<const double *, 2> from = {{&parcel[1], &parcel[1 + n]}};
      const std::array<double *, 2> to = {
          {state.displacement.data() + bodies.first_dof[b],
           state.velocity.data() + bodies.first_dof[b]}};
      if (received.status == Mesh::CELL_REFINE) {
        for (unsigned int k = 0; k < 2; ++k) {
          const auto values =
              in_child<dim>(element, received.child, from[k], n);
          std::copy(values.begin(), values.end(), to[k]);
        }
        const double *translation =
            &parcel[1 + 2 * std::size_t(n) + received.child * dim];
        for (unsigned int i = 0; i < n; ++i)
          to[0][i] += translation[i % dim];
        continue;
      }
      for (unsigned int k = 0; k < 2; ++k)
        std::copy_n(from[k], n, to[k]);
      if (received.status == Mesh::CELL_COARSEN) {
        Block &M_inverse = inverse[bodies.class_of[b]];
        if (M_inverse.rows == 0)
          M_inverse = inverse_of(bodies.classes[bodies.class_of[b]].mass);
        for (unsigned int i = 0; i < n; ++i) {
          to[1][i] = 0.;
          for (unsigned int j = 0; j < n; ++j)
            to[1][i] += M_inverse(i, j) * from[1][j];
        }
      }
    }
  }

  /**
   * The nearest history on the same face of the cell; of equally near ones the
   * most damaged. Null where there is none; @p inside: the face is new, inside
   * an old cell.
   */
  template <int dim>
  const double *StateTransfer<dim>::history_of(const Received &received,
                                               const unsigned int face_no,
                                               const std::size_t i,
                                               const MeshState<dim> &fresh,
                                               bool &inside) const
  {
    using Row = PointHistory<dim>;
    inside = received.status == Mesh::CELL_REFINE &&
             !lies_on_face(received.child, face_no);
    if (inside)
      return nullptr;
    const Parcel &parcel = *received.parcel;
    const PointOrigin origin = fresh.discretization.origins()[i];
    const double *x = &fresh.discretization.points().position[i * dim];
    const double *best = nullptr;
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t at = first_history(parcel); at < parcel.size();
         at += history_.size()) {
      const double *row = &parcel[at];
      if (unsigned(row[Row::face]) != face_no ||
          int(row[Row::origin_kind]) != int(origin.kind) ||
          unsigned(row[Row::origin_block]) != origin.block)
        continue;
      double distance = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        distance += std::pow(row[Row::position + c] - x[c], 2);
      const bool near = distance < nearest * (1. - 1e-6);
      const bool as_near = distance < nearest * (1. + 1e-6);
      if (best == nullptr || near ||
          (as_near && row[Row::beta] < best[Row::beta])) {
        best = row;
        nearest = distance;
      }
    }
    return best;
  }

  /**
   * The history of a point whose springs have another compliance now; a damaged
   * one keeps its traction as well.
   */
  template <int dim>
  void StateTransfer<dim>::set_springs(const MeshState<dim> &fresh,
                                       const double *row, const std::size_t i,
                                       State &state) const
  {
    using Row = PointHistory<dim>;
    const PointOrigin origin = fresh.discretization.origins()[i];
    const double before = row[Row::compliance], now = origin.compliance;
    if (before == now || state.kind[i] != PointKind::cohesive)
      return;
    const auto &law = input_.interfaces[origin.block].law;
    const auto &interaction =
        fresh.problem.interactions[fresh.problem.interaction[i]];
    const double factor = fresh.problem.opening_factor[i];
    if (state.beta[i] >= 1.)
      state.opening_max[i] = fresh.state.opening_max[i];
    else if (state.beta[i] > 0.) {
      const double beta = state.beta[i];
      state.opening_max[i] =
          opening_at_compliance(law, factor * state.opening_max[i], before,
                                now) /
          factor;
      state.beta[i] = interaction.law->beta(factor * state.opening_max[i]);
      if (now < before)
        state.beta[i] = std::min(state.beta[i], beta);
      const double share = (beta / before) / (state.beta[i] / now);
      for (unsigned int c = 0; c < dim; ++c) {
        const double jump = row[Row::jump + c];
        state.jump[i * dim + c] =
            c == 0 && jump < 0. && !state.two_sided[i] ? jump : share * jump;
      }
    }
  }

  /** An intrinsic point that is open farther than it ever was is damaged. */
  template <int dim>
  void record_opening(const OneStepProblem<dim> &problem, const std::size_t i,
                      State &state)
  {
    const auto &interaction = problem.interactions[problem.interaction[i]];
    const Reach reach = reach_of<dim>(interaction, &state.jump[i * dim]);
    if (state.kind[i] != PointKind::cohesive || !interaction.law ||
        interaction.law->extrinsic() || interaction.law->mixed() ||
        reach.opening <= state.opening_max[i])
      return;
    state.opening_max[i] = reach.opening;
    state.beta[i] = std::min(
        state.beta[i],
        interaction.law->beta(problem.opening_factor[i] * reach.opening));
    if (state.beta[i] < 1.)
      state.two_sided[i] = 0;
  }

  template <int dim>
  State StateTransfer<dim>::finish(const MeshState<dim> &fresh) const
  {
    using Row = PointHistory<dim>;
    const auto &points = fresh.discretization.points();
    const std::size_t n = points.n_points;
    State state = fresh.state;
    set_motion(fresh, state);
    fresh.delassus.relative_velocity(state.displacement.data(),
                                     state.jump.data());
    fresh.delassus.relative_velocity(state.velocity.data(),
                                     state.relative_velocity.data());
    history_.resize(n, state);

    // rows of both sides of every point; the first entry says what it is
    enum Kind { none, kept, inside_a_cell };
    const unsigned int size = history_.size();
    std::array<std::vector<double>, 2> rows;
    rows.fill(std::vector<double>(n * size, double(none)));
    for_all_places(
        fresh.discretization.bodies(), n,
        [&](const std::size_t body, const unsigned int slot,
            const std::size_t point, const unsigned int side) {
          bool inside = false;
          double *row = &rows[side][point * size];
          const double *history = history_of(received_[body],
                                             fresh.discretization.cells()
                                                 .class_shape(unsigned(body))
                                                 .slot_faces[slot],
                                             point, fresh, inside);
          if (history)
            std::copy_n(history, size, row);
          row[Row::face] = history ? kept : inside ? inside_a_cell : none;
        });
    fresh.delassus.exchange({{rows[0].data(), rows[1].data()}}, size);

    for (std::size_t i = 0; i < n; ++i) {
      const bool boundary = points.faces[points.face_of[i]].boundary;
      const double *row = &rows[boundary ? 1 : 0][i * size];
      switch (Kind(int(row[Row::face]))) {
      case kept:
        history_.restore(row, points.weight[i], i, state);
        for (unsigned int c = 0; c < dim; ++c)
          state.jump[i * dim + c] += row[Row::offset + c];
        set_springs(fresh, row, i, state);
        if (row[Row::compliance] !=
            fresh.discretization.origins()[i].compliance)
          record_opening(fresh.problem, i, state);
        break;
      case inside_a_cell:
        // intact, even where the block says `broken` or `contact`
        if (state.kind[i] == PointKind::free) {
          state.kind[i] = PointKind::prescribed;
          state.beta[i] = 1.;
        }
        record_opening(fresh.problem, i, state);
        break;
      case none:
        break;
      }
      state.jump[i * dim] += initial_gap(input_, fresh.discretization, i);
    }
    take_sums(old_.state, state);
    return state;
  }

  template class StateTransfer<2>;
  template class StateTransfer<3>;
} // namespace nsfd
