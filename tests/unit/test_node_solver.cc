#include "node_problems.h"

// Problems of nodes as runs with fragments meet them: stars of triangles and of
// tetrahedra that are pulled apart, pushed together and sheared. All of them
// are solved to 1e-12 of the natural map, measured here and not by the solver.

namespace node_test::test_node_solver
{
  struct NamedLaw {
    const char *name;
    test::LawEntries entries;
  };

  /** No drop at the end: there a node may have no solution, see brittle. */
  const std::vector<NamedLaw> continuous = {
      {"camacho-ortiz", {{"strength", "2"}, {"critical opening", "0.6"}}},
      {"tvergaard", {{"strength", "2"}, {"critical opening", "0.6"}}},
      {"geubelle-baylor",
       {{"strength", "2"},
        {"critical opening", "0.6"},
        {"initial strength parameter", "0.9"}}},
      {"michel-suquet", {{"stiffness", "5"}, {"strength", "2"}}}};

  /** Some steps of a run; @p check sees each after its solve. */
  template <int dim, typename Check>
  void expect_solved(const Setting &setting, const std::uint64_t seed,
                     const int steps, const Check &check)
  {
    NodeRun<dim> run(setting, seed);
    NodeSolver<dim> solver;
    for (int k = 0; k < steps; ++k) {
      run.prepare();
      const auto free = run.node.velocity;
      const NodeReport report = solver.solve(run.problem, run.frames, run.node,
                                             run.impulses, run.solutions);
      ASSERT_TRUE(report.converged) << dim << "D, run " << seed << ", step "
                                    << k << ": " << report.residual;
      ASSERT_LE(natural_map(run), 1e-12)
          << dim << "D, run " << seed << ", step " << k;
      check(run, free);
      run.accept();
    }
  }

  template <int dim>
  void expect_solved(const Setting &setting, const std::uint64_t seed,
                     const int steps)
  {
    expect_solved<dim>(setting, seed, steps,
                       [](const NodeRun<dim> &, const auto &) {});
  }

  TEST(NodeSolver, SolvesWhatFragmentsMeet)
  {
    for (const NamedLaw &entry : continuous) {
      std::shared_ptr<const CohesiveLaw> law =
          test::make_law(entry.name, entry.entries);
      for (const double friction : {0., 0.3, 0.8}) {
        SCOPED_TRACE(entry.name + std::string(", friction ") +
                     std::to_string(friction));
        for (int r = 0; r < 40; ++r)
          expect_solved<2>(setting_of(r, law, friction), r, 60);
        for (int r = 0; r < 12; ++r)
          expect_solved<3>(setting_of(r, law, friction, 0.3), r, 30);
      }
    }
  }

  TEST(NodeSolver, SolvesEveryLaw)
  {
    for (const auto &[name, entry] : CohesiveLawRegistry::instance().entries())
      for (const std::string &example : entry.examples) {
        SCOPED_TRACE(name + ": " + example);
        std::shared_ptr<const CohesiveLaw> law =
            test::make_law(name, test::entries_of(example));
        for (int r = 0; r < 12; ++r)
          expect_solved<2>(setting_of(r, law, 0.4, 0.1), r, 40);
        for (int r = 0; r < 4; ++r)
          expect_solved<3>(setting_of(r, law, 0.4, 0.1), r, 20);
      }
  }

