#include "core/disjoint_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace nsfd::test_disjoint_sets
{
  // {0 3 5} {1} {2 4}, in every order of the pairs that say so.
  TEST(DisjointSets, AreNamedByTheirFirstMembers)
  {
    std::vector<std::array<unsigned int, 2>> pairs = {
        {{5, 3}}, {{4, 2}}, {{3, 0}}, {{5, 0}}};
    std::mt19937 random(1);
    for (unsigned int k = 0; k < 24; ++k) {
      std::shuffle(pairs.begin(), pairs.end(), random);
      DisjointSets sets(6);
      for (const auto &pair : pairs)
        sets.join(pair[0], pair[1]);
      const unsigned int first[] = {0, 1, 2, 0, 2, 0};
      for (unsigned int i = 0; i < 6; ++i)
        EXPECT_EQ(sets.first(i), first[i]);
      unsigned int n = 0;
      EXPECT_EQ(sets.numbers(n), (std::vector<unsigned int>{0, 1, 2, 0, 2, 0}));
      EXPECT_EQ(n, 3u);
    }
  }
} // namespace nsfd::test_disjoint_sets
