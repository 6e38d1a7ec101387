#include "body_loops.h"
#include "linear_algebra/factor_limits.h"
#include "sparse_assembly.h"

#include "core/cost.h"
#include "delassus_operator.h"
#include "nsfd/core/archive.h"

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
    class AssembledDelassus final : public DelassusOperator<dim>
    {
    public:
      AssembledDelassus(const Communicator &communicator, const Bodies &bodies,
                        const InterfacePoints<dim> &points,
                        const std::string &solver,
                        const std::vector<double> &coordinates);

      void reinit(double time_step, double theta) override;
      void prepare_preconditioner(const std::vector<double> &D) override;
      void precondition(const double *r, double *z) const override;
      bool inverts() const override { return inverts_; }
      bool solve_springs(const double *P, const double *U, const double *r,
                         double tolerance, double *next) override;
      void serialize(Archive &archive) override;

    private:
      StepShares share() const
      {
        return this->shares(this->time_step_, this->theta_);
      }
      /** Diagonal of W. */
      double own_compliance(const std::size_t row) const
      {
        return this->point_block(row / dim)[row % dim * (dim + 1)];
      }
      void set_body_stiffness();
      void set_springs(const std::vector<double> &D);
      bool loose_springs_changed(const std::vector<char> &joined) const;
      void conform(const std::vector<char> &faces);
      void use_cg();
      void prepare_cg();
      void prepare_again();
      void add_bodies(const double *x, double *y) const;
      void add_smooth(const double *x, double *y) const;
      void add_jump(const std::vector<double> &change, double *next);

      SparseAssembly<dim> assembly_;
      ConformingSpace conforming_;
      std::unique_ptr<SpdSolver> solver_;
      bool direct_, prepared_ = false;
      std::vector<double> body_stiffness_; ///< of the softer body, per point
      std::vector<double> D_, inverse_D_, inverse_D_coarse_;
      bool valid_ = false, coarse_valid_ = false, inverts_ = false;
      mutable std::vector<double> work_, right_, solution_;
      std::vector<double> difference_,
          velocity_;             ///< of the last solve_springs()
      std::vector<double> jump_; ///< H velocity_, to more than its round-off
      std::vector<char> without_jump_; ///< per point: the joined space has none
      bool all_without_jump_ = false;
    };

    template <int dim>
    AssembledDelassus<dim>::AssembledDelassus(
        const Communicator &communicator, const Bodies &bodies,
        const InterfacePoints<dim> &points, const std::string &solver,
        const std::vector<double> &coordinates)
        : DelassusOperator<dim>(communicator, bodies, points),
          assembly_(communicator, bodies, points, coordinates),
          conforming_(communicator, dim, assembly_.unknowns(),
                      assembly_.node_pairs())
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
    void AssembledDelassus<dim>::use_cg()
    {
      direct_ = prepared_ = coarse_valid_ = false;
      solver_ = make_two_level_cg(this->communicator_, this->bodies_.first_dof,
                                  largest_coarse_factor<dim>);
    }

    template <int dim>
    void AssembledDelassus<dim>::reinit(const double time_step,
                                        const double theta)
    {
      if (time_step != this->time_step_ || theta != this->theta_)
        valid_ = coarse_valid_ = false;
      DelassusOperator<dim>::reinit(time_step, theta);
    }

    template <int dim>
    void AssembledDelassus<dim>::set_body_stiffness()
    {
      auto sides = assembly_.own_stiffness(share());
      this->exchange({{sides[0].data(), sides[1].data()}}, 1);
      const std::size_t n = this->points_.n_points;
      body_stiffness_.resize(n);
      for (std::size_t i = 0; i < n; ++i)
        body_stiffness_[i] = std::min(sides[0][i], sides[1][i]);
    }

    template <int dim>
    void AssembledDelassus<dim>::set_springs(const std::vector<double> &D)
    {
      inverse_D_.assign(D.size(), 0.);
      bool exact = true;
      for (std::size_t row = 0; row < D.size(); ++row) {
        if (!(D[row] >= 0.))
          continue;
        const double W = own_compliance(row);
        const double stiffness = body_stiffness_[row / dim];
        double least = 1e-2 * W, vanishing = 0.;
        if (!this->least_compliance_.empty())
          vanishing = least = this->least_compliance_[row];
        else if (std::isfinite(stiffness)) {
          least = 1e-2 / stiffness;
          vanishing = 1e-10 / stiffness;
        } else // rigid on both sides: nothing but inertia to compare with
          vanishing = 1e-10 * W;
        exact = exact && D[row] >= vanishing;
        inverse_D_[row] = 1. / (D[row] >= vanishing ? D[row] : least);
      }
      inverts_ = !this->communicator_.any(!exact);
    }

    /**
     * The coarse matrix knows the springs of faces that are not joined. It
     * stays a good one while they keep their order of magnitude; what is
     * small against the inertia of the bodies does not count.
     */
    template <int dim>
    bool AssembledDelassus<dim>::loose_springs_changed(
        const std::vector<char> &joined) const
    {
      const auto &points = this->points_;
      for (std::size_t f = 0; f < points.faces.size(); ++f) {
        const auto &face = points.faces[f];
        if (joined[f])
          continue;
        const std::size_t first = std::size_t(face.first) * dim;
        for (std::size_t row = first; row < first + face.count * dim; ++row) {
          const double inertia = 1. / own_compliance(row),
                       now = inverse_D_[row] + inertia,
                       then = inverse_D_coarse_[row] + inertia;
          if (now > 4. * then || then > 4. * now)
            return true;
        }
      }
      return false;
    }

    template <int dim>
    void AssembledDelassus<dim>::conform(const std::vector<char> &faces)
    {
      const auto before = conforming_.space().version;
      conforming_.conform(faces);
      if (conforming_.space().version == before &&
          this->communicator_.any(!coarse_valid_ ||
                                  loose_springs_changed(faces)))
        conforming_.touch();
      if (conforming_.space().version != before)
        inverse_D_coarse_ = inverse_D_;
      coarse_valid_ = true;
    }

    template <int dim>
    void
    AssembledDelassus<dim>::prepare_preconditioner(const std::vector<double> &D)
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
      ++this->counters_.global_factorisations;
      if (direct_)
        try {
          assembly_.assemble(share(), inverse_D_);
          solver_->prepare(assembly_.matrix(), conforming_.space(), !prepared_);
          coarse_valid_ = prepared_ = true;
          return;
        } catch (const std::runtime_error &) {
          use_cg();
        }
      prepare_cg();
    }

    /**
     * Springs of joined faces vanish on the joined space, and come into the
     * matrix after the coarse one has been formed: of what is left of the mass
     * beside them, their round-off would leave nothing.
     */
    template <int dim>
    void AssembledDelassus<dim>::prepare_cg()
    {
      conform(assembly_.carrying(share(), inverse_D_));
      const auto &points = this->points_;
      const auto faces = conforming_.without_jump();
      without_jump_.resize(points.n_points);
      bool all = true;
      for (std::size_t i = 0; i < points.n_points; ++i) {
        without_jump_[i] = faces[points.face_of[i]];
        for (std::size_t k = i * dim; k < (i + 1) * dim; ++k)
          all = all && (without_jump_[i] || inverse_D_[k] == 0.);
      }
      all_without_jump_ = !this->communicator_.any(!all);
      assembly_.assemble(share(), inverse_D_, faces);
      solver_->prepare_coarse(
          assembly_.matrix(), conforming_.space(),
          [this](const double *x, double *y) { add_smooth(x, y); });
      assembly_.add_springs(inverse_D_, faces);
      solver_->prepare(assembly_.matrix(), conforming_.space(), !prepared_);
      prepared_ = true;
      this->counters_.coarse_spaces = solver_->counters().coarse_spaces;
    }

    /** y += M_hat x. */
    template <int dim>
    void AssembledDelassus<dim>::add_bodies(const double *x, double *y) const
    {
      const auto &bodies = this->bodies_;
      for_all_bodies(
          bodies,
          [&](const std::size_t k) -> const Block & {
            return bodies.classes[k].mass;
          },
          dof_gather(bodies, x), dof_scatter<true>(bodies, y));
      const StepShares shares = share();
      const auto add = [&](const Block BodyClass::*block, const double s) {
        for_all_bodies(
            bodies,
            [&](const std::size_t k) -> const Block & {
              return bodies.classes[k].*block;
            },
            dof_gather(bodies, x),
            [&](const unsigned int b, const double *Kx,
                const unsigned int stride) {
              const std::size_t first = bodies.first_dof[b],
                                n = bodies.first_dof[b + 1] - first;
              for (std::size_t i = 0; i < n; ++i)
                y[first + i] += s * Kx[i * stride];
            });
      };
      add(&BodyClass::stiffness, shares.stiffness);
      if (this->terms().viscous_theta > 0.)
        add(&BodyClass::damping, shares.damping);
    }

    /** y += A x for x in the joined space. */
    template <int dim>
    void AssembledDelassus<dim>::add_smooth(const double *x, double *y) const
    {
      add_bodies(x, y);
      if (all_without_jump_)
        return;
      std::vector<double> jump(inverse_D_.size()),
          forces(this->bodies_.n_dofs());
      this->relative_velocity(x, jump.data());
      for (std::size_t k = 0; k < jump.size(); ++k)
        jump[k] *= without_jump_[k / dim] ? 0. : inverse_D_[k];
      this->generalised_impulse(jump.data(), forces.data());
      for (std::size_t i = 0; i < forces.size(); ++i)
        y[i] += forces[i];
    }

    template <int dim>
    void AssembledDelassus<dim>::precondition(const double *r, double *z) const
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
    void AssembledDelassus<dim>::add_jump(const std::vector<double> &change,
                                          double *next)
    {
      for (std::size_t k = 0; k < change.size(); ++k) {
        jump_[k] += change[k];
        if (D_[k] >= 0.)
          next[k] -= inverse_D_[k] * change[k];
      }
    }

    template <int dim>
    bool AssembledDelassus<dim>::solve_springs(const double *P, const double *U,
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
      jump_.resize(n, 0.);
      if (direct_) // one part only: nothing adds up over the solves
        this->relative_velocity(velocity_.data(), jump_.data());
      // A dv = M_hat (v_free - v) + H^T P, P = P^ - D^{-1} H v of the last v:
      // the residual without A, whose round-off grows with the stiffness
      for (std::size_t k = 0; k < n; ++k)
        if (D_[k] >= 0.)
          next[k] = P[k] - inverse_D_[k] * (r[k] - (U ? U[k] : 0.) + jump_[k]);
      this->generalised_impulse(next, right_.data());
      for (std::size_t i = 0; i < m; ++i)
        difference_[i] = (*this->free_velocity_)[i] - velocity_[i];
      add_bodies(difference_.data(), right_.data());
      solution_.resize(m);
      this->counters_.inner_iterations += solver_->solve_parts(
          right_.data(), m, solution_.data(), difference_.data(), tolerance);
      ++this->counters_.global_solves;
      for (std::size_t i = 0; i < m; ++i)
        velocity_[i] += solution_[i] + difference_[i];
      this->relative_velocity(solution_.data(), work_.data());
      add_jump(work_, next);
      if (!direct_ && !all_without_jump_) {
        this->relative_velocity(difference_.data(), work_.data());
        for (std::size_t k = 0; k < n; ++k)
          if (without_jump_[k / dim])
            work_[k] = 0.;
        add_jump(work_, next);
      }
      return true;
    }
    /**
     * Where the next iterations start, which springs the joined space was built
     * with, and whether factors have failed for good.
     */
    template <int dim>
    void AssembledDelassus<dim>::serialize(Archive &archive)
    {
      DelassusOperator<dim>::serialize(archive);
      bool direct = direct_;
      archive.numbers("solver", direct, valid_, inverts_);
      archive.bodies("velocity", velocity_);
      archive.points("jump", jump_);
      archive.points("D", D_);
      archive.points("springs", inverse_D_);
      archive.points("springs_of_conforming_space", inverse_D_coarse_);
      if (!archive.reads())
        return;
      if (direct_ && !direct)
        use_cg();
      coarse_valid_ = false;
      if (valid_)
        prepare_again();
    }

    /** Factors and joined space as they were when D_ was prepared. */
    template <int dim>
    void AssembledDelassus<dim>::prepare_again()
    {
      set_body_stiffness();
      if (direct_) {
        assembly_.assemble(share(), inverse_D_);
        solver_->prepare(assembly_.matrix(), conforming_.space(), !prepared_);
        coarse_valid_ = prepared_ = true;
        return;
      }
      const std::vector<double> springs(inverse_D_);
      inverse_D_ = inverse_D_coarse_;
      prepare_cg();
      inverse_D_ = springs;
      prepare_cg();
    }
  } // namespace

  template <int dim>
  std::unique_ptr<DelassusOperator<dim>> make_assembled_delassus(
      const Communicator &communicator, const Bodies &bodies,
      const InterfacePoints<dim> &points, const std::string &solver,
      const std::vector<double> &coordinates)
  {
    return std::make_unique<AssembledDelassus<dim>>(
        communicator, bodies, points, solver, coordinates);
  }

  template std::unique_ptr<DelassusOperator<2>>
  make_assembled_delassus<2>(const Communicator &, const Bodies &,
                             const InterfacePoints<2> &, const std::string &,
                             const std::vector<double> &);
  template std::unique_ptr<DelassusOperator<3>>
  make_assembled_delassus<3>(const Communicator &, const Bodies &,
                             const InterfacePoints<3> &, const std::string &,
                             const std::vector<double> &);
} // namespace nsfd
