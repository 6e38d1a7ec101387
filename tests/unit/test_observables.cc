#include "make_scene.h"
#include "postprocess/run_view.h"

#include "discretization/cells.h"
#include "nsfd/postprocess/running_crack.h"
#include "postprocess/table_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

// Universal functions of running cracks, the energy release rate of known
// fields, and what blocks `Observable` refuse.

using namespace nsfd;
using nsfd::test::Scene;

namespace test_observables
{
  const double pi = std::acos(-1.);

  TEST(RunningCrack, UniversalFunctions)
  {
    const RunningCrack crack(1., 0.25, 1.);
    const double c_R = crack.rayleigh_speed();
    EXPECT_NEAR(c_R / crack.shear_speed(), 0.9194017, 5e-8);
    EXPECT_NEAR(crack.pressure_speed() / crack.shear_speed(), std::sqrt(3.),
                1e-14);
    const std::vector<std::array<double, 2>> known = {{{0.2, 1.0262915}},
                                                      {{0.4, 1.1183660}},
                                                      {{0.6, 1.3390990}},
                                                      {{0.8, 2.0105398}},
                                                      {{0.9, 3.2982004}}};
    for (const auto &[v, A] : known)
      EXPECT_NEAR(crack.opening_function(v * c_R), A, 6e-8) << v;
    // both are 1 at rest, with a smooth passage to what is computed from D
    EXPECT_EQ(crack.opening_function(0.), 1.);
    EXPECT_NEAR(crack.opening_function(1e-3 * c_R), 1., 1e-6);
    EXPECT_NEAR(crack.sliding_function(1e-3 * c_R), 1., 1e-6);
    EXPECT_TRUE(std::isnan(crack.opening_function(c_R)));
    // 2 gamma = (1 - nu) A_I H^2/(pi mu) with K = H sqrt(2/pi)
    const double mu = 1. / 2.5, v = 0.4 * c_R, H = 3.,
                 G = 0.75 * crack.opening_function(v) * H * H / (pi * mu);
    EXPECT_NEAR(crack.opening_intensity(G, v), H * std::sqrt(2. / pi), 1e-13);
  }

  TEST(RunningCrack, PlaneStressHasItsOwnWaves)
  {
    MaterialInput material;
    material.young = 2.;
    material.poisson = 0.3;
    material.density = 8.;
    const RunningCrack crack(material, true);
    EXPECT_NEAR(crack.pressure_speed(), std::sqrt(2. / (8. * (1. - 0.09))),
                1e-14);
    EXPECT_EQ(crack.stiffness(), 2.);
    EXPECT_NEAR(crack.opening_function(1e-3 * crack.rayleigh_speed()), 1.,
                1e-6);
  }

