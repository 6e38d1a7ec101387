#include "body_inverses.h"
#include "linear_algebra/cholesky.h"
#include "linear_algebra/ghost_values.h"
#include "linear_algebra/multigrid.h"
#include "linear_algebra/sparse_rows.h"

#include "core/stop_request.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    class GluedCg final : public SpdSolver
    {
    public:
      GluedCg(const Communicator &communicator,
              const std::vector<std::size_t> &first_dof,
              const long long largest_factor)
          : communicator_(communicator), largest_factor_(largest_factor),
            bodies_(first_dof)
      {
      }

      void prepare(const SparseRows &matrix, const CoarseSpace &coarse,
                   bool new_pattern) override;
      void prepare_coarse(const SparseRows &matrix, const CoarseSpace &coarse,
                          const Product &add_product) override;
      unsigned int solve(const double *b, double *x, double tolerance) override;
      unsigned int solve_parts(const double *b, std::size_t rows, double *rest,
                               double *coarse, double tolerance) override;

    private:
      void build_coarse(const SparseRows &matrix, const CoarseSpace &coarse);
      void precondition(const double *r, double *z);
      void multiply_direction();
      double dot(const double *a, const double *b, const double *coarse_a,
                 const double *coarse_b) const;
      unsigned int iterate(double *rest, double tolerance);

      const Communicator &communicator_;
      const long long largest_factor_;
      const SparseRows *matrix_ = nullptr;
      GhostValues exchange_;
      BodyInverses bodies_;

      unsigned long long version_ = 0;
      /// per own unknown: place among own coarse ones, then coarse ghosts
      std::vector<int> place_;
      long long n_coarse_ = 0;
      GhostValues coarse_exchange_;
      std::unique_ptr<Cholesky> factor_;
      std::unique_ptr<Multigrid> multigrid_;
      Product add_product_; // with A on the coarse space, if known apart
      std::vector<double> r_, z_, p_, q_;
      std::vector<double> coarse_r_, coarse_z_, coarse_p_, coarse_q_, coarse_x_;
    };

    void GluedCg::prepare(const SparseRows &matrix, const CoarseSpace &coarse,
                          const bool new_pattern)
    {
      if (new_pattern || !matrix_)
        exchange_ = GhostValues(communicator_, matrix.first_row,
                                std::size_t(matrix.n_rows()), matrix.ghosts);
      matrix_ = &matrix;
      bodies_.prepare(matrix);
      ++counters_.factorisations;
      if (version_ != coarse.version)
        build_coarse(matrix, coarse);
    }

    void GluedCg::prepare_coarse(const SparseRows &matrix,
                                 const CoarseSpace &coarse,
                                 const Product &add_product)
    {
      add_product_ = add_product;
      if (version_ == coarse.version)
        return;
      if (!matrix_)
        exchange_ = GhostValues(communicator_, matrix.first_row,
                                std::size_t(matrix.n_rows()), matrix.ghosts);
      build_coarse(matrix, coarse);
    }

    void GluedCg::build_coarse(const SparseRows &matrix,
                               const CoarseSpace &coarse)
    {
      version_ = coarse.version;
      const std::size_t n = std::size_t(matrix.n_rows());
      std::vector<double> own(n), ghosts(matrix.ghosts.size());
      for (std::size_t i = 0; i < n; ++i)
        own[i] = double(coarse.number[i]);
      exchange_.fetch(own.data(), ghosts.data());
      const std::vector<long long> numbers(ghosts.begin(), ghosts.end());
      const SparseRows coarse_matrix =
          coarse_rows(communicator_, matrix, coarse, numbers);
      ++counters_.coarse_spaces;

      // coarse unknowns of other ranks that own nodes are glued to
      std::vector<long long> remote;
      const long long first = coarse.first, end = first + coarse.n_own;
      for (const long long k : coarse.number)
        if (k < first || k >= end)
          remote.push_back(k);
      std::sort(remote.begin(), remote.end());
      remote.erase(std::unique(remote.begin(), remote.end()), remote.end());
      coarse_exchange_ =
          GhostValues(communicator_, first, std::size_t(coarse.n_own), remote);
      n_coarse_ = coarse.n_own;
      place_.resize(n);
      for (std::size_t i = 0; i < n; ++i) {
        const long long k = coarse.number[i];
        place_[i] = k >= first && k < end
                        ? int(k - first)
                        : int(n_coarse_ + (std::lower_bound(remote.begin(),
                                                            remote.end(), k) -
                                           remote.begin()));
      }
      coarse_r_.resize(std::size_t(n_coarse_) + remote.size());
      coarse_z_.resize(coarse_r_.size());

      if (coarse.n_global <= largest_factor_) {
        multigrid_.reset();
        if (!factor_)
          factor_ = std::make_unique<Cholesky>(communicator_);
        factor_->factorise(coarse_matrix, true);
      } else {
        factor_.reset();
        if (!multigrid_)
          multigrid_ = std::make_unique<Multigrid>(communicator_);
        multigrid_->prepare(coarse_matrix, coarse.modes, coarse.per_node);
      }
    }

    /** The part of the bodies into @p z, the other one into coarse_z_. */
    void GluedCg::precondition(const double *r, double *z)
    {
      std::fill(coarse_r_.begin(), coarse_r_.end(), 0.);
      for (std::size_t i = 0; i < place_.size(); ++i)
        coarse_r_[place_[i]] += r[i];
      coarse_exchange_.start_add_back(coarse_r_.data() + n_coarse_);
      bodies_.apply(r, z);
      coarse_exchange_.finish_add_back(coarse_r_.data());
      if (factor_)
        factor_->solve(coarse_r_.data(), coarse_z_.data());
      else
        multigrid_->apply(coarse_r_.data(), coarse_z_.data());
      coarse_exchange_.fetch(coarse_z_.data(), coarse_z_.data() + n_coarse_);
    }

    /** a.b + coarse_a.coarse_b over own unknowns. */
    double GluedCg::dot(const double *a, const double *b,
                        const double *coarse_a, const double *coarse_b) const
    {
      // the second one: how many ranks are asked to stop
      double sums[2] = {0.,
                        stop_request::is_due(communicator_.size()) ? 1. : 0.};
      for (std::size_t i = 0; i < place_.size(); ++i)
        sums[0] += a[i] * b[i];
      for (long long i = 0; i < n_coarse_; ++i)
        sums[0] += coarse_a[i] * coarse_b[i];
      if (communicator_.size() > 1)
        MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM,
                      communicator_.mpi());
      if (sums[1] > 0.)
        throw StopRequested();
      return sums[0];
    }

    /** q = A (p + P p_c), and P^T q of it. */
    void GluedCg::multiply_direction()
    {
      const std::size_t n = place_.size();
      for (std::size_t i = 0; i < n; ++i)
        z_[i] = coarse_p_[place_[i]];
      if (add_product_) {
        multiply(*matrix_, exchange_, p_.data(), q_.data());
        add_product_(z_.data(), q_.data());
      } else {
        for (std::size_t i = 0; i < n; ++i) {
          std::swap(p_[i], z_[i]);
          p_[i] += z_[i];
        }
        multiply(*matrix_, exchange_, p_.data(), q_.data());
        std::copy_n(z_.begin(), n, p_.begin());
      }
      std::fill(coarse_q_.begin(), coarse_q_.end(), 0.);
      for (std::size_t i = 0; i < n; ++i)
        coarse_q_[place_[i]] += q_[i];
      coarse_exchange_.start_add_back(coarse_q_.data() + n_coarse_);
      coarse_exchange_.finish_add_back(coarse_q_.data());
    }

    /**
     * Conjugate gradients from the residual r_ on; what is found is rest + P
     * coarse_x_. Directions are kept in these two parts as well: springs that
     * vanish on the coarse space are larger than what A is there by more than
     * the digits of a sum.
     */
    unsigned int GluedCg::iterate(double *rest, const double tolerance)
    {
      const std::size_t n = place_.size(), n_coarse = coarse_z_.size();
      ++counters_.solves;
      z_.resize(n);
      q_.resize(n);
      p_.assign(n + matrix_->ghosts.size(), 0.);
      std::fill_n(rest, n, 0.);
      coarse_q_.resize(n_coarse);
      coarse_p_.assign(n_coarse, 0.);
      coarse_x_.assign(n_coarse, 0.);
      double rz = 1.;
      const auto turn = [&](const bool first) {
        precondition(r_.data(), z_.data());
        const double next =
            dot(r_.data(), z_.data(), coarse_r_.data(), coarse_z_.data());
        const double beta = first ? 0. : next / rz;
        rz = next;
        for (std::size_t i = 0; i < n; ++i)
          p_[i] = z_[i] + beta * p_[i];
        for (std::size_t i = 0; i < n_coarse; ++i)
          coarse_p_[i] = coarse_z_[i] + beta * coarse_p_[i];
      };
      turn(true);
      const double target = tolerance * tolerance * rz;
      // a sum that is not above round-off any more ends it as well
      const unsigned int limit = 1000;
      unsigned int k = 0;
      for (; k < limit && rz > target; ++k) {
        multiply_direction();
        const double pAp =
            dot(q_.data(), p_.data(), coarse_q_.data(), coarse_p_.data());
        if (!(pAp > 0.))
          break;
        const double alpha = rz / pAp;
        for (std::size_t i = 0; i < n; ++i) {
          rest[i] += alpha * p_[i];
          r_[i] -= alpha * q_[i];
        }
        for (std::size_t i = 0; i < n_coarse; ++i)
          coarse_x_[i] += alpha * coarse_p_[i];
        turn(false);
      }
      converged_ = rz <= target;
      counters_.iterations += k;
      return k;
    }

    unsigned int GluedCg::solve_parts(const double *b, const std::size_t rows,
                                      double *rest, double *coarse,
                                      const double tolerance)
    {
      r_.assign(b, b + rows);
      const unsigned int k = iterate(rest, tolerance);
      for (std::size_t i = 0; i < rows; ++i)
        coarse[i] = coarse_x_[place_[i]];
      return k;
    }

    unsigned int GluedCg::solve(const double *b, double *x,
                                const double tolerance)
    {
      const std::size_t n = place_.size();
      r_.assign(b, b + n);
      bool started = false;
      for (std::size_t i = 0; i < n; ++i)
        started = started || x[i] != 0.;
      if (!communicator_.any(started)) {
        const unsigned int k = iterate(x, tolerance);
        for (std::size_t i = 0; i < n; ++i)
          x[i] += coarse_x_[place_[i]];
        return k;
      }
      p_.resize(n + matrix_->ghosts.size());
      q_.resize(n);
      std::copy_n(x, n, p_.begin());
      multiply(*matrix_, exchange_, p_.data(), q_.data());
      for (std::size_t i = 0; i < n; ++i)
        r_[i] -= q_[i];
      std::vector<double> rest(n);
      const unsigned int k = iterate(rest.data(), tolerance);
      for (std::size_t i = 0; i < n; ++i)
        x[i] += rest[i] + coarse_x_[place_[i]];
      return k;
    }
  } // namespace

  std::unique_ptr<SpdSolver>
  make_glued_cg_solver(const Communicator &communicator,
                       const std::vector<std::size_t> &first_dof,
                       const long long largest_factor)
  {
    return std::make_unique<GluedCg>(communicator, first_dof, largest_factor);
  }
} // namespace nsfd
