#include "make_scene.h"

#include "adaptivity/bisection.h"
#include "nsfd/parameters/section_reader.h"
#include "simulation/bisected_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace nsfd::test_bisection
{
  namespace
  {
    double wave(const double phase) { return std::sin(78.233 * phase + 0.4); }

    /** Squares cut along a diagonal, their inner nodes moved. */
    CoarseMesh<2> rough_mesh(const unsigned int n)
    {
      CoarseMesh<2> mesh;
      for (unsigned int j = 0; j <= n; ++j)
        for (unsigned int i = 0; i <= n; ++i) {
          const bool inside = i > 0 && i < n && j > 0 && j < n;
          const double move = inside ? 0.25 : 0.;
          mesh.vertices.emplace_back(i + move * wave(i + 7. * j),
                                     j + move * wave(3. * i + j + 0.5));
        }
      const auto add = [&](const unsigned int a, const unsigned int b,
                           const unsigned int c) {
        auto &cell = mesh.cells.emplace_back(3);
        cell.vertices = {a, b, c};
        cell.material_id = mesh.cells.size() % 3;
      };
      for (unsigned int j = 0; j < n; ++j)
        for (unsigned int i = 0; i < n; ++i) {
          const unsigned int a = j * (n + 1) + i, b = a + 1, c = a + n + 1,
                             d = c + 1;
          add(a, b, d);
          add(a, d, c);
          auto &line = mesh.boundary.boundary_lines.emplace_back(2);
          line.vertices = {a, d};
          line.manifold_id = 5; // a group of inner faces
        }
      return mesh;
    }

    double smallest_angle(const CoarseMesh<2> &mesh)
    {
      double smallest = 4.;
      for (const auto &cell : mesh.cells)
        for (unsigned int k = 0; k < 3; ++k) {
          const auto at = [&](const unsigned int i) {
            return mesh.vertices[cell.vertices[(k + i) % 3]];
          };
          const auto a = at(1) - at(0), b = at(2) - at(0);
          smallest = std::min(smallest, std::acos(a * b / a.norm() / b.norm()));
        }
      return smallest;
    }

    double area(const CoarseMesh<2> &mesh, const int material)
    {
      double sum = 0.;
      for (const auto &cell : mesh.cells) {
        const auto &v = cell.vertices;
        const auto a = mesh.vertices[v[1]] - mesh.vertices[v[0]],
                   b = mesh.vertices[v[2]] - mesh.vertices[v[0]];
        const double twice = a[0] * b[1] - a[1] * b[0];
        EXPECT_GT(twice, 0.);
        if (material < 0 || int(cell.material_id) == material)
          sum += twice / 2.;
      }
      return sum;
    }

    TEST(Bisection, StaysConforming)
    {
      constexpr unsigned int n = 4, deepest = 8;
      const auto first = rough_mesh(n);
      Bisection cells(first);
      const double angle = smallest_angle(first);
      for (unsigned int round = 0; round < 12; ++round) {
        std::vector<char> marked(cells.cells().size());
        for (std::size_t k = 0; k < marked.size(); ++k)
          marked[k] = wave(double(k) + 100. * round) > 0.8;
        cells.refine(marked, deepest);
        const auto mesh = cells.mesh();
        EXPECT_NEAR(area(mesh, -1), n * n, 1e-12);
        for (int material = 0; material < 3; ++material)
          EXPECT_NEAR(area(mesh, material), area(first, material), 1e-12);
        EXPECT_GT(smallest_angle(mesh), angle / 2. - 1e-12);
        std::map<std::pair<unsigned int, unsigned int>, int> n_cells;
        for (const auto &cell : mesh.cells)
          for (unsigned int k = 0; k < 3; ++k) {
            const auto [a, b] =
                std::minmax(cell.vertices[k], cell.vertices[(k + 1) % 3]);
            ++n_cells[{a, b}];
          }
        // Whoever has no neighbour is at the edge of the square.
        double perimeter = 0., diagonals = 0., of_first = 0.;
        for (const auto &[edge, count] : n_cells) {
          ASSERT_LE(count, 2);
          if (count == 1)
            perimeter +=
                mesh.vertices[edge.first].distance(mesh.vertices[edge.second]);
        }
        EXPECT_NEAR(perimeter, 4. * n, 1e-12);
        const auto length = [](const CoarseMesh<2> &one) {
          double sum = 0.;
          for (const auto &line : one.boundary.boundary_lines)
            sum += line.manifold_id == 5
                       ? one.vertices[line.vertices[0]].distance(
                             one.vertices[line.vertices[1]])
                       : 0.;
          return sum;
        };
        diagonals = length(mesh);
        of_first = length(first);
        EXPECT_NEAR(diagonals, of_first, 1e-12);
        for (const auto &cell : cells.cells())
          EXPECT_LE(cell.level, deepest);
      }
      EXPECT_GT(cells.cells().size(), 200u);

      // Ids say all: vertices and cells are numbered alike.
      Bisection again(first);
      again.restore(cells.ids());
      const auto one = cells.mesh(), two = again.mesh();
      ASSERT_EQ(one.cells.size(), two.cells.size());
      for (std::size_t k = 0; k < one.cells.size(); ++k)
        EXPECT_EQ(one.cells[k].vertices, two.cells[k].vertices);
      EXPECT_EQ(one.vertices, two.vertices);
    }

    // Joined round by round, halves are the first mesh in the end.
    TEST(Bisection, JoinsWhatItHalved)
    {
      constexpr unsigned int n = 4;
      const auto first = rough_mesh(n);
      Bisection cells(first);
      for (unsigned int round = 0; round < 9; ++round) {
        std::vector<char> marked(cells.cells().size());
        for (std::size_t k = 0; k < marked.size(); ++k)
          marked[k] = wave(double(k) + 100. * round) > 0.7;
        cells.refine(marked, 7);
      }
      // what was halved since the last settle() is not joined
      EXPECT_TRUE(cells.families().empty());
      const std::size_t most = cells.cells().size();
      EXPECT_GT(most, 150u);
      for (unsigned int round = 0; round < 20; ++round) {
        cells.settle();
        const auto families = cells.families();
        if (families.empty())
          break;
        const std::size_t before = cells.cells().size();
        std::size_t fewer = 0;
        for (const auto &family : families)
          fewer += family.pairs[1][0] == Bisection::none ? 1 : 2;
        cells.join(families);
        EXPECT_EQ(cells.cells().size() + fewer, before);
        const auto mesh = cells.mesh();
        std::map<std::pair<unsigned int, unsigned int>, int> n_cells;
        for (const auto &cell : mesh.cells)
          for (unsigned int k = 0; k < 3; ++k)
            ++n_cells[std::minmax(cell.vertices[k],
                                  cell.vertices[(k + 1) % 3])];
        double perimeter = 0.;
        for (const auto &[edge, count] : n_cells)
          if (count == 1)
            perimeter +=
                mesh.vertices[edge.first].distance(mesh.vertices[edge.second]);
        EXPECT_NEAR(perimeter, 4. * n, 1e-12);
        for (int material = 0; material < 3; ++material)
          EXPECT_NEAR(area(mesh, material), area(first, material), 1e-12);
      }
      ASSERT_EQ(cells.cells().size(), first.cells.size());
      for (std::size_t k = 0; k < first.cells.size(); ++k)
        EXPECT_EQ(cells.cells()[k].level, 0u);
    }

    /** Wants cells of half the size in half of the places, when told so. */
    class Sometimes final : public Indicator
    {
    public:
      explicit Sometimes(SectionReader &) {}
      void limit(const MeshView &view, std::vector<double> &size) const override
      {
        const auto &bodies = view.bodies();
        for (std::size_t b = 0; b < bodies.size(); ++b) {
          const auto &x = bodies[b].centre;
          if (level > 0 && (x[0] < 5e-6 ? left : right) &&
              wave(std::floor(4e5 * x[0]) + 7. * std::floor(4e5 * x[1]) +
                   level) > -0.3)
            size[b] = std::ldexp(bodies[b].largest, -int(level));
        }
      }
      bool is_of_points() const override { return true; }
      static inline unsigned int level = 0;
      static inline bool left = true, right = true; ///< where it wants them
    };
    NSFD_REGISTER(IndicatorRegistry, Sometimes, "sometimes (test)",
                  "For tests");

    constexpr const char *plate = R"(
set dimension = 2
set plane     = strain
subsection Mesh
  set type         = crossed triangles
  set upper corner = 10 um, 10 um
  set cells        = 6, 6
end
subsection Material: bulk
  set Young modulus = 135 GPa
  set Poisson ratio = 0.32
  set density       = 7800 kg/m^3
  set initial velocity x = 15 * (x - 5 um) / 5 um * (1 + y / 20 um)
  set initial velocity y = 10 * (y - 5 um) / 5 um
end
subsection Interface: all
  set law              = camacho-ortiz
  set strength         = 300 MPa
  set toughness        = 0.5 J/m^2
  set strength scatter = 0.1
  set friction         = 0.3
end
subsection Time
  set end    = 24 ns
  set step   = auto
  set scheme = explicit
end
subsection Adaptivity
  set levels = 2
end
subsection Indicator: test
  set type = sometimes (test)
end
)";

    /** The plate, whose faces at @p where alone may break. */
    std::string with_plane(const std::string &where)
    {
      const std::string faces = R"(
subsection Interface: plane
  set where     = )" + where + R"(
  set law       = camacho-ortiz
  set strength  = 300 MPa
  set toughness = 0.5 J/m^2
end
subsection Interface: elsewhere
  set where = all
  set law   = joined
end
)";
      std::string text = plate;
      const auto from = text.find("subsection Interface"),
                 to = text.find("subsection Time");
      return text.replace(from, to - from, faces);
    }

    /** Steps on a mesh that changes. */
    struct BisectedRun {
      explicit BisectedRun(const std::string &text,
                           const std::vector<std::string> &overrides = {})
          : input(test::make_input(text, overrides)),
            communicator(MPI_COMM_WORLD)
      {
        Sometimes::level = 0;
        Sometimes::left = Sometimes::right = true;
        const auto problems = model.build(*input, communicator);
        if (!problems.empty())
          throw std::invalid_argument(problems.front());
        mesh = std::make_unique<BisectedMesh>(*input, communicator, model);
        const State first = mesh->start(); // makes a new leapfrog
        state = model.leapfrog->start_from(first);
      }
      bool step()
      {
        model.leapfrog->advance(state, model.control->step(), next, 2);
        std::swap(state, next);
        swap_motion(state, next); // there is one of it
        model.leapfrog->show(state);
        before = state;
        old_momentum = momentum();
        old_damage = damaged_length();
        return mesh->accept(state);
      }
      std::array<double, 3> momentum() const
      {
        const auto &nodes = model.leapfrog->parts().mesh;
        std::array<double, 3> sum{};
        for (std::size_t k = 0; k < state.velocity.size(); ++k) {
          const double p = nodes.mass(k / 2) * state.velocity[k];
          sum[k % 2] += p;
          sum[2] += std::abs(p);
        }
        return sum;
      }
      double damaged_length() const
      {
        double sum = 0.;
        for (std::size_t i = 0; i < state.beta.size(); ++i)
          if (state.kind[i] != PointKind::bonded)
            sum +=
                model.discretization->points().weight[i] * (2. - state.beta[i]);
        return sum;
      }
      static double total(const EnergyLines &e)
      {
        return e.kinetic + e.elastic + e.cohesive + e.damage + e.friction +
               e.impact + e.viscous + e.numerical - e.work;
      }

      std::unique_ptr<SceneInput> input;
      Communicator communicator;
      Model<2> model;
      std::unique_ptr<BisectedMesh> mesh;
      State state, next, before;
      std::array<double, 3> old_momentum{};
      double old_damage = 0.;
    };

    TEST(Bisection, CarriesBrokenPlates)
    {
      BisectedRun run(plate, {"Adaptivity/coarsen every steps=0"});
      const double start = BisectedRun::total(run.state.energy);
      unsigned int changes = 0;
      bool was_open = false;
      for (unsigned int n = 0; run.state.time < 8e-9; ++n) {
        if (n == 60 || n == 200)
          ++Sometimes::level;
        const bool changed = run.step();
        const auto &energy = run.state.energy;
        ASSERT_NEAR(BisectedRun::total(energy), start, 1e-13 * start)
            << "step " << n;
        if (!changed)
          continue;
        ++changes;
        const auto now = run.momentum();
        for (unsigned int c = 0; c < 2; ++c)
          EXPECT_NEAR(now[c], run.old_momentum[c], 1e-14 * now[2]);
        EXPECT_LE(energy.kinetic, run.before.energy.kinetic);
        EXPECT_EQ(energy.elastic, run.before.energy.elastic);
        EXPECT_NEAR(run.damaged_length(), run.old_damage,
                    1e-13 * run.old_damage);
        was_open = was_open || run.before.energy.damage > 0.;
      }
      EXPECT_GE(changes, 2u);
      EXPECT_TRUE(was_open); // faces that soften and broken ones were cut
      EXPECT_GT(run.state.broken_area, 20e-6);
    }

    // Where cells are not needed any more they are joined, on the left while
    // the right is refined: momentum and damage stay, and there is less energy,
    // which the balance of the steps that come confirms.
    TEST(Bisection, JoinsHalvesWithLessEnergy)
    {
      BisectedRun run(
          plate, {"Material: bulk/initial velocity x=if(x > 5 um, 20, 1) * "
                  "(x - 5 um) / 5 um",
                  "Material: bulk/initial velocity y=0"});
      const double start = BisectedRun::total(run.state.energy);
      const auto count = [&](const char *name) {
        std::map<std::string, double> counters;
        run.mesh->fill_counters(counters);
        return counters.at(name);
      };
      unsigned int changes = 0;
      for (unsigned int n = 0; run.state.time < 8e-9; ++n) {
        if (n == 60) {
          Sometimes::level = 2;
          Sometimes::right = false;
        }
        if (n == 200)
          std::swap(Sometimes::left, Sometimes::right);
        const double joined = count("joined_halves");
        const bool changed = run.step();
        const auto &now = run.state.energy, &before = run.before.energy;
        ASSERT_NEAR(BisectedRun::total(now), start, 1e-13 * start)
            << "step " << n;
        if (!changed || count("joined_halves") == joined)
          continue;
        ++changes;
        const auto momentum = run.momentum();
        for (unsigned int c = 0; c < 2; ++c)
          EXPECT_NEAR(momentum[c], run.old_momentum[c], 1e-14 * momentum[2]);
        EXPECT_LT(now.kinetic + now.elastic, before.kinetic + before.elastic);
        EXPECT_NEAR(run.damaged_length(), run.old_damage,
                    1e-13 * run.old_damage);
        EXPECT_EQ(now.damage, before.damage);
      }
      EXPECT_GE(changes, 1u);
      EXPECT_GE(count("joined_halves"), 2.);
      EXPECT_GT(run.state.energy.damage, 0.);
    }

    // A plane, cut in halves while it breaks, takes its toughness.
    TEST(Bisection, PlaneTakesItsToughness)
    {
      const std::string text = with_plane("abs(y - 5 um) < 1 nm");
      double damage[2]; // without and with cuts
      for (const bool may_cut : {false, true}) {
        BisectedRun run(
            text, {"Time/end=100 ns", "Material: bulk/initial velocity x=0",
                   "Material: bulk/initial velocity y=if(y > 5 um, 1, -1) * "
                   "(2 + 38 * x / 10 um) * abs(y - 5 um) / 5 um"});
        const double start = BisectedRun::total(run.state.energy);
        bool cut = false;
        while (run.state.time < 100e-9 &&
               run.state.broken_area < 10e-6 * (1. - 1e-12)) {
          if (may_cut && run.state.broken_area > 2e-6)
            Sometimes::level = 2;
          cut = run.step() || cut;
        }
        EXPECT_EQ(cut, may_cut);
        EXPECT_NEAR(run.state.broken_area, 10e-6, 1e-17);
        EXPECT_NEAR(BisectedRun::total(run.state.energy), start, 1e-13 * start);
        damage[may_cut] = run.state.energy.damage;
        EXPECT_NEAR(damage[may_cut], 0.5 * 10e-6, 1e-9 * 0.5 * 10e-6);
      }
      EXPECT_NEAR(damage[1], damage[0], 1e-12 * damage[0]);
    }

    // A selection that ends within faces: each of them is in it as a whole, by
    // its middle, and its halves are when it is cut, though the middle of one
    // of them is not.
    TEST(Bisection, SelectionsKeepTheirFaces)
    {
      BisectedRun run(with_plane("abs(y - 5 um) < 1 nm && x > 4.1 um"));
      const auto length = [&] {
        const auto &points = run.model.discretization->points();
        const auto &origins = run.model.discretization->origins();
        double sum = 0.;
        for (std::size_t i = 0; i < origins.size(); ++i)
          if (origins[i].kind == PointOrigin::Kind::interface &&
              origins[i].block == 0)
            sum += points.weight[i];
        return sum;
      };
      // four faces of a sixth of the side: from 3.33 um on, the first of which
      // has its middle at 4.17 um and that of a half of it at 3.75 um
      const double whole = 4. / 6. * 10e-6;
      EXPECT_NEAR(length(), whole, 1e-12 * whole);
      const std::size_t n = run.model.discretization->points().n_points;
      unsigned int changes = 0;
      for (unsigned int k = 0; k < 400 && changes < 2; ++k) {
        Sometimes::level = k < 100 ? 1 : 2;
        changes += run.step();
        EXPECT_NEAR(length(), whole, 1e-12 * whole);
      }
      EXPECT_EQ(changes, 2u);
      EXPECT_GT(run.model.discretization->points().n_points, 2 * n);
    }

    TEST(Bisection, RefusesWhatItCannotCarry)
    {
      std::string intrinsic = plate;
      const std::string law = "camacho-ortiz";
      intrinsic.replace(intrinsic.find(law), law.size(), "geubelle-baylor");
      EXPECT_THROW(test::make_input(intrinsic), std::invalid_argument);
      EXPECT_THROW(test::make_input(
                       plate, {"Time/scheme=moreau-jean", "Time/step=1 ps"}),
                   std::invalid_argument);
      std::string energy = plate;
      const std::string type = "sometimes (test)";
      energy.replace(energy.find(type), type.size(), "energy");
      EXPECT_THROW(test::make_input(energy), std::invalid_argument);
    }
  } // namespace
} // namespace nsfd::test_bisection
