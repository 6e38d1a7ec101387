#include "conforming_solver.h"

#include "linear_algebra/block_kernels.h"
#include "linear_algebra/cholesky.h"
#include "linear_algebra/gmres.h"
#include "linear_algebra/multigrid.h"
#include "linear_algebra/sparse_rows.h"

#include "core/stop_request.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace nsfd
{
  using Vector = std::vector<double>;

  namespace
  {
    /// iterations: where they do not do, a factor or multigrid is cheaper
    constexpr unsigned int most_of_given = 300;

    /** Scalar products over the own unknowns of all ranks, in one exchange. */
    class OwnSums
    {
    public:
      /** @p wide: of short steps, whose iterations are many and need few
          digits. */
      OwnSums(const Communicator &communicator, const std::size_t n,
              const bool wide)
          : communicator_(communicator), n_(n), wide_(wide)
      {
      }

      double operator()(const Vector &a, const Vector &b) const
      {
        return add(of_rank(a, {b.data()}))[0];
      }
      std::array<double, 2> operator()(const Vector &a, const Vector &b,
                                       const Vector &c) const
      {
        const auto both = add(of_rank(b, {a.data(), c.data()}));
        return {both[0], both[1]};
      }
      /** With the first @p n of @p v, and with itself. */
      Vector operator()(const Vector &a, const std::vector<Vector> &v,
                        const unsigned int n) const
      {
        std::vector<const double *> all;
        for (unsigned int j = 0; j < n; ++j)
          all.push_back(v[j].data());
        all.push_back(a.data());
        return add(of_rank(a, all));
      }

    private:
      /** Each of them from its first term to its last, four of them side by
          side: a sum alone waits for its last addition. */
      Vector of_rank(const Vector &a,
                     const std::vector<const double *> &others) const
      {
        Vector sums(others.size(), 0.);
        if (wide_) {
          products_of(a.data(), others.data(), sums.size(), n_, sums.data());
          return sums;
        }
        std::size_t j = 0;
        for (; j + 4 <= sums.size(); j += 4)
          add_products<4>(a, &others[j], &sums[j]);
        for (; j + 2 <= sums.size(); j += 2)
          add_products<2>(a, &others[j], &sums[j]);
        for (; j < sums.size(); ++j)
          add_products<1>(a, &others[j], &sums[j]);
        return sums;
      }

      template <unsigned int n>
      void add_products(const Vector &a, const double *const *others,
                        double *sums) const
      {
        double s[n] = {};
        for (std::size_t i = 0; i < n_; ++i)
          for (unsigned int j = 0; j < n; ++j)
            s[j] += a[i] * others[j][i];
        std::copy_n(s, n, sums);
      }

      Vector add(Vector sums) const
      {
        // the last one: how many ranks are asked to stop
        sums.push_back(stop_request::is_due(communicator_.size()) ? 1. : 0.);
        if (communicator_.size() > 1)
          MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE,
                        MPI_SUM, communicator_.mpi());
        if (sums.back() > 0.)
          throw StopRequested();
        sums.pop_back();
        return sums;
      }

      const Communicator &communicator_;
      const std::size_t n_;
      const bool wide_;
    };

    /**
     * GMRES in the norm of the preconditioner, from x = b; again from what is
     * really left until that is no more than asked for, or does not fall.
     */
    template <typename Product, typename Preconditioner, typename Sums>
    krylov::Outcome
    minimise_residual(const Product &product,
                      const Preconditioner &preconditioner, const Sums &sums,
                      const ConformingSolver::Goal &goal, Vector &x)
    {
      constexpr unsigned int most = 200;
      // each time some digits more than are missing
      constexpr double more = 0.1, shortest = 0.1, least_gain = 0.5;
      const Vector b = x;
      Vector part = b, left(b.size());
      double size = std::sqrt(sums(b, b)), reduction = 1.;
      krylov::Outcome all{0, true};
      std::fill(x.begin(), x.end(), 0.);
      while (size > goal.residual && reduction > goal.tolerance) {
        const double tolerance =
            std::clamp(more * goal.residual / size, goal.tolerance / reduction,
                       std::max(shortest, goal.tolerance / reduction));
        const auto outcome = krylov::gmres_preconditioned(
            product, preconditioner, sums, {tolerance, most - all.iterations},
            part);
        all.iterations += outcome.iterations;
        all.converged = outcome.converged;
        for (std::size_t k = 0; k < x.size(); ++k)
          x[k] += part[k];
        if (!outcome.converged)
          break;
        reduction *= tolerance;
        if (goal.residual == 0.)
          break;
        product(x, left);
        for (std::size_t k = 0; k < x.size(); ++k)
          part[k] = b[k] - left[k];
        const double last = std::exchange(size, std::sqrt(sums(part, part)));
        if (!(size < least_gain * last))
          break;
      }
      return all;
    }
  } // namespace

  ConformingSolver::ConformingSolver(const Communicator &communicator,
                                     const long long largest_factor)
      : communicator_(communicator), largest_factor_(largest_factor)
  {
  }

  ConformingSolver::~ConformingSolver() = default;

  void ConformingSolver::set_space(const CoarseSpace &space)
  {
    space_ = &space;
    new_pattern_ = true;
    const long long first = space.first, end = first + space.n_own;
    std::vector<long long> remote;
    for (const long long k : space.number)
      if (k < first || k >= end)
        remote.push_back(k);
    std::sort(remote.begin(), remote.end());
    remote.erase(std::unique(remote.begin(), remote.end()), remote.end());
    n_own_ = std::size_t(space.n_own);
    exchange_ = GhostValues(communicator_, first, n_own_, remote);
    ties_ = TiedUnknowns(communicator_, space);
    // of this size, not of that of a larger space before
    place_ = std::vector<int>();
    place_.reserve(space.number.size());
    for (const long long k : space.number)
      place_.push_back(
          k >= first && k < end
              ? int(k - first)
              : int(n_own_) +
                    int(std::lower_bound(remote.begin(), remote.end(), k) -
                        remote.begin()));
    b_ = std::vector<double>(n_own_ + remote.size());
    x_ = std::vector<double>(b_.size());
  }

  double ConformingSolver::n_factor_entries() const
  {
    return factor_ ? factor_->n_entries() : given_.entries;
  }

  void ConformingSolver::prepare(const SparseRows &matrix)
  {
    if (!try_to_prepare(matrix))
      throw std::runtime_error(
          "the matrix of the joined bodies has no Cholesky "
          "factor: not positive definite to machine "
          "precision, or too large for the memory");
  }

  bool ConformingSolver::try_to_prepare(const SparseRows &given)
  {
    product_ = nullptr;
    given_ = {};
    is_general_ = false;
    SparseRows folded;
    if (ties_.any())
      folded = ties_.fold(given);
    const SparseRows &matrix = ties_.any() ? folded : given;
    if (space_->n_global <= largest_factor_) {
      if (!factor_)
        factor_ = std::make_unique<Cholesky>(communicator_);
      return factor_->try_factorise(matrix, std::exchange(new_pattern_, false));
    }
    factor_.reset();
    matrix_ = matrix;
    of_matrix_ =
        GhostValues(communicator_, matrix_.first_row, n_own_, matrix_.ghosts);
    if (!multigrid_)
      multigrid_ = std::make_unique<Multigrid>(communicator_);
    multigrid_->set_matrix(matrix_);
    multigrid_->build(space_->modes, space_->per_node);
    return true;
  }

  void ConformingSolver::iterate_with(Product product, Product preconditioner,
                                      const bool general)
  {
    is_general_ = general;
    product_ = nullptr;
    factor_.reset();
    multigrid_.reset();
    matrix_ = SparseRows();
    new_pattern_ = true;
    given_ = {std::move(product), std::move(preconditioner), nullptr, 0.};
  }

  void ConformingSolver::solve_with(Solution factor, const bool general,
                                    const double entries)
  {
    iterate_with(nullptr, nullptr, general);
    given_.factor = std::move(factor);
    given_.entries = entries;
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

  void ConformingSolver::precondition(const Vector &r, Vector &z)
  {
    if (given_.preconditioner)
      given_.preconditioner(r, z);
    else if (given_.factor)
      given_.factor(r.data(), z.data());
    else if (factor_)
      factor_->solve(r.data(), z.data());
    else
      multigrid_->apply(r.data(), z.data());
  }

  krylov::Outcome ConformingSolver::iterate(const Goal &goal)
  {
    const OwnSums sums(communicator_, n_own_, bool(given_.product));
    const auto preconditioner = [&](const Vector &r, Vector &z) {
      precondition(r, z);
    };
    Vector x(n_own_, 0.);
    krylov::Outcome outcome;
    if (product_) {
      constexpr unsigned int most = 100;
      x.assign(b_.begin(), b_.begin() + long(n_own_));
      const auto product = [&](const Vector &p, Vector &q) {
        if (!ties_.any())
          return product_(p, q);
        Vector all = p;
        ties_.follow(all.data());
        product_(all, q);
        ties_.fold(q.data());
      };
      outcome = is_general_
                    ? krylov::gmres(product, preconditioner, sums,
                                    {goal.tolerance, most}, {true, 2}, x)
                    : minimise_residual(product, preconditioner, sums, goal, x);
    } else {
      Vector direction(n_own_ + matrix_.ghosts.size());
      const auto product = [&](const Vector &p, Vector &q) {
        if (given_.product)
          return given_.product(p, q);
        std::copy_n(p.begin(), n_own_, direction.begin());
        multiply(matrix_, of_matrix_, direction.data(), q.data());
      };
      vectors_.r.assign(b_.begin(), b_.begin() + long(n_own_));
      for (Vector *v : {&vectors_.z, &vectors_.p, &vectors_.q})
        v->assign(n_own_, 0.);
      krylov::OneSumCgSystem system(product, preconditioner, sums, vectors_, x);
      const unsigned int limit = given_.product ? most_of_given : 1000;
      outcome = krylov::conjugate_gradients(system, {goal.tolerance, limit});
    }
    std::copy(x.begin(), x.end(), x_.begin());
    return outcome;
  }

  /** From b_ to x_. */
  krylov::Outcome ConformingSolver::solve_here(const Goal &goal)
  {
    krylov::Outcome outcome{0, true};
    if (ties_.any())
      ties_.fold(b_.data());
    if (product_ || !has_factor())
      outcome = iterate(goal);
    else if (given_.factor)
      given_.factor(b_.data(), x_.data());
    else
      factor_->solve(b_.data(), x_.data());
    if (ties_.any())
      ties_.follow(x_.data());
    return outcome;
  }

  krylov::Outcome ConformingSolver::solve(const double *b, double *x,
                                          const Goal &goal)
  {
    restrict_to_space(b, b_.data());
    const auto outcome = solve_here(goal);
    expand(x_.data(), x);
    return outcome;
  }

  krylov::Outcome ConformingSolver::solve_own(const Vector &b, Vector &x,
                                              const Goal &goal)
  {
    std::copy(b.begin(), b.end(), b_.begin());
    const auto outcome = solve_here(goal);
    x.assign(x_.begin(), x_.begin() + long(n_own_));
    return outcome;
  }

  void ConformingSolver::restrict_to_space(const Vector &b, Vector &own)
  {
    own.resize(b_.size());
    restrict_to_space(b.data(), own.data());
    own.resize(n_own_);
  }

  void ConformingSolver::add(const Vector &own, double *x)
  {
    std::copy(own.begin(), own.end(), x_.begin());
    exchange_.fetch(x_.data(), x_.data() + n_own_);
    for (std::size_t i = 0; i < place_.size(); ++i)
      x[i] += x_[place_[i]];
  }

  void ConformingSolver::solve_columns(const double *B, double *X,
                                       const std::size_t rows,
                                       const std::size_t n,
                                       const double tolerance)
  {
    if (!factor_ || product_ || communicator_.size() > 1) {
      for (std::size_t c = 0; c < n; ++c)
        solve(B + c * rows, X + c * rows, tolerance);
      return;
    }
    Vector in(n * n_own_), out(in.size());
    for (std::size_t c = 0; c < n; ++c) {
      restrict_to_space(B + c * rows, &in[c * n_own_]);
      if (ties_.any())
        ties_.fold(&in[c * n_own_]);
    }
    factor_->solve_columns(in.data(), out.data(), n);
    for (std::size_t c = 0; c < n; ++c) {
      if (ties_.any())
        ties_.follow(&out[c * n_own_]);
      expand(&out[c * n_own_], X + c * rows);
    }
  }
} // namespace nsfd
