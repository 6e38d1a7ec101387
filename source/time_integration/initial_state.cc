#include "initial_state.h"

#include "discretization/cells.h"
#include "discretization/obstacle_of_point.h"
#include "state/point_fields.h"

#include "bond_release.h"
#include "point_name.h"
#include "step_data.h"

#include "discretization/loads.h"

#include "nonsmooth/point_law.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    /// gap over the extent of the mesh up to which a body sticks to an obstacle
    constexpr double touching = 1e-9;

    using Components = std::array<Expression, 3>;

    /** One of the initial fields of the materials, as unknowns. */
    template <int dim>
    std::vector<double> initial_field(const SceneInput &input,
                                      const Discretization<dim> &discretization,
                                      const Components MaterialInput::*field)
    {
      if (std::all_of(input.materials.begin(), input.materials.end(),
                      [&](const MaterialInput &material) {
                        return std::all_of(
                            (material.*field).begin(), (material.*field).end(),
                            [](const auto &part) { return part.is_zero(); });
                      }))
        return std::vector<double>(discretization.bodies().n_dofs(), 0.);
      return discretization.interpolate([&](const dealii::Point<dim> &x,
                                            const unsigned int body,
                                            double *value) {
        const auto &material =
            input.materials[discretization.cells().body_class(body).material];
        for (unsigned int c = 0; c < dim; ++c)
          value[c] = (material.*field)[c].at(x, 0.);
      });
    }

    template <int dim>
    void set_interface_point(const InterfaceInput &block,
                             const dealii::Point<dim> &x, const double gap,
                             const OneStepProblem<dim> &problem,
                             const std::size_t i, State &state)
    {
      state.jump[i * dim] += gap;
      if (block.law_name == "contact" || gap != 0. ||
          (block.has_broken && block.broken.at(x, 0.) != 0.)) {
        state.kind[i] = PointKind::free;
        state.beta[i] = 0.;
      } else if (block.intact == IntactFaces::bonded) {
        state.kind[i] = PointKind::bonded;
      } else if (block.law_name == "elastic") {
        state.kind[i] = PointKind::elastic;
        state.two_sided[i] = block.intact == IntactFaces::spring;
      } else if (block.law && block.law->extrinsic())
        state.kind[i] = PointKind::rigid;
      else if (block.law) {
        state.kind[i] = PointKind::cohesive;
        state.two_sided[i] = block.intact == IntactFaces::spring;
        const auto &interaction = problem.interactions[problem.interaction[i]];
        const double factor = problem.opening_factor[i];
        // below the elastic limit there is nothing to keep
        // (just below, so that round-off does not damage it)
        Reach history = reach_of<dim>(interaction, &state.jump[i * dim]);
        history.opening =
            std::max((1. - 1e-14) * interaction.law->elastic_limit() / factor,
                     history.opening);
        state.opening_max[i] = history.opening;
        if (!state.slip_max.empty())
          state.slip_max[i] = history.slip;
        state.beta[i] = beta_of(interaction, state.kind[i], factor, history);
      }
    }

    /** The intact springs of a block have a jump before they break. */
    bool has_springs(const InterfaceInput &block)
    {
      return (block.intact == IntactFaces::spring ||
              block.intact == IntactFaces::unilateral) &&
             (block.law_name == "elastic" ||
              (block.law && !block.law->extrinsic()));
    }

    /**
     * The jump at which the springs of a point carry the traction @p t, to
     * round-off: u = t / K(u) from the undamaged secants on, which grows until
     * it is the smallest solution. False if there is none before the peak.
     */
    template <int dim>
    bool find_jump(const InterfaceInput &block,
                   const OneStepProblem<dim> &problem, const std::size_t i,
                   const double *t, double *u)
    {
      const auto &interaction = problem.interactions[problem.interaction[i]];
      const double closing = block.intact == IntactFaces::spring
                                 ? t[0] / intact_stiffness<dim>(problem, i)
                                 : 0.; // contact carries it
      const auto open = [&](const Secant &secant) {
        u[0] = t[0] > 0. ? t[0] / secant.normal : closing;
        for (unsigned int c = 1; c < dim; ++c)
          u[c] = t[c] / secant.tangential;
      };
      if (!interaction.law) {
        const double C = interaction.normal_stiffness;
        open({C, C * interaction.stiffness_ratio});
        return true;
      }
      const LawPoint law(*interaction.law, problem.strength_factor[i],
                         problem.opening_factor[i], interaction.plateau,
                         interaction.stiffness_ratio, interaction.shear_weight);
      Reach reach;
      // as slow as this it is at its peak
      constexpr unsigned int most = 100000;
      for (unsigned int k = 0; k < most; ++k) {
        open(law.secant(reach));
        const Reach next = law.reach(JumpSize::of<dim>(u));
        if (past_peak(*interaction.law, problem.opening_factor[i], next))
          return false;
        const auto rests = [](const double a, const double b) {
          return std::abs(a - b) <= 1e-15 * b;
        };
        if (rests(reach.opening, next.opening) && rests(reach.slip, next.slip))
          return true;
        reach = next;
      }
      return false;
    }

    /** Stored in springs and cohesion, over the points of this rank. */
    template <int dim>
    std::vector<double> stored_energy(const OneStepProblem<dim> &problem,
                                      const State &state)
    {
      OneStepProblem<dim> start = problem;
      start.kind = state.kind;
      start.jump_old = state.jump;
      start.opening_max = state.opening_max;
      start.slip_max = state.slip_max;
      start.compression_stiffness.assign(problem.n_points, 0.);
      std::vector<double> stored(problem.n_owned, 0.);
      for (std::size_t i = 0; i < problem.n_owned; ++i) {
        if (!has_impulse(state.kind[i]))
          continue; // in the stiffness of the bodies, or nowhere
        if (state.two_sided[i])
          start.compression_stiffness[i] = intact_stiffness<dim>(problem, i);
        stored[i] = problem.weight[i] * stored_energy<dim>(start, i);
      }
      return stored;
    }

    template <int dim>
    double half_product(const DelassusOperator<dim> &delassus,
                        const typename DelassusOperator<dim>::Operator op,
                        const std::vector<double> &x)
    {
      if (!delassus.communicator().any(
              std::any_of(x.begin(), x.end(),
                          [](const double value) { return value != 0.; })))
        return 0.; // without a matrix
      std::vector<double> y(x.size());
      delassus.apply(op, x.data(), y.data());
      return delassus.communicator().dot(x.data(), y.data(), x.size()) / 2.;
    }
  } // namespace

  template <int dim>
  double initial_gap(const SceneInput &input,
                     const Discretization<dim> &discretization,
                     const std::size_t i)
  {
    const int obstacle = obstacle_of(input, discretization.origins()[i]);
    if (obstacle < 0)
      return 0.;
    const auto &points = discretization.points();
    double gap = 0.;
    for (unsigned int c = 0; c < dim; ++c)
      gap += points.axes(i)[c] * (points.position[i * dim + c] -
                                  input.obstacles[obstacle].point[c]);
    // what a body sticks to touches it: round-off of its place is none
    const bool sticks =
        discretization.origins()[i].kind == PointOrigin::Kind::interface;
    return sticks && std::abs(gap) <= touching * discretization.extent() ? 0.
                                                                         : gap;
  }

  template <int dim>
  void set_energies(const DelassusOperator<dim> &delassus,
                    const OneStepProblem<dim> &problem, State &state)
  {
    using Operator = typename DelassusOperator<dim>::Operator;
    auto &energy = state.energy;
    energy.kinetic = half_product(delassus, Operator::mass, state.velocity);
    energy.elastic =
        half_product(delassus, Operator::stiffness, state.displacement);
    energy.cohesive = stored_in_points(delassus.communicator(), problem, state);
  }

  template <int dim>
  void join_motion(JoinedDelassus<dim> &bonded, State &state)
  {
    const auto join = [&](std::vector<double> &motion,
                          std::vector<double> &jumps) {
      const std::vector<double> given = motion;
      if (!bonded.join_motion(motion))
        return;
      std::vector<double> change(motion.size()), jump(jumps.size());
      for (std::size_t k = 0; k < change.size(); ++k)
        change[k] = motion[k] - given[k];
      bonded.relative_velocity(change.data(), jump.data());
      for (std::size_t k = 0; k < jump.size(); ++k)
        jumps[k] += jump[k];
    };
    join(state.displacement, state.jump);
    join(state.velocity, state.relative_velocity);
  }

  template <int dim>
  State initial_state(const SceneInput &input,
                      const Discretization<dim> &discretization,
                      const DelassusOperator<dim> &delassus,
                      const OneStepProblem<dim> &problem,
                      JoinedDelassus<dim> *bonded)
  {
    State state = initial_motion(input, discretization);
    const std::size_t n = discretization.points().n_points;
    state.jump.assign(n * dim, 0.);
    state.relative_velocity.assign(n * dim, 0.);
    delassus.relative_velocity(state.displacement.data(), state.jump.data());
    delassus.relative_velocity(state.velocity.data(),
                               state.relative_velocity.data());
    add_initial_jumps(input, discretization, problem, delassus.communicator(),
                      state);
    set_points(input, discretization, problem, state);
    if (bonded) {
      hold_by_rows(problem, *bonded, state);
      bonded->set_bonds(bonded_points(state));
      join_motion(*bonded, state);
    }
    set_energies(delassus, problem, state);
    begin_balance(state);
    return state;
  }

  template <int dim>
  void add_initial_jumps(const SceneInput &input,
                         const Discretization<dim> &discretization,
                         const OneStepProblem<dim> &problem,
                         const Communicator &communicator, State &state)
  {
    const InitialStress<dim> *const initial =
        discretization.loads().initial_stress();
    if (!initial)
      return;
    const auto &origins = discretization.origins();
    std::string failure;
    for (std::size_t i = 0; i < origins.size(); ++i) {
      if (origins[i].kind != PointOrigin::Kind::interface)
        continue;
      const InterfaceInput &block = input.interfaces[origins[i].block];
      if (!has_springs(block) ||
          (block.has_broken &&
           block.broken.at(position_of(discretization.points(), i), 0.) != 0.))
        continue;
      const double *const t = initial->local_traction(i);
      std::array<double, dim> u;
      if (find_jump(block, problem, i, t, u.data())) {
        for (unsigned int c = 0; c < dim; ++c)
          state.jump[i * dim + c] += u[c];
      } else if (failure.empty())
        failure = fmt::format(
            "the initial stress puts {:.4g} Pa across and {:.4g} Pa along {}, "
            "which reaches the strength of the law {}: take a smaller initial "
            "stress, or write broken = true there",
            t[0], std::hypot(t[1], dim == 3 ? t[dim - 1] : 0.),
            name_of_point<dim>(input, origins, discretization.points().position,
                               i),
            block.law_name);
    }
    if (communicator.any(!failure.empty()))
      throw std::runtime_error(
          failure.empty() ? "the initial stress reaches the strength of a law"
                          : failure);
  }

  template <int dim>
  State initial_motion(const SceneInput &input,
                       const Discretization<dim> &discretization)
  {
    State state;
    state.displacement = initial_field(input, discretization,
                                       &MaterialInput::initial_displacement);
    state.velocity =
        initial_field(input, discretization, &MaterialInput::initial_velocity);
    return state;
  }

  void begin_balance(State &state)
  {
    const auto &energy = state.energy;
    state.initial_energy = energy.kinetic + energy.elastic + energy.cohesive;
    state.largest_energy = state.initial_energy;
  }

  template <int dim>
  double stored_in_points(const Communicator &communicator,
                          const OneStepProblem<dim> &problem,
                          const State &state)
  {
    return communicator.sum(stored_energy(problem, state));
  }

  template <int dim>
  void set_points(const SceneInput &input,
                  const Discretization<dim> &discretization,
                  const OneStepProblem<dim> &problem, State &state)
  {
    const std::size_t n = discretization.points().n_points;
    state.impulse.assign(n * dim, 0.);
    for_point_fields([&](const PointField &field, const auto member,
                         const auto born, const auto &) {
      if (field.life != PointField::Life::step && has_field(input, field))
        (state.*member).assign(n, born);
    });
    for (std::size_t i = 0; i < n; ++i) {
      const PointOrigin origin = discretization.origins()[i];
      switch (origin.kind) {
      case PointOrigin::Kind::interface:
        set_interface_point(input.interfaces[origin.block],
                            position_of(discretization.points(), i),
                            initial_gap(input, discretization, i), problem, i,
                            state);
        break;
      case PointOrigin::Kind::obstacle:
        state.jump[i * dim] += initial_gap(input, discretization, i);
        state.kind[i] = PointKind::free;
        state.beta[i] = 0.;
        break;
      default:
        break;
      }
    }
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template double initial_gap(const SceneInput &, const Discretization<dim> &, \
                              std::size_t);                                    \
  template void set_energies(const DelassusOperator<dim> &,                    \
                             const OneStepProblem<dim> &, State &);            \
  template void join_motion(JoinedDelassus<dim> &, State &);                   \
  template void add_initial_jumps(                                             \
      const SceneInput &, const Discretization<dim> &,                         \
      const OneStepProblem<dim> &, const Communicator &, State &);             \
  template State initial_motion(const SceneInput &,                            \
                                const Discretization<dim> &);                  \
  template double stored_in_points(                                            \
      const Communicator &, const OneStepProblem<dim> &, const State &);       \
  template void set_points(const SceneInput &, const Discretization<dim> &,    \
                           const OneStepProblem<dim> &, State &);              \
  template State initial_state(                                                \
      const SceneInput &, const Discretization<dim> &,                         \
      const DelassusOperator<dim> &, const OneStepProblem<dim> &,              \
      JoinedDelassus<dim> *)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
#undef NSFD_INSTANTIATE
} // namespace nsfd
