#include "body_system.h"

#include "core/cost.h"
#include "discretization/point_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <stdexcept>
#include <utility>

namespace nsfd
{
  namespace
  {
    template <int dim>
    bool are_symmetric(const std::vector<double> &S)
    {
      for (std::size_t i = 0; i < S.size(); i += dim * dim)
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int c = 0; c < k; ++c)
            if (S[i + k * dim + c] != S[i + c * dim + k])
              return false;
      return true;
    }
  } // namespace

  template <int dim>
  BodySystem<dim>::BodySystem(const DelassusOperator<dim> &delassus,
                              const double time_step, const double theta,
                              const long long largest_factor,
                              const TiedNodes<dim> *const ties)
      : delassus_(delassus), largest_factor_(largest_factor), ties_(ties)
  {
    find_faces();
    find_pattern();
    reinit(time_step, theta);
  }

  template <int dim>
  void BodySystem<dim>::reinit(const double time_step, const double theta)
  {
    time_step_ = time_step;
    theta_ = theta;
    shares_ = delassus_.shares(time_step, theta);
    fill_bodies();
    find_impedance();
  }

  /** Rows of H at the points of every face, without the unknowns they miss. */
  template <int dim>
  void BodySystem<dim>::find_faces()
  {
    const auto &points = delassus_.points();
    const auto &bodies = delassus_.bodies();
    // (body, slot, sign) of every side of every point
    struct Side {
      std::size_t body, slot;
      double sign;
    };
    std::vector<std::vector<Side>> sides(points.n_points);
    for_all_places(bodies, points.n_points,
                   [&](const std::size_t body, const unsigned int slot,
                       const std::size_t point, const unsigned int side) {
                     sides[point].push_back({body, slot, side == 1 ? 1. : -1.});
                   });

    faces_.resize(points.faces.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const auto &face = points.faces[f];
      FaceRows &mine = faces_[f];
      mine.first = face.first;
      mine.count = face.count;
      if (ties_ && face.count > 0 && ties_->points()[face.first])
        continue; // its rows say nothing
      for (unsigned int p = face.first; p < face.first + face.count; ++p)
        for (const Side &side : sides[p]) {
          const auto &body = bodies.classes[bodies.class_of[side.body]];
          double largest = 0.;
          for (const double value : body.trace.values)
            largest = std::max(largest, std::abs(value));
          for (unsigned int j = 0; j < body.n_dofs; ++j)
            for (unsigned int c = 0; c < dim; ++c)
              if (std::abs(body.trace(unsigned(side.slot) * dim + c, j)) >
                  1e-12 * largest) {
                mine.dofs.push_back(int(bodies.first_dof[side.body] + j));
                break;
              }
        }
      std::sort(mine.dofs.begin(), mine.dofs.end());
      mine.dofs.erase(std::unique(mine.dofs.begin(), mine.dofs.end()),
                      mine.dofs.end());
      const std::size_t n = mine.dofs.size();
      mine.rows.assign(std::size_t(face.count) * dim * n, 0.);
      for (unsigned int q = 0; q < face.count; ++q) {
        const double *Q = points.axes(face.first + q);
        for (const Side &side : sides[face.first + q]) {
          const auto &body = bodies.classes[bodies.class_of[side.body]];
          for (std::size_t a = 0; a < n; ++a) {
            const std::size_t dof = std::size_t(mine.dofs[a]);
            if (dof < bodies.first_dof[side.body] ||
                dof >= bodies.first_dof[side.body + 1])
              continue;
            const unsigned int j = unsigned(dof - bodies.first_dof[side.body]);
            for (unsigned int k = 0; k < dim; ++k)
              for (unsigned int c = 0; c < dim; ++c)
                mine.rows[(q * dim + k) * n + a] +=
                    side.sign * Q[k * dim + c] *
                    body.trace(unsigned(side.slot) * dim + c, j);
          }
        }
      }
    }
  }

  template <int dim>
  void BodySystem<dim>::find_pattern()
  {
    const auto &bodies = delassus_.bodies();
    std::vector<std::vector<int>> column(ties_ ? ties_->n_unknowns()
                                               : bodies.n_dofs());
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (std::size_t j = bodies.first_dof[b]; j < bodies.first_dof[b + 1];
           ++j)
        for (std::size_t i = bodies.first_dof[b]; i < bodies.first_dof[b + 1];
             ++i)
          column[unknown(j)].push_back(int(unknown(i)));
    for (const FaceRows &face : faces_)
      for (const int j : face.dofs)
        for (const int i : face.dofs)
          column[unknown(std::size_t(j))].push_back(
              int(unknown(std::size_t(i))));
    matrix_.start.assign(1, 0);
    for (auto &rows : column) {
      std::sort(rows.begin(), rows.end());
      rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
      matrix_.column.insert(matrix_.column.end(), rows.begin(), rows.end());
      matrix_.start.push_back(int(matrix_.column.size()));
    }
    const auto entry = [&](const int row, const int dof) {
      const int i = int(unknown(std::size_t(row))),
                j = int(unknown(std::size_t(dof)));
      const auto begin = matrix_.column.begin() + matrix_.start[j],
                 end = matrix_.column.begin() + matrix_.start[j + 1];
      return int(std::lower_bound(begin, end, i) - matrix_.column.begin());
    };
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (std::size_t j = bodies.first_dof[b]; j < bodies.first_dof[b + 1];
           ++j)
        for (std::size_t i = bodies.first_dof[b]; i < bodies.first_dof[b + 1];
             ++i)
          body_entries_.push_back(entry(int(i), int(j)));
    for (const FaceRows &face : faces_) {
      entries_.emplace_back();
      for (const int i : face.dofs)
        for (const int j : face.dofs)
          entries_.back().push_back(entry(i, j));
    }
  }

  template <int dim>
  void BodySystem<dim>::fill_bodies()
  {
    const auto &bodies = delassus_.bodies();
    bodies_.assign(matrix_.column.size(), 0.);
    std::size_t next = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const auto &body = bodies.classes[bodies.class_of[b]];
      for (unsigned int j = 0; j < body.n_dofs; ++j)
        for (unsigned int i = 0; i < body.n_dofs; ++i)
          bodies_[body_entries_[next++]] += matrix_entry(body, i, j);
    }
  }

  template <int dim>
  void BodySystem<dim>::find_impedance()
  {
    const auto &points = delassus_.points();
    const auto &bodies = delassus_.bodies();
    impedance_.assign(points.n_points * dim, 0.);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const FaceRows &face = faces_[f];
      const std::size_t n = face.dofs.size();
      for (unsigned int k = 0; k < points.faces[f].count * dim; ++k) {
        const double *h = &face.rows[k * n];
        double hh = 0., hMh = 0.;
        for (std::size_t a = 0; a < n; ++a) {
          hh += h[a] * h[a];
          const std::size_t b =
              std::upper_bound(bodies.first_dof.begin(), bodies.first_dof.end(),
                               std::size_t(face.dofs[a])) -
              bodies.first_dof.begin() - 1;
          const auto &body = bodies.classes[bodies.class_of[b]];
          for (std::size_t c = 0; c < n; ++c)
            if (std::size_t(face.dofs[c]) >= bodies.first_dof[b] &&
                std::size_t(face.dofs[c]) < bodies.first_dof[b + 1])
              hMh += h[a] * h[c] *
                     matrix_entry(body,
                                  unsigned(face.dofs[a] - bodies.first_dof[b]),
                                  unsigned(face.dofs[c] - bodies.first_dof[b]));
        }
        impedance_[std::size_t(points.faces[f].first) * dim + k] =
            hh > 0. ? hMh / (hh * hh) : 0.;
      }
    }
  }

  template <int dim>
  void BodySystem<dim>::assemble(const Vector &S)
  {
    const auto &points = delassus_.points();
    matrix_.value = bodies_;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const FaceRows &face = faces_[f];
      const std::size_t n = face.dofs.size();
      work_.resize(dim * n);
      for (unsigned int q = 0; q < points.faces[f].count; ++q) {
        const double *s =
            &S[std::size_t(points.faces[f].first + q) * dim * dim];
        const double *h = &face.rows[q * dim * n];
        if (std::all_of(s, s + dim * dim,
                        [](const double x) { return x == 0.; }))
          continue;
        for (unsigned int k = 0; k < dim; ++k)
          for (std::size_t a = 0; a < n; ++a) {
            double value = 0.;
            for (unsigned int c = 0; c < dim; ++c)
              value += s[k * dim + c] * h[c * n + a];
            work_[k * n + a] = value;
          }
        for (std::size_t a = 0; a < n; ++a)
          for (unsigned int k = 0; k < dim; ++k) {
            const double left = h[k * n + a];
            if (left == 0.)
              continue;
            for (std::size_t b = 0; b < n; ++b)
              matrix_.value[entries_[f][a * n + b]] += left * work_[k * n + b];
          }
      }
    }
  }

  template <int dim>
  bool BodySystem<dim>::factorise(const Vector &S)
  {
    const Charge charge(Cost::preconditioner);
    stiffness_ = S;
    const long long n = matrix_.n_rows();
    assemble(S);
    means_ = Means::cholesky;
    if ((ties_ || n <= 10 * largest_factor_) && are_symmetric<dim>(S) &&
        factorise_symmetric())
      return true;
    if (ties_ || n <= largest_factor_ || !may_iterate_)
      return factorise_general();
    means_ = Means::iteration;
    if (!iteration_)
      iteration_ = std::make_unique<BodyKrylov>(
          dim, delassus_.bodies().first_dof, faces_);
    assemble(iteration_->cap(S, impedance_));
    return iteration_->prepare(matrix_, bodies_);
  }

  template <int dim>
  bool BodySystem<dim>::factorise_general()
  {
    means_ = Means::factor;
    const bool is_new = !factor_;
    if (is_new)
      factor_ = std::make_unique<SparseLU>();
    return factor_->factorise(matrix_, is_new);
  }

  /** True if there is a factor now, with which to begin again. */
  template <int dim>
  bool BodySystem<dim>::iterates_in_vain(const unsigned int iterations)
  {
    if (iterations < BodyKrylov::most_iterations ||
        matrix_.n_rows() > 10 * largest_factor_)
      return false;
    may_iterate_ = false;
    iteration_.reset();
    assemble(stiffness_);
    return factorise_general();
  }

  /** False if the matrix is not positive definite. */
  template <int dim>
  bool BodySystem<dim>::factorise_symmetric()
  {
    const bool is_new = !cholesky_;
    if (is_new)
      cholesky_ = make_cholesky_solver(delassus_.communicator());
    try {
      cholesky_->prepare(matrix_, CoarseSpace(), is_new);
    } catch (const std::runtime_error &) {
      return false;
    }
    return true;
  }

  template <int dim>
  unsigned int BodySystem<dim>::solve(const Vector &b, Vector &x,
                                      const double tolerance)
  {
    const Charge charge(Cost::precondition);
    if (means_ == Means::iteration) {
      const Vector none(delassus_.points().n_points * dim, 0.);
      Vector dP;
      x.resize(b.size());
      const auto count = iteration_->solve(b, none, tolerance, x, dP);
      return iterates_in_vain(count) ? count + solve(b, x, tolerance) : count;
    }
    const auto substitute = [&](const Vector &right, Vector &result) {
      result.resize(right.size());
      if (means_ == Means::cholesky)
        cholesky_->solve(right.data(), result.data(), 0.);
      else
        factor_->solve(right.data(), result.data());
    };
    if (!ties_)
      substitute(b, x);
    else {
      Vector sums, motion;
      ties_->fold(b, sums);
      substitute(sums, motion);
      ties_->spread(motion, x);
    }
    return 1;
  }

  template <int dim>
  unsigned int BodySystem<dim>::respond(const Vector &b, const Vector &change,
                                        Vector &x, Vector &dU, Vector &dP,
                                        const double tolerance)
  {
    dU.resize(change.size());
    if (means_ == Means::iteration) {
      const Charge charge(Cost::precondition);
      const auto count = iteration_->solve(b, change, tolerance, x, dP);
      if (iterates_in_vain(count))
        return count + respond(b, change, x, dU, dP, tolerance);
      delassus_.relative_velocity(x.data(), dU.data());
      return count;
    }
    work_.resize(b.size());
    delassus_.generalised_impulse(change.data(), work_.data());
    for (std::size_t k = 0; k < b.size(); ++k)
      work_[k] += b[k];
    const auto count = solve(work_, x);
    delassus_.relative_velocity(x.data(), dU.data());
    dP = change;
    for (std::size_t j = 0; j < dP.size(); ++j)
      for (unsigned int c = 0; c < dim; ++c)
        dP[j] -= stiffness_[j * dim + c] * dU[j / dim * dim + c];
    return count;
  }

  template <int dim>
  void BodySystem<dim>::apply(const Vector &x, Vector &y)
  {
    y.resize(x.size());
    work_.resize(x.size());
    delassus_.apply(DelassusOperator<dim>::Operator::mass, x.data(), y.data());
    delassus_.apply(DelassusOperator<dim>::Operator::stiffness, x.data(),
                    work_.data());
    for (std::size_t k = 0; k < x.size(); ++k)
      y[k] += shares_.stiffness * work_[k];
    if (delassus_.terms().viscous_theta == 0.)
      return;
    delassus_.apply(DelassusOperator<dim>::Operator::damping, x.data(),
                    work_.data());
    for (std::size_t k = 0; k < x.size(); ++k)
      y[k] += shares_.damping * work_[k];
  }

  template class BodySystem<2>;
  template class BodySystem<3>;
} // namespace nsfd
