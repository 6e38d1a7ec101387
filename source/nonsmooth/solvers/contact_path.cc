#include "contact_path.h"

#include "nonsmooth/springs.h"

#include "core/stop_request.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  template <int dim>
  ContactPath<dim>::ContactPath(const OneStepProblem<dim> &problem,
                                const DelassusOperator<dim> &delassus,
                                BodySystem<dim> &system,
                                const SolverControl &control, Vector &impulse,
                                LawEvaluation<dim> &evaluation,
                                SolverReport &report)
      : problem_(problem), delassus_(delassus), system_(system),
        control_(control), impulse_(impulse), evaluation_(evaluation),
        report_(report), frozen_(problem.n_points),
        is_candidate_(problem.n_points, 0), others_(problem.n_points, 1)
  {
    for (std::size_t i = 0; i < problem.n_points; ++i)
      if (problem.contact[i] && has_frozen_law<dim>(problem, i) &&
          problem.kind[i] != PointKind::prescribed) {
        is_candidate_[i] = 1;
        others_[i] = 0;
      }
    at_.y.assign(delassus.bodies().n_dofs(), 0.);
    b_ = residual_ = direction_.y = at_.y;
    at_.U.assign(problem.n_points * dim, 0.);
    direction_.U = at_.U;
    begin();
  }

  /** From the impulses at hand, with the velocities that follow. */
  template <int dim>
  void ContactPath<dim>::begin()
  {
    evaluation_.update(impulse_);
    judge();
    std::fill(at_.y.begin(), at_.y.end(), 0.);
    delassus_.add_velocity_change(impulse_.data(), at_.y.data());
    at_.U = evaluation_.velocity;
    at_.P = impulse_;
  }

  /** The laws at the state of the path, which need not be in equilibrium. */
  template <int dim>
  void ContactPath<dim>::look()
  {
    impulse_ = at_.P;
    evaluation_.velocity = at_.U;
    evaluation_.update_laws(impulse_);
  }

  /** Keep the best impulses; true below the tolerance. */
  template <int dim>
  bool ContactPath<dim>::judge()
  {
    if (evaluation_.error < best_.error) {
      best_.error = evaluation_.error;
      best_.P = impulse_;
    }
    return evaluation_.error <= control_.tolerance;
  }

  template <int dim>
  void ContactPath<dim>::restore()
  {
    if (best_.P.empty())
      return;
    impulse_ = best_.P;
    evaluation_.update(impulse_);
  }

  /** b = H^T P - M_hat y. */
  template <int dim>
  void ContactPath<dim>::set_imbalance(const Vector &P)
  {
    delassus_.generalised_impulse(P.data(), b_.data());
    system_.apply(at_.y, residual_);
    for (std::size_t j = 0; j < b_.size(); ++j)
      b_[j] -= residual_[j];
  }

  /**
   * The velocities that answer to @p P: M_hat (y + dy) = H^T (P - S dU), with
   * y = 0 @p from_rest.
   */
  template <int dim>
  void ContactPath<dim>::equilibrate(const Vector &P, const bool from_rest)
  {
    if (from_rest)
      delassus_.generalised_impulse(P.data(), b_.data());
    else
      set_imbalance(P);
    report_.krylov += system_.solve(b_, direction_.y);
    delassus_.relative_velocity(direction_.y.data(), direction_.U.data());
  }

  /** Springs that stay as they are, and joints: the same in every step. */
  template <int dim>
  bool ContactPath<dim>::is_linear(const std::size_t i) const
  {
    return is_held(i) || evaluation_.linear(i) != nullptr;
  }

  /**
   * Between what the bodies oppose to a velocity of the point alone and to one
   * of the whole of them.
   */
  template <int dim>
  double ContactPath<dim>::stiffness_at(const std::size_t i,
                                        const unsigned int c,
                                        const double balance) const
  {
    const double alone = system_.impedance()[i * dim + c],
                 together = 1. / evaluation_.majorant(i, c);
    return together * std::pow(std::max(1., alone / together), balance);
  }

  template <int dim>
  bool ContactPath<dim>::alternate(const unsigned int count,
                                   const double balance)
  {
    const std::size_t n = problem_.n_points;
    look();
    std::vector<char> linear(n);
    for (std::size_t i = 0; i < n; ++i)
      linear[i] = is_linear(i);
    laws_.update(problem_, evaluation_, impulse_, linear);
    at_.S = laws_.stiffness;
    Vector rho(n * dim, 0.), target(n * dim);
    for (std::size_t i = 0; i < n; ++i)
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t j = i * dim + c;
        if (is_held(i))
          rho[j] = at_.S[j * dim + c];
        else if (!linear[i]) // alike along the face
          rho[j] = at_.S[j * dim + c] =
              stiffness_at(i, std::min(c, 1u), balance);
        target[j] = problem_.given_velocity[j]; // of points that are held
      }
    if (!system_.factorise(at_.S))
      return false;
    ++report_.newton;

    // the affine part of the linear points
    Vector offset(n * dim, 0.);
    for (std::size_t i = 0; i < n; ++i)
      if (linear[i] && !is_held(i))
        for (unsigned int c = 0; c < dim; ++c) {
          offset[i * dim + c] = at_.P[i * dim + c] + laws_.change[i * dim + c];
          for (unsigned int d = 0; d < dim; ++d)
            offset[i * dim + c] +=
                laws_.stiffness[(i * dim + c) * dim + d] * at_.U[i * dim + d];
        }
    std::vector<Reach> reach(n);
    for (std::size_t i = 0; i < n; ++i)
      reach[i] = evaluation_.solutions[i].reach;
    const auto solve_law = [&](const std::size_t i) {
      std::array<double, dim> local;
      for (unsigned int c = 0; c < dim; ++c)
        local[c] = at_.U[i * dim + c] - at_.P[i * dim + c] / rho[i * dim + c];
      const auto solution =
          solve_point<dim>(problem_, i, local, 1. / rho[i * dim],
                           1. / rho[i * dim + 1], reach[i]);
      reach[i] = solution.reach;
      for (unsigned int c = 0; c < dim; ++c) {
        at_.P[i * dim + c] = solution.impulse[c];
        target[i * dim + c] = solution.velocity[c];
      }
    };
    for (std::size_t i = 0; i < n; ++i)
      if (!linear[i])
        solve_law(i);
    Vector trial(n * dim);
    bool solved = false;
    for (unsigned int k = 0; k < count && !solved; ++k) {
      stop_request::leave_if_due();
      for (std::size_t j = 0; j < n * dim; ++j) {
        const std::size_t i = j / dim;
        if (!linear[i] || is_held(i))
          trial[j] = at_.P[j] + rho[j] * (target[j] - at_.U[j]);
        else {
          trial[j] = offset[j];
          for (unsigned int d = 0; d < dim; ++d)
            trial[j] -= laws_.stiffness[j * dim + d] * at_.U[i * dim + d];
        }
      }
      equilibrate(trial, false);
      for (std::size_t j = 0; j < at_.y.size(); ++j)
        at_.y[j] += direction_.y[j];
      for (std::size_t j = 0; j < n * dim; ++j)
        at_.U[j] += direction_.U[j];
      for (std::size_t i = 0; i < n; ++i) {
        if (linear[i]) {
          for (std::size_t j = i * dim; j < (i + 1) * dim; ++j)
            if (is_held(i))
              at_.P[j] += rho[j] * (target[j] - at_.U[j]);
            else {
              at_.P[j] = offset[j];
              for (unsigned int d = 0; d < dim; ++d)
                at_.P[j] -= laws_.stiffness[j * dim + d] * at_.U[i * dim + d];
            }
          continue;
        }
        solve_law(i);
      }
      if (k % 10 == 9 || k + 1 == count) {
        impulse_ = at_.P;
        evaluation_.update(impulse_);
        solved = judge();
      }
    }
    return solved;
  }

  /** Of the springs of a candidate at U: impulse and its slope. */
  template <int dim>
  void ContactPath<dim>::spring(const std::size_t i, double *impulse,
                                double *slope) const
  {
    const auto &secant = frozen_[i].secant;
    const double wh = problem_.weight[i] * problem_.time_step;
    const auto normal = springs::normal_law<dim>(problem_, i, secant.normal);
    impulse[0] = wh * normal.at(at_.U[i * dim]);
    slope[0] = wh * normal.derivative(at_.U[i * dim]);
    const auto tangential =
        springs::tangential_spring<dim>(problem_, secant.tangential);
    for (unsigned int c = 1; c < dim; ++c) {
      slope[c] = wh * tangential.stiffness * tangential.slope;
      impulse[c] = wh * tangential.stiffness *
                   (springs::tangential_offset<dim>(problem_, i, c) +
                    tangential.slope * at_.U[i * dim + c]);
    }
  }

  /** Candidates with the damage of the best impulses, which now holds. */
  template <int dim>
  void ContactPath<dim>::find_candidates()
  {
    candidates_.clear();
    for (std::size_t i = 0; i < problem_.n_points; ++i) {
      if (!is_candidate_[i])
        continue;
      const auto &solution = evaluation_.solutions[i];
      frozen_[i] = solution.frozen;
      Candidate candidate{};
      candidate.point = i;
      candidate.friction =
          frozen_state<dim>(problem_, i, solution.reach, 1.).threshold;
      candidates_.push_back(candidate);
    }
  }

  template <int dim>
  void ContactPath<dim>::start(const double floor, const double centre)
  {
    find_candidates();
    double sum = 0.;
    for (auto &x : candidates_) {
      const std::size_t i = x.point;
      double pull[dim], slope[dim];
      spring(i, pull, slope);
      for (unsigned int c = 0; c < dim; ++c)
        x.r[c] = (at_.P[i * dim + c] + pull[c]) / problem_.weight[i];
      sum += std::abs(x.r[0]);
    }
    mean_impulse_ = candidates_.empty() ? 0. : sum / double(candidates_.size());
    for (auto &x : candidates_) {
      const std::size_t i = x.point;
      const double R_N = impedance(i, 0), R_T = impedance(i, 1);
      const double u_N = at_.U[i * dim] - problem_.target[i];
      double largest = std::max(std::abs(x.r[0]), R_N * std::abs(u_N));
      for (unsigned int c = 1; c < dim; ++c)
        largest =
            std::max({largest, std::abs(x.r[c]),
                      R_T * std::abs(at_.U[i * dim + c] +
                                     problem_.sliding_offset[i * dim + c])});
      x.scale = floor == 1. || mean_impulse_ == 0.
                    ? 1.
                    : std::min(1., std::max(floor, largest / mean_impulse_));
      const double y = x.r[0] - R_N * u_N;
      const double q = std::hypot(y, 2. * centre * mean_impulse_ * x.scale);
      // the small one of the two without cancellation
      const double big = (q + std::abs(y)) / 2.;
      const double small =
          big > 0. ? springs::square(centre * mean_impulse_ * x.scale) / big
                   : 0.;
      x.r[0] = y > 0. ? big : small;
      x.z = (y > 0. ? small : big) / R_N;
    }
  }

  template <int dim>
  double ContactPath<dim>::mean_gap() const
  {
    double sum = 0.;
    for (const auto &x : candidates_)
      sum += x.z * x.r[0] / springs::square(x.scale);
    return sum / double(candidates_.size());
  }

  /**
   * z r_N = eps s^2,  eta r_T + mu r_N u_T = 0,  eta^2 = |u_T|^2 + delta^2 s^2.
   */
  template <int dim>
  void ContactPath<dim>::linearise(Candidate &x, const double barrier,
                                   const double smoothing)
  {
    const std::size_t i = x.point;
    const double s2 = springs::square(x.scale), mu = x.friction;
    const double u_N = at_.U[i * dim] - problem_.target[i];
    const double stiff = x.r[0] / x.z;
    std::fill(x.S, x.S + dim * dim, 0.);
    std::fill(x.k, x.k + dim, 0.);
    x.S[0] = stiff;
    x.k[0] = (barrier * s2 - x.z * x.r[0]) / x.z + stiff * (x.z - u_N);
    if (mu == 0.) {
      for (unsigned int c = 1; c < dim; ++c)
        x.k[c] = -x.r[c];
      return;
    }
    double u[dim] = {}, eta = springs::square(smoothing) * s2;
    for (unsigned int c = 1; c < dim; ++c) {
      u[c] = at_.U[i * dim + c] + problem_.sliding_offset[i * dim + c];
      eta += u[c] * u[c];
    }
    eta = std::sqrt(eta);
    for (unsigned int c = 1; c < dim; ++c) {
      x.k[c] = -x.r[c] - mu * u[c] / eta * (x.r[0] + x.k[0]);
      x.S[c * dim] = -mu * u[c] / eta * stiff;
      for (unsigned int d = 1; d < dim; ++d)
        x.S[c * dim + d] =
            ((c == d ? mu * x.r[0] : 0.) + x.r[c] * u[d] / eta) / eta;
    }
  }

  /** The largest share of a step that keeps r_N and z positive. */
  template <int dim>
  double ContactPath<dim>::path_length(const Candidate &x, const double *dr,
                                       const double dz) const
  {
    double length = 1.;
    if (dr[0] < 0.)
      length = std::min(length, -0.99 * x.r[0] / dr[0]);
    if (dz < 0.)
      length = std::min(length, -0.99 * x.z / dz);
    return length;
  }

  template <int dim>
  bool ContactPath<dim>::step(const double sigma, double &alpha)
  {
    const std::size_t n = problem_.n_points;
    const double gap = mean_gap();
    double mean = 0.;
    for (const auto &x : candidates_)
      mean += x.r[0];
    mean /= double(candidates_.size());
    const double smoothing = gap / mean;

    look();
    laws_.update(problem_, evaluation_, at_.P, others_);
    at_.S = laws_.stiffness;
    Vector wanted(laws_.change);
    for (auto &x : candidates_) {
      const std::size_t i = x.point;
      const double w = problem_.weight[i];
      linearise(x, sigma * gap, smoothing);
      double pull[dim], slope[dim];
      spring(i, pull, slope);
      for (unsigned int c = 0; c < dim; ++c) {
        at_.P[i * dim + c] = w * x.r[c] - pull[c];
        wanted[i * dim + c] = w * x.k[c];
        for (unsigned int d = 0; d < dim; ++d)
          at_.S[(i * dim + c) * dim + d] =
              w * x.S[c * dim + d] + (c == d ? slope[c] : 0.);
      }
    }
    if (!system_.factorise(at_.S))
      return false;
    ++report_.newton;
    set_imbalance(at_.P);
    report_.krylov +=
        system_.respond(b_, wanted, direction_.y, direction_.U, direction_.P);

    alpha = 1.;
    // a stiff contact takes its slack from its impulse, which is the one of the
    // two that is known to all digits
    const auto change = [&](const Candidate &x, double *dr) {
      const std::size_t j = x.point * dim;
      double pull[dim], slope[dim];
      spring(x.point, pull, slope);
      for (unsigned int c = 0; c < dim; ++c)
        dr[c] = (direction_.P[j + c] + slope[c] * direction_.U[j + c]) /
                problem_.weight[x.point];
      if (x.r[0] > x.z * impedance(x.point, 0))
        return (sigma * gap * springs::square(x.scale) - x.z * dr[0]) / x.r[0] -
               x.z;
      return direction_.U[j] - (x.z - (at_.U[j] - problem_.target[x.point]));
    };
    double dr[dim];
    for (const auto &x : candidates_) {
      const double dz = change(x, dr);
      alpha = std::min(alpha, path_length(x, dr, dz));
    }
    if (!(alpha > 0.))
      return false;
    for (auto &x : candidates_) {
      const double dz = change(x, dr);
      x.z += alpha * dz;
      double size = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        x.r[c] += alpha * dr[c];
        if (c > 0)
          size += x.r[c] * x.r[c];
      }
      size = std::sqrt(size);
      const double bound = x.friction * x.r[0];
      if (size > bound)
        for (unsigned int c = 1; c < dim; ++c)
          x.r[c] *= bound / size;
    }
    for (std::size_t i = 0; i < n; ++i)
      if (others_[i])
        for (unsigned int c = 0; c < dim; ++c)
          at_.P[i * dim + c] += alpha * direction_.P[i * dim + c];
    for (std::size_t j = 0; j < at_.y.size(); ++j)
      at_.y[j] += alpha * direction_.y[j];
    for (std::size_t j = 0; j < n * dim; ++j)
      at_.U[j] += alpha * direction_.U[j];
    collect();
    return true;
  }

  /** All impulses, and what the full laws say about them. */
  template <int dim>
  void ContactPath<dim>::collect()
  {
    for (const auto &x : candidates_) {
      double pull[dim], slope[dim];
      spring(x.point, pull, slope);
      for (unsigned int c = 0; c < dim; ++c)
        at_.P[x.point * dim + c] = problem_.weight[x.point] * x.r[c] - pull[c];
    }
    impulse_ = at_.P;
    evaluation_.update(impulse_);
  }

  template <int dim>
  bool ContactPath<dim>::follow(const Stage &stage, const unsigned int limit)
  {
    look();
    start(stage.floor, stage.centre);
    if (candidates_.empty() || !(mean_impulse_ > 0.))
      return false;
    const double first_gap = mean_gap();
    double alpha = 1.;
    unsigned int short_steps = 0;
    for (unsigned int k = 0; k < limit; ++k) {
      stop_request::leave_if_due();
      const double sigma = alpha > 0.9   ? 0.1
                           : alpha > 0.5 ? 0.3
                           : alpha > 0.1 ? 0.6
                                         : 1.;
      if (!step(sigma, alpha) || !(evaluation_.error < 1e300))
        break;
      if (judge())
        return true;
      short_steps = alpha < 0.1 ? short_steps + 1 : 0;
      if (best_.error < 1e-5 && best_.error < 0.1 * refined_) {
        refined_ = best_.error;
        if (refine())
          return true;
      }
      if (short_steps >= 4 && mean_gap() < 1e-9 * first_gap)
        break;
      if (short_steps >= 10)
        break;
      if (mean_gap() < 1e-15 * first_gap)
        break;
    }
    return false;
  }

  template class ContactPath<2>;
  template class ContactPath<3>;
} // namespace nsfd
