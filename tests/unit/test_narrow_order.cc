#include "linear_algebra/narrow_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace nsfd::test_narrow_order
{
  using Graph = std::vector<std::vector<int>>;

  /** Places of a grid, numbered at random. */
  Graph grid(const int nx, const int ny)
  {
    std::vector<int> number(std::size_t(nx * ny));
    for (int i = 0; i < nx * ny; ++i)
      number[std::size_t(i)] = i;
    std::mt19937 random(7);
    std::shuffle(number.begin(), number.end(), random);
    Graph graph(number.size());
    const auto join = [&](const int i, const int j) {
      const int a = number[std::size_t(i)], b = number[std::size_t(j)];
      graph[std::size_t(a)].push_back(b);
      graph[std::size_t(b)].push_back(a);
    };
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        if (x + 1 < nx)
          join(y * nx + x, y * nx + x + 1);
        if (y + 1 < ny)
          join(y * nx + x, (y + 1) * nx + x);
      }
    return graph;
  }

  int bandwidth(const Graph &graph, const std::vector<int> &order)
  {
    std::vector<int> place(order.size(), -1);
    for (std::size_t k = 0; k < order.size(); ++k)
      place[std::size_t(order[k])] = int(k);
    int width = 0;
    for (std::size_t i = 0; i < graph.size(); ++i)
      for (const int j : graph[i])
        width = std::max(width, std::abs(place[i] - place[std::size_t(j)]));
    return width;
  }

  TEST(NarrowOrder, OfAGridIsItsShortSide)
  {
    const Graph graph = grid(40, 5);
    const auto order = narrow_order(graph);
    std::vector<int> sorted(order);
    std::sort(sorted.begin(), sorted.end());
    for (int i = 0; i < 200; ++i)
      ASSERT_EQ(sorted[std::size_t(i)], i);
    EXPECT_LE(bandwidth(graph, order), 6);
  }

  TEST(NarrowOrder, PartsComeOneAfterTheOther)
  {
    // 0 - 3 - 4, 1 - 2, 5
    EXPECT_EQ(narrow_order({{3}, {2}, {1}, {0, 4}, {3}, {}}),
              (std::vector<int>{4, 3, 0, 2, 1, 5}));
    EXPECT_TRUE(narrow_order({}).empty());
  }
} // namespace nsfd::test_narrow_order
