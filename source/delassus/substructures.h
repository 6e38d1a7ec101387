#pragma once

#include "conforming_solver.h"
#include "conforming_space.h"
#include "delassus_operator.h"
#include "joined_matrix.h"

#include "linear_algebra/dense_elimination.h"
#include "linear_algebra/dense_factor.h"
#include "linear_algebra/dissection.h"

#include <algorithm>
#include <vector>

namespace nsfd
{
  /**
   * The space of bodies that share nodes at faces that are joined for ever, and
   * nowhere else: whatever opens, its inner nodes, which no point but those of
   * supports sees, stay what they are. The others are its border.
   */
  template <int dim>
  class FinestSpace
  {
  public:
    /** @p first_dof as of JoinedMatrix. */
    FinestSpace(const DelassusOperator<dim> &delassus, long long first_dof,
                FixedFaces faces);

    long long first_dof() const { return first_dof_; }
    /**
     * Once, where it may be of use: of @p nodes that have common ones at the
     * faces that are @p joined now, and have them again afterwards. Collective.
     */
    void find(ConformingSpace &nodes, const std::vector<char> &joined);
    bool is_known() const { return is_known_; }
    /** The border is small: a dense factor of it costs less than a sparse one
        of all. */
    bool pays() const { return pays_; }

    const CoarseSpace &space() const { return space_; }
    /** By own unknown: of the border. */
    const std::vector<char> &border() const { return border_; }
    /** M_hat of a step and the springs @p supports, the blocks T by point, or
        null. Collective. */
    SparseRows assemble(const StepShares &shares, const double *supports) const;
    const DelassusOperator<dim> &delassus() const { return delassus_; }
    bool is_support(const std::size_t point) const
    {
      return faces_.supports[delassus_.points().face_of[point]];
    }

  private:
    bool may_pay(long long unknowns) const;
    void set_border(const JoinedMatrix<dim> &matrix);

    /// unknowns: their matrix has 128 MB
    static constexpr unsigned long long largest = 4000;

    const DelassusOperator<dim> &delassus_;
    const long long first_dof_;
    const FixedFaces faces_;
    CoarseSpace space_;
    std::vector<char> joined_, border_;
    bool is_known_ = false, pays_ = false;
  };

  /**
   * Substructuring, or static condensation (Przemieniecki 1963): inner nodes,
   * with the springs of supports, are eliminated once for a step length. What
   * this leaves for the border is a dense matrix,
   *
   *     S = A_bb - A_bi A_ii^-1 A_ib,   A = M_hat + H_s^T T_s H_s,
   *
   * and faces that are joined or open and springs of points change that small
   * matrix alone: its factor is all that a Newton step makes anew.
   */
  template <int dim>
  class Substructures
  {
  public:
    explicit Substructures(const FinestSpace<dim> &finest);

    /** Other faces are open. */
    void space_changed() { matrix_ = nullptr; }
    /**
     * Factor of M_hat of the step and H^T T H, @p springs the blocks T by point
     * or null, on @p space, whose matrix is @p matrix: @p solver solves with it
     * from now on. Inner nodes are eliminated if the step or T at supports have
     * changed. False: not positive definite, singular, or out of memory.
     * Collective.
     */
    bool factor(const StepShares &shares, const CoarseSpace &space,
                const JoinedMatrix<dim> &matrix, const double *springs,
                bool symmetric, ConformingSolver &solver);

    /** Iterations with an old factor that a new one costs, but at most
        @p most. */
    unsigned int worth(const double most) const
    {
      const double n = n_border(), products = 4. * n_entries();
      return unsigned(std::min(most, n * n * n / 3. / products));
    }

  private:
    bool eliminate(const StepShares &shares, const double *springs);
    void set_space(const CoarseSpace &space, const JoinedMatrix<dim> &matrix);
    bool factorise(const double *springs, bool symmetric);
    std::vector<double> condensed(bool symmetric) const;
    void add_springs(const double *springs, std::vector<double> &A) const;
    void solve(const double *b, double *x);
    bool eliminate_between_ranks();
    int n_border() const { return n_border_; }
    /** That a solution reads, on this rank. */
    double n_entries() const
    {
      return dissection_.n_entries() + outer_.n_entries() +
             double(n_border()) * n_border();
    }

    const FinestSpace<dim> &finest_;
    Dissection dissection_;
    DenseElimination outer_;    ///< of nodes between ranks that no point sees
    std::vector<double> split_; ///< S, all open, lower triangle
    bool is_analysed_ = false;
    StepShares shares_{-1.};
    std::vector<double> of_supports_; ///< T of their points, one by one
    const JoinedMatrix<dim> *matrix_ = nullptr;
    std::vector<int> place_;  ///< in the border, by block of the matrix
    std::vector<int> merged_; ///< by row of S: that of the space
    int n_border_ = 0;
    DenseFactor factor_;
    std::vector<double> right_, kept_, solution_;
  };
} // namespace nsfd
