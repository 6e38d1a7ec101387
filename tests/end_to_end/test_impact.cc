#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// The benchmarks of doc/impact.md, coarser, against formulas.

namespace end_to_end
{
  namespace
  {
    constexpr double pi = 3.14159265358979323846;

    struct Impact {
      double force = 0., duration = 0.; ///< largest, N or N/m; s
    };

    /**
     * An elastic disc of radius R against a wall at the speed that presses it
     * to a half width a, per thickness in plane strain: see doc/impact.md.
     */
    Impact hertz_disc(const double E, const double nu, const double R,
                      const double a, const double rho, double &speed)
    {
      const double stiffness = E / (1. - nu * nu);
      const auto force = [&](const double half_width) {
        return pi * stiffness * half_width * half_width / (4. * R);
      };
      const auto approach = [&](const double half_width) {
        return half_width > 0. ? force(half_width) / (pi * stiffness) *
                                     (2. * std::log(2. * R / half_width) -
                                      1. / (4. * (1. - nu)))
                               : 0.;
      };
      constexpr unsigned int n = 20000;
      std::vector<double> work = {0.};
      for (unsigned int i = 1; i <= n; ++i) {
        const double a_0 = a * (i - 1) / n, a_1 = a * i / n;
        work.push_back(work.back() + (force(a_0) + force(a_1)) / 2. *
                                         (approach(a_1) - approach(a_0)));
      }
      speed = std::sqrt(2. * work.back() / (pi * R * R * rho));
      Impact impact;
      impact.force = force(a);
      // dt = dW / (P v), v = v_0 cos(phi) with W = W_max sin^2(phi)
      double last = 0.;
      for (unsigned int i = 1; i <= n; ++i) {
        const double phi =
            std::asin(std::min(1., std::sqrt(work[i] / work.back())));
        impact.duration += 4. * work.back() * std::sin((phi + last) / 2.) *
                           (phi - last) / speed / force(a * (i - 0.5) / n);
        last = phi;
      }
      return impact;
    }

    /** Of the rows of a force: the largest mean over a thirtieth of the
        @p duration, and from the first contact to the last one. */
    Impact measured(const std::vector<double> &time,
                    const std::vector<double> &force, const double duration)
    {
      std::vector<double> impulse = {0.};
      for (std::size_t i = 1; i < time.size(); ++i)
        impulse.push_back(impulse.back() +
                          std::abs(force[i]) * (time[i] - time[i - 1]));
      Impact impact;
      double first = -1.;
      for (std::size_t i = 0, k = 0; i < time.size(); ++i) {
        while (time[i] - time[k] > duration / 30.)
          ++k;
        if (k > 0)
          impact.force = std::max(impact.force, (impulse[i] - impulse[k]) /
                                                    (time[i] - time[k]));
        if (force[i] != 0.) {
          if (first < 0.)
            first = time[i];
          impact.duration = time[i] - first;
        }
      }
      return impact;
    }
  } // namespace

  /** Halves of two discs; a sixth of the triangles of the benchmark. */
  TEST(Impact, DiscsAsByHertz)
  {
    const Launch launch{benchmark("hertz_discs"),
                        {with_mesh("hertz_discs_coarse.geo")}};
    const Workspace workspace;
    const Result result = good_run(workspace, "discs", launch);
    ASSERT_TRUE(result.completed()) << result.description();
    double speed = 0.;
    const Impact wanted = hertz_disc(70e9, 0.2, 1e-3, 2e-5, 2500., speed);
    EXPECT_NEAR(speed, 1.56505, 1e-4); // as the scene says
    const History history(
        read_text(result.directory / "observables" / "force.csv"));
    const Impact impact =
        measured(history["time"], history["force_y"], wanted.duration);
    expect_below("largest force",
                 std::abs(2. * impact.force / wanted.force - 1.), 0.02,
                 "demanded");
    expect_below("duration", std::abs(impact.duration / wanted.duration - 1.),
                 0.02, "demanded");
  }
  /**
   * A plug driven out of a plate, by Recht and Ipson with the speed that just
   * drives it out here.
   */
  TEST(Impact, PlugLeavesAsByRechtAndIpson)
  {
    const Workspace workspace;
    const auto speed_after = [&](const double speed) {
      Launch launch{benchmark("plug"), {}};
      launch.set = {"Constants/speed=" + std::to_string(speed) + " m/s"};
      const Result result =
          good_run(workspace, "plug " + std::to_string(speed), launch);
      EXPECT_TRUE(result.completed()) << result.description();
      const auto last = [&](const char *name) {
        return -History(read_text(result.directory / "observables" /
                                  (std::string(name) + ".csv")))["velocity_y"]
                    .back();
      };
      // what holds the plug sends both back
      return std::min(last("plug"), last("projectile"));
    };
    double low = 30., high = 40.;
    while (high - low > 0.5) {
      const double middle = (low + high) / 2.;
      (speed_after(middle) > 0. ? high : low) = middle;
    }
    const double limit = (low + high) / 2., share = 10. / 16.; // of 10 + 6 mm
    for (const double speed : {60., 120.}) {
      const double wanted = share * std::sqrt(speed * speed - limit * limit);
      expect_below("speed after the plate at " + std::to_string(speed),
                   std::abs(speed_after(speed) / wanted - 1.), 0.05,
                   "demanded");
    }
  }

