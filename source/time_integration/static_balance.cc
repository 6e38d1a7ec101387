#include "static_balance.h"

#include "common_balance.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    enum PointRow {
      stored,
      damage,
      friction,
      positive_friction,
      rest,          ///< of the work of the mean forces, with either sign
      released,      ///< of overlaps that damage has turned into contacts
      cohesive_rest, ///< the part of `rest` that cohesion has
      moved,         ///< |work| of the mean forces in cohesion and joints
      motion,
      pressure_work,
      broken,
      n_rows
    };

    template <int dim>
    class PointTerms
    {
    public:
      PointTerms(const OneStepProblem<dim> &problem,
                 const std::vector<LocalSolution<dim>> &solutions,
                 const bool has_heat, const State &old, State &next)
          : terms(n_rows * problem.n_owned, 0.), problem_(problem),
            solutions_(solutions), old_(old), next_(next)
      {
        carry_history(old, next);
        next.heat.of_points.assign(has_heat ? problem.n_points : 0, 0.);
      }

      void add_motion(std::size_t i);
      void add_joint(std::size_t i);
      void add_law(std::size_t i);
      void add_pressure(std::size_t i);

      std::vector<double> terms; ///< n_rows of n_owned
      double penetration = 0., drift = 0.;
      unsigned int active = 0;
      EnergyLeft left;

    private:
      using Vector = std::array<double, dim>;

      void put(const PointRow row, const std::size_t i, const double value)
      {
        auto &heat = next_.heat.of_points;
        if (!heat.empty() && (row == damage || row == friction))
          heat[i] += value;
        if (i < problem_.n_owned)
          terms[row * problem_.n_owned + i] += value;
      }
      double old_force(const std::size_t k) const
      {
        return old_.point_force.empty() ? 0. : old_.point_force[k];
      }
      /** Of the mean force over the step, on the bodies. */
      double mean_work(const std::size_t i) const
      {
        double work = 0.;
        for (std::size_t k = i * dim; k < (i + 1) * dim; ++k)
          work += (old_force(k) + next_.point_force[k]) / 2. *
                  (next_.jump[k] - old_.jump[k]);
        return work;
      }
      Vector old_cohesion(std::size_t i) const;

      const OneStepProblem<dim> &problem_;
      const std::vector<LocalSolution<dim>> &solutions_;
      const State &old_;
      State &next_;
    };

    template <int dim>
    void PointTerms<dim>::add_motion(const std::size_t i)
    {
      put(motion, i, mean_work(i));
    }

    template <int dim>
    void PointTerms<dim>::add_joint(const std::size_t i)
    {
      put(rest, i, -mean_work(i));
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        square += next_.jump[i * dim + c] * next_.jump[i * dim + c];
      drift = std::max(drift, std::sqrt(square));
    }

    /** Traction of the law at the last equilibrium, Pa. */
    template <int dim>
    auto PointTerms<dim>::old_cohesion(const std::size_t i) const -> Vector
    {
      Vector traction{};
      const PointKind kind = old_.kind[i];
      const auto &interaction = problem_.interactions[problem_.interaction[i]];
      if (kind == PointKind::rigid || (kind == PointKind::cohesive &&
                                       problem_.kind[i] == PointKind::rigid)) {
        for (unsigned int c = 0; c < dim; ++c)
          traction[c] = -old_force(i * dim + c) / problem_.weight[i];
        return traction;
      }
      if (kind != PointKind::elastic && kind != PointKind::cohesive)
        return traction;
      const double *u = &old_.jump[i * dim];
      const Secant b =
          frozen_state<dim>(problem_, i, reach_of<dim>(interaction, u), 0.)
              .secant;
      traction[0] =
          (u[0] > 0. ? b.normal : problem_.compression_stiffness[i]) * u[0];
      for (unsigned int c = 1; c < dim; ++c)
        traction[c] = b.tangential * u[c];
      return traction;
    }

    template <int dim>
    void PointTerms<dim>::add_law(const std::size_t i)
    {
      const double w = problem_.weight[i], h = problem_.time_step;
      const auto &solution = solutions_[i];
      Vector velocity;
      for (unsigned int c = 0; c < dim; ++c)
        velocity[c] = (next_.jump[i * dim + c] - old_.jump[i * dim + c]) / h;
      auto energies =
          point_energies<dim>(problem_, i, velocity, solution.frozen);
      if (problem_.kind[i] == PointKind::rigid &&
          energies.history.opening <= problem_.opening_max[i])
        energies.stored = 0.; // still closed: it counts from there again
      const Vector before = old_cohesion(i);
      double cohesive_work = 0., normal_work = 0., rubbing = 0., square = 0.,
             rubbing_before = 0.; // by the forces before the step
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t k = i * dim + c;
        const double R_0 = w * before[c],
                     R_1 = w * energies.cohesive_traction[c],
                     du = next_.jump[k] - old_.jump[k];
        cohesive_work += (R_0 + R_1) / 2. * du;
        const double contact =
            (old_force(k) + R_0 + next_.point_force[k] + R_1) / 2. * du;
        (c == 0 ? normal_work : rubbing) += contact;
        square += c == 0 ? 0. : du * du;
        rubbing_before += c == 0 ? 0. : (old_force(k) + R_0) * du;
      }
      const bool closed = solution.contact_impulse > 0.;
      // what closes or opens within the step has a gap in its mean force
      put(rest, i, -normal_work);
      if (problem_.interactions[problem_.interaction[i]].friction > 0.) {
        // where slip has turned, the force before it is of the other way
        const double taken = rubbing - std::max(0., rubbing_before) / 2.;
        put(friction, i, -taken);
        put(positive_friction, i, std::max(0., taken));
        put(rest, i, taken - rubbing);
      } else
        put(rest, i, -rubbing);
      next_.contact[i] = closed;
      if (closed)
        next_.slip[i] += std::sqrt(square);
      if (i < problem_.n_owned && (closed || solution.damages))
        ++active;

      const double dissipated = w * energies.damage,
                   spent = w * (energies.stored + energies.overlap_released -
                                energies.stored_old);
      put(stored, i, w * energies.stored);
      put(damage, i, dissipated);
      const double over = cohesive_work - spent - dissipated;
      put(rest, i, over);
      put(released, i, w * energies.overlap_released);
      put(cohesive_rest, i, over);
      put(moved, i, std::abs(cohesive_work));
      if (i < problem_.n_owned && std::abs(over) > left.worst) {
        left.worst = std::abs(over);
        left.worst_point = i;
      }
      if (record_damage<dim>(energies, i,
                             problem_.kind[i] == PointKind::rigid &&
                                 energies.history.opening > 0.,
                             old_, next_))
        put(broken, i, w);
      if (!next_.two_sided[i]) {
        const double depth = -next_.jump[i * dim];
        if (old_.two_sided[i])
          next_.released_overlap[i] =
              std::max(next_.released_overlap[i], depth);
        penetration = std::max(penetration, depth);
      }
    }

    template <int dim>
    void PointTerms<dim>::add_pressure(const std::size_t i)
    {
      const double before = old_.pressure.empty() ? 0. : old_.pressure[i];
      put(pressure_work, i,
          problem_.weight[i] * (before + next_.pressure[i]) / 2. *
              (next_.jump[i * dim] - old_.jump[i * dim]));
    }
  } // namespace

  template <int dim>
  bool StaticBalance<dim>::has_pressure(const SceneInput &input)
  {
    return std::any_of(
        input.interfaces.begin(), input.interfaces.end(),
        [](const InterfaceInput &block) { return bool(block.crack_pressure); });
  }

  template <int dim>
  EnergyLeft StaticBalance<dim>::account(Relaxation<dim> &relaxation,
                                         const std::vector<double> &forces_old,
                                         const State &old, State &next,
                                         StepReport &report)
  {
    const auto &communicator = delassus_.communicator();
    const auto &problem = relaxation.load_step();
    PointTerms<dim> points(problem, relaxation.solutions(),
                           discretization_.input().has_heat(), old, next);
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      if (has_pressure_)
        points.add_pressure(i);
      if (old.kind[i] == PointKind::bonded &&
          problem.kind[i] != PointKind::rigid)
        continue; // in the stiffness of the bodies
      if (problem.kind[i] != PointKind::prescribed)
        points.add_law(i);
      else if (discretization_.origins()[i].kind == PointOrigin::Kind::motion)
        points.add_motion(i);
      else
        points.add_joint(i);
    }
    auto sums = communicator.sums(points.terms.data(), n_rows, problem.n_owned);
    if (StaticBonds<dim> *const bonds = relaxation.bonds()) {
      const double work = bonds->work_of_released(forces_old, next);
      sums[rest] -= work;
      sums[cohesive_rest] -= work;
      sums[moved] += std::abs(work);
      bonds->set_tractions(next);
    }

    const std::size_t n = next.displacement.size();
    std::vector<double> terms(3 * n);
    const auto put_elastic = [&](const State &state, const std::size_t row) {
      std::vector<double> product(n);
      delassus_.apply(DelassusOperator<dim>::Operator::stiffness,
                      state.displacement.data(), product.data());
      for (std::size_t k = 0; k < n; ++k)
        terms[row * n + k] = state.displacement[k] * product[k] / 2.;
    };
    put_elastic(next, 0);
    for (std::size_t k = 0; k < n; ++k)
      terms[n + k] = (forces_old[k] + relaxation.forces()[k]) / 2. *
                     (next.displacement[k] - old.displacement[k]);
    const auto body = communicator.sums(terms.data(), 2, n);

    EnergyLines &energy = next.energy;
    energy = old.energy;
    energy.kinetic = 0.;
    energy.elastic = body[0];
    energy.cohesive = sums[stored];
    energy.damage += sums[damage];
    energy.friction += sums[friction];
    energy.numerical += sums[released] + std::max(0., sums[rest]);
    const double above_mean = std::max(0., -sums[rest]);
    const double work =
        sums[motion] + body[1] + sums[pressure_work] + above_mean;
    energy.work += work;
    next.pressure_work = old.pressure_work + sums[pressure_work];
    next.broken_area = old.broken_area + sums[broken];
    next.positive_friction_work =
        old.positive_friction_work + sums[positive_friction];
    next.initial_energy = old.initial_energy;
    next.penetration =
        std::max(old.penetration, communicator.max(points.penetration));
    next.penetration_excess = old.penetration_excess;
    next.rigid_drift =
        std::max(old.rigid_drift, communicator.max(points.drift));
    report.active = unsigned(communicator.sum_integer(points.active));

    const auto &driven = discretization_.driven_boundaries();
    if (!driven.empty()) {
      std::vector<double> rows(reactions_.size() * problem.n_owned, 0.);
      for (std::size_t i = 0; i < problem.n_owned; ++i) {
        const PointOrigin origin = discretization_.origins()[i];
        if (origin.kind != PointOrigin::Kind::motion)
          continue;
        const std::size_t d =
            std::find(driven.begin(), driven.end(), origin.block) -
            driven.begin();
        for (unsigned int c = 0; c < dim; ++c)
          rows[(d * dim + c) * problem.n_owned + i] =
              next.point_force[i * dim + c];
      }
      reactions_ =
          communicator.sums(rows.data(), reactions_.size(), problem.n_owned);
    }

    close_balance(old, next, report);

    EnergyLeft left = points.left;
    left.energy = sums[cohesive_rest];
    left.above_mean = above_mean;
    left.turnover = std::max({std::abs(work), sums[moved], sums[damage],
                              std::abs(energy.elastic - old.energy.elastic)});
    return left;
  }

  template class StaticBalance<2>;
  template class StaticBalance<3>;
} // namespace nsfd
