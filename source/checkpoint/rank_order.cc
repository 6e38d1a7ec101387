#include "rank_order.h"

#include "core/gather.h"

#include <stdexcept>

namespace nsfd
{
  RankOrder::RankOrder(const Communicator &communicator,
                       const std::vector<Key> &keys, const std::size_t n_owned)
      : communicator_(communicator), n_items_(keys.size()), n_owned_(n_owned),
        n_global_(communicator.sum_integer(n_owned))
  {
    const auto all = nsfd::gather(communicator, keys, counts_);
    const auto n_owned_of = nsfd::gather(
        communicator, std::vector<int>{int(n_owned)}, owned_counts_);
    bool good = true;
    if (communicator.is_root()) {
      owned_counts_ = n_owned_of;
      offsets_.assign(counts_.size(), 0);
      owned_offsets_ = offsets_;
      for (std::size_t r = 1; r < counts_.size(); ++r) {
        offsets_[r] = offsets_[r - 1] + counts_[r - 1];
        owned_offsets_[r] = owned_offsets_[r - 1] + owned_counts_[r - 1];
      }
      std::vector<Key> sorted;
      sorted.reserve(n_global_);
      for (std::size_t r = 0; r < counts_.size(); ++r)
        sorted.insert(sorted.end(), all.begin() + offsets_[r],
                      all.begin() + offsets_[r] + owned_counts_[r]);
      std::sort(sorted.begin(), sorted.end());
      good = std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
      for (const Key &key : all) {
        const auto found = std::lower_bound(sorted.begin(), sorted.end(), key);
        good = good && found != sorted.end() && *found == key;
        place_.push_back(unsigned(found - sorted.begin()));
      }
    } else {
      counts_.clear();
      owned_counts_.clear();
    }
    if (communicator.any(!good))
      throw std::logic_error("keys of cells or face points are not unique");
  }
} // namespace nsfd