  /** A rigid disc on a beam that breaks: no step of such an impact is taken
      again. */
  TEST(Impact, BallOnBeam)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "ball", {benchmark("ball_on_beam"), {}});
    ASSERT_TRUE(result.completed()) << result.description();
    EXPECT_EQ(result.counter("rejected_steps"), 0.);
  }

  /** A block lands with the overlap of a step and is torn apart while it rests
      there: its new crack faces begin at nodes that know this overlap. */
  TEST(Impact, CrackThatOpensOnAFloor)
  {
    const Workspace workspace;
    const auto file = workspace.path() / "block.prm";
    write_text(file, R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set lower corner = -1 m, 0
  set upper corner = 1 m, 2 m
  set cells        = 2, 1
end
subsection Material: rubber
  set model              = neo-hookean
  set Young modulus      = 1 MPa
  set Poisson ratio      = 0.2
  set density            = 1000
  set initial velocity x = 4 * x
  set initial velocity y = -1 m/s
end
subsection Interface: middle
  set where     = all
  set law       = camacho-ortiz
  set strength  = 20 kPa
  set toughness = 100 J/m^2
end
subsection Obstacle: floor
  set where  = all
  set point  = 0, 0
  set normal = 0, 1
end
subsection Contact: any
end
subsection Time
  set scheme = moreau-jean
  set step   = 2 ms
  set end    = 60 ms
end
)");
    const Result result = good_run(workspace, "block", {file});
    ASSERT_EQ(result.number("fragments"), 2.) << result.description();
    EXPECT_EQ(result.counter("penetration_excess"), 0.);
    expect_below("overlap", result.number("penetration_max"),
                 2e-3 * 1. * (1. + 1e-3), "a step times the approach speed");
  }

  /**
   * A rigid square of side a that is driven along its top side and may turn. At
   * once the side moves with v: J (1/m + y^2/I) = v, V = 0.4 v. Beside the side
   * nothing works on it: in its frame the kinetic energy stays m v^2 (0.6^2 +
   * 1.2^2/6) / 2 = 0.3 m v^2, however far it has turned.
   */
  TEST(Impact, RigidBlockDrivenAlongItsSide)
  {
    const Workspace workspace;
    const auto file = workspace.path() / "square.prm";
    write_text(file, R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set lower corner = 0, 0
  set upper corner = 1 m, 1 m
  set cells        = 3, 2
end
subsection Material: stone
  set model   = rigid
  set bodies  = connected
  set density = 1000
end
subsection Interface: inside
  set where = all
  set law   = rigid
end
subsection Boundary: top
  set velocity x = 2 m/s
end
subsection Time
  set scheme = moreau-jean
  set step   = 10 ms
  set end    = 2 s
end
)");
    const Result result = good_run(workspace, "square", {file});
    const double m = 1000., v = 2., wanted = 0.3 * m * v * v;
    EXPECT_EQ(result.counter("rejected_steps"), 0.);
    // momentum along the side: what moves it does the work v P in a step, half
    // of that in the first one, which begins at rest
    const auto &kinetic = result.history["kinetic"],
               &work = result.history["work"];
    double least = 1., most = 0., first = 0., drift = 0.;
    for (std::size_t k = 1; k < work.size(); ++k) {
      const double speed = (work[k] + work[1]) / (v * m);
      least = std::min(least, speed / v);
      most = std::max(most, speed / v);
      const double energy = kinetic[k] - v * m * speed + 0.5 * m * v * v;
      if (k == 1)
        first = energy;
      drift = std::max(drift, std::abs(energy - first));
    }
    expect_below("energy in the frame of the side",
                 std::abs(first / wanted - 1.), 1.5e-4,
                 "(h spin / 2)^2 of the first step");
    expect_below("its drift", drift / wanted, 1e-9, "theta = 1/2");
    expect_below("speed at once", std::abs(2. * work[1] / (v * v * m) - 0.4),
                 1e-3, "at the middle of a step of 10 ms");
    EXPECT_GT(most - least, 0.5) << "it has swung to and fro";
  }
} // namespace end_to_end
