#include "cholesky.h"

#include "dissected_factor.h"
#include "start_cholmod.h"

#include "core/large_pages.h"

#include <omp.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

/**
 * In place of that of libgomp, in the whole process: CHOLMOD opens two regions
 * for every supernode, and a team of one thread ends with a call of the kernel,
 * which for factors of some thousand unknowns takes ten times as long as the
 * factor. Ranks are what shares the cores; a region is what its only thread
 * does.
 */
extern "C" void GOMP_parallel(void (*work)(void *), void *data, unsigned,
                              unsigned)
{
  work(data);
}

namespace nsfd
{
  struct Cholesky::Library {
    cholmod_common common;
    cholmod_factor *factor = nullptr;
    cholmod_dense *work_y = nullptr, *work_e = nullptr, *x = nullptr;

    Library()
    {
      SuiteSparse_config.malloc_func = allocate_large;
      // CHOLMOD asks for four threads of its own whatever the environment
      // says, in other kinds of regions too
      omp_set_max_active_levels(0);
      start_cholmod(common);
    }
    Library(const Library &) = delete;
    ~Library()
    {
      cholmod_free_dense(&work_y, &common);
      cholmod_free_dense(&work_e, &common);
      cholmod_free_dense(&x, &common);
      cholmod_free_factor(&factor, &common);
      cholmod_finish(&common);
    }

    /** Rows of a symmetric matrix are its columns; the upper part is used. */
    static cholmod_sparse view(const SparseRows &matrix)
    {
      cholmod_sparse A{};
      A.nrow = A.ncol = std::size_t(matrix.n_rows());
      A.nzmax = matrix.column.size();
      A.p = const_cast<int *>(matrix.start.data());
      A.i = const_cast<int *>(matrix.column.data());
      A.x = const_cast<double *>(matrix.value.data());
      A.stype = 1;
      A.itype = CHOLMOD_INT;
      A.xtype = CHOLMOD_REAL;
      A.dtype = CHOLMOD_DOUBLE;
      A.sorted = 1;
      A.packed = 1;
      return A;
    }
  };

  Cholesky::Cholesky(const Communicator &communicator)
      : library_(std::make_unique<Library>())
  {
    if (communicator.size() > 1)
      dissected_ = std::make_unique<DissectedFactor>(communicator);
  }

  Cholesky::~Cholesky() = default;

  bool Cholesky::try_factorise(const SparseRows &matrix, const bool new_pattern)
  {
    if (dissected_)
      return dissected_->try_factorise(matrix, new_pattern);
    cholmod_sparse A = Library::view(matrix);
    auto *common = &library_->common;
    if (new_pattern || !library_->factor) {
      cholmod_free_factor(&library_->factor, common);
      library_->factor = cholmod_analyze(&A, common);
    }
    return library_->factor &&
           cholmod_factorize(&A, library_->factor, common) &&
           common->status == CHOLMOD_OK && library_->factor->minor >= A.nrow;
  }

  void Cholesky::factorise(const SparseRows &matrix, const bool new_pattern)
  {
    if (!try_factorise(matrix, new_pattern))
      throw std::runtime_error("the sparse matrix has no Cholesky factor: not "
                               "positive definite to machine precision, or "
                               "too large for the memory");
  }

  void Cholesky::solve(const double *b, double *x)
  {
    if (dissected_) {
      dissected_->solve(b, x);
      return;
    }
    cholmod_dense right{};
    right.nrow = right.nzmax = right.d = library_->factor->n;
    right.ncol = 1;
    right.x = const_cast<double *>(b);
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(CHOLMOD_A, library_->factor, &right, nullptr, &library_->x,
                   nullptr, &library_->work_y, &library_->work_e,
                   &library_->common);
    std::copy_n(static_cast<const double *>(library_->x->x),
                library_->factor->n, x);
  }

  void Cholesky::solve_columns(const double *B, double *X, const std::size_t n)
  {
    const std::size_t rows = library_->factor->n;
    cholmod_dense right{};
    right.nrow = right.d = rows;
    right.ncol = n;
    right.nzmax = rows * n;
    right.x = const_cast<double *>(B);
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    cholmod_dense *solution =
        cholmod_solve(CHOLMOD_A, library_->factor, &right, &library_->common);
    std::copy_n(static_cast<const double *>(solution->x), rows * n, X);
    cholmod_free_dense(&solution, &library_->common);
  }

  double Cholesky::n_entries() const
  {
    if (dissected_)
      return dissected_->n_entries();
    return library_->factor ? double(library_->factor->xsize) : 0.;
  }

  namespace
  {
    class CholeskySolver final : public SpdSolver
    {
    public:
      explicit CholeskySolver(const Communicator &communicator)
          : factor_(communicator)
      {
      }

      void prepare(const SparseRows &matrix, const CoarseSpace &,
                   const bool new_pattern) override
      {
        counters_.analyses += new_pattern || counters_.factorisations == 0;
        ++counters_.factorisations;
        factor_.factorise(matrix, new_pattern);
      }

      unsigned int solve(const double *b, double *x, double) override
      {
        ++counters_.solves;
        factor_.solve(b, x);
        return 0;
      }

      void solve_columns(const double *B, double *X, std::size_t,
                         const std::size_t n, double) override
      {
        counters_.solves += n;
        factor_.solve_columns(B, X, n);
      }

    private:
      Cholesky factor_;
    };
  } // namespace

  std::unique_ptr<SpdSolver>
  make_cholesky_solver(const Communicator &communicator)
  {
    return std::make_unique<CholeskySolver>(communicator);
  }
} // namespace nsfd
