#include "leapfrog_chains.h"

#include "step_data.h"

#include "nsfd/core/archive.h"
#include "nsfd/scene/time_input.h"
#include "state/state.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  LeapfrogChains<dim>::LeapfrogChains(const OneStepProblem<dim> &mesh)
      : mesh_(mesh)
  {
    problem.interactions = mesh.interactions;
    problem.rule = CohesionRule::exact;
    for (const Interaction &interaction : problem.interactions)
      has_slips_ |= interaction.law && interaction.law->mixed();
  }

  template <int dim>
  void LeapfrogChains<dim>::append(const unsigned int mesh_point,
                                   const double *axes, const Factors &factors)
  {
    const auto a = unsigned(point.size());
    point.push_back(mesh_point);
    OneStepProblem<dim> &p = problem;
    p.n_points = p.n_owned = a + 1;
    p.acting.push_back(a);
    p.kind.push_back(PointKind::free);
    p.mask.push_back(0);
    p.contact.push_back(0);
    p.interaction.push_back(mesh_.interaction[mesh_point]);
    p.weight.push_back(mesh_.weight[mesh_point] / 2.);
    p.strength_factor.push_back(factors.strength);
    p.opening_factor.push_back(factors.opening);
    for (auto *array : {&p.opening_max, &p.compression_stiffness, &p.target,
                        &p.majorant_normal, &p.majorant_tangential})
      array->push_back(0.);
    if (has_slips_)
      p.slip_max.push_back(0.);
    if (!mesh_.viscosity.empty())
      p.viscosity.push_back(0.);
    if (!mesh_.friction_factor.empty())
      p.friction_factor.push_back(1.);
    for (auto *array :
         {&p.free_velocity, &p.given_velocity, &p.jump_old, &p.jump_free,
          &p.sliding_offset, &velocity, &old_velocity, &impulse})
      array->resize(p.n_points * dim, 0.);
    other.kind.push_back(PointKind::free);
    for (auto *array : {&other.opening_max, &other.slip_max, &other.compression,
                        &other.beta, &beta, &slip, &released})
      array->push_back(0.);
    closed.push_back(0);
    turned.push_back(0);
    solution.emplace_back();
    frame.insert(frame.end(), axes, axes + dim * dim);
  }

  template <int dim>
  void LeapfrogChains<dim>::add(const unsigned int mesh_point,
                                const double *axes, const Factors &factors,
                                const State &state)
  {
    append(mesh_point, axes, factors);
    const std::size_t a = point.size() - 1;
    problem.kind[a] = other.kind[a] = state.kind[mesh_point];
    problem.opening_max[a] = other.opening_max[a] =
        state.opening_max[mesh_point];
    if (has_slips_)
      problem.slip_max[a] = other.slip_max[a] = state.slip_max[mesh_point];
    beta[a] = other.beta[a] = state.beta[mesh_point];
    if (state.two_sided[mesh_point])
      problem.compression_stiffness[a] = other.compression[a] =
          intact_stiffness<dim>(mesh_, mesh_point);
    slip[a] = state.slip[mesh_point];
    released[a] = state.released_overlap[mesh_point];
    closed[a] = state.contact[mesh_point];
    for (unsigned int c = 0; c < dim; ++c) {
      problem.jump_old[a * dim + c] = problem.jump_free[a * dim + c] =
          state.jump[mesh_point * dim + c];
      velocity[a * dim + c] = old_velocity[a * dim + c] =
          state.relative_velocity[mesh_point * dim + c];
      impulse[a * dim + c] = state.impulse[mesh_point * dim + c];
    }
  }

  template <int dim>
  void LeapfrogChains<dim>::release(const unsigned int mesh_point,
                                    const double *axes, const Factors &factors)
  {
    append(mesh_point, axes, factors);
    const std::size_t a = point.size() - 1;
    problem.kind[a] = other.kind[a] = PointKind::rigid;
    beta[a] = other.beta[a] = 1.;
  }

  template <int dim>
  double LeapfrogChains<dim>::turn(const std::size_t a,
                                   const std::array<double, dim * dim> &axes)
  {
    double *const old = &frame[a * dim * dim];
    std::array<double, dim * dim> Q{};
    for (unsigned int r = 0; r < dim; ++r)
      for (unsigned int s = 0; s < dim; ++s)
        for (unsigned int c = 0; c < dim; ++c)
          Q[r * dim + s] += axes[r * dim + c] * old[s * dim + c];
    const auto stored = [&] {
      double sum = 0.;
      for (unsigned int chain = 0; chain < 2; ++chain) {
        sum += problem.weight[a] * stored_energy<dim>(problem, a);
        swap();
      }
      return sum;
    };
    const bool stores = problem.kind[a] == PointKind::cohesive ||
                        problem.kind[a] == PointKind::elastic;
    const double before = stores ? stored() : 0.;
    for (auto *array : {&problem.jump_old, &problem.jump_free, &velocity,
                        &old_velocity, &impulse}) {
      std::array<double, dim> turned{};
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int s = 0; s < dim; ++s)
          turned[r] += Q[r * dim + s] * (*array)[a * dim + s];
      std::copy(turned.begin(), turned.end(), &(*array)[a * dim]);
    }
    std::copy(axes.begin(), axes.end(), old);
    return stores ? stored() - before : 0.;
  }

  template <int dim>
  void LeapfrogChains<dim>::reorder(const std::vector<unsigned int> &order)
  {
    OneStepProblem<dim> &p = problem;
    const auto move = [&order](const auto width, auto &...lists) {
      const auto move_one = [&](auto &list) {
        const auto old = list;
        for (std::size_t k = 0; k < order.size() && !old.empty(); ++k)
          std::copy_n(old.begin() + long(order[k] * width), width,
                      list.begin() + long(k * width));
      };
      (move_one(lists), ...);
    };
    move(1u, point, p.kind, p.mask, p.contact, p.interaction, p.weight,
         p.strength_factor, p.opening_factor, p.friction_factor, p.opening_max,
         p.slip_max, p.compression_stiffness, p.viscosity, p.target,
         p.majorant_normal, p.majorant_tangential, other.kind,
         other.opening_max, other.slip_max, other.compression, other.beta, beta,
         slip, released, closed, turned, solution);
    move(unsigned(dim), p.free_velocity, p.given_velocity, p.jump_old,
         p.jump_free, p.sliding_offset, velocity, old_velocity, impulse);
    move(unsigned(dim * dim), frame);
  }

  /** The next step goes from u_k, over u_{k+1}. */
  template <int dim>
  void LeapfrogChains<dim>::swap()
  {
    OneStepProblem<dim> &p = problem;
    p.jump_old.swap(p.jump_free);
    p.kind.swap(other.kind);
    p.opening_max.swap(other.opening_max);
    if (has_slips_)
      p.slip_max.swap(other.slip_max);
    p.compression_stiffness.swap(other.compression);
    beta.swap(other.beta);
  }

  /** The chain of the last step is the other one now. */
  template <int dim>
  void LeapfrogChains<dim>::show(State &state,
                                 const std::vector<unsigned int> &place) const
  {
    for (std::size_t a = 0; a < size(); ++a) {
      const unsigned int at = place.empty() ? point[a] : place[point[a]];
      if (at == unsigned(-1))
        continue;
      const std::size_t i = at;
      state.kind[i] = other.kind[a];
      state.opening_max[i] = other.opening_max[a];
      if (has_slips_)
        state.slip_max[i] = other.slip_max[a];
      state.beta[i] = other.beta[a];
      state.two_sided[i] = other.compression[a] > 0.;
      state.slip[i] = slip[a];
      state.released_overlap[i] = released[a];
      state.contact[i] = closed[a];
      for (unsigned int c = 0; c < dim; ++c) {
        state.jump[i * dim + c] = problem.jump_free[a * dim + c];
        state.relative_velocity[i * dim + c] = velocity[a * dim + c];
        state.impulse[i * dim + c] = impulse[a * dim + c];
      }
    }
  }

  template <int dim>
  void LeapfrogChains<dim>::serialize(Archive &archive, const std::size_t n,
                                      const Others &others)
  {
    OneStepProblem<dim> &p = problem;
    const Archive::Part part(archive, "chain");
    const auto store = [&](const char *name, std::vector<double> &values,
                           const unsigned int width) {
      std::vector<double> all(n * width, 0.);
      if (!archive.reads())
        for (std::size_t a = 0; a < size(); ++a)
          std::copy_n(&values[a * width], width, &all[point[a] * width]);
      archive.points(name, all);
      if (archive.reads())
        for (std::size_t a = 0; a < size(); ++a)
          std::copy_n(&all[point[a] * width], width, &values[a * width]);
    };
    std::vector<std::uint8_t> kinds(n, 0);
    for (std::size_t a = 0; a < size(); ++a)
      kinds[point[a]] = std::uint8_t(p.kind[a]);
    archive.points("kind", kinds);
    for (std::size_t a = 0; a < size(); ++a)
      p.kind[a] = PointKind(kinds[point[a]]);
    store("jump", p.jump_old, dim);
    store("opening_max", p.opening_max, 1);
    if (has_slips_)
      store("slip_max", p.slip_max, 1);
    store("compression", p.compression_stiffness, 1);
    store("beta", beta, 1);
    if (others.frames) // what a state says of points is along these axes
      store("frame", frame, dim * dim);
    if (others.factors) {
      store("strength_factor", p.strength_factor, 1);
      store("opening_factor", p.opening_factor, 1);
    }
  }

  template struct LeapfrogChains<2>;
  template struct LeapfrogChains<3>;
} // namespace nsfd
