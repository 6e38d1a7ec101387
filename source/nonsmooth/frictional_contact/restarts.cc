#include "contact_cone.h"
#include "session.h"

#include "core/dice.h"

#include <cmath>
#include <limits>

namespace nsfd::stored
{
  namespace
  {
    /** Of the velocities in the map of Newton's method, by contact. */
    std::vector<double> weights(const int n, Dice &dice)
    {
      std::vector<double> result(n);
      for (double &weight : result)
        weight = std::pow(10., dice(-1., 1.));
      return result;
    }

    /** Impulses changed by up to @p share of themselves, in the cones. */
    template <int d>
    void shake(Session<d> &s, const double share, Dice &dice)
    {
      for (double &value : s.r)
        value *= 1. + dice(-share, share);
      for (int i = 0; i < s.problem.n; ++i) {
        const auto inside = project_on_cone<d>(&s.r[d * i], s.problem.mu[i]);
        std::copy(inside.begin(), inside.end(), &s.r[d * i]);
      }
      s.judge();
    }

    /** From nothing, by sweeps in a random order. */
    template <int d>
    void start_anew(Session<d> &s, const unsigned int count, Dice &dice)
    {
      std::fill(s.r.begin(), s.r.end(), 0.);
      Sweeps<d> sweeps(s);
      sweeps.set_order(dice.order(s.problem.n));
      sweeps.run(count);
      s.judge();
    }

    template <int d>
    void weighted_newton(Session<d> &s, Dice &dice)
    {
      NewtonSettings settings;
      settings.limit = 60;
      settings.idle = 30;
      settings.weights = weights(s.problem.n, dice);
      newton(s, settings);
    }
  } // namespace

  template <int d>
  bool restarts(Session<d> &s, const unsigned int attempts, const double budget)
  {
    s.restore_best();
    // none of these solves most problems, each has solved some that others did
    // not; one that gets on goes on
    unsigned int kind = 0;
    const double round_off = 4. * std::numeric_limits<double>::epsilon();
    for (unsigned int k = 0; s.attempts < attempts && s.work < budget &&
                             !s.solved() && s.best_error > round_off;
         ++k) {
      Dice dice(k);
      const bool little = k % 2;
      const double before = s.best_error;
      switch (kind) {
      case 0:
        s.restart("dual newton", [&] { weighted_newton(s, dice); });
        break;
      case 1:
        s.restart("dual newton", [&] {
          shake(s, 0.1, dice);
          weighted_newton(s, dice);
        });
        break;
      case 2:
        s.restart("interior point", [&] {
          start_anew(s, little ? 30 : 300, dice);
          interior_point(s, 100);
        });
        break;
      case 3:
        s.restart("dual newton", [&] {
          start_anew(s, 10, dice);
          weighted_newton(s, dice);
        });
        break;
      case 4:
        s.restart("interior point", [&] {
          shake(s, little ? 0.1 : 1., dice);
          interior_point(s, 100);
        });
        break;
      case 5:
        s.restart("proximal", [&] {
          shake(s, 0.1, dice);
          proximal(s, 60, weights(s.problem.n, dice));
        });
        break;
      default:
        s.restart("proximal", [&] { proximal(s, 150); });
      }
      if (!(s.best_error < 0.8 * before))
        kind = (kind + 1) % 7;
    }
    return s.solved();
  }

  template bool restarts<2>(Session<2> &, unsigned int, double);
  template bool restarts<3>(Session<3> &, unsigned int, double);
} // namespace nsfd::stored
