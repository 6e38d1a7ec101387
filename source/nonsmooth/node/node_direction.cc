#include "node_system.h"

#include "linear_algebra/narrow_order.h"
#include "linear_algebra/small_matrix.h"
#include "point_slopes.h"

#include <algorithm>
#include <cmath>

// Newton's directions of NodeSystem.

namespace nsfd
{
  namespace
  {
    /** B_g^T K B_f of all pairs of ends. */
    template <int dim>
    void add_with_matrices(
        const PointEnds &ends, const std::array<double, dim * dim> &K,
        const std::vector<int> &unknown,
        const std::vector<std::array<double, dim>> &root_mass, DenseLU &matrix)
    {
      using Matrix = std::array<double, dim * dim>;
      const auto for_blocks = [&ends](const auto &visit) {
        for (unsigned int k = 0; k < ends.n_shares(); ++k) {
          Matrix B{};
          for (unsigned int c = 0; c < dim; ++c)
            B[c * dim + c] = ends.shares[k];
          visit(ends.groups[k], B.data());
        }
        for_matrices(&ends, visit);
      };
      for_blocks([&](const int g, const double *B_g) {
        Matrix left{}; // B_g^T K
        for (unsigned int r = 0; r < dim; ++r)
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int e = 0; e < dim; ++e)
              left[r * dim + c] += B_g[e * dim + r] * K[e * dim + c];
        for_blocks([&](const int f, const double *B_f) {
          for (unsigned int r = 0; r < dim; ++r) {
            double *row = matrix.row(unknown[g] + int(r)) + unknown[f];
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int e = 0; e < dim; ++e)
                row[c] += root_mass[g][r] * left[r * dim + e] *
                          B_f[e * dim + c] * root_mass[f][c];
          }
        });
      });
    }

    /** Of clusters of nodes that contacts join, those of one place next to each
        other: around one node everything is near. */
    template <typename Point>
    void order_unknowns(const std::vector<Point> &points,
                        const std::size_t n_points, const int dim,
                        const int n_unknowns, std::vector<int> &unknown)
    {
      constexpr int few = 64;
      if (n_unknowns <= few)
        return;
      std::vector<std::vector<int>> neighbors(std::size_t(n_unknowns / dim));
      std::vector<int> here;
      for (std::size_t k = 0; k < n_points; ++k) {
        const Point &point = points[k];
        if (!point.carries)
          continue;
        here.clear();
        const auto add = [&](const int g, const auto &) {
          here.push_back(unknown[std::size_t(g)] / dim);
        };
        for_ends(point.groups, point.ends, add);
        for_matrices(point.ends, add);
        for (const int i : here)
          for (const int j : here)
            if (i != j)
              neighbors[std::size_t(i)].push_back(j);
      }
      for (auto &list : neighbors) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
      }
      const std::vector<int> order = narrow_order(neighbors);
      std::vector<int> place(order.size());
      for (std::size_t k = 0; k < order.size(); ++k)
        place[std::size_t(order[k])] = int(k);
      for (int &first : unknown)
        if (first >= 0)
          first = place[std::size_t(first / dim)] * dim;
    }
  } // namespace

  template <int dim>
  void NodeSystem<dim>::linearise()
  {
    unknown_.assign(velocity_.size(), -1);
    root_mass_.resize(velocity_.size());
    n_unknowns_ = 0;
    for (std::size_t k = 0; k < n_; ++k) {
      Point &point = points_[k];
      if (!point.carries)
        continue;
      point_slopes<dim>(*problem_, point.index, point.local, point.R,
                        point.solution, point.slopes);
      const auto number = [&](const int g, const auto &) {
        if (unknown_[g] >= 0)
          return;
        unknown_[g] = n_unknowns_;
        n_unknowns_ += dim;
        for (unsigned int c = 0; c < dim; ++c)
          root_mass_[g][c] = std::sqrt((*inverse_mass_)[g][c]);
      };
      for_ends(point.groups, point.ends, number);
      for_matrices(point.ends, number);
    }
    const auto joined =
        std::any_of(points_.begin(), points_.begin() + long(n_),
                    [](const Point &point) { return point.ends != nullptr; });
    if (joined)
      order_unknowns(points_, n_, dim, n_unknowns_, unknown_);
  }

  template <int dim>
  bool NodeSystem<dim>::invert_slopes(Point &point, const double soft,
                                      double &stiffest) const
  {
    Matrix compliance;
    for (unsigned int r = 0; r < dim; ++r)
      for (unsigned int c = 0; c < dim; ++c)
        compliance[r * dim + c] =
            (r == c ? 1. : 0.) -
            (1. - soft) * point.R * point.slopes[r * dim + c];
    double b[dim * dim] = {};
    for (unsigned int c = 0; c < dim; ++c)
      b[c * (dim + 1)] = 1.;
    Matrix &a = compliance;
    for (int k = 0; k < dim; ++k) {
      int p = k;
      for (int i = k + 1; i < dim; ++i)
        if (std::abs(a[i * dim + k]) > std::abs(a[p * dim + k]))
          p = i;
      if (!(std::abs(a[p * dim + k]) > 0.))
        return false;
      const double factor = 1. / a[p * dim + k];
      for (int j = 0; j < dim; ++j) {
        std::swap(a[k * dim + j], a[p * dim + j]);
        std::swap(b[k * dim + j], b[p * dim + j]);
        a[k * dim + j] *= factor;
        b[k * dim + j] *= factor;
      }
      for (int i = 0; i < dim; ++i)
        if (i != k) {
          const double f = a[i * dim + k];
          for (int j = 0; j < dim; ++j) {
            a[i * dim + j] -= f * a[k * dim + j];
            b[i * dim + j] -= f * b[k * dim + j];
          }
        }
    }
    std::copy_n(b, dim * dim, point.inverse.begin());
    stored::multiply<dim>(b, point.slopes.data(), point.stiffness.data());
    for (unsigned int c = 0; c < dim; ++c)
      stiffest = std::max(stiffest,
                          point.R * std::abs(point.stiffness[c * (dim + 1)]));
    return true;
  }

  /** 1 + M^-1/2 H^T K H M^-1/2 */
  template <int dim>
  void NodeSystem<dim>::assemble()
  {
    matrix_.reinit(n_unknowns_);
    for (int i = 0; i < n_unknowns_; ++i)
      matrix_.row(i)[i] = 1.;
    for (std::size_t k = 0; k < n_; ++k) {
      const Point &point = points_[k];
      if (!point.carries)
        continue;
      Matrix KF, K{}; // in the axes of space
      stored::multiply<dim>(point.stiffness.data(), point.frame, KF.data());
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int j = 0; j < dim; ++j)
            K[r * dim + c] += point.frame[j * dim + r] * KF[j * dim + c];
      if (point.ends && point.ends->n_matrices > 0) {
        add_with_matrices<dim>(*point.ends, K, unknown_, root_mass_, matrix_);
        continue;
      }
      for_ends(point.groups, point.ends, [&](const int g, const double of_g) {
        for_ends(point.groups, point.ends, [&](const int f, const double of_f) {
          const double share = of_g * of_f;
          for (unsigned int r = 0; r < dim; ++r) {
            double *row = matrix_.row(unknown_[g] + r) + unknown_[f];
            for (unsigned int c = 0; c < dim; ++c)
              row[c] +=
                  share * root_mass_[g][r] * K[r * dim + c] * root_mass_[f][c];
          }
        });
      });
    }
  }

  /**
   * What is missing of (1 - (1 - soft) R D) dP + D H dv = S - P, and once more
   * solved for it. @return the size of the correction over that of dP.
   */
  template <int dim>
  double NodeSystem<dim>::correct(const double soft)
  {
    right_side_.assign(n_unknowns_, 0.);
    for (std::size_t k = 0; k < n_; ++k) {
      Point &point = points_[k];
      Vector &q = point.residual;
      if (!point.carries) {
        for (unsigned int c = 0; c < dim; ++c)
          q[c] = -point.impulse[c] - point.direction[c];
      } else {
        const Vector dU = relative_velocity<dim>(point.frame, point.groups,
                                                 change_, point.ends);
        for (unsigned int r = 0; r < dim; ++r) {
          q[r] = -point.direction[r];
          for (unsigned int c = 0; c < dim; ++c)
            q[r] += point.inverse[r * dim + c] *
                        (point.solution.impulse[c] - point.impulse[c]) +
                    point.stiffness[r * dim + c] *
                        (soft * point.R * point.direction[c] - dU[c]);
        }
      }
      Vector p{};
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int c = 0; c < dim; ++c)
          p[c] += point.frame[r * dim + c] * q[r];
      for_ends(point.groups, point.ends, [&](const int g, const double share) {
        if (unknown_[g] >= 0)
          for (unsigned int c = 0; c < dim; ++c)
            right_side_[unknown_[g] + c] += share * root_mass_[g][c] * p[c];
      });
      for_matrices(point.ends, [&](const int g, const double *B) {
        for (unsigned int c = 0; unknown_[g] >= 0 && c < dim; ++c)
          for (unsigned int e = 0; e < dim; ++e)
            right_side_[unknown_[g] + c] +=
                B[e * dim + c] * root_mass_[g][c] * p[e];
      });
    }
    matrix_.solve(right_side_.data());
    double change = 0., size = 0.;
    for (std::size_t k = 0; k < n_; ++k) {
      Point &point = points_[k];
      Vector step = point.residual;
      if (point.carries) {
        Vector v{};
        for_ends(
            point.groups, point.ends, [&](const int g, const double share) {
              for (unsigned int c = 0; c < dim; ++c)
                v[c] += share * root_mass_[g][c] * right_side_[unknown_[g] + c];
            });
        for_matrices(point.ends, [&](const int g, const double *B) {
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int e = 0; e < dim; ++e)
              v[c] += B[c * dim + e] * root_mass_[g][e] *
                      right_side_[unknown_[g] + e];
        });
        double U[dim];
        stored::multiply_vector<dim>(point.frame, v.data(), U);
        stored::subtract_vector<dim>(point.stiffness.data(), U, step.data());
      }
      for (unsigned int c = 0; c < dim; ++c) {
        point.direction[c] += step[c];
        change += point.R * step[c] * step[c];
        size += point.R * point.direction[c] * point.direction[c];
      }
    }
    std::fill(change_.begin(), change_.end(), Vector{});
    for (std::size_t k = 0; k < n_; ++k)
      push(points_[k], points_[k].direction, change_);
    return size > 0. ? std::sqrt(change / size) : 0.;
  }

  template <int dim>
  bool NodeSystem<dim>::find_direction(const double soft, const bool refine)
  {
    double stiffest = 0.;
    for (std::size_t k = 0; k < n_; ++k) {
      Point &point = points_[k];
      point.direction.fill(0.);
      if (point.carries && !invert_slopes(point, soft, stiffest))
        return false;
    }
    assemble();
    if (!matrix_.factorise())
      return false;
    change_.assign(velocity_.size(), Vector{});
    // springs stiffer by far than W take digits, which come back
    const double left = refine ? soft : 0.;
    double last = correct(left);
    for (unsigned int k = 0; k < 5 && stiffest > 1e3 && last > 1e-10; ++k) {
      const double next = correct(left);
      if (k > 0 && next > 0.5 * last)
        break;
      last = next;
    }
    return std::isfinite(last);
  }

  template <int dim>
  bool NodeSystem<dim>::respond(const std::vector<int> &groups,
                                std::vector<double> &response)
  {
    // beside points that hold each other, as in NodeSolver
    constexpr double soft = 1e-12;
    const std::size_t n = groups.size() * dim;
    response.assign(n * n, 0.);
    linearise();
    if (n_unknowns_ == 0)
      return true;
    double stiffest = 0.;
    for (std::size_t k = 0; k < n_; ++k)
      if (points_[k].carries && !invert_slopes(points_[k], soft, stiffest))
        return false;
    assemble();
    if (!matrix_.factorise())
      return false;
    for (std::size_t column = 0; column < n; ++column) {
      for (std::size_t k = 0; k < n_; ++k)
        points_[k].direction.fill(0.);
      change_.assign(velocity_.size(), Vector{});
      change_[std::size_t(groups[column / dim])][column % dim] = 1.;
      if (!std::isfinite(correct(soft)))
        return false;
      for (std::size_t k = 0; k < n_; ++k)
        for (unsigned int side = 0; side < 2; ++side)
          for (std::size_t g = 0; g < groups.size(); ++g)
            if (groups[g] == points_[k].groups[side])
              for (unsigned int r = 0; r < dim; ++r)
                for (unsigned int c = 0; c < dim; ++c)
                  response[(g * dim + c) * n + column] +=
                      (side == 0 ? -1. : 1.) * points_[k].direction[r] *
                      points_[k].frame[r * dim + c];
    }
    return true;
  }

#define INSTANTIATE(dim)                                                       \
  template void NodeSystem<dim>::linearise();                                  \
  template bool NodeSystem<dim>::find_direction(double, bool);                 \
  template bool NodeSystem<dim>::respond(const std::vector<int> &,             \
                                         std::vector<double> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
