#include "node_problems.h"

#include "core/communicator.h"
#include "nonsmooth/solvers/vertex_elimination.h"

// A vertex whose nodes move under impulses that are not those of its points:
// afterwards its momenta and laws hold, whatever the motion it was found in.

namespace node_test
{
  namespace
  {
    /** The groups of a run as nodes; @p start is their motion. */
    template <int dim>
    class Star final : public VertexMotion<dim>
    {
    public:
      using Vector = Vec<dim>;

      Star(const NodeData<dim> &data, const std::vector<Vector> &start)
          : data_(data), start_(start),
            vertices_(
                start.size(), dim, data.problem.n_points,
                [&](const std::size_t i) -> const std::vector<int> & {
                  seen_.clear();
                  for (const int g : data.node.points[i].groups)
                    if (g >= 0)
                      seen_.push_back(g);
                  return seen_;
                },
                std::vector<char>(start.size(), 0))
      {
      }

      const NodeClusters &vertices() override { return vertices_; }
      unsigned int unknowns_per_node() const override { return dim; }
      bool is_tied(const int k) const override { return k == tied; }

      int tied = -1; ///< a node that others follow

      /** M (v_free - v_0) + H^T P is left of its momentum. */
      void node(const int k, Vector &inverse_mass,
                Vector &velocity) const override
      {
        inverse_mass = data_.node.inverse_mass[k];
        auto moved = data_.node.velocity;
        for (std::size_t i = 0; i < data_.node.points.size(); ++i)
          push_groups<dim>(
              &data_.frames[i * dim * dim], data_.node.points[i].groups,
              &data_.impulses[i * dim], data_.node.inverse_mass, moved);
        for (int c = 0; c < dim; ++c)
          velocity[c] = inverse_mass[c] == 0. ? 0. : moved[k][c] - start_[k][c];
      }

      void sight(const std::size_t point, std::vector<int> &nodes,
                 std::vector<std::array<double, std::size_t(dim) * dim>> &B)
          const override
      {
        nodes.clear();
        B.clear();
        const auto &groups = data_.node.points[point].groups;
        for (int s = 0; s < 2; ++s)
          if (groups[s] >= 0) {
            nodes.push_back(groups[s]);
            auto &rows = B.emplace_back();
            for (int k = 0; k < dim * dim; ++k)
              rows[k] =
                  (s == 0 ? -1. : 1.) * data_.frames[point * dim * dim + k];
          }
      }

    private:
      const NodeData<dim> &data_;
      const std::vector<Vector> &start_;
      std::vector<int> seen_;
      NodeClusters vertices_;
    };

    template <int dim>
    void expect_solved(const std::uint64_t seed, const int steps)
    {
      Setting setting;
      setting.law = test::make_law(
          "camacho-ortiz", {{"strength", "2"}, {"critical opening", "0.6"}});
      setting.friction = 0.3;
      setting.loaded = 0.5;
      setting.contraction = 0.1;
      NodeRun<dim> run(setting, seed);
      NodeSolver<dim> solver;
      VertexElimination<dim> elimination;
      const Communicator alone(MPI_COMM_SELF);
      for (int k = 0; k < steps; ++k) {
        run.prepare();
        const auto free = run.node.velocity;
        auto start = free;
        for (auto &v : start)
          for (double &x : v)
            x *= run.random(0.5, 1.5);
        std::vector<double> U, w(start.size() * dim, 0.), P = run.impulses;
        std::vector<std::size_t> points;
        for (std::size_t i = 0; i < run.n_points(); ++i) {
          const auto relative = run.relative(i, start);
          U.insert(U.end(), relative.begin(), relative.end());
          points.push_back(i);
        }
        Star<dim> star(run, start);
        if (star.vertices().clusters.size() != 1)
          return; // parts that hang together are joined
        ASSERT_TRUE(
            elimination.solve(run.problem, star, alone, points, U, w, P));

        solver.solve(run.problem, run.frames, run.node, run.impulses,
                     run.solutions);
        auto &v = run.node.velocity;
        const auto kept = v;
        const auto impulses = run.impulses;
        run.impulses = P;
        double size = 0.;
        for (std::size_t g = 0; g < v.size(); ++g)
          for (int c = 0; c < dim; ++c) {
            v[g][c] = start[g][c] + w[g * dim + c];
            size = std::max(size, std::abs(v[g][c]));
          }
        EXPECT_LE(natural_map(run), 1e-11) << dim << "D, run " << seed;
        auto moved = free;
        for (std::size_t i = 0; i < run.n_points(); ++i)
          push_groups<dim>(&run.frames[i * dim * dim],
                           run.node.points[i].groups, &P[i * dim],
                           run.node.inverse_mass, moved);
        for (std::size_t g = 0; g < v.size(); ++g)
          for (int c = 0; c < dim; ++c)
            EXPECT_NEAR(v[g][c], moved[g][c], 1e-12 * size);
        v = kept;
        run.impulses = impulses;
        run.accept();
      }
    }

    /** What is moved by itself comes apart from what follows it. */
    void expect_left_alone()
    {
      Setting setting;
      setting.law = test::make_law(
          "camacho-ortiz", {{"strength", "2"}, {"critical opening", "0.6"}});
      setting.friction = 0.3;
      NodeRun<2> run(setting, 1);
      run.prepare();
      const auto start = run.node.velocity;
      std::vector<double> U, w(start.size() * 2, 0.), P = run.impulses;
      std::vector<std::size_t> points;
      for (std::size_t i = 0; i < run.n_points(); ++i) {
        const auto relative = run.relative(i, start);
        U.insert(U.end(), relative.begin(), relative.end());
        points.push_back(i);
      }
      Star<2> star(run, start);
      const auto &vertex = star.vertices().clusters.at(0);
      star.tied = vertex.nodes.at(0);
      VertexElimination<2> elimination;
      const Communicator alone(MPI_COMM_SELF);
      ASSERT_EQ(star.vertices().clusters.size(), 1u);
      EXPECT_FALSE(
          elimination.solve(run.problem, star, alone, points, U, w, P));
      EXPECT_EQ(w, std::vector<double>(w.size(), 0.));
      EXPECT_EQ(P, run.impulses);
    }
  } // namespace

  TEST(VertexElimination, MomentaAndLawsHoldAfterwards)
  {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      expect_solved<2>(seed, 20);
      expect_solved<3>(seed, 5);
    }
  }

  TEST(VertexElimination, NodesThatOthersFollowStay) { expect_left_alone(); }
} // namespace node_test
