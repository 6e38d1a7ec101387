#include "cholesky.h"

#include "core/large_pages.h"

#include <cholmod.h>
#include <omp.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

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
      // says; ranks are what shares the cores
      omp_set_max_active_levels(0);
      cholmod_start(&common);
      common.supernodal = CHOLMOD_SUPERNODAL;
      common.print = 0;
      common.error_handler = nullptr;
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
      : library_(std::make_unique<Library>()), communicator_(communicator)
  {
  }

  Cholesky::~Cholesky() = default;

  void Cholesky::gather(const SparseRows &matrix)
  {
    const int n_ranks = communicator_.size();
    const bool root = communicator_.is_root();
    const MPI_Comm mpi = communicator_.mpi();
    // row lengths, global columns and values, in the order of the ranks
    const int n = matrix.n_rows(), n_entries = int(matrix.column.size());
    std::vector<int> lengths(n), entries(n_ranks), entry_offsets(n_ranks, 0);
    for (int i = 0; i < n; ++i)
      lengths[i] = matrix.start[i + 1] - matrix.start[i];
    std::vector<int> columns(n_entries);
    for (int k = 0; k < n_entries; ++k)
      columns[k] = matrix.column[k] < n
                       ? int(matrix.first_row) + matrix.column[k]
                       : int(matrix.ghosts[matrix.column[k] - n]);
    counts_.resize(n_ranks);
    offsets_.assign(n_ranks, 0);
    MPI_Gather(&n, 1, MPI_INT, counts_.data(), 1, MPI_INT, 0, mpi);
    MPI_Gather(&n_entries, 1, MPI_INT, entries.data(), 1, MPI_INT, 0, mpi);
    if (root)
      for (int r = 1; r < n_ranks; ++r) {
        offsets_[r] = offsets_[r - 1] + counts_[r - 1];
        entry_offsets[r] = entry_offsets[r - 1] + entries[r - 1];
      }
    const int n_all = root ? offsets_.back() + counts_.back() : 0,
              n_all_entries = root ? entry_offsets.back() + entries.back() : 0;
    std::vector<int> all_lengths(n_all);
    gathered_.column.resize(n_all_entries);
    gathered_.value.resize(n_all_entries);
    MPI_Gatherv(lengths.data(), n, MPI_INT, all_lengths.data(), counts_.data(),
                offsets_.data(), MPI_INT, 0, mpi);
    MPI_Gatherv(columns.data(), n_entries, MPI_INT, gathered_.column.data(),
                entries.data(), entry_offsets.data(), MPI_INT, 0, mpi);
    MPI_Gatherv(matrix.value.data(), n_entries, MPI_DOUBLE,
                gathered_.value.data(), entries.data(), entry_offsets.data(),
                MPI_DOUBLE, 0, mpi);
    gathered_.start.assign(n_all + 1, 0);
    std::vector<std::pair<int, double>> row;
    for (int i = 0; i < n_all; ++i) {
      const int first = gathered_.start[i];
      gathered_.start[i + 1] = first + all_lengths[i];
      row.clear();
      for (int k = first; k < gathered_.start[i + 1]; ++k)
        row.emplace_back(gathered_.column[k], gathered_.value[k]);
      std::sort(row.begin(), row.end());
      for (std::size_t k = 0; k < row.size(); ++k) {
        gathered_.column[first + k] = row[k].first;
        gathered_.value[first + k] = row[k].second;
      }
    }
    b_.resize(n_all);
    x_.resize(n_all);
  }

  bool Cholesky::try_factorise(const SparseRows &matrix, const bool new_pattern)
  {
    const bool alone = communicator_.size() == 1;
    if (!alone)
      gather(matrix);
    bool failed = false;
    if (communicator_.is_root()) {
      cholmod_sparse A = Library::view(alone ? matrix : gathered_);
      auto *common = &library_->common;
      if (new_pattern || !library_->factor) {
        cholmod_free_factor(&library_->factor, common);
        library_->factor = cholmod_analyze(&A, common);
      }
      failed = !library_->factor ||
               !cholmod_factorize(&A, library_->factor, common) ||
               common->status != CHOLMOD_OK || library_->factor->minor < A.nrow;
    }
    return !communicator_.any(failed);
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
    const bool alone = communicator_.size() == 1;
    const MPI_Comm mpi = communicator_.mpi();
    int n = 0;
    if (!alone) {
      MPI_Scatter(counts_.data(), 1, MPI_INT, &n, 1, MPI_INT, 0, mpi);
      MPI_Gatherv(b, n, MPI_DOUBLE, b_.data(), counts_.data(), offsets_.data(),
                  MPI_DOUBLE, 0, mpi);
    }
    if (communicator_.is_root()) {
      cholmod_dense right{};
      right.nrow = right.nzmax = right.d = library_->factor->n;
      right.ncol = 1;
      right.x = const_cast<double *>(alone ? b : b_.data());
      right.xtype = CHOLMOD_REAL;
      right.dtype = CHOLMOD_DOUBLE;
      cholmod_solve2(CHOLMOD_A, library_->factor, &right, nullptr, &library_->x,
                     nullptr, &library_->work_y, &library_->work_e,
                     &library_->common);
      std::copy_n(static_cast<const double *>(library_->x->x),
                  library_->factor->n, alone ? x : x_.data());
    }
    if (!alone)
      MPI_Scatterv(x_.data(), counts_.data(), offsets_.data(), MPI_DOUBLE, x, n,
                   MPI_DOUBLE, 0, mpi);
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
