#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace nsfd
{
  /** Groups and their shares in the velocity of body 2 less that of body 1, of
      a point that is not between two nodes: a contact of surfaces. */
  struct PointEnds {
    // six ends at most: two edges of two corners, or a corner and a facet;
    // each may be at a rigid body of its own, which has two matrices
    std::array<int, 18> groups{};
    std::array<double, 18> shares{};
    unsigned int size = 0;
    /// of the last groups, unknowns of rigid bodies: what they have in it, in
    /// place of shares, dim x dim
    unsigned int n_matrices = 0;
    std::array<std::array<double, 9>, 12> matrices{};

    unsigned int n_shares() const { return size - n_matrices; }
  };

  /** @p visit (group, share) of a point: @p ends if there are some, else body 1
      and body 2 (-1: none). Those with matrices are left out. */
  template <typename Visit>
  void for_ends(const std::array<int, 2> &groups, const PointEnds *ends,
                const Visit &visit)
  {
    if (!ends) {
      if (groups[0] >= 0)
        visit(groups[0], -1.);
      if (groups[1] >= 0)
        visit(groups[1], 1.);
      return;
    }
    for (unsigned int k = 0; k < ends->n_shares(); ++k)
      visit(ends->groups[k], ends->shares[k]);
  }

  /** @p visit (group, matrix) of those that have one. */
  template <typename Visit>
  void for_matrices(const PointEnds *ends, const Visit &visit)
  {
    for (unsigned int k = 0; ends && k < ends->n_matrices; ++k)
      visit(ends->groups[ends->n_shares() + k], ends->matrices[k].data());
  }

  /** The active points around one node, between groups of corners of cells. */
  template <int dim>
  struct NodeProblem {
    struct Point {
      std::size_t point; ///< in the OneStepProblem
      /// below, of body 1 and of body 2; -1: none (an obstacle or support at
      /// rest)
      std::array<int, 2> groups;
      const PointEnds *ends = nullptr; ///< in place of these
      /// U where the groups have no velocity, local frame, m/s
      std::array<double, dim> start{};
    };
    std::vector<Point> points;
    /// of every group and axis, 1/kg; 0 where the motion is prescribed
    std::vector<std::array<double, dim>> inverse_mass;
    /// of the groups, m/s: in without the impulses of the points, out with them
    std::vector<std::array<double, dim>> velocity;

    /** Empty; the memory stays. */
    void clear()
    {
      points.clear();
      inverse_mass.clear();
      velocity.clear();
    }
  };

  /** U = H v of a point: @p frame has the rows n, t1, t2, @p groups are those
   * of body 1 and body 2 (-1: none), @p ends stand in place of these. */
  template <int dim>
  std::array<double, dim>
  relative_velocity(const double *frame, const std::array<int, 2> &groups,
                    const std::vector<std::array<double, dim>> &velocity,
                    const PointEnds *ends = nullptr)
  {
    const auto [a, b] = groups;
    std::array<double, dim> v{}, U{};
    if (ends) {
      for (unsigned int k = 0; k < ends->n_shares(); ++k)
        for (unsigned int c = 0; c < dim; ++c)
          v[c] += ends->shares[k] * velocity[std::size_t(ends->groups[k])][c];
      for_matrices(ends, [&](const int g, const double *B) {
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            v[c] += B[c * dim + d] * velocity[std::size_t(g)][d];
      });
    } else {
      if (b >= 0)
        v = velocity[std::size_t(b)];
      if (a >= 0)
        for (unsigned int c = 0; c < dim; ++c)
          v[c] -= velocity[std::size_t(a)][c];
    }
    for (unsigned int r = 0; r < dim; ++r)
      for (unsigned int c = 0; c < dim; ++c)
        U[r] += frame[r * dim + c] * v[c];
    return U;
  }

  /** v += M^-1 H^T P, @p impulse (dim) in N s. */
  template <int dim>
  void push_groups(const double *frame, const std::array<int, 2> &groups,
                   const double *impulse,
                   const std::vector<std::array<double, dim>> &inverse_mass,
                   std::vector<std::array<double, dim>> &velocity,
                   const PointEnds *ends = nullptr)
  {
    std::array<double, dim> P{};
    for (unsigned int r = 0; r < dim; ++r)
      for (unsigned int c = 0; c < dim; ++c)
        P[c] += frame[r * dim + c] * impulse[r];
    for_ends(groups, ends, [&](const int g, const double share) {
      for (unsigned int c = 0; c < dim; ++c)
        velocity[std::size_t(g)][c] +=
            share * inverse_mass[std::size_t(g)][c] * P[c];
    });
    for_matrices(ends, [&](const int g, const double *B) {
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          velocity[std::size_t(g)][d] +=
              B[c * dim + d] * inverse_mass[std::size_t(g)][d] * P[c];
    });
  }
} // namespace nsfd
