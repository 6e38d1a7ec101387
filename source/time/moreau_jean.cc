#include "nsfd/time/moreau_jean.h"

#include "nsfd/input/scene_input.h"
#include "nsfd/interface/scatter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>

namespace nsfd
{
  namespace
  {
    double cpu_seconds()
    {
      timespec t;
      clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
      return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
    }

    /** Adds the CPU time of a scope to a line of the table. */
    class Stopwatch
    {
    public:
      explicit Stopwatch(double &line)
        : line_(line)
        , start_(cpu_seconds())
      {}
      ~Stopwatch() { line_ += cpu_seconds() - start_; }

    private:
      double &line_;
      double start_;
    };

    /** Largest eigenvalue of a small symmetric positive semi-definite block. */
    double largest_eigenvalue(const std::vector<double> &A,
                              const unsigned int n)
    {
      std::vector<double> x(n), y(n);
      for (unsigned int i = 0; i < n; ++i)
        x[i] = 1. + 0.1 * i;
      double value = 0.;
      for (unsigned int k = 0; k < 60; ++k) {
        double norm = 0.;
        for (unsigned int i = 0; i < n; ++i) {
          y[i] = 0.;
          for (unsigned int j = 0; j < n; ++j)
            y[i] += A[i * n + j] * x[j];
          norm += y[i] * y[i];
        }
        norm = std::sqrt(norm);
        if (norm == 0.)
          return 0.;
        value = norm;
        for (unsigned int i = 0; i < n; ++i)
          x[i] = y[i] / norm;
      }
      return value;
    }
  } // namespace

  template <int dim>
  MoreauJean<dim>::MoreauJean(const SceneInput &input,
                              const Discretization<dim> &discretization,
                              Dynamics<dim> &dynamics,
                              NonsmoothSolver<dim> &solver)
    : input_(input)
    , discretization_(discretization)
    , dynamics_(dynamics)
    , solver_(solver)
  {
    set_up_points();
    forces_.assign(discretization.bodies().n_dofs(), 0.);
    reactions_.assign(discretization.driven_boundaries().size() * dim, 0.);
  }

