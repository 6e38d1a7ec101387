#include "bonded.h"

#include "condensed.h"
#include "conforming_solver.h"
#include "joined_matrix.h"
#include "linear_algebra/factor_limits.h"
#include "linear_algebra/positive_part.h"
#include "sparse_assembly.h"

#include "core/cost.h"
#include "core/gather.h"
#include "nsfd/core/archive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace nsfd
{
  namespace
  {
    /// of iterations: the energy balance shows what a product with W leaves
    constexpr double tight = 1e-12;
    constexpr long long most = std::numeric_limits<long long>::max();

    template <int dim>
    class Bonded final : public BondedDelassus<dim>
    {
    public:
      using typename BondedDelassus<dim>::Operator;

      Bonded(const Communicator &communicator, const Bodies &bodies,
             const InterfacePoints<dim> &points, const std::string &solver,
             const std::vector<double> &coordinates, bool share_nodes);

      void reinit(double time_step, double theta) override;
      bool bodies_are_apart() const override { return false; }
      void apply_delassus(const double *impulse,
                          double *velocity) const override;
      void add_velocity_change(const double *impulse,
                               double *velocity) const override;
      void apply(Operator op, const double *x, double *y) const override;
      void prepare_preconditioner(const std::vector<double> &D) override;
      void precondition(const double *r, double *z) const override;
      bool solve_linearised(const std::vector<double> &T, bool symmetric,
                            double tolerance, const std::vector<double> &c,
                            std::vector<double> &dP,
                            std::vector<double> &dU) override;
      bool join_motion(std::vector<double> &x) override;
      std::vector<std::uint8_t>
      once_per_node(const std::vector<std::uint8_t> &masks) override;
      std::vector<char>
      opens_with(const std::vector<std::uint8_t> &bonded) override
      {
        return conforming_->jumping(joined_by(bonded));
      }
      void serialize(Archive &archive) override;

    private:
      void bonds_changed() override;
      void set_bodies() const;
      std::vector<char>
      joined_by(const std::vector<std::uint8_t> &bonded) const;
      void solve(const double *b, double *x) const;
      bool respond(ConformingSolver &solver, const double *impulse,
                   double *velocity, double tolerance = tight) const;
      bool solve(ConformingSolver &solver, const double *b, double *x,
                 double tolerance = tight) const;
      void update() const;
      bool is_row(const std::size_t k) const { return !this->bonded_[k / dim]; }
      double least_compliance(std::size_t row, double W) const;
      bool condense() const;
      void set_diagonal();
      void prepare_joined();

      mutable std::unique_ptr<JoinedMatrix<dim>> matrix_;
      mutable bool has_bodies_ = false; ///< matrix_, of the step
      const bool may_share_;            ///< nodes
      std::unique_ptr<ConformingSpace> conforming_;
      std::unique_ptr<ConformingSolver> factor_; ///< of M_hat
      std::unique_ptr<ConformingSolver>
          joined_;                 ///< of A = M_hat + H^T D^{-1} H
      mutable bool valid_ = false; ///< factor_
      bool joined_valid_ = false;
      /// the system was factored as a dense one: W may be condensed later,
      /// within the iterations of a system prepared without
      bool dense_system_ = false;
      mutable std::size_t n_solves_ = 0;    ///< with the present factor
      mutable CondensedDelassus condensed_; ///< W of the rows, if it pays
      std::vector<double> D_;               ///< of the system to precondition
      std::vector<double> inverse_D_;       ///< of the one that was factored
      std::vector<double> diagonal_;        ///< of W, from above
      /// applications after which a new factor is cheaper than going on
      static constexpr unsigned int patience = 12;
      mutable unsigned int n_applied_ = 0; ///< since the last system
      mutable struct {
        std::vector<double> rows, columns, points;
      } work_; ///< by unknown of the bodies twice, and by component of points
    };

    template <int dim>
    Bonded<dim>::Bonded(const Communicator &communicator, const Bodies &bodies,
                        const InterfacePoints<dim> &points,
                        const std::string &solver,
                        const std::vector<double> &coordinates,
                        const bool share_nodes)
        : BondedDelassus<dim>(communicator, bodies, points),
          may_share_(share_nodes)
    {
      // K >= so much of the bodies' own: their blocks bound W from above
      this->stiffness_share_ = 1. - 1. / BulkTraction<dim>::penalty_factor;
      const long long mine = static_cast<long long>(bodies.n_dofs());
      long long sum = 0;
      MPI_Scan(&mine, &sum, 1, MPI_LONG_LONG, MPI_SUM, communicator.mpi());
      matrix_ = std::make_unique<JoinedMatrix<dim>>(
          communicator, bodies, points, point_traces(*this, sum - mine, true),
          this->bulk_.bonds(), sum - mine);
      const SparseAssembly<dim> nodes(communicator, bodies, points,
                                      coordinates);
      conforming_ = std::make_unique<ConformingSpace>(
          communicator, dim, nodes.unknowns(), nodes.node_pairs());
      for (auto *one : {&factor_, &joined_})
        *one = std::make_unique<ConformingSolver>(
            communicator, solver == "direct" ? most
                          : solver == "cg"   ? 0
                                             : largest_factor<dim>);
      bonds_changed();
    }

    template <int dim>
    std::vector<std::uint8_t>
    Bonded<dim>::once_per_node(const std::vector<std::uint8_t> &masks)
    {
      struct Claim {
        long long node;
        std::uint64_t key; ///< of the face
        unsigned int number, point, mask;
        int rank;
        bool operator<(const Claim &other) const
        {
          return std::tie(node, key, number) <
                 std::tie(other.node, other.key, other.number);
        }
      };
      std::vector<Claim> claims;
      for (std::size_t i = 0; i < masks.size(); ++i) {
        const long long node = masks[i] ? matrix_->node_of_point(i) : -1;
        if (node < 0)
          continue;
        const auto &face = this->points_.faces[this->points_.face_of[i]];
        claims.push_back({node, face.key, unsigned(i) - face.first, unsigned(i),
                          masks[i], this->communicator_.rank()});
      }
      claims = gather_all(this->communicator_, claims);
      std::sort(claims.begin(), claims.end());
      std::vector<std::uint8_t> result = masks;
      unsigned int said = 0;
      for (std::size_t k = 0; k < claims.size(); ++k) {
        if (k == 0 || claims[k].node != claims[k - 1].node)
          said = 0;
        if (claims[k].rank == this->communicator_.rank())
          result[claims[k].point] &= std::uint8_t(~said);
        said |= claims[k].mask;
      }
      return result;
    }

    /** Faces that are bonded all over, node to node. */
    template <int dim>
    std::vector<char>
    Bonded<dim>::joined_by(const std::vector<std::uint8_t> &bonded) const
    {
      std::vector<char> joined(this->points_.faces.size(), 0);
      for (std::size_t f = 0; f < joined.size(); ++f) {
        const auto &face = this->points_.faces[f];
        const auto first = bonded.begin() + face.first,
                   last = first + face.count;
        joined[f] =
            may_share_ && conforming_->is_complete(f) &&
            std::all_of(first, last, [](const std::uint8_t b) { return b; });
      }
      return joined;
    }

    template <int dim>
    void Bonded<dim>::bonds_changed()
    {
      valid_ = joined_valid_ = false;
      this->shares_nodes_ = joined_by(this->bonded_);
      for (std::size_t f = 0; f < this->shares_nodes_.size(); ++f)
        if (this->shares_nodes_[f])
          std::fill_n(this->penalised_.begin() + this->points_.faces[f].first,
                      this->points_.faces[f].count, 0);
      conforming_->conform(this->shares_nodes_);
      matrix_->set_space(conforming_->space(), this->shares_nodes_,
                         this->penalised_);
      for (auto *one : {&factor_, &joined_})
        (*one)->set_space(conforming_->space());
      has_bodies_ = false;
    }

    /** M_hat in the space, as far as it does not depend on springs. */
    template <int dim>
    void Bonded<dim>::set_bodies() const
    {
      if (has_bodies_)
        return;
      matrix_->set_bodies(this->shares(this->time_step_, this->theta_));
      has_bodies_ = true;
    }

    /** Its positive part preconditions what is not symmetric. */
    template <int dim>
    bool Bonded<dim>::solve_linearised(const std::vector<double> &T,
                                       const bool symmetric,
                                       const double tolerance,
                                       const std::vector<double> &c,
                                       std::vector<double> &dP,
                                       std::vector<double> &dU)
    {
      joined_valid_ = false; // its factor is the one of the preconditioner
      {
        const Charge charge(Cost::preconditioner);
        set_bodies();
        const std::vector<double> *positive = &T;
        std::vector<double> part;
        if (!symmetric) {
          part = T;
          for (std::size_t k = 0; k < T.size(); k += dim * dim)
            take_positive_part<dim>(&part[k]);
          positive = &part;
        }
        ++this->counters_.global_factorisations;
        if (!joined_->try_to_prepare(matrix_->assemble(positive->data())))
          return false;
        if (!symmetric)
          joined_->set_unsymmetric(matrix_->assemble(T.data()));
      }
      const Charge charge(Cost::precondition);
      dU.resize(c.size());
      if (!respond(*joined_, c.data(), dU.data(),
                   symmetric ? tight : tolerance))
        return false;
      dP = c;
      for (std::size_t k = 0; k < c.size(); ++k)
        for (unsigned int e = 0; e < dim; ++e)
          dP[k] -= T[k * dim + e] * dU[k / dim * dim + e];
      return true;
    }

    template <int dim>
    bool Bonded<dim>::join_motion(std::vector<double> &x)
    {
      ConformingSolver mass(this->communicator_, most);
      mass.set_space(conforming_->space());
      matrix_->set_bodies({0., 0.});
      has_bodies_ = false;
      mass.prepare(matrix_->assemble(nullptr));
      std::vector<double> momentum(x.size()), joined(x.size());
      this->apply(Operator::mass, x.data(), momentum.data());
      mass.solve(momentum.data(), joined.data(), tight);
      double size = 0., change = 0.;
      for (std::size_t k = 0; k < x.size(); ++k) {
        size = std::max(size, std::abs(x[k]));
        change = std::max(change, std::abs(joined[k] - x[k]));
      }
      // what has no jump but for round-off keeps its bits
      if (!(this->communicator_.max(change) >
            1e-12 * this->communicator_.max(size)))
        return false;
      x = std::move(joined);
      return true;
    }

    template <int dim>
    void Bonded<dim>::reinit(const double time_step, const double theta)
    {
      if (time_step != this->time_step_ || theta != this->theta_)
        valid_ = joined_valid_ = has_bodies_ = false;
      DelassusOperator<dim>::reinit(time_step, theta);
    }

    /** Factor M_hat if the step or the bonds have changed. */
    template <int dim>
    void Bonded<dim>::update() const
    {
      if (valid_)
        return;
      const Charge charge(Cost::preconditioner);
      set_bodies();
      factor_->prepare(matrix_->assemble(nullptr));
      ++this->counters_.global_factorisations;
      valid_ = true;
      n_solves_ = 0;
      condensed_.clear();
    }

    template <int dim>
    void Bonded<dim>::solve(const double *b, double *x) const
    {
      update();
      solve(*factor_, b, x);
      ++n_solves_;
    }

    template <int dim>
    bool Bonded<dim>::solve(ConformingSolver &solver, const double *b,
                            double *x, const double tolerance) const
    {
      std::fill(x, x + this->bodies_.n_dofs(), 0.);
      const auto outcome = solver.solve(b, x, tolerance);
      this->counters_.inner_iterations += outcome.iterations;
      ++this->counters_.global_solves;
      return outcome.converged;
    }

    template <int dim>
    void Bonded<dim>::apply(const Operator op, const double *x, double *y) const
    {
      if (op == Operator::inverse) {
        solve(x, y);
        return;
      }
      BondedDelassus<dim>::apply(op, x, y);
    }

    template <int dim>
    void Bonded<dim>::apply_delassus(const double *impulse,
                                     double *velocity) const
    {
      const Charge charge(Cost::delassus);
      ++this->counters_.delassus;
      if (condense()) {
        condensed_.apply(impulse, velocity);
        return;
      }
      update();
      ++n_solves_;
      respond(*factor_, impulse, velocity);
    }

    /** U = H x of the answer x to H^T P. */
    template <int dim>
    bool Bonded<dim>::respond(ConformingSolver &solver, const double *impulse,
                              double *velocity, const double tolerance) const
    {
      if (this->communicator_.size() == 1) { // points that can part alone
        matrix_->impulse(impulse, work_.rows);
        const auto outcome = solver.solve_own(work_.rows, work_.columns, tight);
        this->counters_.inner_iterations += outcome.iterations;
        ++this->counters_.global_solves;
        matrix_->velocity(work_.columns, velocity);
        return outcome.converged;
      }
      work_.rows.resize(this->bodies_.n_dofs());
      work_.columns.resize(work_.rows.size());
      this->generalised_impulse(impulse, work_.rows.data());
      const bool solved =
          solve(solver, work_.rows.data(), work_.columns.data(), tolerance);
      this->relative_velocity(work_.columns.data(), velocity);
      return solved;
    }

    template <int dim>
    void Bonded<dim>::add_velocity_change(const double *impulse,
                                          double *velocity) const
    {
      work_.rows.resize(this->bodies_.n_dofs());
      work_.columns.resize(work_.rows.size());
      this->generalised_impulse(impulse, work_.rows.data());
      solve(work_.rows.data(), work_.columns.data());
      for (std::size_t k = 0; k < work_.columns.size(); ++k)
        velocity[k] += work_.columns[k];
    }

    /**
     * W of the rows as a dense matrix, on one rank: once as many systems have
     * been solved as its columns cost, and if it fits.
     */
    template <int dim>
    bool Bonded<dim>::condense() const
    {
      if (this->communicator_.size() > 1)
        return false;
      update();
      if (!condensed_.empty())
        return true;
      std::vector<std::size_t> rows;
      for (std::size_t k = 0; k < this->bonded_.size() * dim; ++k)
        if (is_row(k))
          rows.push_back(k);
      // Many columns at once cost a quarter of as many single ones; a product
      // by the factor reads it twice.
      const double by_factor =
          2. * factor_->n_factor_entries() + 10. * double(rows.size());
      if (rows.empty() || rows.size() > CondensedDelassus::largest ||
          (rows.size() > 64 &&
           (4 * n_solves_ < rows.size() ||
            double(rows.size()) * double(rows.size()) > by_factor)))
        return false;
      const std::size_t n = this->bodies_.n_dofs(), m = rows.size();
      constexpr std::size_t batch = 64; // columns fill the caches
      std::vector<double> B(n * batch), X(n * batch),
          impulse(this->bonded_.size() * dim, 0.), velocity(impulse.size());
      condensed_.reset(impulse.size(), rows);
      for (std::size_t first = 0; first < m; first += batch) {
        const std::size_t count = std::min(batch, m - first);
        for (std::size_t c = 0; c < count; ++c) {
          impulse[rows[first + c]] = 1.;
          this->generalised_impulse(impulse.data(), &B[c * n]);
          impulse[rows[first + c]] = 0.;
        }
        factor_->solve_columns(B.data(), X.data(), n, count, tight);
        for (std::size_t c = 0; c < count; ++c) {
          this->relative_velocity(&X[c * n], velocity.data());
          condensed_.set_column(first + c, velocity.data());
        }
      }
      this->counters_.global_solves += m;
      return true;
    }

    template <int dim>
    double Bonded<dim>::least_compliance(const std::size_t row,
                                         const double W) const
    {
      return this->least_compliance_.empty() ? 1e-2 * W
                                             : this->least_compliance_[row];
    }

    template <int dim>
    void Bonded<dim>::prepare_preconditioner(const std::vector<double> &D)
    {
      const Charge charge(Cost::preconditioner);
      dense_system_ = condense() && condensed_.can_factor();
      if (dense_system_) {
        condensed_.factor(D);
        return;
      }
      // all ranks take the same way: a factor is made by all of them
      if (!this->communicator_.any(!joined_valid_ || D != D_))
        return;
      D_ = D;
      // an old factor is a good preconditioner until iterations say otherwise
      const unsigned int applied = std::exchange(n_applied_, 0);
      if (joined_valid_ && applied <= patience)
        return;
      set_diagonal();
      inverse_D_.assign(D.size(), 0.);
      for (std::size_t row = 0; row < D.size(); ++row)
        if (D[row] >= 0. && is_row(row))
          inverse_D_[row] =
              1. / std::max(D[row], least_compliance(row, diagonal_[row]));
      prepare_joined();
    }

    template <int dim>
    void Bonded<dim>::set_diagonal()
    {
      diagonal_.assign(this->bonded_.size() * dim, 0.);
      for (std::size_t f = 0; f < this->points_.faces.size(); ++f) {
        const auto &face = this->points_.faces[f];
        const unsigned int n = face.count * dim;
        const double *W = this->face_block(f);
        for (unsigned int k = 0; k < n; ++k)
          diagonal_[std::size_t(face.first) * dim + k] = W[k * n + k];
      }
    }

    template <int dim>
    void Bonded<dim>::prepare_joined()
    {
      set_bodies();
      std::vector<double> springs(inverse_D_.size() * dim, 0.);
      for (std::size_t k = 0; k < inverse_D_.size(); ++k)
        springs[k * dim + k % dim] = inverse_D_[k];
      joined_->prepare(matrix_->assemble(springs.data()));
      ++this->counters_.global_factorisations;
      joined_valid_ = true;
    }

    /**
     * Factors are made again; whether W was condensed depends on how many
     * systems had been solved, and how good an old factor is on its springs.
     */
    template <int dim>
    void Bonded<dim>::serialize(Archive &archive)
    {
      BondedDelassus<dim>::serialize(archive);
      bool factored = valid_, joined = joined_valid_,
           condensed = !condensed_.empty();
      std::size_t n_solves = n_solves_;
      unsigned int n_applied = n_applied_;
      archive.numbers("solver", factored, joined, condensed, n_solves,
                      n_applied);
      archive.points("D", D_);
      archive.points("springs", inverse_D_);
      if (!archive.reads())
        return;
      valid_ = joined_valid_ = false;
      condensed_.clear();
      if (factored)
        update();
      if (condensed) {
        n_solves_ = CondensedDelassus::largest; // enough for any
        condense();
      }
      if (joined) {
        set_diagonal();
        prepare_joined();
      }
      n_solves_ = n_solves;
      n_applied_ = n_applied;
    }

    template <int dim>
    void Bonded<dim>::precondition(const double *r, double *z) const
    {
      const Charge charge(Cost::precondition);
      if (dense_system_) {
        condensed_.solve(r, z);
        return;
      }
      ++n_applied_;
      const std::size_t n = inverse_D_.size();
      work_.points.resize(n);
      for (std::size_t k = 0; k < n; ++k)
        work_.points[k] = D_[k] >= 0. ? inverse_D_[k] * r[k] : 0.;
      const std::vector<double> springs(work_.points);
      respond(*joined_, springs.data(), z);
      // a principal part of the inverse where the factor knows the row, and the
      // bound of the diagonal where it does not: positive definite together
      for (std::size_t k = 0; k < n; ++k)
        if (D_[k] < 0.)
          z[k] = 0.;
        else if (inverse_D_[k] > 0.)
          z[k] = inverse_D_[k] * (r[k] - z[k]);
        else
          z[k] = r[k] / (diagonal_[k] + D_[k]);
    }
  } // namespace

  template <int dim>
  std::unique_ptr<BondedDelassus<dim>> make_bonded_delassus(
      const Communicator &communicator, const Bodies &bodies,
      const InterfacePoints<dim> &points, const std::string &solver,
      const std::vector<double> &coordinates, const bool share_nodes)
  {
    return std::make_unique<Bonded<dim>>(communicator, bodies, points, solver,
                                         coordinates, share_nodes);
  }

  template std::unique_ptr<BondedDelassus<2>>
  make_bonded_delassus<2>(const Communicator &, const Bodies &,
                          const InterfacePoints<2> &, const std::string &,
                          const std::vector<double> &, bool);
  template std::unique_ptr<BondedDelassus<3>>
  make_bonded_delassus<3>(const Communicator &, const Bodies &,
                          const InterfacePoints<3> &, const std::string &,
                          const std::vector<double> &, bool);
} // namespace nsfd
