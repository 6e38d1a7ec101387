#include "leapfrog_steps.h"
#include "node_problems.h"

#include "joined/held_nodes.h"

#include <gtest/gtest.h>

// Nodes whose points are held for a step: they take more than their laws do.

namespace node_test::test_held_nodes
{
  /** What point @p i took in the step, less what its law stores and damage,
      friction and contact take, J; and the sum of the sizes of all that. */
  template <int dim>
  std::pair<double, double> taken_beyond(const NodeRun<dim> &run,
                                         const std::size_t i)
  {
    const auto &p = run.problem;
    const auto U = run.relative(i, run.node.velocity);
    const auto e = point_energies<dim>(p, i, U, run.solutions[i].frozen);
    const double w = p.weight[i];
    double sum = w * (e.stored_old - e.stored - e.damage - e.overlap_released),
           size = w * (e.stored_old + e.stored + e.damage);
    for (int c = 0; c < dim; ++c) {
      const double way =
          p.jump_free[i * dim + c] + run.h * U[c] - p.jump_old[i * dim + c];
      sum += w * e.cohesive_traction[c] * way;
      size += std::abs(w * e.cohesive_traction[c] * way);
    }
    return {sum, size};
  }

  /** Far beyond uniqueness, all points held in every step. */
  template <int dim>
  void expect_loss(const Setting &setting, const std::uint64_t seed, int &grown)
  {
    NodeRun<dim> run(setting, seed);
    NodeSolver<dim> solver;
    for (int k = 0; k < 30; ++k) {
      run.prepare();
      const auto kinds = run.problem.kind;
      {
        HeldNodes<dim> held(run.problem);
        held.hold(run.node);
        const NodeReport report = solver.solve(
            run.problem, run.frames, run.node, run.impulses, run.solutions);
        ASSERT_TRUE(report.converged) << report.residual;
        held.mark(run.solutions);
        EXPECT_GE(held.excess(run.impulses), 0.);
      }
      ASSERT_EQ(run.problem.kind, kinds);
      ASSERT_LE(run.problem.interactions.size(), 2u);
      for (std::size_t i = 0; i < run.n_points(); ++i) {
        const auto &s = run.solutions[i];
        for (int c = 0; c < dim && kinds[i] == PointKind::rigid; ++c) {
          ASSERT_LE(std::abs(s.velocity[c]), 1e-12);
        }
        if (kinds[i] != PointKind::cohesive)
          continue;
        const auto [taken, size] = taken_beyond(run, i);
        ASSERT_GE(taken, -1e-12 * size) << seed << ", step " << k;
        grown += taken > 1e-3 * size;
      }
      run.accept();
    }
  }

  TEST(HeldNodes, TakeMoreThanTheirLaws)
  {
    const std::shared_ptr<const CohesiveLaw> law = test::make_law(
        "camacho-ortiz", {{"strength", "2"}, {"critical opening", "0.6"}});
    int grown = 0;
    for (const double friction : {0., 0.5})
      for (int r = 0; r < 20; ++r) {
        Setting setting;
        setting.law = law;
        setting.friction = friction;
        setting.loaded = 0.5;
        setting.broken = 0.2;
        setting.contraction = 10.;
        expect_loss<2>(setting, r, grown);
        expect_loss<3>(setting, r, grown);
      }
    EXPECT_GT(grown, 100);
  }

  // A pillar that falls on a floor, in cells far longer than its cohesive
  // zones: at some speed some problem has no solution that is found, and all
  // steps keep their length.
  TEST(HeldNodes, GiveNoEnergyInARun)
  {
    double held = 0.;
    for (const char *speed : {"3", "4"}) {
      test::Steps<3> run(std::string(R"(
set dimension = 3
subsection Mesh
  set type         = tetrahedra
  set upper corner = 6 m, 6 m, 30 m
  set cells        = 4, 4, 20
end
subsection Material: granite
  set Young modulus = 50 GPa
  set Poisson ratio = 0.22
  set density       = 2650 kg/m^3
  set initial velocity z = -)") +
                         speed + R"( m/s
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 8 MPa
  set toughness = 150 J/m^2
  set friction  = 0.6
end
subsection Obstacle: ground
  set where  = z == 0
  set point  = 0, 0, 0
  set normal = 0, 0, 1
end
subsection Time
  set end    = 9 ms
  set step   = auto
  set scheme = explicit
end
)");
      double given = 0.;
      while (run.state.time < run.input->time.end) {
        const double before = run.state.energy.numerical;
        const StepReport report = run.step();
        given = std::max(given, before - run.state.energy.numerical);
        ASSERT_LT(report.solver.residual, 1e-12)
            << speed << " m/s at " << run.state.time;
        ASSERT_LT(report.balance_residual, 1e-13);
      }
      std::map<std::string, double> counters;
      run.leapfrog->fill_counters(counters);
      held += counters["held_node_problems"];
      EXPECT_LT(given, 1e-14 * run.state.largest_energy);
      EXPECT_LT(run.state.penetration, 1e-14 * 30.);
    }
    EXPECT_GT(held, 0.);
  }
} // namespace node_test::test_held_nodes