  TEST(NodeSolver, SolvesWhatWasHard)
  {
    // runs that Gauss-Seidel, Newton alone or a softened Newton did not solve:
    // wedges that hold themselves, points at the strength beside others
    struct Hard {
      int law;
      double friction;
      int run, steps;
    };
    for (const Hard &hard :
         {Hard{0, 0.3, 146, 123}, Hard{0, 0.3, 187, 46}, Hard{0, 0.8, 147, 30},
          Hard{0, 0.8, 332, 50}, Hard{0, 0.8, 168, 20}, Hard{1, 0.8, 147, 26},
          Hard{2, 0.3, 173, 32}, Hard{2, 0.8, 355, 5},
          Hard{2, 0.8, 223, 155}}) {
      const NamedLaw &entry = continuous[hard.law];
      SCOPED_TRACE(entry.name);
      expect_solved<2>(setting_of(hard.run,
                                  test::make_law(entry.name, entry.entries),
                                  hard.friction),
                       hard.run, hard.steps);
    }
    for (const Hard &hard :
         {Hard{0, 0.8, 7, 20}, Hard{0, 0.3, 16, 55}, Hard{0, 0.8, 22, 15},
          Hard{0, 0.3, 53, 51}, Hard{0, 0.8, 67, 16}, Hard{1, 0.8, 71, 12},
          Hard{0, 0.8, 32, 30}}) {
      const NamedLaw &entry = continuous[hard.law];
      SCOPED_TRACE(entry.name);
      expect_solved<3>(setting_of(hard.run,
                                  test::make_law(entry.name, entry.entries),
                                  hard.friction),
                       hard.run, hard.steps);
    }
  }

  template <int dim>
  void expect_momentum()
  {
    const NamedLaw &entry = continuous[0];
    Setting setting =
        setting_of(1, test::make_law(entry.name, entry.entries), 0.5);
    setting.obstacles = 0;
    setting.supports = 0.;
    expect_solved<dim>(
        setting, 5, 60, [](const NodeRun<dim> &run, const auto &free) {
          Vec<dim> sum{};
          double size = 0.;
          for (std::size_t g = 0; g < run.mass.size(); ++g)
            for (int c = 0; c < dim; ++c) {
              sum[c] += run.mass[g] * (run.node.velocity[g][c] - free[g][c]);
              size += run.mass[g] * (std::abs(run.node.velocity[g][c]) +
                                     std::abs(free[g][c]));
            }
          // round-off of the sums
          for (const double x : sum)
            EXPECT_NEAR(x, 0., 1e-14 * size);
        });
  }

  TEST(NodeSolver, KeepsMomentum)
  {
    expect_momentum<2>();
    expect_momentum<3>();
  }

  template <int dim>
  void expect_no_energy()
  {
    for (const NamedLaw &entry : continuous)
      for (int r = 0; r < 6; ++r) {
        Setting setting =
            setting_of(3 * r, test::make_law(entry.name, entry.entries), 0.);
        setting.two_sided = false;
        setting.supports = 0.;
        expect_solved<dim>(
            setting, r, 40, [](const NodeRun<dim> &run, const auto &) {
              for (const auto &p : run.node.points) {
                const std::size_t i = p.point;
                const Vec<dim> U = run.relative(i, run.node.velocity);
                const auto e = point_energies<dim>(run.problem, i, U,
                                                   run.solutions[i].frozen);
                double work = 0., size = 0.;
                for (int c = 0; c < dim; ++c) {
                  const std::size_t k = i * dim + c;
                  const double change = run.h * U[c] +
                                        run.problem.jump_free[k] -
                                        run.problem.jump_old[k];
                  work += run.impulses[k] * change / (2. * run.h);
                  size += std::abs(run.impulses[k] * change) / (2. * run.h);
                }
                // over both steps, of which half counts in each
                const double kept =
                    run.problem.weight[i] *
                    (e.stored - e.stored_old + e.damage + e.viscous);
                // the toughness: closed points have round-off of positions
                size += run.problem.weight[i] *
                        (e.stored + e.stored_old + run.law().toughness());
                // contact at the level of positions only takes
                EXPECT_LE(work + kept, 1e-11 * size);
                if (run.solutions[i].contact_impulse == 0.) {
                  EXPECT_NEAR(work, -kept, 1e-11 * size);
                }
              }
            });
      }
  }

  TEST(NodeSolver, CreatesNoEnergy)
  {
    expect_no_energy<2>();
    expect_no_energy<3>();
  }

