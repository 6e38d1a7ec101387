#pragma once

#include "face_rows.h"

#include "linear_algebra/spd_solver.h"

namespace nsfd
{
  /**
   * The coarse space of bodies joined at their faces by stiffnesses of very
   * different size. Unknowns of all bodies at one place are a node; on every
   * node the motions that stretch no stiff spring: one common velocity where
   * all its faces stick or stand, one more for every direction in which bodies
   * are free of each other. A face that slides is stiff along its normal alone.
   * Stiff is what opposes more than 5 times what the bodies do, both for the
   * motion of the node alone (the stiffest motions of the pencil of both).
   *
   * Two unknowns are at one place where their columns of H on a face are
   * opposite. On one rank.
   */
  class SoftSpace
  {
  public:
    /** @p first_dof: per body and one more. */
    SoftSpace(unsigned int dim, const std::vector<std::size_t> &first_dof,
              const std::vector<FaceRows> &faces);

    /**
     * For K with its springs, and @p bodies, the values of M_hat on the same
     * pattern. K need not be symmetric.
     */
    void build(const SparseRows &K, const std::vector<double> &bodies);

    /** P^T K P, in the rows that K was given in. */
    const SparseRows &matrix() const { return matrix_; }
    int size() const { return first_.back(); }

    std::size_t n_nodes() const { return nodes_.size(); }
    int n_motions(const std::size_t node) const
    {
      return first_[node + 1] - first_[node];
    }
    /** The node of an unknown. */
    int node_of(const std::size_t unknown) const { return node_of_[unknown]; }

    /** c = P^T r. */
    void restrict_to(const double *r, double *c) const;
    /** x = P c. */
    void prolong(const double *c, double *x) const;

  private:
    void find_motions(const SparseRows &K, const std::vector<double> &bodies);
    void find_matrix(const SparseRows &K);

    std::vector<std::vector<int>> nodes_;      // unknowns
    std::vector<int> node_of_, place_;         // of an unknown, and where in it
    std::vector<std::vector<double>> motions_; // unknowns x motions, by columns
    std::vector<int> first_{0};                // motion of a node
    SparseRows matrix_;
  };
} // namespace nsfd
