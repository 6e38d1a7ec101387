#include "nsfd/base/communicator.h"

#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    double largest(const double *x, const std::size_t n)
    {
      double result = 0.;
      for (std::size_t i = 0; i < n; ++i)
        result = std::max(result, std::abs(x[i]));
      // max() drops NaN; a sum of zero terms times x keeps it
      double probe = 0.;
      for (std::size_t i = 0; i < n; ++i)
        probe += x[i] * 0.;
      return probe == 0. ? result : std::numeric_limits<double>::infinity();
    }

    /**
     * Add the part of each term above the ulp of @p boundary; leave the rest
     * in @p x. The additions are exact, so their order does not matter.
     */
    double extract(const double boundary, double *x, const std::size_t n)
    {
      double lanes[8] = {};
      std::size_t i = 0;
      for (; i + 8 <= n; i += 8)
        for (unsigned int l = 0; l < 8; ++l) {
          const double high = (x[i + l] + boundary) - boundary;
          lanes[l] += high;
          x[i + l] -= high;
        }
      double result = 0.;
      for (; i < n; ++i) {
        const double high = (x[i] + boundary) - boundary;
        result += high;
        x[i] -= high;
      }
      for (const double lane : lanes)
        result += lane;
      return result;
    }
  } // namespace

  Communicator::Communicator(const MPI_Comm communicator)
    : communicator_(communicator)
  {
    MPI_Comm_rank(communicator, &rank_);
    MPI_Comm_size(communicator, &size_);
  }

  double Communicator::sum(const double *terms, const std::size_t n) const
  {
    return sums(terms, 1, n)[0];
  }

  double Communicator::dot(const double *a,
                           const double *b,
                           const std::size_t n) const
  {
    static thread_local std::vector<double> products;
    products.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      products[i] = a[i] * b[i];
    return sums(products.data(), 1, n)[0];
  }

  std::vector<double> Communicator::sums(const double *terms,
                                         const std::size_t rows,
                                         const std::size_t n) const
  {
    scratch_.assign(terms, terms + rows * n);
    // largest terms and the number of terms, in one exchange
    std::vector<double> largest_term(rows + 1);
    for (std::size_t r = 0; r < rows; ++r)
      largest_term[r] = largest(scratch_.data() + r * n, n);
    largest_term[rows] = static_cast<double>(n) * size_;
    if (size_ > 1)
      MPI_Allreduce(MPI_IN_PLACE, largest_term.data(), int(rows + 1),
                    MPI_DOUBLE, MPI_MAX, communicator_);
    // The splitting places must not depend on the number of ranks: use an
    // upper bound of the number of terms that is the same for all of them.
    const int log_n = 24;
    std::vector<double> parts(2 * rows, 0.);
    for (std::size_t r = 0; r < rows; ++r) {
      if (largest_term[r] == 0. || !std::isfinite(largest_term[r]))
        continue;
      const int top = std::ilogb(largest_term[r]) + 2 + log_n;
      double *x = scratch_.data() + r * n;
      parts[2 * r] = extract(std::ldexp(1.5, top), x, n);
      parts[2 * r + 1] = extract(std::ldexp(1.5, top - 52 + log_n), x, n);
    }
    if (size_ > 1)
      MPI_Allreduce(MPI_IN_PLACE, parts.data(), int(2 * rows), MPI_DOUBLE,
                    MPI_SUM, communicator_);
    std::vector<double> result(rows);
    for (std::size_t r = 0; r < rows; ++r)
      result[r] = std::isfinite(largest_term[r])
                    ? parts[2 * r] + parts[2 * r + 1]
                    : std::numeric_limits<double>::quiet_NaN();
    return result;
  }

  double Communicator::max(double value) const
  {
    if (size_ > 1)
      MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX,
                    communicator_);
    return value;
  }

  double Communicator::min(const double value) const { return -max(-value); }

  bool Communicator::any(const bool value) const
  {
    return max(value ? 1. : 0.) > 0.;
  }

  unsigned long long Communicator::sum_integer(unsigned long long value) const
  {
    if (size_ > 1)
      MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM,
                    communicator_);
    return value;
  }
} // namespace nsfd
