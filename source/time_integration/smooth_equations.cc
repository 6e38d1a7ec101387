#include "smooth_equations.h"

#include "bond_release.h"
#include "step_data.h"

#include "discretization/cells.h"
#include "discretization/fixed_faces.h"
#include "discretization/loads.h"
#include "discretization/node_coordinates.h"
#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** With the mass alone, and common nodes as @p bonded has them. */
    template <int dim>
    std::unique_ptr<DelassusOperator<dim>>
    free_bodies(const SceneInput &input,
                const Discretization<dim> &discretization,
                const Communicator &communicator,
                JoinedDelassus<dim> *const bonded, const State &start)
    {
      if (!bonded)
        return make_local_delassus<dim>(communicator, discretization.bodies(),
                                        discretization.points());
      auto free = make_joined_delassus<dim>(
          communicator, discretization.bodies(), discretization.points(),
          input.solver.linear_solver, node_coordinates(discretization),
          fixed_faces(discretization));
      const auto points = bonded_points(start);
      bonded->set_bonds(points);
      free->set_bonds(points);
      return free;
    }
  } // namespace

  template <int dim>
  SmoothEquations<dim>::SmoothEquations(
      const SceneInput &input, const Discretization<dim> &discretization,
      DelassusOperator<dim> &delassus, JoinedDelassus<dim> *const bonded,
      const State &start)
      : input_(input), discretization_(discretization), delassus_(delassus),
        communicator_(delassus.communicator()), motion_(input, discretization),
        free_(free_bodies(input, discretization, delassus.communicator(),
                          bonded, start)),
        problem_(constant_data(input, discretization)), kind_(start.kind),
        n_(discretization.bodies().n_dofs()),
        n_rows_(discretization.points().n_points * dim),
        joined_(*free_, discretization.points().n_owned),
        shifted_(delassus, discretization.points().n_owned)
  {
    free_->reinit(0., 1.);
    if (input.has_bonded_faces())
      bulk_ = std::make_unique<BulkTraction<dim>>(delassus);
    for (auto *vector : {&work_.given, &work_.mu, &work_.lambda, &work_.rows})
      vector->assign(n_rows_, 0.);
    for (auto *vector :
         {&loads_.force, &work_.force, &work_.rate, &work_.v, &work_.body})
      vector->assign(n_, 0.);
    set_rows(bonded);
    find_scales(start);
  }

  /** Joints all over, driven boundaries in the components that they drive. */
  template <int dim>
  void SmoothEquations<dim>::set_rows(JoinedDelassus<dim> *const bonded)
  {
    const auto is_driven = [this](const std::size_t i) {
      return kind_[i] == PointKind::prescribed &&
             discretization_.origins()[i].kind == PointOrigin::Kind::motion;
    };
    std::vector<std::uint8_t> driven(kind_.size(), 0); // components
    for (std::size_t i = 0; i < kind_.size(); ++i)
      for (unsigned int c = 0; c < dim && is_driven(i); ++c)
        if (motion_.drives(i, c))
          driven[i] |= std::uint8_t(1u << c);
    if (bonded)
      driven = bonded->once_per_node(driven);
    D_joined_.assign(n_rows_, -1.);
    for (std::size_t i = 0; i < n_rows_ / dim; ++i) {
      if (kind_[i] != PointKind::prescribed)
        continue;
      for (unsigned int c = 0; c < dim; ++c) {
        if (is_driven(i)) {
          if (!(driven[i] & (1u << c)))
            continue;
          const Expression *velocity = motion_.velocity(i, c);
          moves_ |= !(velocity && velocity->is_zero());
        }
        D_joined_[i * dim + c] = 0.;
      }
    }
    moves_ = communicator_.any(moves_);
    joined_.set(D_joined_);
  }

  template <int dim>
  void SmoothEquations<dim>::serialize(Archive &archive)
  {
    const Archive::Part part(archive, "smooth_motion");
    archive.numbers("scales", scales_.velocity, scales_.displacement,
                    scales_.energy, scales_.inner_step, scales_.share);
    archive.points("row_forces", work_.lambda); // where their iterations start
  }

  template <int dim>
  double SmoothEquations<dim>::motion(const std::size_t point,
                                      const unsigned int c,
                                      const double t) const
  {
    if (const Expression *velocity = motion_.velocity(point, c))
      return motion_.at(*velocity, point, t);
    const Expression *displacement = motion_.displacement(point, c);
    if (displacement == nullptr)
      return 0.;
    // fourth order: what is left is of the size of round-off
    const double d = 1e-4 * input_.time.end;
    const auto u = [&](const double at) {
      return motion_.at(*displacement, point, at);
    };
    return (8. * (u(t + d) - u(t - d)) - (u(t + 2. * d) - u(t - 2. * d))) /
           (12. * d);
  }

  template <int dim>
  void SmoothEquations<dim>::set_motion(const double t, Values &g) const
  {
    for (std::size_t k = 0; k < n_rows_; ++k)
      g[k] = moves_ && D_joined_[k] == 0. ? motion(k / dim, k % dim, t) : 0.;
  }

  /** For the work and the reactions alone. */
  template <int dim>
  void SmoothEquations<dim>::set_motion_rate(const double t, Values &rate) const
  {
    const double d = 1e-3 * input_.time.end;
    for (std::size_t k = 0; k < n_rows_; ++k) {
      if (!moves_ || D_joined_[k] != 0.) {
        rate[k] = 0.;
        continue;
      }
      const auto g = [&](const double at) {
        return motion(k / dim, k % dim, at);
      };
      rate[k] = (8. * (g(t + d) - g(t - d)) - (g(t + 2. * d) - g(t - 2. * d))) /
                (12. * d);
    }
  }

  template <int dim>
  auto SmoothEquations<dim>::loads(const double t) -> const Values &
  {
    if (!discretization_.loads().any() ||
        (loads_.known &&
         (loads_.time == t || !discretization_.loads().depend_on_time())))
      return loads_.force;
    std::fill(loads_.force.begin(), loads_.force.end(), 0.);
    discretization_.add_loads(t, loads_.force);
    loads_.known = true;
    loads_.time = t;
    return loads_.force;
  }

  /**
   * The size of the motion, for tolerances that ask for no number of the user:
   * what the start, the loads and the driven boundaries can bring about.
   */
  template <int dim>
  void SmoothEquations<dim>::find_scales(const State &start)
  {
    double speed = 0., mass = 0., largest = 0.;
    const auto &bodies = discretization_.bodies();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const unsigned int m =
          discretization_.cells().body_class(unsigned(b)).material;
      mass +=
          discretization_.cells().class_shape(unsigned(b)).extremes.densest *
          discretization_.cells().volume(unsigned(b));
      if (!input_.materials[m].rigid)
        speed = std::max(speed, discretization_.extremes(m).fastest);
    }
    mass = communicator_.sum(Values{mass});
    speed = communicator_.max(speed);
    const double length = discretization_.extent();
    const double end = input_.time.end;
    const double crossing = speed > 0. ? std::min(end, length / speed) : end;
    for (const double u : start.displacement)
      largest = std::max(largest, std::abs(u));
    scales_.velocity = largest / crossing;
    for (const double v : start.velocity)
      scales_.velocity = std::max(scales_.velocity, std::abs(v));
    constexpr unsigned int samples = 32;
    for (unsigned int k = 0; k <= samples; ++k) {
      const double t = k * end / samples;
      set_motion(t, work_.given);
      for (const double g : work_.given)
        scales_.velocity = std::max(scales_.velocity, std::abs(g));
      free_->apply(Operator::inverse, loads(t).data(), work_.rate.data());
      for (const double a : work_.rate)
        scales_.velocity = std::max(scales_.velocity, std::abs(a) * crossing);
    }
    scales_.velocity = communicator_.max(scales_.velocity);
    scales_.displacement = scales_.velocity * crossing;
    scales_.energy = mass * scales_.velocity * scales_.velocity;
    scales_.inner_step =
        1e-2 * (speed > 0. ? discretization_.crossing_time() : end);
  }

  /** @p result: v with the impulses that joints and driven boundaries need. */
  template <int dim>
  void SmoothEquations<dim>::project(const double t, const double *v,
                                     Values &result)
  {
    result.assign(v, v + n_);
    if (joined_.empty())
      return;
    set_motion(t, work_.given);
    free_->relative_velocity(v, work_.rows.data());
    for (std::size_t k = 0; k < n_rows_; ++k)
      work_.rows[k] = work_.given[k] - work_.rows[k];
    counters.iterations += joined_.solve(
        work_.rows, 1e-14 * scales_.velocity * std::sqrt(double(n_rows_)),
        work_.mu);
    free_->add_velocity_change(work_.mu.data(), result.data());
  }

  /** force -= H^T w C H q. */
  template <int dim>
  void SmoothEquations<dim>::add_springs(const double *q, Values &force) const
  {
    Values jump(n_rows_, 0.), sum(n_);
    bool any = false;
    free_->relative_velocity(q, jump.data());
    for (std::size_t i = 0; i < kind_.size(); ++i) {
      const auto &joint = problem_.interactions[problem_.interaction[i]];
      const bool elastic = kind_[i] == PointKind::elastic;
      any |= elastic;
      for (unsigned int c = 0; c < dim; ++c)
        jump[i * dim + c] *=
            !elastic ? 0.
                     : -problem_.weight[i] * joint.normal_stiffness *
                           (c == 0 ? 1. : joint.stiffness_ratio);
    }
    if (!communicator_.any(any))
      return;
    free_->generalised_impulse(jump.data(), sum.data());
    for (std::size_t k = 0; k < n_; ++k)
      force[k] += sum[k];
  }

  /** Without the forces of joints and driven boundaries. */
  template <int dim>
  auto SmoothEquations<dim>::acceleration(const double t, const double *q)
      -> const Values &
  {
    delassus_.apply(Operator::stiffness, q, work_.force.data());
    const Values &external = loads(t);
    for (std::size_t k = 0; k < n_; ++k)
      work_.force[k] = external[k] - work_.force[k];
    add_springs(q, work_.force);
    free_->apply(Operator::inverse, work_.force.data(), work_.rate.data());
    return work_.rate;
  }

  /** lambda: forces of the rows, W lambda = g' - H a. */
  template <int dim>
  void SmoothEquations<dim>::set_reaction_forces(const double t,
                                                 const double *a)
  {
    if (joined_.empty())
      return;
    Values rate(n_rows_);
    set_motion_rate(t, rate);
    free_->relative_velocity(a, work_.rows.data());
    double scale = 0.;
    for (std::size_t k = 0; k < n_rows_; ++k) {
      scale = std::max(scale, std::abs(work_.rows[k]));
      work_.rows[k] = rate[k] - work_.rows[k];
    }
    counters.iterations += joined_.solve(work_.rows,
                                         1e-13 * communicator_.max(scale) *
                                             std::sqrt(double(n_rows_)),
                                         work_.lambda);
  }

  template <int dim>
  void SmoothEquations<dim>::evaluate(const double t, const Vector &y,
                                      Vector &rate)
  {
    ++counters.evaluations;
    project(t, velocity(y), work_.v);
    std::copy(work_.v.begin(), work_.v.end(), displacement(rate));
    const Values &a = acceleration(t, displacement(y));
    std::copy(a.begin(), a.end(), velocity(rate));
    Values power(n_ + n_rows_, 0.);
    const Values &external = loads(t);
    for (std::size_t k = 0; k < n_; ++k)
      power[k] = external[k] * work_.v[k];
    if (moves_) {
      set_reaction_forces(t, velocity(rate));
      const std::size_t n_owned = discretization_.points().n_owned * dim;
      for (std::size_t k = 0; k < n_owned; ++k)
        power[n_ + k] = work_.lambda[k] * work_.given[k];
    }
    const double sum = communicator_.sum(power);
    if (communicator_.is_root())
      rate.local_element(2 * n_) = sum;
  }

  /**
   * (1 - gamma J) x = b in the velocity w that the rows allow:
   *
   *     (M + gamma^2 K) w + ... = M b_v - gamma K b_q + H^T P,
   *
   * springs as rows of compliance 1 / (gamma^2 w C). x_q = b_q + gamma w.
   */
  template <int dim>
  void SmoothEquations<dim>::solve_shifted(const double gamma, const Vector &b,
                                           Vector &x)
  {
    ++counters.linear_solves;
    const auto spring = [&](const std::size_t k) {
      const auto &joint = problem_.interactions[problem_.interaction[k / dim]];
      return problem_.weight[k / dim] * joint.normal_stiffness *
             (k % dim == 0 ? 1. : joint.stiffness_ratio);
    };
    if (gamma != gamma_) {
      gamma_ = gamma;
      delassus_.reinit(gamma, 1.);
      Values D = D_joined_;
      for (std::size_t k = 0; k < n_rows_; ++k)
        if (kind_[k / dim] == PointKind::elastic)
          D[k] = 1. / (gamma * gamma * spring(k));
      shifted_.set(D);
    }
    Values w(n_), momentum(n_), product(n_), P(n_rows_, 0.), U(n_rows_),
        jump(n_rows_);
    delassus_.apply(Operator::mass, velocity(b), momentum.data());
    delassus_.apply(Operator::stiffness, displacement(b), product.data());
    for (std::size_t k = 0; k < n_; ++k)
      momentum[k] -= gamma * product[k];
    delassus_.apply(Operator::inverse, momentum.data(), w.data());
    if (!shifted_.empty()) {
      free_->relative_velocity(w.data(), U.data());
      free_->relative_velocity(displacement(b), jump.data());
      double norm = 0.;
      for (std::size_t k = 0; k < n_rows_; ++k) {
        U[k] = -U[k] -
               (kind_[k / dim] == PointKind::elastic ? jump[k] / gamma : 0.);
        norm = std::max(norm, std::abs(U[k]));
      }
      counters.iterations += shifted_.solve(
          U, 1e-13 * communicator_.max(norm) * std::sqrt(double(n_rows_)), P);
      delassus_.add_velocity_change(P.data(), w.data());
    }
    for (std::size_t k = 0; k < n_; ++k)
      displacement(x)[k] = displacement(b)[k] + gamma * w[k];
    Values force(n_);
    delassus_.apply(Operator::stiffness, displacement(x), force.data());
    for (double &f : force)
      f = -f;
    add_springs(displacement(x), force);
    free_->apply(Operator::inverse, force.data(), product.data());
    for (std::size_t k = 0; k < n_; ++k)
      velocity(x)[k] = velocity(b)[k] + gamma * product[k];
    if (communicator_.is_root())
      x.local_element(2 * n_) = b.local_element(2 * n_);
  }

  template class SmoothEquations<2>;
  template class SmoothEquations<3>;
} // namespace nsfd
