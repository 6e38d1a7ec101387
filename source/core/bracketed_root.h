#pragma once

namespace nsfd
{
  /**
   * Root of decreasing-at-the-ends @p f in [low, high], f(low) >= 0 >=
   * f(high): regula falsi with the Illinois change, bisection as the guard.
   */
  template <typename Function>
  double bracketed_root(const Function &f, double low, double high,
                        double f_low, double f_high)
  {
    int side = 0;
    for (unsigned int k = 0; k < 200; ++k) {
      if (high - low <= 4e-16 * high || f_low == 0.)
        break;
      double middle = (low * f_high - high * f_low) / (f_high - f_low);
      if (!(middle > low && middle < high) || k % 4 == 3)
        middle = 0.5 * (low + high);
      const double value = f(middle);
      if (value == 0.)
        return middle;
      if (value > 0.) {
        low = middle;
        f_low = value;
        if (side == 1)
          f_high /= 2.;
        side = 1;
      } else {
        high = middle;
        f_high = value;
        if (side == -1)
          f_low /= 2.;
        side = -1;
      }
    }
    return f_low == 0. ? low : 0.5 * (low + high);
  }
} // namespace nsfd
