#include "session.h"

#include <cmath>
#include <utility>

namespace nsfd::stored
{
  namespace
  {
    /** Products of blocks in a factorisation per block of W. */
    template <int d>
    double relative_work(Session<d> &s)
    {
      return s.factors().work() / double(s.problem.column.size());
    }

    /** Sweeps as long as their contraction promises the tolerance for less than
     * Newton steps would cost. */
    template <int d>
    void hopeful_sweeps(Session<d> &s)
    {
      Sweeps<d> sweeps(s);
      double last[3] = {s.error}; // errors of three sweeps before, in turn
      double affordable = 0.;
      for (unsigned int k = 1; !s.solved(); ++k) {
        sweeps.run(1);
        s.judge();
        const double before = std::exchange(last[k % 3], s.error);
        if (k < 3 || s.solved())
          continue;
        // measured: half a dozen Newton steps, each two sweeps and a half for
        // what is linear in the size and one for three products of blocks
        if (affordable == 0.)
          affordable = 5. * (3. + relative_work(s));
        const double rate = std::cbrt(s.error / before);
        const double left = std::log(s.tolerance / s.error) / std::log(rate);
        if (!(rate < 1.) || left > affordable)
          break;
      }
    }

    /** Iterations of ADMM, each a solve and its share of a product with W, for
     * the price of a factorisation. */
    template <int d>
    double iterations_per_factor(Session<d> &s)
    {
      return d * relative_work(s) / 1.3;
    }
  } // namespace

  template <int d>
  bool automatic(Session<d> &s, const unsigned int attempts)
  {
    s.attempt("gauss seidel", [&] { hopeful_sweeps(s); });
    if (s.solved())
      return true;
    // ADMM takes 50 to 150 iterations or very many, Newton's method half a
    // dozen factors or fails, interior points 15 to 35: measured
    if (iterations_per_factor(s) > 50.)
      s.attempt("admm", [&] { admm(s, 150); });
    s.attempt("dual newton", [&] {
      NewtonSettings settings;
      settings.limit = 20;
      settings.largest_growth = 1e4;
      newton(s, settings);
    });
    if (iterations_per_factor(s) > 12.)
      s.attempt("admm", [&] { admm(s, 100); });
    s.attempt("interior point", [&] { interior_point(s, 100); });
    s.attempt("proximal", [&] { proximal(s, 60); });
    s.attempt("admm", [&] { admm(s, 2000); });
    s.attempt("gauss seidel", [&] { gauss_seidel(s, 10000); });
    // in products of blocks, not on a clock: the same answer every time
    constexpr double ten_seconds = 3e9;
    return s.solved() || restarts(s, attempts, ten_seconds);
  }

  template bool automatic<2>(Session<2> &, unsigned int);
  template bool automatic<3>(Session<3> &, unsigned int);
} // namespace nsfd::stored
