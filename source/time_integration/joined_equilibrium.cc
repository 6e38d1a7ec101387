#include "joined_equilibrium.h"

#include "joined_start.h"
#include "point_name.h"
#include "time_integrator.h"

#include "discretization/body_frequency.h"
#include "discretization/cells.h"
#include "discretization/loads.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    // a restart that leaves more than this of what was left over is of no use
    constexpr double least_gain = 0.5;
    /// of what is open, over the largest displacement: what these are known to
    constexpr double largest_overlap = 1e-6;
  } // namespace

  template <int dim>
  JoinedEquilibrium<dim>::JoinedEquilibrium(
      const SceneInput &input, const Communicator &communicator,
      const Discretization<dim> &discretization, const JoinedMesh<dim> &mesh,
      const LeapfrogGhosts<dim> &ghosts, HangingNodes<dim> &hanging,
      CellForces<dim> &forces, EquilibriumSprings<dim> &springs)
      : input_(input), communicator_(communicator),
        discretization_(discretization), mesh_(mesh), ghosts_(ghosts),
        hanging_(hanging), forces_(forces), springs_(springs),
        loads_(input, discretization, mesh, hanging),
        supports_(input, discretization, mesh)
  {
  }

  template <int dim>
  void JoinedEquilibrium<dim>::set_inverse()
  {
    const auto &cells = discretization_.cells();
    const auto frequency = frequencies_of_bodies(cells);
    const auto &groups = *groups_;
    std::vector<double> mass(groups.size(), 0.), stiffness(groups.size(), 0.);
    for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
      const std::size_t first = cells.bodies.first_dof[b] / dim,
                        n = cells.body_class(b).n_dofs / dim;
      for (std::size_t i = first; i < first + n; ++i) {
        mass[groups.of(i)] += mesh_.mass(i);
        stiffness[groups.of(i)] += mesh_.mass(i) * frequency[b] * frequency[b];
      }
    }
    std::vector<double> of_springs(groups.size() * dim, 0.);
    springs_.add_diagonal(groups, of_springs);
    inverse_.assign(groups.size() * dim, 0.);
    for (std::size_t i = 0; i < groups.size(); ++i)
      for (unsigned int c = 0; c < dim; ++c)
        if (groups.mass[i] > 0. && !(supports_.mask()[i] & (1u << c)))
          inverse_[i * dim + c] = mass[i] / (groups.mass[i] * stiffness[i] +
                                             mass[i] * of_springs[i * dim + c]);
  }

  /** Of the displacements of the groups. */
  template <int dim>
  void JoinedEquilibrium<dim>::set_forces()
  {
    ghosts_.fetch_motion(*groups_);
    if (hanging_.any())
      hanging_.follow(*groups_);
    hanging_.set_forces(forces_, *groups_);
    springs_.add_forces(*groups_);
  }

  /** Of the present place; sets the size of the forces too. */
  template <int dim>
  double JoinedEquilibrium<dim>::find_residual()
  {
    auto &groups = *groups_;
    groups.displacement = place_;
    set_forces();
    std::vector<double> sizes(groups.force.size(), 0.);
    for (std::size_t i = 0; i < mesh_.n_corners(); ++i) {
      const auto force = forces_.corner_force(i, groups);
      for (unsigned int c = 0; c < dim; ++c)
        sizes[groups.of(i) * dim + c] += std::abs(force[c]);
    }
    springs_.add_sizes(groups, sizes);
    residual_.resize(groups.force.size());
    for (std::size_t k = 0; k < residual_.size(); ++k) {
      const double load = given_.empty() ? 0. : given_[k];
      sizes[k] += std::abs(load);
      residual_[k] = inverse_[k] > 0. ? groups.force[k] + load : 0.;
    }
    size_ = std::sqrt(ghosts_.dot(groups, sizes, sizes));
    return std::sqrt(ghosts_.dot(groups, residual_, residual_));
  }

  /** Until no more than @p goal is left by the recurrence. False where nothing
      holds a direction. */
  template <int dim>
  bool JoinedEquilibrium<dim>::descend(const double goal, double residual)
  {
    auto &groups = *groups_;
    const std::size_t n = residual_.size();
    // more than without round-off
    const auto most = 2 * communicator_.sum_integer(n);
    direction_.assign(n, 0.);
    scaled_.resize(n);
    double product = 0.;
    for (unsigned long long k = 0; k < most && residual > goal; ++k) {
      ++iterations_;
      for (std::size_t i = 0; i < n; ++i)
        scaled_[i] = inverse_[i] * residual_[i];
      const double last = product;
      product = ghosts_.dot(groups, scaled_, residual_);
      const double share = k == 0 ? 0. : product / last;
      for (std::size_t i = 0; i < n; ++i)
        direction_[i] = scaled_[i] + share * direction_[i];
      groups.displacement = direction_;
      set_forces();
      for (std::size_t i = 0; i < n; ++i)
        scaled_[i] = inverse_[i] > 0. ? direction_[i] / inverse_[i] : 0.;
      const double size = ghosts_.dot(groups, scaled_, direction_);
      for (std::size_t i = 0; i < n; ++i)
        scaled_[i] = inverse_[i] > 0. ? groups.force[i] : 0.; // -K p
      const double curvature = -ghosts_.dot(groups, direction_, scaled_);
      if (!(curvature > 1e-15 * size))
        return false;
      const double length = product / curvature;
      for (std::size_t i = 0; i < n; ++i) {
        place_[i] += length * direction_[i];
        residual_[i] += length * scaled_[i];
      }
      residual = std::sqrt(ghosts_.dot(groups, residual_, residual_));
    }
    return true;
  }

  /** What is left over of the forces, relative to those present. */
  template <int dim>
  double JoinedEquilibrium<dim>::solve()
  {
    const double tolerance = input_.statics->tolerance;
    double last = std::numeric_limits<double>::infinity();
    for (;;) {
      const double residual = find_residual(),
                   imbalance = size_ > 0. ? residual / size_ : 0.;
      if (imbalance <= tolerance || !(residual < least_gain * last) ||
          !descend(0.1 * tolerance * size_, residual))
        return imbalance;
      last = residual;
    }
  }

  /** On all ranks if @p here at @p point of the mesh on one of them. */
  template <int dim>
  void JoinedEquilibrium<dim>::refuse(const bool here, const std::size_t point,
                                      const State &state,
                                      const std::string &what,
                                      const std::string &cure) const
  {
    if (!communicator_.any(here))
      return;
    const std::string place =
        here ? ", " + name_of_point<dim>(input_, discretization_.origins(),
                                         discretization_.points().position,
                                         point)
             : std::string();
    throw StepRejected(fmt::format("no equilibrium at t = {:.6g}: {}{}; {}",
                                   state.time, what, place, cure),
                       StepRejected::Cure::none);
  }

  template <int dim>
  void JoinedEquilibrium<dim>::check_open(const State &state) const
  {
    double largest = 0.;
    for (const double u : groups_->displacement)
      largest = std::max(largest, std::abs(u));
    const double allowed = largest_overlap * communicator_.max(largest);
    const auto &origins = discretization_.origins();
    std::size_t closed = intact_.size();
    for (std::size_t i = 0; i < intact_.size() && closed == intact_.size(); ++i)
      if (!intact_[i] && !state.two_sided[i] &&
          origins[i].kind != PointOrigin::Kind::motion &&
          -state.jump[i * dim] > allowed)
        closed = i;
    refuse(closed < intact_.size(), closed, state,
           "it would close faces whose contact carries nothing in it yet",
           "take loads that leave them open, or write scheme = moreau-jean");
  }

  template <int dim>
  void JoinedEquilibrium<dim>::find(const FaceRelease<dim> &faces, State &state)
  {
    State joined = state; // kinds of points become others
    intact_ = joined_points(discretization_, joined);
    for (std::size_t i = 0; i < intact_.size(); ++i) {
      const PointOrigin &origin = discretization_.origins()[i];
      if (origin.kind != PointOrigin::Kind::interface ||
          joined.kind[i] != PointKind::rigid)
        continue;
      const auto &law = input_.interfaces[origin.block].law;
      if (law && law->friction_exponent() == 0.)
        intact_[i] = 1; // a fault that holds
    }
    groups_ = std::make_unique<CornerGroups<dim>>(mesh_, intact_);
    auto &groups = *groups_;
    groups.gather(state.displacement, groups.displacement);
    groups.velocity.assign(groups.displacement.size(), 0.);
    if (hanging_.any())
      hanging_.tie(groups);
    const bool springs = springs_.add(
        points_between_groups(discretization_, mesh_, hanging_, intact_),
        discretization_.points(), faces, state);
    refuse(!springs, springs_.bad_point(), state,
           "a law has no straight part to begin on",
           "take another law, or write scheme = moreau-jean");
    refuse(
        springs_.any() && discretization_.loads().initial_stress(),
        springs_.a_point(), state,
        "springs that carry an initial stress are beyond their place at rest",
        "write scheme = moreau-jean, or begin with a motion");
    supports_.find(groups, {});
    loads_.start(state.time, state.clock, groups);
    given_ = loads_.sum(state.time, nullptr, springs_.chains(), groups);
    set_inverse();
    supports_.set_places(state.time, groups);
    place_ = groups.displacement;
    forces_.front().holds = true; // it acts on rates alone
    const double imbalance = solve();
    forces_.front().holds = false;
    if (!(imbalance <= input_.statics->tolerance))
      throw StepRejected(
          fmt::format(
              "no equilibrium at t = {:.6g}: after {} iterations {:.1e} "
              "of the forces are left over; supports must hold what "
              "loads push, or raise Time/equilibrium tolerance",
              state.time, iterations_, imbalance),
          StepRejected::Cure::none);
    groups.displacement = place_;
    ghosts_.fetch_motion(groups);
    if (hanging_.any())
      hanging_.follow(groups);
    groups.scatter(groups.displacement, state.displacement);
    groups.scatter(groups.velocity, state.velocity);
    set_jumps(discretization_, mesh_, state);
    check_open(state);
    const bool straight = springs_.are_straight(state);
    refuse(!straight, springs_.bad_point(), state,
           "it would open faces beyond the straight part of their law",
           "take smaller loads, or write scheme = moreau-jean");
    for (std::size_t i = 0; i < intact_.size(); ++i)
      if (!intact_[i] && !state.two_sided[i]) // contact holds where it is
        state.released_overlap[i] = std::max(0., -state.jump[i * dim]);
  }

  template class JoinedEquilibrium<2>;
  template class JoinedEquilibrium<3>;
} // namespace nsfd
