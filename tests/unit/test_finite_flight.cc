#include "finite_strain.h"

namespace finite_strain::test_finite_flight
{
  template <int dim>
  struct Flight {
    const Cell<dim> &cell;
    std::vector<double> u, v;
    FiniteScratch scratch;
    const std::vector<double> none;
    double dissipated = 0.;

    /** Stretched along x and spinning at @p spin, in space about (1, 1, 1). */
    Flight(const Cell<dim> &body, const double stretch, const double spin,
           const double drift)
        : cell(body), u(turned(body, 0., stretch)), v(body.n, 0.),
          none(body.n, 0.)
    {
      const std::vector<double> x = cell.positions(u);
      for (unsigned int i = 0; i < cell.n; i += dim)
        for (unsigned int c = 0; c < dim; ++c) {
          const unsigned int next = (c + 1) % dim, last = (c + dim - 1) % dim;
          v[i + c] = drift + (dim == 3 ? spin * (x[i + last] - x[i + next])
                              : c == 0 ? -spin * x[i + 1]
                                       : spin * x[i]);
        }
    }

    bool advance(const double h, const double theta = 0.5)
    {
      FiniteStep step;
      step.time_step = h;
      step.theta = theta;
      step.mass = cell.mass.data();
      step.displacement = u.data();
      step.velocity = v.data();
      step.load = none.data();
      std::vector<double> next = v, end = u, change(cell.n);
      if (!cell.finite->solve(step, next.data(), scratch))
        return false;
      for (unsigned int i = 0; i < cell.n; ++i) {
        end[i] += h * (theta * next[i] + (1. - theta) * v[i]);
        change[i] = next[i] - v[i];
      }
      dissipated +=
          cell.finite->account({u.data(), end.data(), theta}).numerical +
          (theta - 0.5) * scalar(change, applied(cell.mass, change));
      u = end;
      v = next;
      return true;
    }

    double energy() const
    {
      return scalar(v, applied(cell.mass, v)) / 2. +
             cell.finite->energy(u.data());
    }
    std::array<double, 3> spin() const
    {
      return moment<dim>(cell.positions(u), applied(cell.mass, v));
    }
  };

  template <int dim>
  void free_flight_conserves(const unsigned int degree, const unsigned int n)
  {
    for_each_law<dim>([&](const Law<dim> &law) {
      const Cell<dim> cell(law.material, degree);
      Flight<dim> flight(cell, 1.2, 0.5, 0.1);
      const double energy = flight.energy();
      const auto spin = flight.spin();
      const auto momentum = resultant<dim>(applied(cell.mass, flight.v));
      double size = 0., softest = energy, most = 0.;
      for (const double s : spin)
        size = std::max(size, std::abs(s));
      for (unsigned int i = 0; i < n; ++i) {
        ASSERT_TRUE(flight.advance(0.1)) << i;
        ASSERT_NEAR(flight.energy(), energy, 1e-12 * energy) << i;
        for (unsigned int c = 0; c < 3; ++c)
          ASSERT_NEAR(flight.spin()[c], spin[c], 1e-12 * size) << i;
        const auto now = resultant<dim>(applied(cell.mass, flight.v));
        for (unsigned int c = 0; c < dim; ++c)
          ASSERT_NEAR(now[c], momentum[c], 1e-12 * std::abs(momentum[c])) << i;
        const double stored = cell.finite->energy(flight.u.data());
        softest = std::min(softest, stored);
        most = std::max(most, stored);
      }
      // it has oscillated
      EXPECT_LT(softest, 0.5 * most);
    });
  }

  TEST(FiniteCell, FreeFlightConserves)
  {
    free_flight_conserves<2>(1, 1000);
    free_flight_conserves<3>(1, 1000);
  }

  TEST(FiniteCell, FreeFlightOfSecondDegreeConserves)
  {
    free_flight_conserves<2>(2, 200);
    free_flight_conserves<3>(2, 20);
  }

  TEST(FiniteCell, WhatThetaTakesIsCounted)
  {
    for_each_law<3>([](const Law<3> &law) {
      const Cell<3> cell(law.material, 1);
      Flight<3> flight(cell, 1.2, 0.5, 0.1);
      const double energy = flight.energy();
      for (unsigned int i = 0; i < 100; ++i)
        ASSERT_TRUE(flight.advance(0.1, 1.));
      EXPECT_GT(flight.dissipated, 1e-2 * energy);
      EXPECT_NEAR(flight.energy() + flight.dissipated, energy, 1e-12 * energy);
    });
  }

  /** Stiff cells of micrometres, at rest and loaded: all sizes are relative. */
  TEST(FiniteCell, SmallStiffCellsMoveUnderTheirLoad)
  {
    const std::shared_ptr<const Hyperelastic<2>> steel =
        make_saint_venant_kirchhoff<2>(2e11, 0.3, false);
    const double edge = 1e-6;
    const Cell<2> cell(steel, 1, edge); // of the density 1
    std::vector<double> u(cell.n, 0.), v0(cell.n, 0.), v(cell.n, 0.),
        load(cell.n), impulse(cell.n, 0.);
    const double mass = edge * edge, h = 1e-12;
    for (unsigned int i = 0; i < cell.n; ++i)
      load[i] = i % 2 == 0 ? mass / 4. * 9.81 : 0.;
    impulse[1] = impulse[3] = impulse[5] = impulse[7] = mass / 4. * 1e-3;
    FiniteStep step;
    step.time_step = h;
    step.mass = cell.mass.data();
    step.displacement = u.data();
    step.velocity = v0.data();
    step.load = load.data();
    FiniteScratch scratch;
    ASSERT_TRUE(cell.finite->solve(step, v.data(), scratch));
    for (unsigned int i = 0; i < cell.n; i += 2)
      EXPECT_NEAR(v[i], 9.81 * h, 1e-10 * 9.81 * h);
    step.impulse = impulse.data();
    ASSERT_TRUE(cell.finite->solve(step, v.data(), scratch));
    for (unsigned int i = 1; i < cell.n; i += 2)
      EXPECT_NEAR(v[i], 1e-3, 1e-13);
  }

  TEST(FiniteCell, WhatCannotBeSolvedIsRefused)
  {
    for_each_law<2>([](const Law<2> &law) {
      const Cell<2> cell(law.material, 1);
      Flight<2> flight(cell, 1.2, 0.5, 0.1);
      const double nan = std::numeric_limits<double>::quiet_NaN();
      std::vector<double> load(cell.n, 0.), v = flight.v;
      load[0] = nan;
      FiniteStep step;
      step.time_step = 0.1;
      step.mass = cell.mass.data();
      step.displacement = flight.u.data();
      step.velocity = flight.v.data();
      step.load = load.data();
      EXPECT_FALSE(cell.finite->solve(step, v.data(), flight.scratch));
      EXPECT_EQ(v, flight.v);
      const auto mirrored = turned(cell, 0., -1.);
      load[0] = 0.;
      step.displacement = mirrored.data();
      EXPECT_FALSE(cell.finite->solve(step, v.data(), flight.scratch));
      EXPECT_EQ(v, flight.v);
    });
  }
} // namespace finite_strain::test_finite_flight
