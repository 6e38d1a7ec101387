#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace nsfd
{
  /**
   * Numbers 0 to n - 1 in sets that grow together: cells that joined faces make
   * one body, corners of cells that are one node. The smallest member names a
   * set, whatever order they were joined in.
   */
  class DisjointSets
  {
  public:
    explicit DisjointSets(const std::size_t n = 0) : parent_(n)
    {
      std::iota(parent_.begin(), parent_.end(), 0u);
    }

    std::size_t size() const { return parent_.size(); }

    /** The smallest member of the set of @p i. */
    unsigned int first(unsigned int i)
    {
      while (parent_[i] != i)
        i = parent_[i] = parent_[parent_[i]];
      return i;
    }

    void join(const unsigned int i, const unsigned int j)
    {
      const unsigned int a = first(i), b = first(j);
      parent_[std::max(a, b)] = std::min(a, b);
    }

    /** By member: the number of its set, counted by their first members. */
    std::vector<unsigned int> numbers(unsigned int &n_sets)
    {
      n_sets = 0;
      std::vector<unsigned int> result(size());
      for (unsigned int i = 0; i < size(); ++i)
        result[i] = first(i) == i ? n_sets++ : result[first(i)];
      return result;
    }

  private:
    std::vector<unsigned int> parent_;
  };
} // namespace nsfd
