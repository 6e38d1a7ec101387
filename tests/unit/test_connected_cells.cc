#include "make_scene.h"

#include "discretization/cells.h"
#include "joined/connected_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

namespace nsfd::test_connected_cells
{
  using test::Scene;

  namespace
  {
    const std::string grid = R"(# grid - twelve cells.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 4, 3
  set cells        = 4, 3
end
subsection Material: block
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 1
  set toughness = 1
end
subsection Time
  set end  = 1
  set step = 0.1
end
)";
  } // namespace

  // Columns, numbered from left to right; each cell alone where nothing holds.
  TEST(ConnectedCells, AreNumberedByTheirPlace)
  {
    const Scene<2> scene(grid);
    const auto &mesh = *scene.discretization;
    ConnectedCells<2> cells(mesh, scene.communicator);
    cells.connect([](const auto &) { return false; });
    EXPECT_EQ(cells.count(), 12u);
    cells.connect([](const auto &face) {
      return std::abs(face.centre[0] - std::round(face.centre[0])) > 0.25;
    });
    EXPECT_EQ(cells.count(), 4u);
    const auto numbers = cells.numbers();
    std::map<std::uint64_t, std::set<unsigned int>> by_name;
    for (unsigned int c = 0; c < mesh.bodies().size(); ++c) {
      EXPECT_EQ(numbers[c], unsigned(mesh.cells().centre(c)[0]));
      by_name[cells.name(c)].insert(numbers[c]);
    }
    for (const auto &[name, columns] : by_name)
      EXPECT_EQ(columns.size(), 1u);
    if (scene.communicator.size() == 1) {
      EXPECT_EQ(by_name.size(), 4u);
    }
  }

  // A point without a jump joins its face; a law holds down to beta = 1e-3.
  TEST(ConnectedCells, FacesHoldByTheirBestPoint)
  {
    Scene<2> scene(grid);
    for (const auto &face : scene.discretization->points().faces) {
      if (face.boundary)
        continue;
      ASSERT_GE(face.count, 2u);
      const auto of = [&](const PointKind first, const PointKind last,
                          const double beta) {
        for (unsigned int i = face.first; i < face.first + face.count; ++i) {
          scene.state.kind[i] = last;
          scene.state.beta[i] = beta;
        }
        scene.state.kind[face.first] = first;
        return connection<2>(scene.state, face);
      };
      using K = PointKind;
      EXPECT_EQ(of(K::free, K::bonded, 0.), Connection::joined);
      EXPECT_EQ(of(K::rigid, K::cohesive, 0.5), Connection::joined);
      EXPECT_EQ(of(K::free, K::cohesive, 1e-3), Connection::intact);
      EXPECT_EQ(of(K::elastic, K::separated, 0.), Connection::intact);
      EXPECT_EQ(of(K::cohesive, K::free, 0.99e-3), Connection::open);
      EXPECT_EQ(of(K::separated, K::free, 0.), Connection::open);
    }
  }
} // namespace nsfd::test_connected_cells
