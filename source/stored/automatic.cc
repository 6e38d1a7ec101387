#include "session.h"

#include <cmath>

namespace nsfd::stored
{
  namespace
  {
    /** Sweeps as long as their contraction promises the tolerance soon. */
    template <int d>
    void hopeful_sweeps(Session<d> &s)
    {
      Sweeps<d> sweeps(s);
      double last = s.error;
      for (unsigned int k = 1; !s.solved(); ++k) {
        sweeps.run(1);
        s.judge();
        const double rate = s.error / last;
        last = s.error;
        if (k < 3)
          continue;
        const double left =
            rate < 1. ? std::log(s.tolerance / s.error) / std::log(rate) : 1e9;
        // a Newton step costs a few sweeps, and some are needed
        if (k >= 10 ? left > 20. : left > 40.)
          break;
      }
    }
  } // namespace

  template <int d>
  bool automatic(Session<d> &s)
  {
    s.attempt("gauss seidel", [&] { hopeful_sweeps(s); });
    const double work = s.factors().work() / double(s.problem.column.size());
    if (work > 20.)
      s.attempt("admm", [&] { admm(s, 150); });
    s.attempt("dual newton", [&] {
      NewtonSettings settings;
      settings.limit = 20;
      newton(s, settings);
    });
    s.attempt("interior point", [&] { interior_point(s, 100); });
    s.attempt("proximal", [&] { proximal(s, 60); });
    s.attempt("admm", [&] { admm(s, 2000); });
    s.attempt("gauss seidel", [&] { gauss_seidel(s, 10000); });
    return s.solved();
  }

  template bool automatic<2>(Session<2> &);
  template bool automatic<3>(Session<3> &);
} // namespace nsfd::stored
