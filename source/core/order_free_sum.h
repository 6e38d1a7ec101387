#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace nsfd
{
  /**
   * A sum whose bits depend neither on the order of its terms nor on how they
   * are shared out over partial sums: every term is written in digits of
   * base 2^30, and the digits at the three places below the largest term are
   * added as integers. What is dropped is below 2^-60 of the largest term, for
   * each term. For many small sums at once, as over the pieces of a body;
   * Communicator::sums() is the faster one for few long ones.
   */
  class OrderFreeSum
  {
  public:
    void add(const double term)
    {
      if (term == 0.)
        return;
      if (!std::isfinite(term)) {
        finite_ = false;
        return;
      }
      const int exponent = std::ilogb(term);
      // rounded down, also below 1
      const int place = (exponent - (exponent < 0 ? width - 1 : 0)) / width;
      raise(place);
      double rest = std::ldexp(term, -width * place);
      for (int k = top_ - place; k < n_places; ++k) {
        const auto digit = std::int64_t(rest);
        digits_[k] += digit;
        rest = (rest - double(digit)) * base;
      }
    }

    void add(const OrderFreeSum &other)
    {
      finite_ = finite_ && other.finite_;
      if (other.top_ == none)
        return;
      raise(other.top_);
      for (int k = top_ - other.top_; k < n_places; ++k)
        digits_[k] += other.digits_[k - (top_ - other.top_)];
    }

    double value() const
    {
      if (!finite_)
        return std::numeric_limits<double>::quiet_NaN();
      double sum = 0.;
      for (int k = n_places; k-- > 0;)
        if (digits_[k] != 0)
          sum += std::ldexp(double(digits_[k]), width * (top_ - k));
      return sum;
    }

  private:
    static constexpr int width = 30, n_places = 3,
                         none = std::numeric_limits<int>::min();
    static constexpr double base = 1 << width;

    /** The largest place is at least @p place. */
    void raise(const int place)
    {
      if (top_ == none)
        top_ = place;
      if (place <= top_)
        return;
      const int shift = place - top_;
      for (int k = n_places; k-- > 0;)
        digits_[k] = k >= shift ? digits_[k - shift] : 0;
      top_ = place;
    }

    int top_ = none;
    bool finite_ = true;
    std::array<std::int64_t, n_places> digits_{};
  };
} // namespace nsfd
