#include "step_data.h"

#include "cohesive_laws/stiffened_law.h"
#include "driven_motion.h"

#include "cohesive_laws/friction_weight.h"
#include "core/pages_of_zeros.h"
#include "discretization/point_factors.h"
#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace nsfd
{
  namespace
  {
    Interaction interaction_of(const InterfaceInput &block)
    {
      Interaction interaction;
      interaction.law = block.law;
      interaction.friction = block.friction;
      interaction.friction_exponent = block.friction_exponent;
      interaction.restitution = block.restitution;
      interaction.plateau = block.plateau;
      interaction.viscous_limit = block.viscous_limit;
      interaction.wear = block.sliding.wear;
      if (block.law) {
        interaction.stiffness_ratio = block.law->stiffness_ratio();
        interaction.shear_weight = block.law->shear_weight();
      } else if (block.law_name == "elastic") {
        interaction.normal_stiffness = block.normal_stiffness;
        interaction.stiffness_ratio =
            block.tangential_stiffness / block.normal_stiffness;
        interaction.shear_weight = interaction.stiffness_ratio;
      }
      return interaction;
    }

    /** Of an obstacle or of two surfaces. */
    template <typename Block>
    Interaction contact_of(const Block &block)
    {
      Interaction interaction;
      interaction.friction = block.friction;
      interaction.restitution = block.restitution;
      interaction.wear = block.sliding.wear;
      return interaction;
    }

    /** Of faces whose springs have a share of the compliance of the block. */
    Interaction stiffer(Interaction interaction, const double compliance)
    {
      if (interaction.law)
        interaction.law = with_compliance(interaction.law, compliance);
      else
        interaction.normal_stiffness /= compliance;
      return interaction;
    }

    /**
     * U_N that contact allows, without the forecast; everything relative to
     * where sliding has lifted the contact.
     */
    double contact_target(const TimeInput &time, const double restitution,
                          const double u_N, const double U_N,
                          const double jump_free, const double h)
    {
      switch (time.contact_target) {
      case ContactTarget::energy_safe:
        return U_N <= 0. ? -restitution * U_N
                         : -(1. - time.theta) / time.theta * U_N;
      case ContactTarget::velocity:
        return -restitution * U_N;
      case ContactTarget::position:
        return (std::min(0., u_N) - jump_free) / (h * time.theta);
      }
      return 0.;
    }

    /** Joints, springs in compression, contact by forecast. */
    template <int dim>
    void set_point(const TimeInput &time, const double extent, const State &old,
                   const std::size_t i, OneStepProblem<dim> &problem)
    {
      constexpr auto all_components = std::uint8_t((1u << dim) - 1u);
      const double h = problem.time_step;
      double lift = 0., lift_speed = 0.;
      if (!old.dilated.empty()) {
        lift = old.dilated[i] - old.worn[i];
        lift_speed = old.dilation_speed[i] - old.wear_speed[i];
      }
      const double u_N = old.jump[i * dim] - lift,
                   U_N = old.relative_velocity[i * dim] - lift_speed;
      const auto &interaction = problem.interactions[problem.interaction[i]];
      problem.contact[i] = 0;
      problem.mask[i] = 0;
      problem.compression_stiffness[i] = 0.;
      if (!has_impulse(old.kind[i])) {
        problem.kind[i] = PointKind::free; // without contact: no impulse
        return;
      }
      if (old.kind[i] == PointKind::rigid) {
        // joined until activate() finds that the strength is reached
        problem.kind[i] = PointKind::prescribed;
        problem.mask[i] = all_components;
        for (unsigned int c = 0; c < dim; ++c) {
          problem.given_velocity[i * dim + c] = 0.;
          // The law counts from where the joint is released, not from its
          // drift. What a solver has left of its velocity is no slip either: a
          // law that began there would hold more than the strength on one side.
          double &free = problem.jump_free[i * dim + c];
          free = old.last_step > 0. ? 0. : free - old.jump[i * dim + c];
          problem.jump_old[i * dim + c] = 0.;
        }
      }
      if (old.kind[i] == PointKind::prescribed)
        problem.mask[i] = all_components;
      else if (old.two_sided[i]) {
        problem.compression_stiffness[i] = intact_stiffness<dim>(problem, i);
      } else {
        // A closed point must not open by what the solver left of its position;
        // one without restitution stays a candidate as long as it rests.
        const bool rests = old.contact[i] && interaction.restitution == 0.;
        // What has been joined is closed, wherever it has drifted to: without
        // contact it would lose what it carries as soon as it slides.
        problem.contact[i] = old.kind[i] == PointKind::rigid ||
                             u_N + h * time.forecast_gamma1 * U_N <=
                                 (rests ? 1e-9 : 1e-14) * extent;
        // restitution belongs to broken points
        const double e =
            old.kind[i] == PointKind::free ? interaction.restitution : 0.;
        problem.target[i] =
            contact_target(time, e, u_N, U_N,
                           problem.jump_free[i * dim] - lift -
                               h * (1. - time.theta) * lift_speed,
                           h);
      }
    }

    /** Of points that were not broken before the step. */
    template <int dim>
    void set_viscosity(const SceneInput &input,
                       const std::vector<PointOrigin> &origins,
                       const State &old, OneStepProblem<dim> &problem)
    {
      for (std::size_t i = 0; i < origins.size() && !problem.viscosity.empty();
           ++i) {
        const PointOrigin origin = origins[i];
        if (origin.kind != PointOrigin::Kind::interface)
          continue;
        const auto &block = input.interfaces[origin.block];
        problem.viscosity[i] =
            old.beta[i] > block.broken_beta() ? block.opening_viscosity : 0.;
      }
    }

    /**
     * Strength, toughness and friction at the temperatures before the step:
     * what friction dissipates in it is the heat of the step, to the last bit.
     */
    template <int dim>
    void set_warm_laws(const SceneInput &input,
                       const Discretization<dim> &discretization,
                       const std::vector<PointOrigin> &origins,
                       const HeatState &heat, OneStepProblem<dim> &problem)
    {
      if (heat.at_faces.empty())
        return;
      const auto &points = discretization.points();
      for (std::size_t i = 0; i < origins.size(); ++i) {
        const PointOrigin &origin = origins[i];
        if (!problem.friction_factor.empty())
          problem.friction_factor[i] =
              friction_factor(input, origin, heat.at_faces[i]);
        if (origin.kind != PointOrigin::Kind::interface)
          continue;
        const auto &block = input.interfaces[origin.block];
        if (!block.heat.changes_law())
          continue;
        const PointFactors cold = point_factors<dim>(
            block, &points.position[i * dim], discretization.extent());
        const PointFactors warm = warm_factors(block, heat.of_laws[i]);
        problem.strength_factor[i] = cold.strength * warm.strength;
        problem.opening_factor[i] =
            problem.strength_factor[i] / (cold.toughness * warm.toughness);
      }
    }

    const SlidingInput *sliding_of(const SceneInput &input,
                                   const PointOrigin &origin)
    {
      switch (origin.kind) {
      case PointOrigin::Kind::interface:
        return &input.interfaces[origin.block].sliding;
      case PointOrigin::Kind::obstacle:
        return &input.obstacles[origin.block].sliding;
      default:
        return nullptr;
      }
    }

    /** As much as friction is there already: kappa(beta). */
    template <int dim>
    void set_dilatancy(const SceneInput &input,
                       const std::vector<PointOrigin> &origins,
                       const State &old, OneStepProblem<dim> &problem)
    {
      for (std::size_t i = 0; i < origins.size() && !problem.dilatancy.empty();
           ++i) {
        const SlidingInput *sliding = sliding_of(input, origins[i]);
        if (sliding == nullptr || sliding->dilatancy == 0.)
          continue;
        const auto &interaction = problem.interactions[problem.interaction[i]];
        problem.lift_left[i] =
            std::max(0., sliding->saturation - old.dilated[i] -
                             problem.time_step * (1. - problem.theta) *
                                 old.dilation_speed[i]);
        problem.dilatancy[i] =
            problem.lift_left[i] > 0.
                ? sliding->dilatancy *
                      kappa(old.beta[i], interaction.friction_exponent)
                : 0.;
      }
    }

    /** Velocities of driven boundaries at the end of the step. */
    template <int dim>
    void set_motion(const DrivenMotion<dim> &motion,
                    const Discretization<dim> &discretization, const State &old,
                    OneStepProblem<dim> &problem)
    {
      const double h = problem.time_step, t = old.time + h;
      const auto &origins = discretization.origins();
      const auto &points = discretization.points();
      for (std::size_t j = 0; j < origins.size(); ++j) {
        if (origins[j].kind != PointOrigin::Kind::motion)
          continue;
        const std::size_t i = point_of_step(j, points.n_owned,
                                            problem.n_points - points.n_points);
        problem.mask[i] = 0;
        for (unsigned int c = 0; c < dim; ++c) {
          if (!motion.drives(j, c))
            continue;
          double &given = problem.given_velocity[i * dim + c];
          if (const Expression *velocity = motion.velocity(j, c))
            given = motion.velocity_at(*velocity, j, t, old.clock);
          else if (const Expression *displacement = motion.displacement(j, c))
            // back to the path: what the last step missed is made up for
            given = (motion.place_at(*displacement, j, t, old.clock) -
                     old.jump[i * dim + c]) /
                    h;
          problem.mask[i] |= std::uint8_t(1u << c);
        }
      }
    }

    /** Largest row sums of the diagonal blocks of W, point by point. */
    template <int dim>
    void set_majorants(const DelassusOperator<dim> &delassus,
                       OneStepProblem<dim> &problem)
    {
      for (std::size_t i = 0; i < delassus.points().n_points; ++i) {
        const double *W = delassus.point_block(i);
        double normal = 0., tangential = 0.;
        for (unsigned int r = 0; r < dim; ++r) {
          double sum = 0.;
          for (unsigned int c = 0; c < dim; ++c)
            sum += std::abs(W[r * dim + c]);
          double &largest = r == 0 ? normal : tangential;
          largest = std::max(largest, sum);
        }
        problem.majorant_normal[i] = normal;
        problem.majorant_tangential[i] = tangential;
      }
    }
  } // namespace

  template <int dim>
  double intact_stiffness(const OneStepProblem<dim> &problem,
                          const std::size_t i)
  {
    const auto &interaction = problem.interactions[problem.interaction[i]];
    return interaction.law
               ? problem.strength_factor[i] * problem.opening_factor[i] *
                     interaction.law->normal_stiffness()
               : interaction.normal_stiffness;
  }

  template <int dim>
  OneStepProblem<dim> constant_data(const SceneInput &input,
                                    const Discretization<dim> &discretization)
  {
    auto constants = point_constants(input, discretization);
    OneStepProblem<dim> problem;
    resize(problem, constants.n_points);
    // in a run of equilibria those of its motions are never filled
    for (const auto member :
         {&OneStepProblem<dim>::free_velocity,
          &OneStepProblem<dim>::given_velocity, &OneStepProblem<dim>::jump_old,
          &OneStepProblem<dim>::jump_free, &OneStepProblem<dim>::sliding_offset,
          &OneStepProblem<dim>::opening_max,
          &OneStepProblem<dim>::compression_stiffness,
          &OneStepProblem<dim>::target, &OneStepProblem<dim>::majorant_normal,
          &OneStepProblem<dim>::majorant_tangential})
      release_pages_of_zeros(problem.*member);
    problem.n_owned = constants.n_owned;
    problem.theta = constants.theta;
    problem.rule = constants.rule;
    problem.interactions.swap(constants.interactions);
    problem.interaction.swap(constants.interaction);
    for (const auto member :
         {&OneStepProblem<dim>::weight, &OneStepProblem<dim>::strength_factor,
          &OneStepProblem<dim>::opening_factor,
          &OneStepProblem<dim>::friction_factor,
          &OneStepProblem<dim>::viscosity, &OneStepProblem<dim>::dilatancy,
          &OneStepProblem<dim>::lift_left})
      (problem.*member).swap(constants.*member);
    return problem;
  }

  template <int dim>
  OneStepProblem<dim> point_constants(const SceneInput &input,
                                      const Discretization<dim> &discretization)
  {
    const auto &points = discretization.points();
    OneStepProblem<dim> problem;
    problem.n_points = points.n_points;
    problem.interaction.assign(points.n_points, 0);
    problem.strength_factor.assign(points.n_points, 1.);
    problem.opening_factor = problem.strength_factor;
    problem.n_owned = points.n_owned;
    problem.weight = points.weight;
    problem.theta = input.time.theta;
    problem.rule = input.time.cohesion_rule;

    // one interaction per interface block, then per obstacle, then a support,
    // then per contact of surfaces, then those of blocks with stiffer springs
    for (const auto &block : input.interfaces)
      problem.interactions.push_back(interaction_of(block));
    for (const auto &obstacle : input.obstacles)
      problem.interactions.push_back(contact_of(obstacle));
    const auto support = unsigned(problem.interactions.size());
    problem.interactions.emplace_back();
    for (const auto &contact : input.contacts)
      problem.interactions.push_back(contact_of(contact));
    std::map<std::pair<unsigned int, double>, unsigned int> stiffer_ones;

    if (has_warm_friction(input))
      problem.friction_factor.assign(points.n_points, 1.);
    if (has_opening_viscosity(input))
      problem.viscosity.assign(points.n_points, 0.);
    if (has_sliding_lift(input)) {
      problem.dilatancy.assign(points.n_points, 0.);
      problem.lift_left.assign(points.n_points, 0.);
    }
    for (std::size_t i = 0; i < points.n_points; ++i) {
      const PointOrigin origin = discretization.origins()[i];
      switch (origin.kind) {
      case PointOrigin::Kind::interface: {
        problem.interaction[i] = origin.block;
        if (origin.compliance != 1.) {
          const auto [place, is_new] =
              stiffer_ones.emplace(std::pair(origin.block, origin.compliance),
                                   unsigned(problem.interactions.size()));
          if (is_new)
            problem.interactions.push_back(
                stiffer(problem.interactions[origin.block], origin.compliance));
          problem.interaction[i] = place->second;
        }
        const PointFactors factors = point_factors<dim>(
            input.interfaces[origin.block], &points.position[i * dim],
            discretization.extent());
        problem.strength_factor[i] = factors.strength;
        problem.opening_factor[i] = factors.strength / factors.toughness;
        break;
      }
      case PointOrigin::Kind::obstacle:
        problem.interaction[i] =
            unsigned(input.interfaces.size()) + origin.block;
        break;
      case PointOrigin::Kind::motion:
        problem.interaction[i] = support;
        break;
      case PointOrigin::Kind::surface:
      case PointOrigin::Kind::pin:
        break; // of single steps only
      }
    }
    return problem;
  }

  template <int dim>
  void set_step(const SceneInput &input,
                const Discretization<dim> &discretization,
                const std::vector<PointOrigin> &origins,
                const DelassusOperator<dim> &delassus,
                const DrivenMotion<dim> &motion, const State &old,
                const double h, OneStepProblem<dim> &problem)
  {
    problem.time_step = h;
    problem.kind = old.kind;
    problem.opening_max = old.opening_max;
    problem.slip_max = old.slip_max;
    problem.jump_old = old.jump;
    for (std::size_t k = 0; k < old.jump.size(); ++k)
      problem.jump_free[k] =
          old.jump[k] + h * (1. - input.time.theta) * old.relative_velocity[k];
    set_warm_laws(input, discretization, origins, old.heat, problem);
    problem.acting.clear();
    const auto parting = delassus.parting();
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      if (has_impulse(old.kind[i]) && parting[i])
        problem.acting.push_back(unsigned(i));
      set_point(input.time, discretization.extent(), old, i, problem);
    }
    set_viscosity(input, origins, old, problem);
    set_dilatancy(input, origins, old, problem);
    set_motion(motion, discretization, old, problem);
    set_majorants(delassus, problem);
  }

  template double intact_stiffness(const OneStepProblem<2> &, std::size_t);
  template double intact_stiffness(const OneStepProblem<3> &, std::size_t);
  template OneStepProblem<2> constant_data(const SceneInput &,
                                           const Discretization<2> &);
  template OneStepProblem<3> constant_data(const SceneInput &,
                                           const Discretization<3> &);
  template OneStepProblem<2> point_constants(const SceneInput &,
                                             const Discretization<2> &);
  template OneStepProblem<3> point_constants(const SceneInput &,
                                             const Discretization<3> &);
  template void set_step(const SceneInput &, const Discretization<2> &,
                         const std::vector<PointOrigin> &,
                         const DelassusOperator<2> &, const DrivenMotion<2> &,
                         const State &, double, OneStepProblem<2> &);
  template void set_step(const SceneInput &, const Discretization<3> &,
                         const std::vector<PointOrigin> &,
                         const DelassusOperator<3> &, const DrivenMotion<3> &,
                         const State &, double, OneStepProblem<3> &);
} // namespace nsfd
