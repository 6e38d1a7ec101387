#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// Bodies that deform, meet and slide: benchmarks of doc/impact.md.

namespace end_to_end::test_elastic_impact
{
  namespace
  {
    constexpr double pi = 3.14159265358979323846;

    const std::vector<std::string> implicit_bars = {"Time/scheme=moreau-jean",
                                                    "Time/step=2 us"},
                                   implicit_slope = {"Time/scheme=moreau-jean",
                                                     "Time/step=5 ms"};

    History observable(const Result &result, const std::string &name)
    {
      return History(
          read_text(result.directory / "observables" / (name + ".csv")));
    }

    /** What a force has given, from its mean over every step. */
    double impulse(const History &rows, const std::string &column)
    {
      const auto &time = rows["time"], &force = rows[column];
      double sum = 0.;
      for (std::size_t i = 1; i < time.size(); ++i)
        sum += force[i] * (time[i] - time[i - 1]);
      return sum;
    }

    /** Equal bars: pressed by rho c v/2 for 2 L/c, then the second one has the
        speed of the first. */
    void expect_exchange(const std::vector<std::string> &set)
    {
      const double rho = 7800., c = std::sqrt(200e9 / rho), L = 1., A = 0.02;
      const Workspace workspace;
      const Result result =
          good_run(workspace, "bars", {benchmark("bars"), set});
      ASSERT_TRUE(result.completed()) << result.description();
      const History rows = observable(result, "force");
      const double given = impulse(rows, "force_x");
      expect_below("speed that goes over", std::abs(given / (rho * L * A) - 1.),
                   0.01, "demanded");
      const auto &time = rows["time"], &force = rows["force_x"];
      double first = -1., last = 0.;
      for (std::size_t i = 1; i < time.size(); ++i)
        if (force[i] != 0.) {
          first = first < 0. ? time[i - 1] : first;
          last = time[i];
        }
      expect_below("duration", std::abs((last - first) / (2. * L / c) - 1.),
                   0.02, "demanded");
      expect_below("force",
                   std::abs(given / (last - first) / (rho * c * A / 2.) - 1.),
                   0.02, "demanded");
    }

    /** Along the slope in a second, over what gravity does without friction. */
    double way_down(const double friction, const std::vector<std::string> &set)
    {
      const Workspace workspace;
      Launch launch{benchmark("slope"), set};
      launch.set.push_back("Constants/mu=" + std::to_string(friction));
      const Result result = good_run(workspace, "slope", launch);
      EXPECT_TRUE(result.completed()) << result.description();
      return observable(result, "back")["displacement_x"].back() /
             (0.5 * 9.81 * std::sin(pi / 18.));
    }

    void expect_slope(const std::vector<std::string> &set)
    {
      const double slope = std::tan(pi / 18.);
      for (const double share : {0.1 / slope, 0.99})
        expect_below("way with mu = " + std::to_string(share) + " tan a",
                     std::abs(way_down(share * slope, set) - (1. - share)),
                     0.01, "demanded");
      expect_below("way with mu = 1.01 tan a",
                   std::abs(way_down(1.01 * slope, set)), 1e-3,
                   "sticks: what waves of the start do");
    }

    /** Discs in a row, as point masses with quasi-static contact. */
    class Discs
    {
    public:
      Discs(const double E, const double nu, const double R, const double rho)
          : radius_(R), compliance_((1. - nu * nu) / (pi * E)),
            free_rim_(1. / (4. * (1. - nu))), mass_(pi * R * R * rho)
      {
      }

      double mass() const { return mass_; }

      /** Velocities over that of the first of three, and the largest forces. */
      void meet(const double speed, double (&v)[3], double (&force)[2]) const
      {
        double x[3] = {}, P[2] = {};
        v[0] = speed;
        v[1] = v[2] = force[0] = force[1] = 0.;
        constexpr double dt = 2e-9;
        for (unsigned int n = 0; n < 4000; ++n) {
          // each presses the disc between them, which the other one feels
          for (unsigned int sweep = 0; sweep < 20; ++sweep)
            for (unsigned int k = 0; k < 2; ++k)
              P[k] = force_of((x[k] - x[k + 1] - across() * P[1 - k]) / 2.);
          v[0] -= dt * P[0] / mass_;
          v[1] += dt * (P[0] - P[1]) / mass_;
          v[2] += dt * P[1] / mass_;
          for (unsigned int k = 0; k < 3; ++k)
            x[k] += dt * v[k];
          for (unsigned int k = 0; k < 2; ++k)
            force[k] = std::max(force[k], P[k]);
        }
        for (double &velocity : v)
          velocity /= speed;
      }

    private:
      double radius_, compliance_, free_rim_, mass_;

