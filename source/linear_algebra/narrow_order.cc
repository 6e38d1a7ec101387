#include "narrow_order.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    using Graph = std::vector<std::vector<int>>;

    /** Layer by layer from @p start, those with few neighbours first; how many
        layers there are. */
    int add_layers(const Graph &graph, const int start, std::vector<char> &done,
                   std::vector<int> &order)
    {
      const auto fewer = [&graph](const int i, const int j) {
        const auto n = graph[std::size_t(i)].size(),
                   m = graph[std::size_t(j)].size();
        return n != m ? n < m : i < j;
      };
      std::size_t next = order.size(), end = next + 1;
      order.push_back(start);
      done[std::size_t(start)] = 1;
      int layers = 0;
      for (; next < order.size(); ++layers, end = order.size())
        for (; next < end; ++next) {
          const std::size_t first = order.size();
          for (const int j : graph[std::size_t(order[next])])
            if (!done[std::size_t(j)]) {
              done[std::size_t(j)] = 1;
              order.push_back(j);
            }
          std::sort(order.begin() + long(first), order.end(), fewer);
        }
      return layers;
    }
  } // namespace

  std::vector<int> narrow_order(const std::vector<std::vector<int>> &neighbors)
  {
    std::vector<int> order;
    order.reserve(neighbors.size());
    std::vector<char> done(neighbors.size(), 0);
    for (int i = 0; i < int(neighbors.size()); ++i) {
      if (done[std::size_t(i)])
        continue;
      // from an end of the part: as many layers as there are
      const std::size_t first = order.size();
      int start = i, layers = 0;
      for (unsigned int attempt = 0; attempt < 4; ++attempt) {
        const int n = add_layers(neighbors, start, done, order);
        const int last = order.back();
        for (std::size_t k = first; k < order.size(); ++k)
          done[std::size_t(order[k])] = 0;
        order.resize(first);
        if (n <= layers)
          break;
        layers = n;
        start = last;
      }
      add_layers(neighbors, start, done, order);
    }
    return order;
  }
} // namespace nsfd