  template <int dim>
  void MoreauJean<dim>::set_up_points()
  {
    const auto &points = discretization_.points();
    auto &problem = problem_;
    problem.resize(points.n_points);
    problem.n_owned = points.n_owned;
    problem.weight = points.weight;
    problem.theta = input_.time.theta;
    problem.rule = input_.time.cohesion_rule;

    // one interaction per interface block, then per obstacle, then a support
    for (const auto &block : input_.interfaces) {
      Interaction interaction;
      interaction.law = block.law;
      interaction.friction = block.friction;
      interaction.friction_exponent = block.friction_exponent;
      interaction.restitution = block.restitution;
      if (block.law) {
        interaction.stiffness_ratio = block.law->stiffness_ratio();
        interaction.shear_weight = block.law->shear_weight();
      } else if (block.law_name == "elastic") {
        interaction.normal_stiffness = block.normal_stiffness;
        interaction.stiffness_ratio =
          block.tangential_stiffness / block.normal_stiffness;
        interaction.shear_weight = interaction.stiffness_ratio;
      }
      problem.interactions.push_back(interaction);
    }
    for (const auto &obstacle : input_.obstacles) {
      Interaction interaction;
      interaction.friction = obstacle.friction;
      interaction.restitution = obstacle.restitution;
      problem.interactions.push_back(interaction);
    }
    problem.interactions.emplace_back();

    strength_factor_.assign(points.n_points, 1.);
    initial_gap_.assign(points.n_points, 0.);
    for (std::size_t i = 0; i < points.n_points; ++i) {
      const PointOrigin origin = discretization_.origins()[i];
      const double *x = points.position.data() + i * dim;
      if (origin.kind == PointOrigin::Kind::interface) {
        problem.interaction[i] = origin.block;
        const auto &block = input_.interfaces[origin.block];
        if (block.strength_scatter > 0.) {
          std::array<double, 3> scaled{};
          for (unsigned int c = 0; c < dim; ++c)
            scaled[c] = x[c] / discretization_.extent();
          strength_factor_[i] =
            scatter_uniform(block.seed, scaled, block.strength_scatter);
        }
      } else if (origin.kind == PointOrigin::Kind::obstacle) {
        problem.interaction[i] =
          unsigned(input_.interfaces.size()) + origin.block;
        const auto &obstacle = input_.obstacles[origin.block];
        for (unsigned int c = 0; c < dim; ++c)
          initial_gap_[i] +=
            points.frame[i * dim * dim + c] * (x[c] - obstacle.point[c]);
      } else
        problem.interaction[i] = unsigned(problem.interactions.size()) - 1;
    }
    problem.strength_factor = strength_factor_;

    // flexibility w (lambda_1 + lambda_2) of the faces that can soften, with
    // the mass alone: an upper bound for every step
    flexibility_.assign(points.faces.size(), 0.);
    bool softens = false;
    for (const auto &block : input_.interfaces)
      if (block.law) {
        softens = true;
        has_extrinsic_ |= block.law->extrinsic();
      }
    if (!softens)
      return;
    const auto &bodies = discretization_.bodies();
    std::vector<Block> delassus(bodies.classes.size());
    for (std::size_t k = 0; k < delassus.size(); ++k)
      delassus[k] =
        gram(forward_solve(cholesky(bodies.classes[k].mass),
                           bodies.classes[k].trace.transposed()));
    std::array<std::vector<double>, 2> sides;
    for (auto &side : sides)
      side.assign(points.n_points, 0.);
    // congruent bodies with points at the same slots share the value
    std::map<std::pair<unsigned int, std::vector<unsigned int>>, double> known;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Block &W = delassus[bodies.class_of[b]];
      std::vector<unsigned int> slots, places;
      for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
           ++s)
        if (bodies.slot_point[s] < points.n_points) {
          slots.push_back(unsigned(s - bodies.first_slot[b]));
          places.push_back(bodies.slot_point[s]);
        }
      const auto [entry, is_new] =
        known.emplace(std::pair(bodies.class_of[b], slots), 0.);
      if (is_new) {
        const unsigned int n = unsigned(slots.size()) * dim;
        std::vector<double> A(std::size_t(n) * n);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            A[std::size_t(i) * n + j] =
              std::sqrt(points.weight[places[i / dim]] *
                        points.weight[places[j / dim]]) *
              W(slots[i / dim] * dim + i % dim, slots[j / dim] * dim + j % dim);
        entry->second = largest_eigenvalue(A, n);
      }
      for (const unsigned int i : places)
        sides[points.faces[points.face_of[i]].bodies[1] == int(b)][i] =
          entry->second;
    }
    dynamics_.exchange({{sides[0].data(), sides[1].data()}}, 1);
    for (std::size_t f = 0; f < points.faces.size(); ++f)
      flexibility_[f] =
        sides[0][points.faces[f].first] + sides[1][points.faces[f].first];
  }

  template <int dim>
  State MoreauJean<dim>::initial_state() const
  {
    const auto &points = discretization_.points();
    State state;
    const auto component = [&](const auto &member) {
      return [&](const dealii::Point<dim> &x, const unsigned int body,
                 double *value) {
        const auto &material =
          input_.materials[discretization_.material_of(body)];
        for (unsigned int c = 0; c < dim; ++c)
          value[c] = (material.*member)[c].at(x, 0.);
      };
    };
    state.displacement = discretization_.interpolate(
      component(&MaterialInput::initial_displacement));
    state.velocity = discretization_.interpolate(
      component(&MaterialInput::initial_velocity));

    const std::size_t n = points.n_points;
    state.jump.assign(n * dim, 0.);
    state.relative_velocity.assign(n * dim, 0.);
    dynamics_.relative_velocity(state.displacement.data(), state.jump.data());
    dynamics_.relative_velocity(state.velocity.data(),
                                state.relative_velocity.data());
    state.impulse.assign(n * dim, 0.);
    state.opening_max.assign(n, 0.);
    state.beta.assign(n, 1.);
    state.slip.assign(n, 0.);
    state.penetration_bound.assign(n, 0.);
    state.kind.assign(n, PointKind::prescribed);
    state.two_sided.assign(n, 0);
    state.contact.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      state.jump[i * dim] += initial_gap_[i];
      const PointOrigin origin = discretization_.origins()[i];
      if (origin.kind == PointOrigin::Kind::motion)
        continue;
      if (origin.kind == PointOrigin::Kind::obstacle) {
        state.kind[i] = PointKind::free;
        state.beta[i] = 0.;
        continue;
      }
      const auto &block = input_.interfaces[origin.block];
      dealii::Point<dim> x;
      for (unsigned int c = 0; c < dim; ++c)
        x[c] = points.position[i * dim + c];
      if (block.law_name == "contact" ||
          (block.has_broken && block.broken.at(x, 0.) != 0.)) {
        state.kind[i] = PointKind::free;
        state.beta[i] = 0.;
      } else if (block.law_name == "elastic") {
        state.kind[i] = PointKind::elastic;
        state.two_sided[i] = block.intact == IntactFaces::spring;
      } else if (block.law) {
        state.kind[i] =
          block.law->extrinsic() ? PointKind::rigid : PointKind::cohesive;
        state.two_sided[i] =
          !block.law->extrinsic() && block.intact == IntactFaces::spring;
        if (!block.law->extrinsic()) {
          // below the elastic limit there is nothing to remember
          state.opening_max[i] =
            // (just below, so that round-off does not damage it)
            std::max((1. - 1e-14) * block.law->elastic_limit() /
                       strength_factor_[i],
                     effective_opening<dim>(
                       problem_.interactions[origin.block],
                       &state.jump[i * dim]));
          state.beta[i] =
            beta_of(problem_.interactions[origin.block], state.kind[i],
                    strength_factor_[i], state.opening_max[i]);
        }
      }
    }

    // energies at t = 0
    std::vector<double> y(state.velocity.size());
    const auto quadratic = [&](const typename Dynamics<dim>::Operator op,
                               const std::vector<double> &x) {
      dynamics_.apply(op, x.data(), y.data());
      return dynamics_.communicator().dot(x.data(), y.data(), x.size()) / 2.;
    };
    state.energy.kinetic =
      quadratic(Dynamics<dim>::Operator::mass, state.velocity);
    state.energy.elastic =
      quadratic(Dynamics<dim>::Operator::stiffness, state.displacement);
    std::vector<double> stored(points.n_owned, 0.);
    for (std::size_t i = 0; i < points.n_owned; ++i)
      if (state.kind[i] == PointKind::elastic ||
          state.kind[i] == PointKind::cohesive) {
        const auto &interaction =
          problem_.interactions[problem_.interaction[i]];
        const double f = strength_factor_[i];
        const double b =
          interaction.law
            ? f * f * interaction.law->secant(f * state.opening_max[i])
            : interaction.normal_stiffness;
        const double *u = &state.jump[i * dim];
        double slip = 0.;
        for (unsigned int c = 1; c < dim; ++c)
          slip += u[c] * u[c];
        const double normal =
          u[0] > 0. || state.two_sided[i] ? u[0] * u[0] : 0.;
        stored[i] = points.weight[i] * b *
                    (normal + interaction.stiffness_ratio * slip) / 2.;
      }
    state.energy.cohesive = dynamics_.communicator().sum(stored);
    state.initial_energy = state.energy.kinetic + state.energy.elastic +
                           state.energy.cohesive;
    state.largest_energy = state.initial_energy;
    return state;
  }

  template <int dim>
  void MoreauJean<dim>::prepare(const State &old, const double h)
  {
    const auto &points = discretization_.points();
    auto &problem = problem_;
    const double theta = input_.time.theta;
    problem.time_step = h;
    problem.kind = old.kind;
    problem.opening_max = old.opening_max;
    problem.jump_old = old.jump;
    for (std::size_t k = 0; k < old.jump.size(); ++k)
      problem.jump_free[k] =
        old.jump[k] + h * (1. - theta) * old.relative_velocity[k];

    for (std::size_t i = 0; i < points.n_points; ++i) {
      const double u_N = old.jump[i * dim],
                   U_N = old.relative_velocity[i * dim];
      problem.contact[i] = 0;
      problem.mask[i] = 0;
      problem.compression_stiffness[i] = 0.;
      const auto &interaction = problem.interactions[problem.interaction[i]];
      if (old.kind[i] == PointKind::rigid) {
        // joined until activate() finds that the strength is reached
        problem.kind[i] = PointKind::prescribed;
        problem.mask[i] = (1u << dim) - 1u;
        for (unsigned int c = 0; c < dim; ++c) {
          problem.given_velocity[i * dim + c] = 0.;
          // the law counts from where the joint lets go, not from its drift
          problem.jump_free[i * dim + c] -= old.jump[i * dim + c];
          problem.jump_old[i * dim + c] = 0.;
        }
      }
      if (old.kind[i] == PointKind::prescribed)
        problem.mask[i] = (1u << dim) - 1u;
      else if (old.two_sided[i])
        problem.compression_stiffness[i] =
          interaction.law ? strength_factor_[i] * strength_factor_[i] *
                              interaction.law->normal_stiffness()
                          : interaction.normal_stiffness;
      else {
        // A closed point must not open by what the solver left of its position;
        // one without restitution stays a candidate as long as it rests.
        const bool rests = old.contact[i] && interaction.restitution == 0.;
        problem.contact[i] = u_N + h * input_.time.forecast_gamma1 * U_N <=
                             (rests ? 1e-9 : 1e-14) * discretization_.extent();
        // restitution belongs to broken points
        const double e =
          old.kind[i] == PointKind::free ? interaction.restitution : 0.;
        switch (input_.time.contact_target) {
        case ContactTarget::energy_safe:
          problem.target[i] =
            U_N <= 0. ? -e * U_N : -(1. - theta) / theta * U_N;
          break;
        case ContactTarget::velocity: problem.target[i] = -e * U_N; break;
        case ContactTarget::position:
          problem.target[i] =
            (std::min(0., u_N) - problem.jump_free[i * dim]) / (h * theta);
          break;
        }
      }
      if (input_.time.sliding == Sliding::increment)
        for (unsigned int c = 1; c < dim; ++c)
          problem.sliding_offset[i * dim + c] =
            (1. - theta) / theta * old.relative_velocity[i * dim + c];
    }

    // prescribed motion at the end of the step
    const double t = old.time + h;
    for (std::size_t i = 0; i < points.n_points; ++i) {
      const PointOrigin origin = discretization_.origins()[i];
      if (origin.kind != PointOrigin::Kind::motion)
        continue;
      const auto &boundary = input_.boundaries[origin.block];
      dealii::Point<dim> x;
      for (unsigned int c = 0; c < dim; ++c)
        x[c] = points.position[i * dim + c];
      problem.mask[i] = 0;
      for (unsigned int c = 0; c < dim; ++c) {
        double &given = problem.given_velocity[i * dim + c];
        if (boundary.velocity[c])
          given = boundary.velocity[c]->at(x, t);
        else if (boundary.displacement[c])
          // back to the path: what the last step missed is made up for
          given =
            (boundary.displacement[c]->at(x, t) - old.jump[i * dim + c]) / h;
        else
          continue;
        problem.mask[i] |= std::uint8_t(1u << c);
      }
    }

    // majorants of the diagonal blocks of W
    for (std::size_t f = 0; f < points.faces.size(); ++f) {
      const auto &face = points.faces[f];
      const unsigned int n = face.count * dim;
      const double *W = dynamics_.face_block(f);
      for (unsigned int p = 0; p < face.count; ++p) {
        double normal = 0., tangential = 0.;
        for (unsigned int r = 0; r < dim; ++r) {
          double sum = 0.;
          for (unsigned int c = 0; c < dim; ++c)
            sum += std::abs(W[(p * dim + r) * n + p * dim + c]);
          (r == 0 ? normal : tangential) =
            std::max(r == 0 ? normal : tangential, sum);
        }
        problem.majorant_normal[face.first + p] = normal;
        problem.majorant_tangential[face.first + p] = tangential;
      }
    }
  }

  template <int dim>
  StepReport
  MoreauJean<dim>::advance(const State &old, const double h, State &next)
  {
    const double theta = input_.time.theta;
    StepReport report;
    const std::size_t n_dofs = discretization_.bodies().n_dofs();
    {
      const Stopwatch watch(timings_.assembly);
      dynamics_.reinit(h, theta);
      prepare(old, h);

      // v_free = v_k + M_hat^{-1} h (F - K (q_k + h theta v_k))
      if (discretization_.has_loads() &&
          (!forces_known_ || (discretization_.loads_depend_on_time() &&
                              forces_time_ != old.time + theta * h))) {
        std::fill(forces_.begin(), forces_.end(), 0.);
        discretization_.add_loads(old.time + theta * h, forces_);
        forces_known_ = true;
        forces_time_ = old.time + theta * h;
        ++counters_.load_assemblies;
      }
      work_.resize(n_dofs);
      v_free_.resize(n_dofs);
      for (std::size_t i = 0; i < n_dofs; ++i)
        v_free_[i] = old.displacement[i] + h * theta * old.velocity[i];
      dynamics_.apply(Dynamics<dim>::Operator::stiffness, v_free_.data(),
                      work_.data());
      for (std::size_t i = 0; i < n_dofs; ++i)
        work_[i] = h * (forces_[i] - work_[i]);
      dynamics_.apply(Dynamics<dim>::Operator::inverse, work_.data(),
                      v_free_.data());
      for (std::size_t i = 0; i < n_dofs; ++i)
        v_free_[i] += old.velocity[i];
      dynamics_.relative_velocity(v_free_.data(),
                                  problem_.free_velocity.data());
    }

    next.impulse = old.impulse;
    // kinetic energies before the impulses: the scale of round-off
    dynamics_.apply(Dynamics<dim>::Operator::mass, v_free_.data(),
                    work_.data());
    const double energy_scale =
      2. * old.energy.kinetic +
      dynamics_.communicator().dot(v_free_.data(), work_.data(), n_dofs);
    LawEvaluation<dim> evaluation(problem_, dynamics_, energy_scale,
                                  input_.solver.tolerance);
    {
      const Stopwatch watch(timings_.solve);
      SolverControl control;
      control.tolerance = input_.solver.tolerance;
      control.maximum_iterations = input_.solver.maximum_iterations;
      for (unsigned int round = 0;; ++round) {
        const SolverReport part =
          solver_.solve(problem_, dynamics_, energy_scale, control,
                        next.impulse, evaluation);
        report.solver.newton += part.newton;
        report.solver.krylov += part.krylov;
        report.solver.sweeps += part.sweeps;
        report.solver.line_searches += part.line_searches;
        report.solver.residual = part.residual;
        report.solver.converged = part.converged;
        report.solver.switches.insert(report.solver.switches.end(),
                                      part.switches.begin(),
                                      part.switches.end());
        ++counters_.solves;
        if (!part.converged || !has_extrinsic_ || round > 30 ||
            !activate(next.impulse))
          break;
        ++counters_.activation_rounds;
      }
      counters_.newton += report.solver.newton;
      counters_.krylov += report.solver.krylov;
      counters_.sweeps += report.solver.sweeps;
      counters_.law_sweeps += evaluation.law_calls;
      counters_.line_searches += report.solver.line_searches;
    }
    if (!report.solver.converged)
      throw StepRejected(fmt::format(
        "the step of {:.4g} at t = {:.6g} was not solved: residual {:.2e} "
        "after {} Newton steps and {} sweeps; worst face {}",
        h, old.time, report.solver.residual, report.solver.newton,
        report.solver.sweeps, describe(evaluation.worst_point)));

    {
      const Stopwatch watch(timings_.update);
      next.step = old.step + 1;
      next.time = old.time + h;
      next.velocity = v_free_;
      dynamics_.add_velocity_change(next.impulse.data(), next.velocity.data());
      next.displacement.resize(n_dofs);
      for (std::size_t i = 0; i < n_dofs; ++i)
        next.displacement[i] =
          old.displacement[i] +
          h * (theta * next.velocity[i] + (1. - theta) * old.velocity[i]);
      next.relative_velocity = evaluation.velocity;
      next.jump.resize(old.jump.size());
      for (std::size_t k = 0; k < old.jump.size(); ++k)
        next.jump[k] =
          problem_.jump_free[k] + h * theta * evaluation.velocity[k];
    }
    const Stopwatch watch(timings_.ledger);
    book(old, next, h, evaluation, report);
    return report;
  }

  /**
   * Let go of rigidly joined extrinsic points whose traction exceeds the
   * strength; true if there was one. Rigid rows on neighbouring faces make
   * tractions ambiguous (W is singular, one condition per loop around a
   * vertex): what counts is the impulse of least norm on the joined rows with
   * the same effect, W^+ W P, by conjugate gradients from zero.
   */
  template <int dim>
  bool MoreauJean<dim>::activate(const std::vector<double> &impulse)
  {
    const auto &communicator = dynamics_.communicator();
    auto &problem = problem_;
    const std::size_t n = problem.n_points * dim,
                      n_owned = problem.n_owned * dim;
    std::vector<double> P(n, 0.), x(n, 0.), r(n), p(n), Wp(n);
    const auto joined = [&](const std::size_t k) {
      return problem.mask[k / dim] & (1u << (k % dim)) &&
             problem.kind[k / dim] == PointKind::prescribed;
    };
    bool candidates = false;
    for (std::size_t k = 0; k < n; ++k)
      if (joined(k)) {
        P[k] = impulse[k];
        candidates |= discretization_.origins()[k / dim].kind ==
                        PointOrigin::Kind::interface &&
                      problem.interactions[problem.interaction[k / dim]].law;
      }
    if (!communicator.any(candidates))
      return false;
    const auto apply = [&](const std::vector<double> &in,
                           std::vector<double> &out) {
      dynamics_.apply_delassus(in.data(), out.data());
      for (std::size_t k = 0; k < n; ++k)
        if (!joined(k))
          out[k] = 0.;
    };
    apply(P, r);
    p = r;
    double rr = communicator.dot(r.data(), r.data(), n_owned);
    const double goal = 1e-20 * rr;
    for (unsigned int k = 0; k < 1000 && rr > goal; ++k) {
      apply(p, Wp);
      const double pWp = communicator.dot(p.data(), Wp.data(), n_owned);
      if (!(pWp > 0.))
        break;
      for (std::size_t j = 0; j < n; ++j) {
        x[j] += rr / pWp * p[j];
        r[j] -= rr / pWp * Wp[j];
      }
      const double next = communicator.dot(r.data(), r.data(), n_owned);
      for (std::size_t j = 0; j < n; ++j)
        p[j] = r[j] + next / rr * p[j];
      rr = next;
    }

    bool any = false;
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      const auto &interaction = problem.interactions[problem.interaction[i]];
      if (!joined(i * dim) || !interaction.law ||
          discretization_.origins()[i].kind != PointOrigin::Kind::interface)
        continue;
      const double pull = std::max(0., -x[i * dim]);
      double traction = pull * pull;
      for (unsigned int c = 1; c < dim; ++c)
        traction += interaction.shear_weight > 0.
                      ? x[i * dim + c] * x[i * dim + c] /
                          interaction.shear_weight
                      : 0.;
      if (std::sqrt(traction) > problem.weight[i] * problem.time_step *
                                  problem.strength_factor[i] *
                                  interaction.law->strength()) {
        problem.kind[i] = PointKind::rigid;
        problem.mask[i] = 0;
        any = true;
      }
    }
    return communicator.any(any);
  }

  template <int dim>
  void MoreauJean<dim>::book(const State &old,
                             State &next,
                             const double h,
                             const LawEvaluation<dim> &evaluation,
                             StepReport &report)
  {
    const auto &points = discretization_.points();
    const auto &communicator = dynamics_.communicator();
    const double theta = input_.time.theta;
    const std::size_t n = points.n_owned, n_dofs = next.velocity.size();

    // --- bodies: energies, theta term, work of the loads
    std::vector<double> change(n_dofs), product(n_dofs),
      lines(5 * n_dofs);
    using Operator = typename Dynamics<dim>::Operator;
    const auto line = [&](const unsigned int row, const double *x,
                          const double factor) {
      for (std::size_t i = 0; i < n_dofs; ++i)
        lines[row * n_dofs + i] = factor * x[i] * product[i];
    };
    dynamics_.apply(Operator::mass, next.velocity.data(), product.data());
    line(0, next.velocity.data(), 0.5);
    dynamics_.apply(Operator::stiffness, next.displacement.data(),
                    product.data());
    line(1, next.displacement.data(), 0.5);
    if (theta > 0.5) {
      for (std::size_t i = 0; i < n_dofs; ++i)
        change[i] = next.velocity[i] - old.velocity[i];
      dynamics_.apply(Operator::mass, change.data(), product.data());
      line(2, change.data(), theta - 0.5);
      for (std::size_t i = 0; i < n_dofs; ++i)
        change[i] = next.displacement[i] - old.displacement[i];
      dynamics_.apply(Operator::stiffness, change.data(), product.data());
      line(3, change.data(), theta - 0.5);
    }
    if (discretization_.has_loads())
      for (std::size_t i = 0; i < n_dofs; ++i)
        lines[4 * n_dofs + i] =
          h * forces_[i] *
          (theta * next.velocity[i] + (1. - theta) * old.velocity[i]);
    const auto body = communicator.sums(lines.data(), 5, n_dofs);

    // --- points
    enum Row
    {
      stored,
      damage,
      friction,
      positive_friction,
      impact,
      numerical,
      motion,
      broken,
      n_rows
    };
    std::vector<double> rows(n_rows * n, 0.);
    const std::size_t n_driven = discretization_.driven_boundaries().size();
    std::vector<double> reaction(n_driven * dim * n, 0.);
    next.opening_max = old.opening_max;
    next.beta = old.beta;
    next.kind = old.kind;
    next.two_sided = old.two_sided;
    next.slip = old.slip;
    next.penetration_bound = old.penetration_bound;
    next.contact.assign(points.n_points, 0);
    double penetration = 0., excess = 0., drift = 0.;
    unsigned int active = 0;
    bool beyond = false;
    const double chi =
      input_.time.cohesion_rule == CohesionRule::exact ? 0.5 : 1.;

    for (std::size_t i = 0; i < points.n_points; ++i) {
      const bool owned = i < n;
      const double w = points.weight[i];
      const double *P = &next.impulse[i * dim];
      std::array<double, dim> U, U_theta;
      for (unsigned int c = 0; c < dim; ++c) {
        U[c] = next.relative_velocity[i * dim + c];
        U_theta[c] =
          theta * U[c] + (1. - theta) * old.relative_velocity[i * dim + c];
      }
      const auto put = [&](const Row row, const double value) {
        if (owned)
          rows[row * n + i] += value;
      };
      const auto &solution = evaluation.solutions[i];
      const PointKind kind = problem_.kind[i];

      if (kind == PointKind::prescribed) {
        const PointOrigin origin = discretization_.origins()[i];
        double power = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          power += P[c] * U_theta[c];
        if (origin.kind == PointOrigin::Kind::motion) {
          put(motion, power);
          const auto &driven = discretization_.driven_boundaries();
          const std::size_t d =
            std::find(driven.begin(), driven.end(), origin.block) -
            driven.begin();
          if (owned)
            for (unsigned int c = 0; c < dim; ++c)
              reaction[(d * dim + c) * n + i] = P[c] / h;
        } else {
          put(impact, -power); // a joint that closes a jump of velocities
          double jump = 0.;
          for (unsigned int c = 0; c < dim; ++c)
            jump += next.jump[i * dim + c] * next.jump[i * dim + c];
          drift = std::max(drift, std::sqrt(jump));
        }
        continue;
      }

      const auto energies =
        point_energies<dim>(problem_, i, U, solution.frozen);
      const bool held = kind == PointKind::rigid && !solution.damages;
      // contact part by the law, what is left over is the solver's residual
      double cohesive_work = 0., residual = 0.;
      std::array<double, dim> contact{};
      for (unsigned int c = 0; c < dim; ++c) {
        const double pull = w * h * energies.cohesive_traction[c];
        cohesive_work += -pull * U_theta[c];
        contact[c] = P[c] + pull;
      }
      if (held) {
        for (unsigned int c = 0; c < dim; ++c)
          residual += contact[c] * U_theta[c];
        put(numerical, -residual);
      } else {
        const bool closed = solution.contact_impulse > 0.;
        const bool rubs = solution.frozen.threshold > 0.;
        if (closed)
          put(impact, -contact[0] * U_theta[0]);
        else
          residual += contact[0] * U_theta[0];
        double rubbing = 0.;
        for (unsigned int c = 1; c < dim; ++c)
          rubbing += contact[c] * U_theta[c];
        if (rubs) {
          put(friction, -rubbing);
          put(positive_friction, rubbing > 0. ? rubbing : 0.);
        } else
          residual += rubbing;
        put(numerical, -residual);
        next.contact[i] = closed;
        if (closed) {
          double slip = 0.;
          for (unsigned int c = 1; c < dim; ++c)
            slip += U_theta[c] * U_theta[c];
          next.slip[i] += h * std::sqrt(slip);
        }
        if (owned && (closed || solution.damages))
          ++active;
      }

      const double dissipated = w * energies.damage;
      put(stored, w * energies.stored);
      put(damage, dissipated);
      // -w h R.U_theta = -w (d psi + d D + N)
      put(numerical, -cohesive_work -
                       w * (energies.stored + energies.overlap_released -
                            energies.stored_old) -
                       dissipated);
      put(numerical, w * energies.overlap_released);

      // --- history
      next.opening_max[i] = energies.opening_max;
      if (kind == PointKind::rigid && solution.damages)
        next.kind[i] = PointKind::cohesive;
      if (next.kind[i] == PointKind::cohesive) {
        const auto &interaction =
          problem_.interactions[problem_.interaction[i]];
        next.beta[i] = std::min(old.beta[i], energies.beta);
        if (energies.beta < 1.)
          next.two_sided[i] = 0; // its overlap is booked in point_energies()
        if (next.beta[i] <= 0.)
          next.kind[i] = PointKind::free;
        // a softening point in a step above the uniqueness bound
        const double f = strength_factor_[i];
        if (solution.damages &&
            f * energies.opening_max >= interaction.law->peak_opening())
          beyond |= h * h * theta * chi * f * f *
                      interaction.law->steepest_softening() *
                      flexibility_[points.face_of[i]] >=
                    1.;
        // newly broken surface; tails count once they carry a thousandth
        if (next.beta[i] < 1e-3 && old.beta[i] >= 1e-3)
          put(broken, w);
      }
      // --- penetration against its bound: approach speed at activation, and
      // the overlap of the spring where it turns into a contact
      if (!next.two_sided[i]) {
        double &bound = next.penetration_bound[i];
        if (old.two_sided[i])
          bound = std::max(bound, -next.jump[i * dim]);
        if (problem_.contact[i])
          bound = std::max(bound, -h * old.relative_velocity[i * dim]);
        // approach that the forecast did not see
        if (!problem_.contact[i])
          bound = std::max(bound, -h * U_theta[0]);
        const double depth = -next.jump[i * dim];
        penetration = std::max(penetration, depth);
        excess = std::max(excess, depth - bound);
      }
    }
    const auto sums = communicator.sums(rows.data(), n_rows, n);
    if (n_driven > 0) {
      const auto force =
        communicator.sums(reaction.data(), n_driven * dim, n);
      reactions_ = force;
    }

    EnergyLines &energy = next.energy;
    energy = old.energy;
    energy.kinetic = body[0];
    energy.elastic = body[1];
    energy.cohesive = sums[stored];
    energy.damage += sums[damage];
    energy.friction += sums[friction];
    energy.impact += sums[impact];
    energy.numerical += sums[numerical] + body[2] + body[3];
    energy.work += sums[motion] + body[4];
    next.broken_area = old.broken_area + sums[broken];
    next.positive_friction_work =
      old.positive_friction_work + sums[positive_friction];
    next.initial_energy = old.initial_energy;
    next.penetration = std::max(old.penetration, communicator.max(penetration));
    next.penetration_excess =
      std::max(old.penetration_excess, communicator.max(excess));
    next.rigid_drift = std::max(old.rigid_drift, communicator.max(drift));
    report.active = unsigned(communicator.sum_integer(active));
    report.beyond_unique = communicator.any(beyond);

    next.largest_energy = std::max(
      {old.largest_energy, energy.kinetic, energy.elastic, energy.cohesive,
       std::abs(energy.work), energy.damage, energy.impact, energy.friction});
    const double defect =
      energy.kinetic + energy.elastic + energy.cohesive + energy.damage +
      energy.friction + energy.viscous + energy.plastic + energy.impact +
      energy.numerical - energy.work - next.initial_energy;
    report.ledger_defect =
      next.largest_energy > 0. ? std::abs(defect) / next.largest_energy : 0.;
  }

  template <int dim>
  double MoreauJean<dim>::unique_step(const State &state) const
  {
    const auto &points = discretization_.points();
    const double chi =
      input_.time.cohesion_rule == CohesionRule::exact ? 0.5 : 1.;
    double result = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points.n_owned; ++i) {
      if (state.kind[i] != PointKind::cohesive)
        continue;
      const auto &law =
        *problem_.interactions[problem_.interaction[i]].law;
      const double f = strength_factor_[i];
      if (f * state.opening_max[i] < law.peak_opening() &&
          !(law.extrinsic() && state.opening_max[i] > 0.))
        continue;
      const double factor = input_.time.theta * chi * f * f *
                            law.steepest_softening() *
                            flexibility_[points.face_of[i]];
      if (factor > 0.)
        result = std::min(result, 1. / std::sqrt(factor));
    }
    return dynamics_.communicator().min(result);
  }

  template <int dim>
  std::string MoreauJean<dim>::describe(const std::size_t i) const
  {
    const auto &points = discretization_.points();
    if (i >= points.n_points)
      return "unknown";
    std::string name = "support";
    const PointOrigin origin = discretization_.origins()[i];
    if (origin.kind == PointOrigin::Kind::interface)
      name = "Interface: " + input_.interfaces[origin.block].name;
    else if (origin.kind == PointOrigin::Kind::motion)
      name = "Boundary: " + input_.boundaries[origin.block].name;
    else
      name = "Obstacle: " + input_.obstacles[origin.block].name;
    std::string place;
    for (unsigned int c = 0; c < dim; ++c)
      place += fmt::format("{}{:.6g}", c ? ", " : "",
                           points.position[i * dim + c]);
    return fmt::format("at ({}) of `{}`", place, name);
  }

  template class MoreauJean<2>;
  template class MoreauJean<3>;
} // namespace nsfd
