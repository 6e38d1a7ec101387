#include "nsfd/dynamics/dynamics.h"

#include <deal.II/base/index_set.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/solver_control.h>
#include <deal.II/lac/trilinos_precondition.h>
#include <deal.II/lac/trilinos_solver.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>
#include <deal.II/lac/trilinos_vector.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /**
     * The global sparse matrix of all bodies joined by what their faces carry,
     *
     *     A = M_hat + H^T D^{-1} H,
     *
     * as a preconditioner of W + D by the Woodbury identity,
     *
     *     (W + D)^{-1} = D^{-1} (1 - H A^{-1} H^T D^{-1}).
     *
     * With D > 0 everywhere this is the inverse itself. Rigid rows and closed
     * contacts (D = 0) enter with a compliance 1e-2 of the diagonal of W: a
     * stiffness only for the preconditioner, the row stays exact. (A smaller
     * one lets round-off grow along impulses that W does not see.)
     */
    template <int dim>
    class SparseDynamics final : public Dynamics<dim>
    {
    public:
      SparseDynamics(const Communicator &communicator,
                     const Bodies &bodies,
                     const InterfacePoints<dim> &points,
                     const std::string &solver);

      void reinit(double time_step, double theta) override;
      void prepare_preconditioner(const std::vector<double> &D) override;
      void precondition(const double *r, double *z) const override;

    private:
      void exchange_traces();
      void build_pattern();

      /** dofs and rows of Q T at a point on one side, known on both ranks. */
      struct Trace
      {
        long long first = -1;
        std::vector<double> rows; // dim x n_dofs
      };
      std::array<std::vector<Trace>, 2> traces_;
      long long first_dof_ = 0;
      bool direct_;
      dealii::IndexSet owned_;
      dealii::TrilinosWrappers::SparseMatrix matrix_;
      dealii::SolverControl control_;
      std::unique_ptr<dealii::TrilinosWrappers::SolverDirect> factor_;
      std::unique_ptr<dealii::TrilinosWrappers::PreconditionAMG> multigrid_;
      std::vector<double> D_, inverse_D_;
      bool valid_ = false;
      mutable std::vector<double> work_, body_work_;
    };

    template <int dim>
    SparseDynamics<dim>::SparseDynamics(const Communicator &communicator,
                                        const Bodies &bodies,
                                        const InterfacePoints<dim> &points,
                                        const std::string &solver)
      : Dynamics<dim>(communicator, bodies, points)
      , direct_(solver == "direct")
    {
      const long long mine = static_cast<long long>(bodies.n_dofs());
      long long sum = 0;
      MPI_Scan(&mine, &sum, 1, MPI_LONG_LONG, MPI_SUM, communicator.mpi());
      first_dof_ = sum - mine;
      const auto total = communicator.sum_integer(bodies.n_dofs());
      owned_ = dealii::IndexSet(total);
      owned_.add_range(first_dof_, sum);
      exchange_traces();
      build_pattern();
    }

    template <int dim>
    void SparseDynamics<dim>::exchange_traces()
    {
      const auto &points = this->points_;
      const auto &bodies = this->bodies_;
      double largest = 0.;
      for (const auto &body : bodies.classes)
        largest = std::max(largest, double(body.n_dofs));
      const unsigned int width =
        unsigned(this->communicator_.max(largest)); // on every rank
      const unsigned int stride = 2 + dim * width;
      std::array<std::vector<double>, 2> side;
      for (auto &s : side)
        s.assign((points.n_points + 1) * stride, -1.);
      const auto fill = [&](const std::size_t b, const std::size_t slot,
                            const std::size_t point, const bool second) {
        const BodyClass &body = bodies.classes[bodies.class_of[b]];
        double *out = side[second].data() + point * stride;
        out[0] = double(first_dof_) + double(bodies.first_dof[b]);
        out[1] = body.n_dofs;
        const double *Q = points.frame.data() + point * dim * dim;
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int j = 0; j < body.n_dofs; ++j) {
            double value = 0.;
            for (unsigned int c = 0; c < dim; ++c)
              value +=
                Q[k * dim + c] * body.trace(unsigned(slot) * dim + c, j);
            out[2 + k * width + j] = value;
          }
      };
      for (std::size_t b = 0; b < bodies.size(); ++b)
        for (std::size_t s = bodies.first_slot[b];
             s < bodies.first_slot[b + 1]; ++s)
          if (bodies.slot_point[s] < points.n_points)
            fill(b, s - bodies.first_slot[b], bodies.slot_point[s],
                 bodies.slot_sign[s] > 0);
      for (const auto &[slot, point] : bodies.extra_points) {
        const std::size_t b =
          std::upper_bound(bodies.first_slot.begin(), bodies.first_slot.end(),
                           slot) -
          bodies.first_slot.begin() - 1;
        fill(b, slot - bodies.first_slot[b], point, true);
      }
      this->exchange({{side[0].data(), side[1].data()}}, stride);
      for (unsigned int s = 0; s < 2; ++s) {
        traces_[s].resize(points.n_points);
        for (std::size_t i = 0; i < points.n_points; ++i) {
          const double *in = side[s].data() + i * stride;
          if (in[0] < 0.)
            continue;
          const unsigned int n = unsigned(in[1]);
          traces_[s][i].first = static_cast<long long>(in[0]);
          traces_[s][i].rows.resize(dim * n);
          for (unsigned int k = 0; k < dim; ++k)
            for (unsigned int j = 0; j < n; ++j)
              traces_[s][i].rows[k * n + j] =
                (s == 1 ? 1. : -1.) * in[2 + k * width + j];
        }
      }
    }

    template <int dim>
    void SparseDynamics<dim>::build_pattern()
    {
      const auto &bodies = this->bodies_;
      dealii::DynamicSparsityPattern pattern(owned_.size(), owned_.size(),
                                             owned_);
      std::vector<dealii::types::global_dof_index> columns;
      const auto range = [&](const long long first, const std::size_t n) {
        columns.resize(n);
        for (std::size_t j = 0; j < n; ++j)
          columns[j] = first + j;
      };
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        const std::size_t n = bodies.first_dof[b + 1] - bodies.first_dof[b];
        range(first_dof_ + bodies.first_dof[b], n);
        for (std::size_t j = 0; j < n; ++j)
          pattern.add_entries(columns[j], columns.begin(), columns.end(),
                              true);
      }
      for (const auto &face : this->points_.faces) {
        const std::size_t i = face.first;
        for (unsigned int s = 0; s < 2; ++s) {
          const Trace &row = traces_[s][i], &column = traces_[1 - s][i];
          if (face.bodies[s] < 0 || row.first < 0 || column.first < 0)
            continue;
          range(column.first, column.rows.size() / dim);
          for (std::size_t j = 0; j < row.rows.size() / dim; ++j)
            pattern.add_entries(row.first + j, columns.begin(), columns.end(),
                                true);
        }
      }
      matrix_.reinit(owned_, owned_, pattern, this->communicator_.mpi(),
                     true);
    }

    template <int dim>
    void SparseDynamics<dim>::reinit(const double time_step,
                                     const double theta)
    {
      if (time_step != this->time_step_ || theta != this->theta_)
        valid_ = false;
      Dynamics<dim>::reinit(time_step, theta);
    }

    template <int dim>
    void
    SparseDynamics<dim>::prepare_preconditioner(const std::vector<double> &D)
    {
      // a factor is good as long as the step and D stay what they were
      if (!this->communicator_.any(!valid_ || D != D_))
        return;
      D_ = D;
      valid_ = true;
      const auto &points = this->points_;
      const auto &bodies = this->bodies_;
      inverse_D_.assign(D.size(), 0.);
      for (std::size_t f = 0; f < points.faces.size(); ++f) {
        const auto &face = points.faces[f];
        const unsigned int n = face.count * dim;
        const double *W = this->face_block(f);
        for (unsigned int k = 0; k < n; ++k) {
          const std::size_t row = std::size_t(face.first) * dim + k;
          const double least = this->least_compliance_.empty()
                                 ? 1e-2 * W[k * n + k]
                                 : this->least_compliance_[row];
          if (D[row] >= 0.)
            inverse_D_[row] = 1. / std::max(D[row], least);
        }
      }

      matrix_ = 0.;
      std::vector<dealii::types::global_dof_index> rows, columns;
      dealii::FullMatrix<double> block;
      const double factor =
        this->time_step_ * this->time_step_ * this->theta_ * this->theta_;
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        const BodyClass &body = bodies.classes[bodies.class_of[b]];
        const unsigned int n = body.n_dofs;
        rows.resize(n);
        block.reinit(n, n);
        for (unsigned int i = 0; i < n; ++i) {
          rows[i] = first_dof_ + bodies.first_dof[b] + i;
          for (unsigned int j = 0; j < n; ++j)
            block(i, j) = body.mass(i, j) +
                          (body.rigid ? 0. : factor * body.stiffness(i, j));
        }
        matrix_.add(rows, rows, block);
      }
      for (const auto &face : points.faces)
        for (unsigned int s = 0; s < 2; ++s) {
          if (face.bodies[s] < 0)
            continue;
          for (unsigned int t = 0; t < 2; ++t) {
            if (traces_[t][face.first].first < 0)
              continue;
            const std::size_t n = traces_[s][face.first].rows.size() / dim,
                              m = traces_[t][face.first].rows.size() / dim;
            rows.resize(n);
            columns.resize(m);
            block.reinit(n, m);
            for (std::size_t i = 0; i < n; ++i)
              rows[i] = traces_[s][face.first].first + i;
            for (std::size_t j = 0; j < m; ++j)
              columns[j] = traces_[t][face.first].first + j;
            for (unsigned int p = face.first; p < face.first + face.count; ++p)
              for (unsigned int k = 0; k < dim; ++k) {
                const double stiffness = inverse_D_[p * dim + k];
                if (stiffness == 0.)
                  continue;
                const double *a = &traces_[s][p].rows[k * n];
                const double *c = &traces_[t][p].rows[k * m];
                for (std::size_t i = 0; i < n; ++i)
                  for (std::size_t j = 0; j < m; ++j)
                    block(i, j) += stiffness * a[i] * c[j];
              }
            matrix_.add(rows, columns, block);
          }
        }
      matrix_.compress(dealii::VectorOperation::add);
      ++this->counters_.global_factorisations;
      if (direct_) {
        factor_ = std::make_unique<dealii::TrilinosWrappers::SolverDirect>(
          control_, dealii::TrilinosWrappers::SolverDirect::AdditionalData(
                      false, "Amesos_Klu"));
        factor_->initialize(matrix_);
      } else {
        dealii::TrilinosWrappers::PreconditionAMG::AdditionalData data;
        data.elliptic = true;
        data.higher_order_elements = true;
        data.aggregation_threshold = 1e-3;
        data.smoother_sweeps = 2;
        // translations of the bodies
        data.constant_modes.assign(dim, std::vector<bool>(bodies.n_dofs()));
        for (std::size_t b = 0; b < bodies.size(); ++b)
          for (std::size_t k = bodies.first_dof[b];
               k < bodies.first_dof[b + 1]; ++k)
            data.constant_modes[(k - bodies.first_dof[b]) % dim][k] = true;
        multigrid_ =
          std::make_unique<dealii::TrilinosWrappers::PreconditionAMG>();
        multigrid_->initialize(matrix_, data);
      }
    }

    template <int dim>
    void SparseDynamics<dim>::precondition(const double *r, double *z) const
    {
      const std::size_t n = inverse_D_.size(), m = this->bodies_.n_dofs();
      work_.resize(n);
      body_work_.resize(m);
      for (std::size_t k = 0; k < n; ++k)
        work_[k] = inverse_D_[k] * r[k];
      this->generalised_impulse(work_.data(), body_work_.data());
      dealii::TrilinosWrappers::MPI::Vector b(owned_,
                                              this->communicator_.mpi()),
        x(owned_, this->communicator_.mpi());
      std::copy(body_work_.begin(), body_work_.end(), b.begin());
      if (direct_)
        factor_->solve(x, b);
      else {
        const double norm = b.l2_norm();
        if (norm > 0.) {
          dealii::SolverControl control(2000, 1e-11 * norm);
          dealii::TrilinosWrappers::SolverCG cg(control);
          try {
            cg.solve(matrix_, x, b, *multigrid_);
          } catch (const dealii::SolverControl::NoConvergence &) {
            // only a preconditioner: the outer iteration judges the result
          }
        }
      }
      std::copy(x.begin(), x.end(), body_work_.begin());
      this->relative_velocity(body_work_.data(), z);
      for (std::size_t k = 0; k < n; ++k)
        z[k] = inverse_D_[k] * (r[k] - z[k]);
    }
  } // namespace

  template <int dim>
  std::unique_ptr<Dynamics<dim>>
  make_sparse_dynamics(const Communicator &communicator,
                       const Bodies &bodies,
                       const InterfacePoints<dim> &points,
                       const std::string &solver)
  {
    return std::make_unique<SparseDynamics<dim>>(communicator, bodies, points,
                                                 solver);
  }

  template std::unique_ptr<Dynamics<2>>
  make_sparse_dynamics<2>(const Communicator &, const Bodies &,
                          const InterfacePoints<2> &, const std::string &);
  template std::unique_ptr<Dynamics<3>>
  make_sparse_dynamics<3>(const Communicator &, const Bodies &,
                          const InterfacePoints<3> &, const std::string &);
} // namespace nsfd