      /** Approach of the centre of mass to a contact by its force. */
      double approach(const double P) const
      {
        const double a = 2. * std::sqrt(P * radius_ * compliance_);
        return P * compliance_ * (2. * std::log(2. * radius_ / a) - free_rim_);
      }
      /** The same by the force on the other side, per force. */
      double across() const
      {
        return compliance_ * (2. * std::log(2.) - 1. + free_rim_);
      }
      double force_of(const double way) const
      {
        double low = 0., high = 1e5;
        for (unsigned int n = 0; way > 0. && n < 50; ++n) {
          const double P = (low + high) / 2.;
          (approach(P) < way ? low : high) = P;
        }
        return low;
      }
    };

    /** Largest mean over @p span. */
    double largest_force(const History &rows, const std::string &column,
                         const double span)
    {
      const auto &time = rows["time"], &force = rows[column];
      double largest = 0., sum = 0.;
      for (std::size_t i = 1, k = 1; i < time.size(); ++i) {
        sum += force[i] * (time[i] - time[i - 1]);
        for (; time[i] - time[k] > span; ++k)
          sum -= force[k] * (time[k] - time[k - 1]);
        largest = std::max(largest, std::abs(sum) / span);
      }
      return largest;
    }
  } // namespace

  TEST(ElasticImpact, BarsExchangeTheirVelocities) { expect_exchange({}); }

  TEST(ElasticImpact, BarsInImplicitSteps) { expect_exchange(implicit_bars); }

  TEST(ElasticImpact, BlockOnASlope) { expect_slope({}); }

  TEST(ElasticImpact, BlockOnASlopeInImplicitSteps)
  {
    expect_slope(implicit_slope);
  }

  /** Newton's cradle of three discs that touch; cells larger than those of the
      benchmark. */
  TEST(ElasticImpact, CradleOfDiscs)
  {
    const Launch launch{benchmark("elastic_cradle"),
                        {with_mesh("cradle_coarse.geo")}};
    const Workspace workspace;
    const Result result = good_run(workspace, "cradle", launch);
    ASSERT_TRUE(result.completed()) << result.description();
    const double speed = 3.1301;
    const Discs discs(70e9, 0.2, 1e-3, 2500.);
    double v[3], force[2];
    discs.meet(speed, v, force);
    // of half a disc of this mesh
    const double mass = 2. * result.history["kinetic"][0] / (speed * speed);
    double gone[2];
    const std::string names[] = {"first", "second"};
    for (unsigned int k = 0; k < 2; ++k) {
      const History rows = observable(result, names[k]);
      gone[k] = std::abs(impulse(rows, "force_y")) / (mass * speed);
      expect_below(
          "largest force, " + names[k],
          std::abs(2. * largest_force(rows, "force_y", 58e-9) / force[k] - 1.),
          0.02, "demanded");
    }
    const double found[] = {1. - gone[0], gone[0] - gone[1], gone[1]};
    for (unsigned int k = 0; k < 3; ++k)
      expect_below("velocity of disc " + std::to_string(k + 1),
                   std::abs(found[k] - v[k]), 0.02, "demanded");
  }

  /** The trapezoidal error of explicit large motions has no trend and falls
      with the square of the step, with impacts and without. */
  TEST(ElasticImpact, EnergyOfABouncingBlockHasNoTrend)
  {
    const auto errors = [](const char *gravity, const char *step) {
      const Workspace workspace;
      const Result result =
          good_run(workspace, "block",
                   {benchmark("bouncing_block"),
                    {std::string("Loads/gravity=") + gravity,
                     std::string("Constants/h=") + step, "Time/end=0.6 s"}});
      EXPECT_TRUE(result.completed()) << result.description();
      std::vector<double> numerical = result.history["numerical"];
      const double energy = result.history.largest_energy();
      for (double &value : numerical)
        value /= energy;
      return numerical;
    };
    const auto largest = [](const std::vector<double> &values) {
      double size = 0.;
      for (const double value : values)
        size = std::max(size, std::abs(value));
      return size;
    };
    for (const char *const gravity : {"0, 0", "0, -9.81 m/s^2"}) {
      const auto coarse = errors(gravity, "80 us"),
                 fine = errors(gravity, "40 us");
      EXPECT_GT(largest(coarse) / largest(fine), 3.) << gravity;
      if (gravity[3] != '0')
        continue;
      double first = 0., second = 0.;
      const std::size_t n = fine.size();
      for (std::size_t i = 0; i < n; ++i)
        (i < n / 2 ? first : second) += fine[i] / (double(n) / 2.);
      expect_below("drift between both halves over the largest",
                   std::abs(second - first) / largest(fine), 0.1,
                   "the mean of what has no trend");
    }
  }
} // namespace end_to_end::test_elastic_impact
