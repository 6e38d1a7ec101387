#include "leapfrog_large.h"

#include "joined_start.h"

#include "bodies/rigid_motions.h"
#include "discretization/cells.h"
#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /// of the bound by the stiffest cell: it may become stiffer until the next
    /// look
    constexpr double share_of_bound = 0.97;
    constexpr unsigned int steps_between_looks = 4;
  } // namespace

  template <int dim>
  LeapfrogLarge<dim>::LeapfrogLarge(const SceneInput &input,
                                    const Discretization<dim> &discretization,
                                    const JoinedMesh<dim> &mesh,
                                    const OneStepProblem<dim> &all,
                                    const Communicator &communicator,
                                    NonlinearForces<dim> &forces)
      : input_(input), discretization_(discretization), mesh_(mesh),
        communicator_(communicator), forces_(forces)
  {
    if (input.large_motion &&
        (!input.contacts.empty() || !input.obstacles.empty() ||
         input.has_rigid_bodies()))
      contacts_ = std::make_unique<LeapfrogContacts<dim>>(input, discretization,
                                                          all, communicator);
  }

  template <int dim>
  void LeapfrogLarge<dim>::set_initial(State &state) const
  {
    state.material_history = forces_.histories().at_rest();
    if (input_.large_motion && input_.has_rigid_bodies()) {
      const BodyLayout<dim> layout(input_, discretization_);
      RigidMotions<dim>(input_, discretization_, layout, communicator_)
          .set_nearest(state);
    }
    if (contacts_)
      contacts_->set_initial(state);
  }

  template <int dim>
  void LeapfrogLarge<dim>::start(const State &state,
                                 const CornerGroups<dim> &groups)
  {
    if (contacts_)
      contacts_->start(state, groups);
    stored_ = stored();
  }

  template <int dim>
  double LeapfrogLarge<dim>::stable_share() const
  {
    return stiffening_ > 1. ? share_of_bound / std::sqrt(stiffening_) : 1.;
  }

  template <int dim>
  void LeapfrogLarge<dim>::begin(const double time, const double h,
                                 const std::vector<std::uint8_t> &prescribed,
                                 const RigidGroups<dim> *rigid,
                                 const CornerGroups<dim> &groups,
                                 LeapfrogPoints<dim> &points,
                                 LeapfrogEnergies &energies)
  {
    if (!input_.large_motion)
      return;
    turned_ += communicator_.sum(
        points.turn([this](const std::size_t i) { return forces_.frame(i); },
                    rigid, groups));
    energies.turned = turned_;
    if (contacts_)
      contacts_->find(time, h, prescribed, rigid, groups);
  }

  /** The node of a group that points hold; else no_node. */
  template <int dim>
  std::vector<std::size_t>
  LeapfrogLarge<dim>::nodes_of_groups(const LeapfrogPoints<dim> &points,
                                      const CornerGroups<dim> &groups) const
  {
    std::vector<std::size_t> result(groups.size(),
                                    LeapfrogContacts<dim>::no_node);
    const auto &chains = points.chains();
    for (std::size_t a = 0; a < chains.size(); ++a)
      if (has_impulse(chains.problem.kind[a]))
        for (const unsigned int corner : mesh_.corners(chains.point[a]))
          if (corner != JoinedMesh<dim>::none)
            result[groups.of(corner)] = mesh_.node(corner);
    return result;
  }

  template <int dim>
  auto LeapfrogLarge<dim>::solve(const double h, const double last,
                                 const std::vector<std::uint8_t> &prescribed,
                                 const double tolerance,
                                 RigidGroups<dim> *rigid,
                                 LeapfrogPoints<dim> &points,
                                 CornerGroups<dim> &groups) ->
      typename LeapfrogPoints<dim>::Outcome
  {
    constexpr unsigned int most_rounds = 30;
    if (!rigid && (!contacts_ || !contacts_->any()))
      return points.solve(h, last, prescribed, tolerance, groups);
    const std::vector<double> free = groups.velocity;
    const auto node_of = nodes_of_groups(points, groups);
    typename LeapfrogPoints<dim>::Outcome outcome;
    for (unsigned int round = 0; round < most_rounds; ++round) {
      groups.velocity = free;
      std::vector<double> of_bodies(rigid ? rigid->n_free() : 0, 0.);
      auto clusters = contacts_->clusters(node_of);
      std::vector<std::size_t> apart;
      for (const auto &cluster : clusters)
        apart.insert(apart.end(), cluster.nodes.begin(), cluster.nodes.end());
      std::sort(apart.begin(), apart.end());
      auto of_round =
          points.solve(h, last, prescribed, tolerance, groups, apart);
      of_round.sweeps += outcome.sweeps;
      of_round.newton += outcome.newton;
      of_round.problems += outcome.problems;
      outcome = of_round;
      for (auto &cluster : clusters)
        points.solve_cluster(cluster, prescribed, tolerance, rigid, of_bodies,
                             groups, outcome);
      contacts_->take(clusters);
      outcome.residual =
          std::max(outcome.residual,
                   contacts_->solve_others(tolerance, of_bodies, groups));
      if (rigid)
        rigid->move(of_bodies, groups);
      ++rounds_;
      if (!contacts_->improve(groups))
        break;
    }
    return outcome;
  }

  template <int dim>
  void LeapfrogLarge<dim>::add_impulses(const std::vector<int> &row_of_group,
                                        std::vector<double> &rows) const
  {
    if (contacts_)
      contacts_->add_impulses(row_of_group, rows);
  }

  /** Of the front viscosity against each of @p velocities, W. Collective. */
  template <int dim>
  std::vector<double> LeapfrogLarge<dim>::front_powers(
      const CornerGroups<dim> &groups,
      const std::vector<const std::vector<double> *> &velocities) const
  {
    const std::size_t rows = velocities.size();
    if (!forces_.front().acts())
      return std::vector<double>(rows, 0.);
    const auto terms = forces_.front_powers(groups, velocities);
    return communicator_.sums(terms.data(), rows, terms.size() / rows);
  }

  template <int dim>
  void LeapfrogLarge<dim>::take_energies(const double h, const double last,
                                         const std::vector<double> &before,
                                         const CornerGroups<dim> &groups,
                                         LeapfrogEnergies &energies)
  {
    const auto powers = front_powers(groups, {&before, &groups.velocity});
    const double front_before = powers[0], front_after = powers[1];
    front_taken_ = -(h + last) / 4. * (front_before + front_after);
    // of elastic forces alone, where a step changes its length
    energies.numerical -= (h - last) / 4. * (front_after - front_before);
    energies.power -= front_after;
    const double kick = (h + last) / 2., half = h / 2.;
    halving_.gives =
        last > 0.
            ? (last - half) * (last + half) / (8. * kick) *
                  (energies.power - (energies.power_before - front_before))
            : 0.;
    energies.viscous += flow_[1];
    energies.plastic = flow_[0];
    // steps that change their length are among it
    energies.large = energies.numerical + bulk_ - energies.turned;
    energies.numerical = energies.large;
    energies.stored = stored_;
    power_ = energies.power;
    if (!contacts_)
      return;
    const auto contacts = contacts_->account(groups);
    energies.friction = contacts.friction;
    energies.positive_friction = contacts.positive_friction;
    energies.impact = contacts.impact;
    energies.work += contacts.work;
    energies.penetration = contacts.penetration;
    energies.excess = contacts.excess;
    energies.touching = contacts.active;
  }

  /**
   * The part @p held of the kinetic energy is held by the viscosity of the new
   * forces, see FrontViscosity; what is left below zero is of rates that are
   * not those of straight lines.
   */
  template <int dim>
  void LeapfrogLarge<dim>::take_front(const double held,
                                      LeapfrogEnergies &energies)
  {
    const double taken = front_taken_ + held - front_held_;
    front_held_ = held;
    energies.kinetic -= held;
    energies.viscous += std::max(0., taken);
    energies.large += std::min(0., taken);
    energies.numerical += std::min(0., taken);
  }

  template <int dim>
  void LeapfrogLarge<dim>::take_forces(const unsigned int step, const double h,
                                       const CornerGroups<dim> &groups,
                                       LeapfrogEnergies &energies)
  {
    const double stored_now = stored(),
                 front = front_powers(groups, {&groups.velocity})[0];
    energies.power_after -= front;
    take_front(-h / 4. * front, energies);
    bulk_ = stored_ - stored_now - h / 2. * (power_ + energies.power_after);
    if (input_.has_history()) {
      const std::size_t n = forces_.taken().size() / 2;
      const auto sums = communicator_.sums(forces_.taken().data(), 2, n);
      std::copy_n(sums.begin(), 2, flow_.begin());
      bulk_ -= flow_[0] + flow_[1];
    }
    stored_ = stored_now;
    // a longer step later would take or give energy, as each change does
    if (step % steps_between_looks == 0)
      stiffening_ =
          std::max(stiffening_, communicator_.max(forces_.stiffening()));
  }

  template <int dim>
  bool LeapfrogLarge<dim>::accept(LeapfrogPoints<dim> &points)
  {
    turned_ = 0.;
    if (!contacts_)
      return false;
    contacts_->accept();
    // how far they have come, which never goes back
    const auto n_open = [this, &points] {
      const auto &chains = points.chains();
      std::size_t n = 0;
      for (std::size_t a = 0; a < chains.size(); ++a) {
        for (const PointKind kind :
             {chains.problem.kind[a], chains.other.kind[a]})
          n += kind == PointKind::separated  ? 3
               : kind == PointKind::free     ? 2
               : kind == PointKind::cohesive ? 1
                                             : 0;
        const auto left = contacts_->left(chains, a, way_);
        n += chains.is_left(a) || left.slid;
        n += chains.is_left(a) || left.overlaps;
      }
      return n + chains.size();
    };
    if (n_open() == n_open_) {
      contacts_->set_kinds(points.chains(), way_);
      return false;
    }
    const auto parted = contacts_->part(points.chains(), way_);
    for (const unsigned int point : parted)
      points.part(point);
    n_open_ = n_open();
    return !parted.empty();
  }

  /**
   * The error of a step, of third order, may go on for a few steps before it
   * comes back with the other sign: a fifth of what a run may give. Sooner is
   * better, since what a change of the step takes or gives grows with the
   * square of the forces. Where a change would give more than such steps do, as
   * in few cells whose fastest motions hold much of the energy, it waits for
   * less force. A cell that is crushed is far stiffer than at rest: no step
   * would be short enough, and the certificate says what it gave, if that is no
   * more than what a run may give.
   */
  template <int dim>
  bool LeapfrogLarge<dim>::is_too_long(const double largest)
  {
    constexpr double most_of_step = 2e-4, few_steps = 5., of_crushed = 64.;
    if (bulk_ < -most_of_large_motion * largest)
      return true;
    if (!(stiffening_ < of_crushed))
      return false;
    const bool is_now = std::abs(bulk_) > most_of_step * largest;
    halving_.waits = halving_.waits || is_now;
    return halving_.waits &&
           halving_.gives <=
               (is_now ? few_steps * std::abs(bulk_) : most_of_step * largest);
  }

  template <int dim>
  std::string LeapfrogLarge<dim>::inverted() const
  {
    bool here = forces_.inverted() >= 0;
    if (!communicator_.any(here))
      return {};
    // of several ranks the first place by its coordinates
    std::vector<double> place(dim, std::numeric_limits<double>::max());
    if (here) {
      const auto x =
          discretization_.cells().centre(std::size_t(forces_.inverted()));
      place.assign(x.begin_raw(), x.end_raw());
    }
    for (double &x : place) {
      const double mine = here ? x : std::numeric_limits<double>::max();
      x = communicator_.min(mine);
      here = here && mine == x;
    }
    return fmt::format("({:.6g})", fmt::join(place, ", "));
  }

  template <int dim>
  void LeapfrogLarge<dim>::show(State &state) const
  {
    state.material_history = forces_.histories().values();
    if (contacts_)
      contacts_->show(state);
  }

  template <int dim>
  void LeapfrogLarge<dim>::fill_counters(std::map<std::string, double> &c) const
  {
    if (!contacts_)
      return;
    contacts_->fill_counters(c);
    c["contact_rounds"] = double(rounds_);
  }

  template <int dim>
  void LeapfrogLarge<dim>::serialize(Archive &archive,
                                     const LeapfrogPoints<dim> &points)
  {
    archive.numbers("large", bulk_, stiffening_, way_, front_held_,
                    halving_.waits);
    if (input_.has_history())
      archive.numbers("flow", flow_[0], flow_[1]);
    if (archive.reads() && contacts_)
      contacts_->set_kinds(points.chains(), way_);
  }

  template class LeapfrogLarge<2>;
  template class LeapfrogLarge<3>;
} // namespace nsfd