  const std::string plate = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set lower corner = -1, -1
  set upper corner = 1, 1
  set cells        = 40, 40
end
subsection Discretization
  set degree = 2
end
subsection Material: solid
  set Young modulus = 1
  set Poisson ratio = 0.25
  set density       = 1
end
subsection Interface: crack
  set where = abs(y) < 1e-6 && x < 0
  set law   = contact
end
subsection Interface: elsewhere
  set law = rigid
end
subsection Time
  set end  = 1
  set step = 1e-6
end
subsection Observable: tip
  set type  = energy release rate
  set at    = 0, 0
  set radii = 0.6, 0.75, 0.9
end
)";

  /** u of a crack that runs with v along x and is at x = v t, K = 1. */
  struct MovingField {
    double v;
    RunningCrack crack{1., 0.25, 1.};

    std::array<double, 2> displacement(const double x, const double y,
                                       const double side, const double t) const
    {
      const double square = std::pow(v / crack.shear_speed(), 2),
                   d = std::sqrt(1. - std::pow(v / crack.pressure_speed(), 2)),
                   s = std::sqrt(1. - square);
      const double D = 4. * d * s - (2. - square) * (2. - square);
      const auto polar = [&](const double a) {
        const double X = x - v * t, Y = a * y;
        const double angle =
            Y == 0. && X < 0. ? std::copysign(pi, side) : std::atan2(Y, X);
        return std::array<double, 2>{{std::sqrt(std::hypot(X, Y)), angle / 2.}};
      };
      const auto [rd, td] = polar(d);
      const auto [rs, ts] = polar(s);
      const double factor = std::sqrt(2. / pi) / 0.4 / D, sum = 2. - square;
      return {
          {factor * (sum * rd * std::cos(td) - 2. * d * s * rs * std::cos(ts)),
           factor * d * (-sum * rd * std::sin(td) + 2. * rs * std::sin(ts))}};
    }
  };

  /**
   * G of the field on the three contours. Next to the tip, where all weights
   * are 1 and the field is singular, the bodies do not move: what they add is
   * a v,1 - a u,1 = 0 of a steady field.
   */
  std::vector<double> release(const double speed)
  {
    Scene<2> scene(plate);
    const MovingField field{speed};
    const auto &mesh = *scene.discretization;
    // by the way of the tip: slow fields are small differences of large ones
    const double h = 1e-3 / speed, dt = 1e-4 / speed;
    const auto at = [&](const double t, const bool rate) {
      return mesh.interpolate([&](const dealii::Point<2> &x,
                                  const unsigned int body, double *values) {
        const double side = mesh.cells().centre(body)[1];
        const bool inner = mesh.cells().centre(body).norm() < 0.15;
        const auto now = field.displacement(x[0], x[1], side, t),
                   later = field.displacement(x[0], x[1], side, t + dt),
                   before = field.displacement(x[0], x[1], side, t - dt);
        for (unsigned int c = 0; c < 2; ++c)
          values[c] = !rate   ? now[c]
                      : inner ? 0.
                              : (later[c] - before[c]) / (2. * dt);
      });
    };
    State before = scene.state, after = scene.state;
    before.displacement = at(-h / 2., false);
    before.velocity = at(-h / 2., true);
    after.displacement = at(h / 2., false);
    after.velocity = at(h / 2., true);
    RunViewOf<2> view(*scene.input, mesh, scene.communicator);
    view.find(*scene.triangulation, *scene.groups);
    Observable &tip = *scene.input->observables.at(0).observable;
    tip.find(view);
    HistoryRow row;
    row.step = 1;
    row.time = row.time_step = h;
    view.motion().show(after, &before, row);
    tip.follow(view);
    const auto values = tip.values(view);
    return {values.begin() + 1, values.begin() + 4};
  }

  TEST(EnergyReleaseRate, OfMovingFieldOnAnyContour)
  {
    const RunningCrack crack(1., 0.25, 1.);
    for (const double share : {1e-3, 0.4, 0.8}) {
      const double v = share * crack.rayleigh_speed(),
                   exact = crack.opening_function(v) / crack.stiffness();
      for (const double G : release(v))
        EXPECT_NEAR(G / exact, 1., 2e-3) << share;
    }
  }

  TEST(TableFile, GoesOnWhereItWas)
  {
    const std::string path =
        (std::filesystem::temp_directory_path() / "nsfd_table.csv").string();
    std::uintmax_t n_bytes = 0;
    const double third = 1. / 3.;
    {
      TableFile file(path, {"a", "b, c"});
      file.write({1., third});
      n_bytes = file.n_bytes();
      file.write({2., 1e300});
    }
    {
      TableFile file(path, {"a", "b, c"}, n_bytes);
      file.write({3., std::nan("")});
      n_bytes = file.n_bytes();
    }
    const auto rows = TableFile::read(path, 2, n_bytes);
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0][1], third);
    EXPECT_EQ(rows[1][0], 3.);
    EXPECT_TRUE(std::isnan(rows[1][1]));
    EXPECT_THROW(TableFile::read(path, 3, n_bytes), std::runtime_error);
    EXPECT_THROW(TableFile::read(path, 2, n_bytes + 1), std::runtime_error);
    std::filesystem::remove(path);
  }

  TEST(ObservableRecord, KeepsPeakAndThinsRows)
  {
    ObservableRecord record;
    for (unsigned int k = 0; k <= 50000; ++k)
      record.add(k, {k == 777 ? -9. : std::sin(double(k)), std::nan("")}, true);
    EXPECT_EQ(record.peak[0], -9.);
    EXPECT_EQ(record.peak_time[0], 777.);
    EXPECT_TRUE(std::isnan(record.peak[1]));
    EXPECT_LE(record.rows.size(), 20001u);
    for (std::size_t k = 1; k < record.rows.size(); ++k)
      ASSERT_EQ(record.rows[k][0] - record.rows[k - 1][0],
                double(record.stride));
  }

  /** The messages about a plate with one more block. */
  std::string report_of(const std::string &block,
                        const std::vector<std::string> &overrides = {})
  {
    InputErrors errors;
    read_scene_text(plate + block, "test.prm", overrides, errors);
    return errors.report();
  }

  TEST(ObservableInput, EnergyIsReleasedInUniformElasticBodies)
  {
    for (const auto &[entry, words] :
         std::vector<std::pair<std::string, std::string>>{
             {"Young modulus=1 + x * x", "differs from place to place"},
             {"shear viscosity=0.1", "is viscous"}})
      EXPECT_NE(report_of("", {"Material: solid/" + entry}).find(words),
                std::string::npos)
          << entry;
    const std::string flow = report_of("", {"Material: solid/model=j2 plastic",
                                            "Material: solid/yield stress=1"});
    EXPECT_NE(flow.find("`Material: solid` flows"), std::string::npos) << flow;
  }

  TEST(ObservableInput, RefusesWithWords)
  {
    const auto holds = [](const std::string &block, const std::string &words) {
      const std::string report =
          report_of("subsection Observable: one\n" + block + "end\n");
      EXPECT_NE(report.find(words), std::string::npos) << block << report;
    };
    holds("set type = crak\n", "crack");
    holds("set type = crack\n", "no Interface block has a law that breaks");
    holds("set type = probe\n", "the probe has no place");
    holds("set type = probe\n set at = 0, 0\n set on = crack\n", "not at both");
    holds("set type = reaction\n set on = crak\n",
          "on = crak is the name of no Boundary");
    holds("set type = contact pressure\n", "`on` must be given");
    const std::vector<std::string> slides = {"motion=large",
                                             "Contact: pair/friction=0"};
    const auto large = [&](const std::string &block) {
      return report_of("subsection Observable: one\n" + block + "end\n",
                       slides);
    };
    EXPECT_NE(large("set type = contact pressure\n set on = pair\n")
                  .find("write type = reaction"),
              std::string::npos);
    EXPECT_NE(large("set type = reaction\n set on = pair\n")
                  .find("of two different materials"),
              std::string::npos);
    EXPECT_NE(large("set type = probe\n set on = pair\n")
                  .find("has no faces of its own"),
              std::string::npos);
    holds("set type = energy release rate\n set at = 0, 0\n"
          "set direction = 0, 0\n",
          "direction = 0 has no direction");
    holds("set type = probe\n set at = 0, 0\n set radii = 1\n", "radii");
    EXPECT_NE(report_of("subsection Observable: a/b\nset type = probe\n"
                        "set at = 0, 0\nend\n")
                  .find("cannot be the name of a file"),
              std::string::npos);
    EXPECT_NE(report_of("subsection Observable: Tip\nset type = probe\n"
                        "set at = 0, 0\nend\n")
                  .find("write to the same file"),
              std::string::npos);
  }

  TEST(ObservableInput, PlacesAreInTheMesh)
  {
    Scene<2> scene(plate + "subsection Observable: p\n set type = probe\n"
                           " set at = 2, 0\nend\n");
    RunViewOf<2> view(*scene.input, *scene.discretization, scene.communicator);
    view.find(*scene.triangulation, *scene.groups);
    try {
      scene.input->observables.at(1).observable->find(view);
      FAIL() << "a place outside of the mesh";
    } catch (const std::runtime_error &error) {
      EXPECT_NE(std::string(error.what()).find("outside of the mesh"),
                std::string::npos);
    }
  }
} // namespace test_observables
