#include "body_inverses.h"
#include "cholesky.h"
#include "ghost_values.h"
#include "multigrid.h"
#include "sparse_rows.h"

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
        : communicator_(communicator)
        , largest_factor_(largest_factor)
        , bodies_(first_dof)
      {}

      void prepare(const SparseRows &matrix,
                   const CoarseSpace &coarse,
                   bool new_pattern) override;
      unsigned int
      solve(const double *b, double *x, double tolerance) override;

    private:
      void prepare_coarse(const CoarseSpace &coarse);
      void precondition(const double *r, double *z);

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
      std::vector<double> r_, z_, p_, q_, coarse_r_, coarse_z_;
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
      if (version_ != coarse.version) {
        prepare_coarse(coarse);
        version_ = coarse.version;
      }
    }

    void GluedCg::prepare_coarse(const CoarseSpace &coarse)
    {
      const std::size_t n = std::size_t(matrix_->n_rows());
      std::vector<double> own(n), ghosts(matrix_->ghosts.size());
      for (std::size_t i = 0; i < n; ++i)
        own[i] = double(coarse.number[i]);
      exchange_.fetch(own.data(), ghosts.data());
      const std::vector<long long> numbers(ghosts.begin(), ghosts.end());
      const SparseRows coarse_matrix =
        coarse_rows(communicator_, *matrix_, coarse, numbers);
      ++counters_.coarse_spaces;

      // coarse unknowns of other ranks that own nodes are glued to
      std::vector<long long> remote;
      const long long first = coarse.first, end = first + coarse.n_own;
      for (const long long k : coarse.number)
        if (k < first || k >= end)
          remote.push_back(k);
      std::sort(remote.begin(), remote.end());
      remote.erase(std::unique(remote.begin(), remote.end()), remote.end());
      coarse_exchange_ = GhostValues(communicator_, first,
                                     std::size_t(coarse.n_own), remote);
      n_coarse_ = coarse.n_own;
      place_.resize(n);
      for (std::size_t i = 0; i < n; ++i) {
        const long long k = coarse.number[i];
        place_[i] =
          k >= first && k < end
            ? int(k - first)
            : int(n_coarse_ +
                  (std::lower_bound(remote.begin(), remote.end(), k) -
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

    void GluedCg::precondition(const double *r, double *z)
    {
      const std::size_t n = place_.size();
      bodies_.apply(r, z);
      std::fill(coarse_r_.begin(), coarse_r_.end(), 0.);
      for (std::size_t i = 0; i < n; ++i)
        coarse_r_[place_[i]] += r[i];
      coarse_exchange_.add_back(coarse_r_.data() + n_coarse_, coarse_r_.data());
      if (factor_)
        factor_->solve(coarse_r_.data(), coarse_z_.data());
      else
        multigrid_->apply(coarse_r_.data(), coarse_z_.data());
      coarse_exchange_.fetch(coarse_z_.data(), coarse_z_.data() + n_coarse_);
      for (std::size_t i = 0; i < n; ++i)
        z[i] += coarse_z_[place_[i]];
    }

    unsigned int GluedCg::solve(const double *b, double *x,
                                const double tolerance)
    {
      const std::size_t n = std::size_t(matrix_->n_rows());
      const auto dot = [&](const std::vector<double> &a,
                           const std::vector<double> &c) {
        double sum = 0.;
        for (std::size_t i = 0; i < n; ++i)
          sum += a[i] * c[i];
        if (communicator_.size() > 1)
          MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM,
                        communicator_.mpi());
        return sum;
      };
      ++counters_.solves;
      r_.assign(b, b + n);
      z_.resize(n);
      q_.resize(n);
      p_.resize(n + matrix_->ghosts.size());
      bool started = false;
      for (std::size_t i = 0; i < n; ++i)
        started = started || x[i] != 0.;
      if (communicator_.any(started)) {
        std::copy_n(x, n, p_.begin());
        multiply(*matrix_, exchange_, p_.data(), q_.data());
        for (std::size_t i = 0; i < n; ++i)
          r_[i] -= q_[i];
      }
      precondition(r_.data(), z_.data());
      double rz = dot(r_, z_);
      const double target = tolerance * tolerance * rz;
      std::copy(z_.begin(), z_.end(), p_.begin());
      // a sum that is not above round-off any more ends it as well
      const unsigned int limit = 1000;
      unsigned int k = 0;
      for (; k < limit && rz > target; ++k) {
        multiply(*matrix_, exchange_, p_.data(), q_.data());
        const double pAp = dot(p_, q_);
        if (!(pAp > 0.))
          break;
        const double alpha = rz / pAp;
        for (std::size_t i = 0; i < n; ++i) {
          x[i] += alpha * p_[i];
          r_[i] -= alpha * q_[i];
        }
        precondition(r_.data(), z_.data());
        const double next = dot(r_, z_), beta = next / rz;
        rz = next;
        for (std::size_t i = 0; i < n; ++i)
          p_[i] = z_[i] + beta * p_[i];
      }
      converged_ = rz <= target;
      counters_.iterations += k;
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
