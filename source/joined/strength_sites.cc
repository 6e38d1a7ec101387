#include "strength_sites.h"

#include <algorithm>
#include <numeric>

namespace nsfd
{
  namespace
  {
    constexpr unsigned int bits = 64;

    /** Blocks that a site is in: one or two. */
    template <typename Site, typename Visit>
    void for_blocks(const Site &site, const unsigned int cells_of_block,
                    Visit &&visit)
    {
      const unsigned int one = site.cells[0] / cells_of_block,
                         other = site.cells[1] / cells_of_block;
      visit(one);
      if (other != one)
        visit(other);
    }
  } // namespace

  template <int dim>
  void StrengthSites<dim>::finish(const std::size_t n_cells)
  {
    const std::size_t n_blocks =
        (n_cells + cells_of_block - 1) / cells_of_block;
    first_of_block_.assign(n_blocks + 1, 0);
    for (const Site &site : sites_)
      for_blocks(site, cells_of_block, [this](const unsigned int block) {
        ++first_of_block_[block + 1];
      });
    std::partial_sum(first_of_block_.begin(), first_of_block_.end(),
                     first_of_block_.begin());
    of_block_.resize(first_of_block_.back());
    auto next = first_of_block_;
    for (unsigned int k = 0; k < sites_.size(); ++k)
      for_blocks(sites_[k], cells_of_block, [&](const unsigned int block) {
        of_block_[next[block]++] = k;
      });
    least_.resize(n_blocks);
    for (std::size_t block = 0; block < n_blocks; ++block)
      set_least(block);
    marks_.assign((sites_.size() + bits - 1) / bits, 0);
  }

  template <int dim>
  void StrengthSites<dim>::set_least(const std::size_t block)
  {
    double least = std::numeric_limits<double>::infinity();
    for (unsigned int j = first_of_block_[block];
         j < first_of_block_[block + 1]; ++j)
      if (!is_released(of_block_[j]))
        least = std::min(least, sites_[of_block_[j]].least);
    least_[block] = least;
  }

  template <int dim>
  void StrengthSites<dim>::release(const std::size_t site)
  {
    sites_[site].limit = std::numeric_limits<double>::infinity();
    for_blocks(sites_[site], cells_of_block,
               [this](const unsigned int block) { set_least(block); });
  }

  template <int dim>
  void StrengthSites<dim>::set_limits(const std::vector<Limits> &limits)
  {
    for (std::size_t site = 0; site < sites_.size(); ++site)
      if (!is_released(site)) {
        sites_[site].limit = limits[site].limit;
        sites_[site].least = limits[site].least;
      }
    for (std::size_t block = 0; block < least_.size(); ++block)
      set_least(block);
  }

  template <int dim>
  void StrengthSites<dim>::find(const std::vector<double> &bounds,
                                Near &near) const
  {
    constexpr double quiet = looked_at * looked_at;
    near.site.clear();
    bool any = false;
    for (std::size_t block = 0; block < least_.size(); ++block) {
      // what is not a number is looked at
      if (bounds[block] < quiet * least_[block])
        continue;
      any = true;
      for (unsigned int j = first_of_block_[block];
           j < first_of_block_[block + 1]; ++j)
        marks_[of_block_[j] / bits] |= std::uint64_t(1) << of_block_[j] % bits;
    }
    for (std::size_t word = 0; any && word < marks_.size(); ++word)
      for (std::uint64_t &left = marks_[word]; left != 0; left &= left - 1) {
        const auto k =
            unsigned(word * bits + std::size_t(__builtin_ctzll(left)));
        const Site &site = sites_[k];
        const double one = bounds[site.cells[0] / cells_of_block],
                     other = bounds[site.cells[1] / cells_of_block];
        if (!is_released(k) &&
            !((one > other ? one : other) < quiet * site.least))
          near.site.push_back(k);
      }
    near.square.assign(near.site.size(), 0.);
  }

  template class StrengthSites<2>;
  template class StrengthSites<3>;
} // namespace nsfd
