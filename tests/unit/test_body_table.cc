#include "make_scene.h"

#include "discretization/cells.h"
#include "rigid_in_rubber.h"

#include "mesh/body_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

// Bodies of large motions: their numbers, and the ranks they belong to.

using namespace nsfd;
using namespace nsfd::test;

namespace test_body_table
{
  TEST(BodyTable, NumbersBodiesByTheirFirstCells)
  {
    const Scene<2> scene(rigid_in_rubber);
    const BodyTable &table = scene.discretization->body_table();
    EXPECT_EQ(table.n_cells(), 72u);
    EXPECT_EQ(table.bodies.size(), 72u - 24u + 1u);
    EXPECT_EQ(table.n_rigid, 1u);
    std::vector<unsigned int> n_cells(table.bodies.size(), 0);
    unsigned int last = 0;
    for (unsigned int c = 0; c < table.n_cells(); ++c) {
      const unsigned int b = table.body_of_cell[c];
      ASSERT_LE(b, last);
      if (n_cells[b]++ == 0) {
        EXPECT_EQ(table.bodies[b].first_cell, c);
        last = b + 1;
      }
      // one rank alone numbers its cells as the table does
      EXPECT_EQ(
          table.cell_of_global[scene.discretization->cells().global_cell[c]],
          c);
      EXPECT_EQ(table.bodies[b].material,
                scene.discretization->cells().body_class(c).material);
    }
    for (unsigned int b = 0; b < table.bodies.size(); ++b) {
      EXPECT_EQ(n_cells[b], table.is_rigid(b) ? 24u : 1u);
      EXPECT_EQ(table.bodies[b].rank, 0);
    }
  }

  class PartitionTest : public testing::TestWithParam<int>
  {
  };

  TEST_P(PartitionTest, KeepsBodiesWholeAndRanksBusy)
  {
    Scene<2> scene(rigid_in_rubber);
    const BodyTable &table = scene.discretization->body_table();
    const int n_ranks = GetParam();
    partition_by_bodies<2>(*scene.input, *scene.triangulation, n_ranks);
    std::map<unsigned int, std::set<unsigned int>> ranks_of_body;
    std::vector<int> n_cells(std::size_t(n_ranks), 0);
    for (const auto &cell : scene.triangulation->active_cell_iterators()) {
      const unsigned int rank = cell->subdomain_id();
      ASSERT_LT(rank, unsigned(n_ranks));
      ranks_of_body[table.body_of_global(cell->global_active_cell_index())]
          .insert(rank);
      ++n_cells[rank];
    }
    for (const auto &[body, ranks] : ranks_of_body)
      EXPECT_EQ(ranks.size(), 1u) << body;
    // no rank has more than its share and half of the largest body at each of
    // the cuts that lead to it
    int cuts = 0;
    while (1 << cuts < n_ranks)
      ++cuts;
    EXPECT_LE(*std::max_element(n_cells.begin(), n_cells.end()),
              72 / n_ranks + 1 + 12 * cuts);
    if (n_ranks <= 3) {
      EXPECT_GT(*std::min_element(n_cells.begin(), n_cells.end()), 0);
    }
  }

  INSTANTIATE_TEST_SUITE_P(Ranks, PartitionTest,
                           testing::Values(1, 2, 3, 5, 8));
} // namespace test_body_table
