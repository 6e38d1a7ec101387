#pragma once

#include "conforming_solver.h"
#include "delassus_operator.h"
#include "node_jacobi.h"

namespace nsfd
{
  /**
   * Solves with M_hat + H^T T H of bodies that share nodes, T a block of
   * dim x dim per point. Where few points have changed since it was made, an
   * old factor preconditions the present matrix.
   */
  template <int dim>
  class TangentFactor
  {
  public:
    TangentFactor(const DelassusOperator<dim> &delassus,
                  const Communicator &communicator, long long largest_factor)
        : delassus_(delassus), communicator_(communicator),
          solver_(communicator, largest_factor), jacobi_(communicator)
    {
    }

    /** Of this space from now on, without a factor. Collective. */
    void set_space(const CoarseSpace &space);
    /** The bodies are others: there is no factor. */
    void clear()
    {
      springs_.clear();
      is_general_ = false;
      jacobi_.clear();
    }

    enum class Fit {
      exact, ///< the factor is that of these springs
      close, ///< good enough as a preconditioner
      none
    };
    /** Of @p springs, T, positive semidefinite; close if at most @p few points
        have changed much. Collective. */
    Fit fit(const std::vector<double> &springs, unsigned int few) const;
    /** False: not positive definite. Collective. */
    bool factor(const SparseRows &matrix, const std::vector<double> &springs);
    /** The same for iterations on @p matrix, of short steps; @p general: the
        springs are not symmetric, on one rank. */
    bool precondition(const JoinedMatrix<dim> &matrix,
                      const std::vector<double> &springs, bool general);

    /** Iterations are on the matrix of these springs, symmetric ones, with the
        preconditioner that there is. */
    void iterate_on(const std::vector<double> &springs) { present_ = springs; }

    ConformingSolver &solver() { return solver_; }
    /** Those that were factored; empty: none. */
    std::vector<double> &springs() { return springs_; }
    /** The preconditioner is made anew at little cost. */
    bool is_cheap() const { return jacobi_.is_by_vertex(); }
    /** These need not be symmetric, and the preconditioner is not. */
    bool is_general() const { return is_general_; }

  private:
    const DelassusOperator<dim> &delassus_;
    const Communicator &communicator_;
    ConformingSolver solver_;
    NodeJacobi<dim> jacobi_;
    std::vector<double> springs_, present_;
    bool is_general_ = false;
  };
} // namespace nsfd
