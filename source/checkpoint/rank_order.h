#pragma once

#include "core/bytes_type.h"

#include "core/communicator.h"

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace nsfd
{
  /**
   * Items with keys, each owned by one rank and seen by several: the order of
   * all of them by their keys, which no number of ranks changes, and values
   * to and from it. On the first rank, 4 bytes per item of every rank.
   */
  class RankOrder
  {
  public:
    using Key = std::array<std::uint64_t, 3>;

    /**
     * @p keys of the items of this rank, of which the first @p n_owned are
     * its own. Keys are unique among the owned ones. Collective.
     */
    RankOrder(const Communicator &communicator, const std::vector<Key> &keys,
              std::size_t n_owned);

    std::size_t n_items() const { return n_items_; } ///< of this rank
    std::size_t n_global() const { return n_global_; }

    /** In the order of all, on the first rank; components are contiguous. */
    template <typename T>
    std::vector<T> gather(const std::vector<T> &values,
                          unsigned int components) const;

    /** And back, to all that see an item. */
    template <typename T>
    std::vector<T> scatter(const std::vector<T> &all,
                           unsigned int components) const;

  private:
    const Communicator &communicator_;
    std::size_t n_items_, n_owned_, n_global_ = 0;
    /// on the first rank
    std::vector<int> counts_, offsets_, owned_counts_, owned_offsets_;
    std::vector<unsigned int> place_; ///< of the items of all ranks
  };

  template <typename T>
  std::vector<T> RankOrder::gather(const std::vector<T> &values,
                                   const unsigned int components) const
  {
    const bool root = communicator_.is_root();
    std::vector<T> received(root ? n_global_ * components : 0),
        all(received.size());
    const BytesType type(components * sizeof(T));
    MPI_Gatherv(values.data(), int(n_owned_), type, received.data(),
                owned_counts_.data(), owned_offsets_.data(), type, 0,
                communicator_.mpi());
    for (std::size_t r = 0; r < owned_counts_.size(); ++r)
      for (int i = 0; i < owned_counts_[r]; ++i)
        std::copy_n(&received[std::size_t(owned_offsets_[r] + i) * components],
                    components,
                    &all[std::size_t(place_[offsets_[r] + i]) * components]);
    return all;
  }

  template <typename T>
  std::vector<T> RankOrder::scatter(const std::vector<T> &all,
                                    const unsigned int components) const
  {
    std::vector<T> sent(place_.size() * components),
        values(n_items_ * components);
    for (std::size_t i = 0; i < place_.size(); ++i)
      std::copy_n(&all[std::size_t(place_[i]) * components], components,
                  &sent[i * components]);
    const BytesType type(components * sizeof(T));
    MPI_Scatterv(sent.data(), counts_.data(), offsets_.data(), type,
                 values.data(), int(n_items_), type, 0, communicator_.mpi());
    return values;
  }
} // namespace nsfd
