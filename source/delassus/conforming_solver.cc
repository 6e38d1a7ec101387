#include "conforming_solver.h"

#include "linear_algebra/cholesky.h"
#include "linear_algebra/ghost_values.h"
#include "linear_algebra/krylov.h"
#include "linear_algebra/multigrid.h"
#include "linear_algebra/sparse_rows.h"

#include "core/stop_request.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    using Vector = std::vector<double>;

    class ConformingSolver final : public SpdSolver
    {
    public:
      ConformingSolver(const Communicator &communicator,
                       const long long largest_factor)
          : communicator_(communicator), largest_factor_(largest_factor)
      {
      }

      void prepare(const SparseRows &matrix, const CoarseSpace &space,
                   bool new_pattern) override;
      unsigned int solve(const double *b, double *x, double tolerance) override;
      void solve_columns(const double *B, double *X, std::size_t rows,
                         std::size_t n, double tolerance) override;

    private:
      void set_places(const CoarseSpace &space);
      void restrict_to_space(const double *b, double *own);
      void expand(double *own, double *x);
      unsigned int iterate(double tolerance);

      const Communicator &communicator_;
      const long long largest_factor_;
      GhostValues of_matrix_; ///< of the ghosts of A
      unsigned long long version_ = 0;
      /// per unknown of A: place among own ones of the space, then its ghosts
      std::vector<int> place_;
      std::size_t n_own_ = 0;
      GhostValues exchange_; ///< of the space
      std::unique_ptr<Cholesky> factor_;
      std::unique_ptr<Multigrid> multigrid_;
      SparseRows reduced_; ///< P^T A P, for iterations
      GhostValues of_reduced_;
      krylov::CgVectors vectors_;
      Vector b_, x_; ///< own, with room for ghosts
    };

    void ConformingSolver::set_places(const CoarseSpace &space)
    {
      const long long first = space.first, end = first + space.n_own;
      std::vector<long long> remote;
      for (const long long k : space.number)
        if (k < first || k >= end)
          remote.push_back(k);
      std::sort(remote.begin(), remote.end());
      remote.erase(std::unique(remote.begin(), remote.end()), remote.end());
      n_own_ = std::size_t(space.n_own);
      exchange_ = GhostValues(communicator_, first, n_own_, remote);
      place_.clear();
      for (const long long k : space.number)
        place_.push_back(
            k >= first && k < end
                ? int(k - first)
                : int(n_own_) +
                      int(std::lower_bound(remote.begin(), remote.end(), k) -
                          remote.begin()));
      b_.resize(n_own_ + remote.size());
      x_.resize(b_.size());
    }

    void ConformingSolver::prepare(const SparseRows &matrix,
                                   const CoarseSpace &space,
                                   const bool new_pattern)
    {
      const auto n = std::size_t(matrix.n_rows());
      if (new_pattern)
        of_matrix_ =
            GhostValues(communicator_, matrix.first_row, n, matrix.ghosts);
      const bool new_space = version_ != space.version;
      version_ = space.version;
      if (new_space) {
        set_places(space);
        ++counters_.coarse_spaces;
      }
      Vector own(space.number.begin(), space.number.end()),
          ghosts(matrix.ghosts.size());
      of_matrix_.fetch(own.data(), ghosts.data());
      SparseRows reduced =
          coarse_rows(communicator_, matrix, space,
                      std::vector<long long>(ghosts.begin(), ghosts.end()));
      ++counters_.factorisations;
      if (space.n_global <= largest_factor_) {
        if (!factor_)
          factor_ = std::make_unique<Cholesky>(communicator_);
        counters_.analyses += new_space;
        factor_->factorise(reduced, new_space);
        return;
      }
      reduced_ = std::move(reduced);
      of_reduced_ = GhostValues(communicator_, reduced_.first_row, n_own_,
                                reduced_.ghosts);
      if (!multigrid_)
        multigrid_ = std::make_unique<Multigrid>(communicator_);
      multigrid_->prepare(reduced_, space.modes, space.per_node);
    }

    /** P^T b. */
    void ConformingSolver::restrict_to_space(const double *b, double *own)
    {
      std::fill(own, own + b_.size(), 0.);
      for (std::size_t i = 0; i < place_.size(); ++i)
        own[place_[i]] += b[i];
      exchange_.start_add_back(own + n_own_);
      exchange_.finish_add_back(own);
    }

    /** x = P own. */
    void ConformingSolver::expand(double *own, double *x)
    {
      exchange_.fetch(own, own + n_own_);
      for (std::size_t i = 0; i < place_.size(); ++i)
        x[i] = own[place_[i]];
    }

    unsigned int ConformingSolver::iterate(const double tolerance)
    {
      const auto dot = [this](const Vector &a, const Vector &b) {
        // the second one: how many ranks are asked to stop
        double sums[2] = {0.,
                          stop_request::is_due(communicator_.size()) ? 1. : 0.};
        for (std::size_t i = 0; i < n_own_; ++i)
          sums[0] += a[i] * b[i];
        if (communicator_.size() > 1)
          MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM,
                        communicator_.mpi());
        if (sums[1] > 0.)
          throw StopRequested();
        return sums[0];
      };
      Vector direction(n_own_ + reduced_.ghosts.size());
      const auto product = [&](const Vector &p, Vector &q) {
        std::copy_n(p.begin(), n_own_, direction.begin());
        multiply(reduced_, of_reduced_, direction.data(), q.data());
      };
      const auto preconditioner = [&](const Vector &r, Vector &z) {
        multigrid_->apply(r.data(), z.data());
      };
      const auto never = [] { return false; };
      vectors_.r.assign(b_.begin(), b_.begin() + long(n_own_));
      for (Vector *v : {&vectors_.z, &vectors_.p, &vectors_.q})
        v->assign(n_own_, 0.);
      Vector x(n_own_, 0.);
      krylov::CgSystem system(product, preconditioner, dot, never, vectors_, x);
      const unsigned int limit = 1000;
      const auto outcome =
          krylov::conjugate_gradients(system, {tolerance, limit});
      std::copy(x.begin(), x.end(), x_.begin());
      converged_ = outcome.converged;
      counters_.iterations += outcome.iterations;
      return outcome.iterations;
    }

    unsigned int ConformingSolver::solve(const double *b, double *x,
                                         const double tolerance)
    {
      ++counters_.solves;
      restrict_to_space(b, b_.data());
      unsigned int iterations = 0;
      if (factor_)
        factor_->solve(b_.data(), x_.data());
      else
        iterations = iterate(tolerance);
      expand(x_.data(), x);
      return iterations;
    }

    void ConformingSolver::solve_columns(const double *B, double *X,
                                         const std::size_t rows,
                                         const std::size_t n,
                                         const double tolerance)
    {
      if (!factor_ || communicator_.size() > 1) {
        SpdSolver::solve_columns(B, X, rows, n, tolerance);
        return;
      }
      counters_.solves += n;
      Vector in(n * n_own_), out(in.size());
      for (std::size_t c = 0; c < n; ++c)
        restrict_to_space(B + c * rows, &in[c * n_own_]);
      factor_->solve_columns(in.data(), out.data(), n);
      for (std::size_t c = 0; c < n; ++c)
        expand(&out[c * n_own_], X + c * rows);
    }
  } // namespace

  std::unique_ptr<SpdSolver>
  make_conforming_solver(const Communicator &communicator,
                         const long long largest_factor)
  {
    return std::make_unique<ConformingSolver>(communicator, largest_factor);
  }
} // namespace nsfd
