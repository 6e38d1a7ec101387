#include "communicator.h"

#include "sum_kernels.h"

#include "cost.h"
#include "stop_request.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace nsfd
{
  namespace
  {
    /// of the bits of a double that is not negative: the sign
    constexpr unsigned long long stop_bit = 1ull << 63;
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

  double Communicator::dot(const double *a, const double *b,
                           const std::size_t n) const
  {
    const Charge charge(Cost::sums);
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
    const Charge charge(Cost::sums);
    // Bit patterns of non-negative doubles are ordered like the doubles.
    std::vector<unsigned long long> largest(rows);
    for (std::size_t r = 0; r < rows; ++r)
      largest[r] = largest_bits(terms + r * n, n);
    // a request to stop travels along: all ranks see it in the same sum
    if (rows > 0 && stop_request::is_due(size_))
      largest[0] |= stop_bit;
    if (size_ > 1)
      MPI_Allreduce(MPI_IN_PLACE, largest.data(), int(rows),
                    MPI_UNSIGNED_LONG_LONG, MPI_MAX, communicator_);
    if (rows > 0 && (largest[0] & stop_bit) != 0)
      throw StopRequested();
    // The splitting places must not depend on the number of ranks: an upper
    // bound of the number of terms that is the same for all of them.
    const int log_n = 24;
    std::vector<double> parts(2 * rows, 0.), top(rows);
    for (std::size_t r = 0; r < rows; ++r) {
      std::memcpy(&top[r], &largest[r], sizeof(double));
      if (top[r] == 0. || !std::isfinite(top[r]))
        continue;
      const int place = std::ilogb(top[r]) + 2 + log_n;
      split_sums(terms + r * n, n, std::ldexp(1.5, place),
                 std::ldexp(1.5, place - 52 + log_n), &parts[2 * r]);
    }
    if (size_ > 1)
      MPI_Allreduce(MPI_IN_PLACE, parts.data(), int(2 * rows), MPI_DOUBLE,
                    MPI_SUM, communicator_);
    std::vector<double> result(rows);
    for (std::size_t r = 0; r < rows; ++r)
      result[r] = std::isfinite(top[r])
                      ? parts[2 * r] + parts[2 * r + 1]
                      : std::numeric_limits<double>::quiet_NaN();
    return result;
  }

  double Communicator::max(double value) const
  {
    double both[2] = {value, stop_request::is_due(size_) ? 1. : 0.};
    if (size_ > 1)
      MPI_Allreduce(MPI_IN_PLACE, both, 2, MPI_DOUBLE, MPI_MAX, communicator_);
    if (both[1] > 0.)
      throw StopRequested();
    return both[0];
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
