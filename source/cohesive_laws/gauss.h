#pragma once

namespace nsfd
{
  /** Integral of @p f by the Gauss-Legendre rule with 5 points, degree 9. */
  template <typename Function>
  double integrate(const Function &f, const double lower, const double upper)
  {
    constexpr double x1 = 0.53846931010568309104;
    constexpr double x2 = 0.90617984593866399280;
    constexpr double w0 = 0.56888888888888888889;
    constexpr double w1 = 0.47862867049936646804;
    constexpr double w2 = 0.23692688505618908751;

    const double middle = lower + 0.5 * (upper - lower);
    const double half = 0.5 * (upper - lower);
    const auto at = [&](const double x) { return f(middle + x * half); };
    return half *
           (w0 * at(0.) + w1 * (at(-x1) + at(x1)) + w2 * (at(-x2) + at(x2)));
  }
} // namespace nsfd