  /** Two groups with one point between them. */
  NodeProblem<2> pair(const Vec<2> &inverse_a, const Vec<2> &inverse_b)
  {
    NodeProblem<2> node;
    node.points = {{0, {{0, 1}}}};
    node.inverse_mass = {inverse_a, inverse_b};
    node.velocity = {{{0.3, -0.1}}, {{0.9, 0.4}}};
    return node;
  }

  TEST(NodeSolver, OnePointIsSolvePoint)
  {
    point_law_test::OnePoint<2> point(
        interaction_of(point_law_test::camacho_ortiz()), PointKind::rigid,
        CohesionRule::exact, 0.5);
    point.prepare();
    const std::vector<double> frames = {0.8, 0.6, -0.6, 0.8};
    for (const double inverse : {1e-3, 1e-2, 0.1, 1., 10.}) {
      NodeProblem<2> node =
          pair({{inverse, inverse}}, {{3. * inverse, 3. * inverse}});
      std::vector<double> impulses = {0.1, 0.2};
      std::vector<LocalSolution<2>> solutions(1);
      EXPECT_TRUE(NodeSolver<2>()
                      .solve(point.problem, frames, node, impulses, solutions)
                      .converged);
      const double R = inverse + 3. * inverse;
      // 0.8 * 0.6 + 0.6 * 0.5, -0.6 * 0.6 + 0.8 * 0.5
      const double a = 0.9 - 0.3, b = 0.4 - -0.1;
      const Vec<2> U{{0.8 * a + 0.6 * b, -0.6 * a + 0.8 * b}};
      const auto expected = solve_point<2>(point.problem, 0, U, R, R, Reach());
      for (int c = 0; c < 2; ++c) {
        EXPECT_EQ(impulses[c], expected.impulse[c]);
        EXPECT_EQ(solutions[0].velocity[c], expected.velocity[c]);
      }
      EXPECT_EQ(solutions[0].damages, expected.damages);
      EXPECT_EQ(solutions[0].reach.opening, expected.reach.opening);
    }
  }

  TEST(NodeSolver, PrescribedOnBothSides)
  {
    // a spring between groups that nothing moves, in one axis and in both
    point_law_test::OnePoint<2> point(point_law_test::spring(5., 0.4),
                                      PointKind::elastic, CohesionRule::exact,
                                      0.5);
    point.jump = {{0.02, -0.01}};
    point.two_sided = true;
    point.prepare();
    const double h = point.problem.time_step, wh = point.weight_step();
    const std::vector<double> frames = {1., 0., 0., 1.};
    for (const double inverse : {0., 0.5}) {
      NodeProblem<2> node = pair({{0., inverse}}, {{0., 2. * inverse}});
      std::vector<double> impulses(2, 0.);
      std::vector<LocalSolution<2>> solutions(1);
      EXPECT_TRUE(NodeSolver<2>()
                      .solve(point.problem, frames, node, impulses, solutions)
                      .converged);
      EXPECT_EQ(node.velocity[0][0], 0.3);
      EXPECT_EQ(node.velocity[1][0], 0.9);
      // the mean jump 0.02 + h U / 4, U = 0.6: round-off of a few operations
      EXPECT_NEAR(impulses[0], -wh * 5. * (0.02 + h * 0.6 / 4.), 1e-14 * wh);
      // U_T = 0.5 + W P_T, P_T = -k (u_0 + h U_T / 4)
      const double k = wh * 2., W = 3. * inverse;
      const double U = (0.5 + W * k * 0.01) / (1. + W * k * h / 4.);
      EXPECT_NEAR(impulses[1], -k * (-0.01 + h * U / 4.), 1e-14 * wh);
    }
  }

