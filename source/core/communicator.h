#pragma once

#include <mpi.h>

#include <cstddef>
#include <vector>

namespace nsfd
{
  /**
   * The ranks of a run, and global sums that do not depend on them.
   *
   * sum() and dot() return the same bits for any distribution of the same
   * terms: every term is split at fixed binary places below the largest one,
   * so that the partial sums are exact (pre-rounded summation, Demmel & Nguyen
   * 2013). What is dropped is below 2^-50 of the number of terms times the
   * largest term.
   */
  class Communicator
  {
  public:
    explicit Communicator(MPI_Comm communicator);

    MPI_Comm mpi() const { return communicator_; }
    int rank() const { return rank_; }
    int size() const { return size_; }
    bool is_root() const { return rank_ == 0; }

    /** Reproducible sum of @p n terms per rank. */
    double sum(const double *terms, std::size_t n) const;
    double sum(const std::vector<double> &terms) const
    {
      return sum(terms.data(), terms.size());
    }

    /** Reproducible scalar product of the first @p n entries. */
    double dot(const double *a, const double *b, std::size_t n) const;

    /**
     * Reproducible sums of several rows of terms at once: @p terms holds
     * @p rows blocks of @p n; one exchange for all of them.
     */
    std::vector<double> sums(const double *terms, std::size_t rows,
                             std::size_t n) const;

    double max(double value) const;
    double min(double value) const;
    bool any(bool value) const;
    unsigned long long sum_integer(unsigned long long value) const;

  private:
    MPI_Comm communicator_;
    int rank_ = 0, size_ = 1;
  };
} // namespace nsfd
