#pragma once

#include "condensed.h"
#include "conforming_solver.h"
#include "conforming_space.h"
#include "joined_delassus.h"
#include "joined_matrix.h"
#include "node_jacobi.h"
#include "substructures.h"
#include "tangent_factor.h"
#include "velocity_solver.h"

#include <limits>

namespace nsfd
{
  template <int dim>
  class JoinedMotion;

  /** The largest entry of f K over that of M on the diagonals of bodies, f the
      share of K in a step. Collective. */
  double stiffness_over_mass(const Bodies &bodies, const StepShares &shares,
                             const Communicator &communicator);

  /**
   * Implicit bodies that share nodes: W = H P (P^T M_hat P)^-1 P^T H^T, P the
   * motions of the bodies that the space of the nodes allows.
   */
  template <int dim>
  class JoinedBodies : public JoinedDelassus<dim>, public VelocitySolver
  {
  public:
    using typename JoinedDelassus<dim>::Operator;

    /** As make_joined_delassus(). */
    JoinedBodies(const Communicator &communicator, const Bodies &bodies,
                 const InterfacePoints<dim> &points,
                 const std::vector<double> &coordinates, FixedFaces faces,
                 long long largest_factor);

    void reinit(double time_step, double theta) override;
    bool bodies_are_apart() const override { return false; }
    void apply_delassus(const double *impulse, double *velocity) const override;
    void add_velocity_change(const double *impulse,
                             double *velocity) const override;
    void apply(Operator op, const double *x, double *y) const override;
    void jumps(const double *velocity, double *result) const override;
    std::vector<char> parting() const override;
    bool solve_linearised(const std::vector<double> &T,
                          const std::vector<double> &c, double tolerance,
                          std::vector<double> &dP,
                          std::vector<double> &dU) override;
    bool join_motion(std::vector<double> &x) override;
    std::vector<std::uint8_t>
    once_per_node(const std::vector<std::uint8_t> &masks) override;
    std::vector<char> sharing(const std::vector<std::uint8_t> &bonded) override;
    std::vector<char>
    opens_with(const std::vector<std::uint8_t> &bonded) override;
    void serialize(Archive &archive) override;

    /// how systems of M_hat are solved: factors, for the rest of a step where
    /// iterations have failed, conjugate gradients, or the border of
    /// Substructures
    enum class Means {
      unknown,
      factors,
      factors_once,
      iterations,
      substructures
    };
    /** Collective. */
    Means means() const;

  protected:
    /// of iterations: the energy balance shows what a product with W leaves
    static constexpr double tight = 1e-12;

    void bonds_changed() override;
    bool condense() const;
    bool respond(ConformingSolver &solver, const double *impulse,
                 double *velocity, double tolerance = tight) const;
    const SparseRows &assemble(const std::vector<double> &springs) const;

    mutable CondensedDelassus condensed_; ///< W of the rows, if it pays
    std::unique_ptr<ConformingSpace> conforming_;

  private:
    friend JoinedMotion<dim>;
    bool factor_tangent(const std::vector<double> &springs, bool general);
    using Goal = ConformingSolver::Goal;
    bool solve_tangent(const std::vector<double> &T, bool symmetric,
                       const Goal &goal);
    krylov::Outcome solve(ConformingSolver &solver,
                          const Goal &goal = tight) const;
    void answer(double tolerance = tight) const;
    void update() const;

    JoinedMatrix<dim> &matrix() const;

    mutable std::unique_ptr<JoinedMatrix<dim>> matrix_;
    mutable bool placed_ = false; ///< matrix_ is that of the present space
    FinestSpace<dim> finest_;
    mutable Substructures<dim> substructures_; ///< of M_hat
    mutable ConformingSolver factor_;          ///< of M_hat
    mutable NodeJacobi<dim> jacobi_;           ///< the same, in short steps
    mutable Means means_ = Means::unknown;
    TangentFactor<dim> tangent_;
    mutable bool valid_ = false;       ///< factor_
    mutable std::size_t n_solves_ = 0; ///< with the present factor
    std::vector<int> representative_;  ///< unknown of a body, by own node
    mutable std::vector<double> rows_, columns_; ///< own values of the space
    struct {
      std::vector<double> rows, columns;
    } mutable last_; ///< system that was solved with factor_; empty: none
  };
} // namespace nsfd
