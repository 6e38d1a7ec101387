#pragma once

#include "conforming_solver.h"
#include "delassus_operator.h"
#include "node_jacobi.h"
#include "node_values.h"
#include "substructures.h"
#include "tangent_multigrid.h"

namespace nsfd
{
  /**
   * Solves with M_hat + H^T T H of bodies that share nodes, T a block of
   * dim x dim per point. Where few points have changed since it was made, an
   * old factor preconditions the present matrix; beyond the unknowns of a
   * factor, a hierarchy for as long as it does its work.
   */
  template <int dim>
  class TangentFactor
  {
  public:
    TangentFactor(const DelassusOperator<dim> &delassus,
                  const FinestSpace<dim> &finest,
                  const Communicator &communicator, long long largest_factor)
        : delassus_(delassus), communicator_(communicator),
          largest_factor_(largest_factor),
          solver_(communicator, largest_factor), substructures_(finest),
          jacobi_(communicator), cycles_(communicator)
    {
    }

    /** Of this space from now on, without a factor. Collective. */
    void set_space(const CoarseSpace &space);
    /** The bodies are others: there is no factor. */
    void clear()
    {
      springs_.clear();
      present_.clear();
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
    Fit fit(const JoinedMatrix<dim> &matrix, const std::vector<double> &springs,
            unsigned int few) const;
    /** False: not positive definite. Collective. */
    bool factor(const SparseRows &matrix, const std::vector<double> &springs);
    /** The same of the border of substructures: @p matrix is that of the space
        and of the step of @p shares. */
    bool factor_border(const JoinedMatrix<dim> &matrix,
                       const StepShares &shares,
                       const std::vector<double> &springs, bool general);
    const Substructures<dim> &substructures() const { return substructures_; }
    /** The same for iterations on @p matrix, of short steps; @p general: the
        springs are not symmetric, on one rank. */
    bool precondition(const JoinedMatrix<dim> &matrix,
                      const std::vector<double> &springs, bool general);

    /** Multigrid takes the place of factors. */
    bool has_cycles() const { return is_too_large(*space_); }
    bool is_too_large(const CoarseSpace &space) const
    {
      return space.n_global > largest_factor_ && space.ties.empty();
    }
    /** Conjugate gradients with a new hierarchy from now on; @p springs, T,
        symmetric. False as factor(). Collective. */
    bool precondition_by_cycles(JoinedMatrix<dim> &matrix,
                                const std::vector<double> &springs);
    /** The same with the hierarchy that there is: false where there is none,
        or it has worn out. Collective. */
    bool adjust_cycles(const JoinedMatrix<dim> &matrix,
                       const std::vector<double> &springs);
    /** Iterations with the present hierarchy. */
    struct Wear {
      double least = 0.;  ///< per digit, or 0: there are none
      double excess = 0.; ///< what all have taken beyond that
    };
    Wear &wear() { return wear_; }
    /** A new one would do more. */
    bool is_worn() const { return wear_.excess > worth / 4.; }
    /** What conjugate gradients by cycles have taken for a @p reduction of the
        residual. */
    void note(unsigned int iterations, double reduction);

    /** Iterations are on the matrix of these springs, symmetric ones, with the
        preconditioner that there is. */
    void iterate_on(const JoinedMatrix<dim> &matrix,
                    const std::vector<double> &springs)
    {
      copy_of_points<dim * dim>(matrix.parting_points(), springs, present_);
    }

    ConformingSolver &solver() { return solver_; }
    /** Those that were factored; empty: none. */
    std::vector<double> &springs() { return springs_; }
    /** The same of a factor of the whole matrix, else empty. */
    const std::vector<double> &factored() const;
    /** The preconditioner is made anew at little cost. */
    bool is_cheap() const { return jacobi_.is_by_vertex(); }
    /** These need not be symmetric, and the preconditioner is not. */
    bool is_general() const { return is_general_; }

  private:
    /// iterations that a hierarchy costs
    static constexpr double worth = 50.;

    const DelassusOperator<dim> &delassus_;
    const Communicator &communicator_;
    const long long largest_factor_;
    const CoarseSpace *space_ = nullptr;
    ConformingSolver solver_;
    Substructures<dim> substructures_;
    NodeJacobi<dim> jacobi_;
    TangentMultigrid<dim> cycles_;
    Wear wear_;
    std::vector<double> springs_, present_;
    bool is_general_ = false;
  };
} // namespace nsfd
