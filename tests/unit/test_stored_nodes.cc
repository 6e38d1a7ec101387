#include "stored_nodes.h"

#include <gtest/gtest.h>

// Problems that runs have met and that Gauss-Seidel or Newton's method with
// shortened steps did not solve, or not soon.

namespace node_test::test_stored_nodes
{
  template <int dim>
  void expect_solved(const Json &stored)
  {
    NodeData<dim> data = stored_node<dim>(stored);
    const NodeReport report = NodeSolver<dim>().solve(
        data.problem, data.frames, data.node, data.impulses, data.solutions);
    EXPECT_TRUE(report.converged) << report.residual;
    // a point that has several answers against R has one against a part of it
    EXPECT_LE(std::min(natural_map(data), natural_map(data, 0.1)), 1e-12);
  }

  TEST(StoredNodes, AreAllSolved)
  {
    const Json all =
        read_stored_nodes(NSFD_SOURCE_DIR "/tests/problems/nodes.cbor");
    ASSERT_EQ(all.size(), 56);
    for (std::size_t k = 0; k < all.size(); ++k) {
      SCOPED_TRACE(k);
      if (all[k]["dimension"] == 2)
        expect_solved<2>(all[k]);
      else
        expect_solved<3>(all[k]);
    }
  }
} // namespace node_test::test_stored_nodes
