#include "delassus/node_clusters.h"

#include <gtest/gtest.h>

using namespace nsfd;

namespace
{
  using Nodes = std::vector<int>;

  NodeClusters clusters_of(const std::vector<Nodes> &seen,
                           const std::vector<char> &excluded,
                           const unsigned int size = 2)
  {
    return NodeClusters(
        excluded.size(), size, seen.size(),
        [&](const std::size_t i) -> const Nodes & { return seen[i]; },
        excluded);
  }
} // namespace

TEST(NodeClusters, HoldWhatPointsCoupleDirectlyOrThroughOthers)
{
  // 5 - 2, 2 - 7 are one vertex, 0 - 1 another; node 3 is seen by nobody
  const auto found =
      clusters_of({{5, 2}, {0, 1}, {}, {7, 2}}, std::vector<char>(8, 0));
  ASSERT_EQ(found.clusters.size(), 2u);
  EXPECT_EQ(found.clusters[0].nodes, (Nodes{0, 1}));
  EXPECT_EQ(found.clusters[1].nodes, (Nodes{2, 5, 7}));
  EXPECT_EQ(found.clusters[1].points, (std::vector<std::size_t>{0, 3}));
  EXPECT_EQ(found.of_point, (std::vector<int>{1, 0, -1, 1}));
  EXPECT_EQ(found.place[7], 2);
  EXPECT_EQ(found.place[3], -1);
  EXPECT_EQ(found.covers, (std::vector<char>{1, 1, 1, 1}));
}

TEST(NodeClusters, AreTheSameInAnyOrderOfThePoints)
{
  const auto a = clusters_of({{4, 3}, {3, 2}, {2, 1}}, std::vector<char>(5, 0));
  const auto b = clusters_of({{2, 1}, {4, 3}, {3, 2}}, std::vector<char>(5, 0));
  ASSERT_EQ(a.clusters.size(), 1u);
  ASSERT_EQ(b.clusters.size(), 1u);
  EXPECT_EQ(a.clusters[0].nodes, b.clusters[0].nodes);
}

TEST(NodeClusters, HaveNoNodesOfOtherRanksAndAreNotLarge)
{
  std::vector<char> excluded(6, 0);
  excluded[4] = 1;
  const auto found = clusters_of({{0, 1}, {3, 4}}, excluded);
  ASSERT_EQ(found.clusters.size(), 1u);
  EXPECT_EQ(found.of_point, (std::vector<int>{0, -1}));
  EXPECT_EQ(found.covers, (std::vector<char>{1, 0}));

  Nodes all;
  for (int k = 0; k < int(NodeClusters::largest); ++k)
    all.push_back(k);
  const std::vector<char> none(NodeClusters::largest, 0);
  EXPECT_EQ(clusters_of({all}, none, 1).clusters.size(), 1u);
  EXPECT_TRUE(clusters_of({all}, none, 2).clusters.empty());
}
