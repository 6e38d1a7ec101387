#include "factor_limits.h"
#include "sparse_assembly.h"

#include "nsfd/base/cost.h"
#include "nsfd/dynamics/dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace nsfd
{
  namespace
  {

    /**
     * The sparse matrix of all bodies joined by what their faces carry,
     *
     *     A = M_hat + H^T D^{-1} H,
     *
     * as a preconditioner of W + D by the Woodbury identity,
     *
     *     (W + D)^{-1} = D^{-1} (1 - H A^{-1} H^T D^{-1}).
     *
     * With D > 0 everywhere this is the inverse itself. Rigid rows and closed
     * contacts (D = 0) enter with a hundred times the stiffness of the softer
     * body next to them: only in the preconditioner, the row stays exact. (A
     * stiffer one lets round-off grow along impulses that W does not see.)
     */
    template <int dim>
    class SparseDynamics final : public Dynamics<dim>
    {
    public:
      SparseDynamics(const Communicator &communicator,
                     const Bodies &bodies,
                     const InterfacePoints<dim> &points,
                     const std::string &solver,
                     const std::vector<double> &coordinates);

      void reinit(double time_step, double theta) override;
      void prepare_preconditioner(const std::vector<double> &D) override;
      void precondition(const double *r, double *z) const override;
      bool inverts() const override { return inverts_; }
      bool solve_springs(const double *P, const double *U, const double *r,
                         double tolerance, double *next) override;

    private:
      double share() const
      {
        return this->time_step_ * this->time_step_ * this->theta_ *
               this->theta_;
      }
      void set_body_stiffness();
      void set_springs(const std::vector<double> &D);
      bool loose_springs_changed(const std::vector<char> &glued) const;
      void glue();
      void use_cg();

      SparseAssembly<dim> assembly_;
      GluedSpace glued_;
      std::unique_ptr<SpdSolver> solver_;
      bool direct_, prepared_ = false;
      std::vector<double> body_stiffness_; ///< of the softer body, per point
      std::vector<double> D_, inverse_D_, inverse_D_coarse_;
      bool valid_ = false, coarse_valid_ = false, inverts_ = false;
      mutable std::vector<double> work_, right_, solution_;
      std::vector<double> difference_, velocity_; ///< of the last solve_springs()
    };

    template <int dim>
    SparseDynamics<dim>::SparseDynamics(const Communicator &communicator,
                                        const Bodies &bodies,
                                        const InterfacePoints<dim> &points,
                                        const std::string &solver,
                                        const std::vector<double> &coordinates)
      : Dynamics<dim>(communicator, bodies, points)
      , assembly_(communicator, bodies, points, coordinates)
      , glued_(communicator, dim, assembly_.unknowns(), assembly_.node_pairs())
    {
      assembly_.forget_coordinates();
      const auto n = communicator.sum_integer(bodies.n_dofs());
      // not by the number of ranks: results must not depend on it
      direct_ = solver == "direct" ||
                (solver == "auto" &&
                 static_cast<long long>(n) <= largest_factor<dim>);
      if (direct_)
        solver_ = make_cholesky_solver(communicator);
      else
        use_cg();
    }

    template <int dim>
    void SparseDynamics<dim>::use_cg()
    {
      direct_ = prepared_ = coarse_valid_ = false;
      solver_ =
        make_glued_cg_solver(this->communicator_, this->bodies_.first_dof,
                             largest_coarse_factor<dim>);
    }

    template <int dim>
    void SparseDynamics<dim>::reinit(const double time_step,
                                     const double theta)
    {
      if (time_step != this->time_step_ || theta != this->theta_)
        valid_ = coarse_valid_ = false;
      Dynamics<dim>::reinit(time_step, theta);
    }

    template <int dim>
    void SparseDynamics<dim>::set_body_stiffness()
    {
      auto sides = assembly_.own_stiffness(share());
      this->exchange({{sides[0].data(), sides[1].data()}}, 1);
      const std::size_t n = this->points_.n_points;
      body_stiffness_.resize(n);
      for (std::size_t i = 0; i < n; ++i)
        body_stiffness_[i] = std::min(sides[0][i], sides[1][i]);
    }

    template <int dim>
    void SparseDynamics<dim>::set_springs(const std::vector<double> &D)
    {
      const auto &points = this->points_;
      inverse_D_.assign(D.size(), 0.);
      bool exact = true;
      for (std::size_t f = 0; f < points.faces.size(); ++f) {
        const auto &face = points.faces[f];
        const unsigned int n = face.count * dim;
        const double *W = this->face_block(f);
        for (unsigned int k = 0; k < n; ++k) {
          const std::size_t row = std::size_t(face.first) * dim + k;
          if (!(D[row] >= 0.))
            continue;
          const double stiffness = body_stiffness_[row / dim];
          double least = 1e-2 * W[k * n + k], vanishing = 0.;
          if (!this->least_compliance_.empty())
            vanishing = least = this->least_compliance_[row];
          else if (std::isfinite(stiffness)) {
            least = 1e-2 / stiffness;
            vanishing = 1e-10 / stiffness;
          } else
            vanishing = least;
          exact = exact && D[row] >= vanishing;
          inverse_D_[row] = 1. / (D[row] >= vanishing ? D[row] : least);
        }
      }
      inverts_ = !this->communicator_.any(!exact);
    }

    /**
     * The coarse matrix knows the springs of faces that are not glued. It
     * stays a good one while they keep their order of magnitude; what is
     * small against the inertia of the bodies does not count.
     */
    template <int dim>
    bool SparseDynamics<dim>::loose_springs_changed(
      const std::vector<char> &glued) const
    {
      const auto &points = this->points_;
      for (std::size_t f = 0; f < points.faces.size(); ++f) {
        const auto &face = points.faces[f];
        if (glued[f])
          continue;
        const unsigned int n = face.count * dim;
        const double *W = this->face_block(f);
        for (unsigned int k = 0; k < n; ++k) {
          const std::size_t row = std::size_t(face.first) * dim + k;
          const double inertia = 1. / W[k * n + k],
                       now = inverse_D_[row] + inertia,
                       then = inverse_D_coarse_[row] + inertia;
          if (now > 4. * then || then > 4. * now)
            return true;
        }
      }
      return false;
    }

    template <int dim>
    void SparseDynamics<dim>::glue()
    {
      const auto faces = assembly_.carrying(share(), inverse_D_);
      const auto before = glued_.space().version;
      glued_.glue(faces);
      if (glued_.space().version == before &&
          this->communicator_.any(!coarse_valid_ ||
                                  loose_springs_changed(faces)))
        glued_.touch();
      if (glued_.space().version != before)
        inverse_D_coarse_ = inverse_D_;
      coarse_valid_ = true;
    }

    template <int dim>
    void
    SparseDynamics<dim>::prepare_preconditioner(const std::vector<double> &D)
    {
      const Charge charge(Cost::preconditioner);
      // all is good as long as the step and D stay what they were
      if (!this->communicator_.any(!valid_ || D != D_))
        return;
      if (this->communicator_.any(!coarse_valid_ || body_stiffness_.empty()))
        set_body_stiffness();
      D_ = D;
      valid_ = true;
      set_springs(D);
      assembly_.assemble(share(), inverse_D_);
      ++this->counters_.global_factorisations;
      if (direct_)
        try {
          solver_->prepare(assembly_.matrix(), glued_.space(), !prepared_);
          coarse_valid_ = prepared_ = true;
          return;
        } catch (const std::runtime_error &) {
          use_cg();
        }
      glue();
      solver_->prepare(assembly_.matrix(), glued_.space(), !prepared_);
      prepared_ = true;
      this->counters_.coarse_spaces = solver_->counters().coarse_spaces;
    }

    template <int dim>
    void SparseDynamics<dim>::precondition(const double *r, double *z) const
    {
      const Charge charge(Cost::precondition);
      const std::size_t n = inverse_D_.size(), m = this->bodies_.n_dofs();
      work_.resize(n);
      right_.resize(m);
      for (std::size_t k = 0; k < n; ++k)
        work_[k] = inverse_D_[k] * r[k];
      this->generalised_impulse(work_.data(), right_.data());
      solution_.assign(m, 0.);
      this->counters_.inner_iterations += solver_->solve(
        right_.data(), solution_.data(), this->inner_tolerance_);
      ++this->counters_.global_solves;
      this->relative_velocity(solution_.data(), z);
      for (std::size_t k = 0; k < n; ++k)
        z[k] = inverse_D_[k] * (r[k] - z[k]);
    }

    template <int dim>
    bool SparseDynamics<dim>::solve_springs(const double *P, const double *U,
                                            const double *r,
                                            const double tolerance,
                                            double *next)
    {
      const std::size_t n = inverse_D_.size(), m = this->bodies_.n_dofs();
      if (!this->free_velocity_ || this->free_velocity_->size() != m)
        return false;
      work_.resize(n);
      right_.resize(m);
      difference_.resize(m);
      velocity_.resize(m, 0.);
      // A dv = M_hat (v_free - v) + H^T P, P = P^ - D^{-1} H v of the last v:
      // the residual without A, whose round-off grows with the stiffness
      this->relative_velocity(velocity_.data(), work_.data());
      for (std::size_t k = 0; k < n; ++k)
        if (D_[k] >= 0.)
          next[k] = P[k] - inverse_D_[k] * (r[k] - U[k] + work_[k]);
      this->generalised_impulse(next, right_.data());
      for (std::size_t i = 0; i < m; ++i)
        difference_[i] = (*this->free_velocity_)[i] - velocity_[i];
      solution_.resize(m);
      this->apply(Dynamics<dim>::Operator::mass, difference_.data(),
                  solution_.data());
      for (std::size_t i = 0; i < m; ++i)
        right_[i] += solution_[i];
      this->apply(Dynamics<dim>::Operator::stiffness, difference_.data(),
                  solution_.data());
      for (std::size_t i = 0; i < m; ++i)
        right_[i] += share() * solution_[i];
      solution_.assign(m, 0.);
      this->counters_.inner_iterations +=
        solver_->solve(right_.data(), solution_.data(), tolerance);
      ++this->counters_.global_solves;
      this->relative_velocity(solution_.data(), work_.data());
      for (std::size_t k = 0; k < n; ++k)
        if (D_[k] >= 0.)
          next[k] -= inverse_D_[k] * work_[k];
      for (std::size_t i = 0; i < m; ++i)
        velocity_[i] += solution_[i];
      return true;
    }
  } // namespace

  template <int dim>
  std::unique_ptr<Dynamics<dim>>
  make_sparse_dynamics(const Communicator &communicator,
                       const Bodies &bodies,
                       const InterfacePoints<dim> &points,
                       const std::string &solver,
                       const std::vector<double> &coordinates)
  {
    return std::make_unique<SparseDynamics<dim>>(communicator, bodies, points,
                                                 solver, coordinates);
  }

  template std::unique_ptr<Dynamics<2>>
  make_sparse_dynamics<2>(const Communicator &, const Bodies &,
                          const InterfacePoints<2> &, const std::string &,
                          const std::vector<double> &);
  template std::unique_ptr<Dynamics<3>>
  make_sparse_dynamics<3>(const Communicator &, const Bodies &,
                          const InterfacePoints<3> &, const std::string &,
                          const std::vector<double> &);
} // namespace nsfd
