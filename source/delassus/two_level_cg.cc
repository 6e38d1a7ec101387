#include "body_inverses.h"
#include "linear_algebra/cholesky.h"
#include "linear_algebra/ghost_values.h"
#include "linear_algebra/krylov.h"
#include "linear_algebra/multigrid.h"
#include "linear_algebra/sparse_rows.h"

#include "core/stop_request.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    class TwoLevelCg final : public SpdSolver
    {
    public:
      TwoLevelCg(const Communicator &communicator,
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
      void precondition();
      void multiply_direction();
      using Vector = std::vector<double>;
      double dot(const Vector &a, const Vector &b, const Vector &coarse_a,
                 const Vector &coarse_b) const;
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
      krylov::CgVectors fine_, coarse_;
      Vector coarse_x_;

      /** What krylov::conjugate_gradients() asks for, of both parts. */
      struct Iteration {
        TwoLevelCg &cg;
        double *rest; ///< the solution but for that of the coarse space

        bool is_solved() { return false; }
        double precondition();
        void turn(double beta);
        double multiply();
        void advance(double alpha);
      };
    };

    void TwoLevelCg::prepare(const SparseRows &matrix,
                             const CoarseSpace &coarse, const bool new_pattern)
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

    void TwoLevelCg::prepare_coarse(const SparseRows &matrix,
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

    void TwoLevelCg::build_coarse(const SparseRows &matrix,
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

      // coarse unknowns of other ranks that own nodes are joined to
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
      coarse_.r.resize(std::size_t(n_coarse_) + remote.size());
      coarse_.z.resize(coarse_.r.size());

      if (coarse.n_global <= largest_factor_) {
        multigrid_.reset();
        if (!factor_)
          factor_ = std::make_unique<Cholesky>(communicator_);
        factor_->factorise(coarse_matrix, true);
      } else {
        factor_.reset();
        if (!multigrid_)
          multigrid_ = std::make_unique<Multigrid>(communicator_);
        multigrid_->set_matrix(coarse_matrix);
        multigrid_->build(coarse.modes, coarse.per_node);
      }
    }

    /** z = B r, the part of the bodies and that of the coarse space. */
    void TwoLevelCg::precondition()
    {
      std::fill(coarse_.r.begin(), coarse_.r.end(), 0.);
      for (std::size_t i = 0; i < place_.size(); ++i)
        coarse_.r[place_[i]] += fine_.r[i];
      coarse_exchange_.start_add_back(coarse_.r.data() + n_coarse_);
      bodies_.apply(fine_.r.data(), fine_.z.data());
      coarse_exchange_.finish_add_back(coarse_.r.data());
      if (factor_)
        factor_->solve(coarse_.r.data(), coarse_.z.data());
      else
        multigrid_->apply(coarse_.r.data(), coarse_.z.data());
      coarse_exchange_.fetch(coarse_.z.data(), coarse_.z.data() + n_coarse_);
    }

    /** a.b + coarse_a.coarse_b over own unknowns. */
    double TwoLevelCg::dot(const Vector &a, const Vector &b,
                           const Vector &coarse_a, const Vector &coarse_b) const
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
    void TwoLevelCg::multiply_direction()
    {
      const std::size_t n = place_.size();
      for (std::size_t i = 0; i < n; ++i)
        fine_.z[i] = coarse_.p[place_[i]];
      if (add_product_) {
        multiply(*matrix_, exchange_, fine_.p.data(), fine_.q.data());
        add_product_(fine_.z.data(), fine_.q.data());
      } else {
        for (std::size_t i = 0; i < n; ++i) {
          std::swap(fine_.p[i], fine_.z[i]);
          fine_.p[i] += fine_.z[i];
        }
        multiply(*matrix_, exchange_, fine_.p.data(), fine_.q.data());
        std::copy_n(fine_.z.begin(), n, fine_.p.begin());
      }
      std::fill(coarse_.q.begin(), coarse_.q.end(), 0.);
      for (std::size_t i = 0; i < n; ++i)
        coarse_.q[place_[i]] += fine_.q[i];
      coarse_exchange_.start_add_back(coarse_.q.data() + n_coarse_);
      coarse_exchange_.finish_add_back(coarse_.q.data());
    }

    double TwoLevelCg::Iteration::precondition()
    {
      cg.precondition();
      return cg.dot(cg.fine_.r, cg.fine_.z, cg.coarse_.r, cg.coarse_.z);
    }

    void TwoLevelCg::Iteration::turn(const double beta)
    {
      for (std::size_t i = 0; i < cg.fine_.z.size(); ++i)
        cg.fine_.p[i] = cg.fine_.z[i] + beta * cg.fine_.p[i];
      for (std::size_t i = 0; i < cg.coarse_.z.size(); ++i)
        cg.coarse_.p[i] = cg.coarse_.z[i] + beta * cg.coarse_.p[i];
    }

    double TwoLevelCg::Iteration::multiply()
    {
      cg.multiply_direction();
      return cg.dot(cg.fine_.q, cg.fine_.p, cg.coarse_.q, cg.coarse_.p);
    }

    void TwoLevelCg::Iteration::advance(const double alpha)
    {
      for (std::size_t i = 0; i < cg.fine_.z.size(); ++i) {
        rest[i] += alpha * cg.fine_.p[i];
        cg.fine_.r[i] -= alpha * cg.fine_.q[i];
      }
      for (std::size_t i = 0; i < cg.coarse_.z.size(); ++i)
        cg.coarse_x_[i] += alpha * cg.coarse_.p[i];
    }

    /**
     * From the residual r on; what is found is rest + P coarse_x_. Directions
     * are kept in these two parts as well: springs that vanish on the coarse
     * space are larger than what A is there by more than the digits of a sum.
     */
    unsigned int TwoLevelCg::iterate(double *rest, const double tolerance)
    {
      const std::size_t n = place_.size(), n_coarse = coarse_.z.size();
      ++counters_.solves;
      fine_.z.resize(n);
      fine_.q.resize(n);
      fine_.p.assign(n + matrix_->ghosts.size(), 0.);
      std::fill_n(rest, n, 0.);
      coarse_.q.resize(n_coarse);
      coarse_.p.assign(n_coarse, 0.);
      coarse_x_.assign(n_coarse, 0.);
      Iteration iteration{*this, rest};
      const unsigned int limit = 1000;
      const auto outcome =
          krylov::conjugate_gradients(iteration, {tolerance, limit});
      converged_ = outcome.converged;
      counters_.iterations += outcome.iterations;
      return outcome.iterations;
    }

    unsigned int TwoLevelCg::solve_parts(const double *b,
                                         const std::size_t rows, double *rest,
                                         double *coarse, const double tolerance)
    {
      fine_.r.assign(b, b + rows);
      const unsigned int k = iterate(rest, tolerance);
      for (std::size_t i = 0; i < rows; ++i)
        coarse[i] = coarse_x_[place_[i]];
      return k;
    }

    unsigned int TwoLevelCg::solve(const double *b, double *x,
                                   const double tolerance)
    {
      const std::size_t n = place_.size();
      fine_.r.assign(b, b + n);
      bool started = false;
      for (std::size_t i = 0; i < n; ++i)
        started = started || x[i] != 0.;
      if (!communicator_.any(started)) {
        const unsigned int k = iterate(x, tolerance);
        for (std::size_t i = 0; i < n; ++i)
          x[i] += coarse_x_[place_[i]];
        return k;
      }
      fine_.p.resize(n + matrix_->ghosts.size());
      fine_.q.resize(n);
      std::copy_n(x, n, fine_.p.begin());
      multiply(*matrix_, exchange_, fine_.p.data(), fine_.q.data());
      for (std::size_t i = 0; i < n; ++i)
        fine_.r[i] -= fine_.q[i];
      std::vector<double> rest(n);
      const unsigned int k = iterate(rest.data(), tolerance);
      for (std::size_t i = 0; i < n; ++i)
        x[i] += rest[i] + coarse_x_[place_[i]];
      return k;
    }
  } // namespace

  std::unique_ptr<SpdSolver>
  make_two_level_cg(const Communicator &communicator,
                    const std::vector<std::size_t> &first_dof,
                    const long long largest_factor)
  {
    return std::make_unique<TwoLevelCg>(communicator, first_dof,
                                        largest_factor);
  }
} // namespace nsfd