  TEST(NodeSolver, DependsOnTheProblemAlone)
  {
    const NamedLaw &entry = continuous[0];
    std::shared_ptr<const CohesiveLaw> law =
        test::make_law(entry.name, entry.entries);
    NodeRun<3> one(setting_of(0, law, 0.8), 3),
        other(setting_of(4, law, 0.3), 9);
    NodeSolver<3> used;
    for (int k = 0; k < 10; ++k) {
      one.prepare();
      other.prepare();
      used.solve(other.problem, other.frames, other.node, other.impulses,
                 other.solutions);
      NodeRun<3> same = one;
      used.solve(one.problem, one.frames, one.node, one.impulses,
                 one.solutions);
      NodeSolver<3>().solve(same.problem, same.frames, same.node, same.impulses,
                            same.solutions);
      EXPECT_EQ(one.impulses, same.impulses);
      EXPECT_EQ(one.node.velocity, same.node.velocity);
      one.accept();
      other.accept();
    }
  }

  /** A point whose ends are listed is the one between the same two groups; and
     a facet of two groups that move alike is one group of their masses. */
  TEST(NodeSolver, ContactsHaveSharesOfSeveralGroups)
  {
    const NamedLaw &entry = continuous[0];
    std::shared_ptr<const CohesiveLaw> law =
        test::make_law(entry.name, entry.entries);
    for (int r = 0; r < 6; ++r) {
      NodeRun<2> run(setting_of(r, law, 0.4), r);
      for (int k = 0; k < 20; ++k) {
        run.prepare();
        NodeRun<2> listed = run;
        std::vector<PointEnds> ends(listed.node.points.size());
        for (std::size_t i = 0; i < ends.size(); ++i) {
          auto &point = listed.node.points[i];
          for (unsigned int side = 0; side < 2; ++side)
            if (point.groups[side] >= 0) {
              ends[i].groups[ends[i].size] = point.groups[side];
              ends[i].shares[ends[i].size++] = side == 0 ? -1. : 1.;
            }
          point.groups = {{-1, -1}};
          point.ends = &ends[i];
        }
        NodeRun<2> halves = listed;
        // every group is two halves that share what acts on it
        for (std::size_t i = 0; i < ends.size(); ++i)
          halves.node.points[i].ends = nullptr;
        std::vector<PointEnds> of_halves(ends.size());
        for (std::size_t i = 0; i < ends.size(); ++i) {
          for (unsigned int e = 0; e < ends[i].size; ++e)
            for (unsigned int half = 0; half < 2; ++half) {
              PointEnds &mine = of_halves[i];
              mine.groups[mine.size] = 2 * ends[i].groups[e] + int(half);
              mine.shares[mine.size++] = ends[i].shares[e] / 2.;
            }
          halves.node.points[i].ends = &of_halves[i];
        }
        std::vector<std::array<double, 2>> inverse, velocity;
        for (std::size_t g = 0; g < listed.node.inverse_mass.size(); ++g)
          for (unsigned int half = 0; half < 2; ++half) {
            inverse.push_back(listed.node.inverse_mass[g]);
            for (double &x : inverse.back())
              x *= 2.;
            velocity.push_back(listed.node.velocity[g]);
          }
        halves.node.inverse_mass = inverse;
        halves.node.velocity = velocity;
        NodeSolver<2> solver;
        for (NodeRun<2> *one : {&run, &listed, &halves})
          EXPECT_TRUE(solver
                          .solve(one->problem, one->frames, one->node,
                                 one->impulses, one->solutions)
                          .converged);
        EXPECT_EQ(run.impulses, listed.impulses);
        EXPECT_EQ(run.node.velocity, listed.node.velocity);
        double size = 0.;
        for (const auto &v : run.node.velocity)
          size = std::max({size, std::abs(v[0]), std::abs(v[1])});
        for (std::size_t g = 0; g < run.node.velocity.size(); ++g)
          for (unsigned int c = 0; c < 2; ++c)
            EXPECT_NEAR((halves.node.velocity[2 * g][c] +
                         halves.node.velocity[2 * g + 1][c]) /
                            2.,
                        run.node.velocity[g][c], 1e-10 * size);
        run.accept();
      }
    }
  }
} // namespace node_test::test_node_solver
