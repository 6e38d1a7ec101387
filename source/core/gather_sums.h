#pragma once

#include "gather.h"
#include "order_free_sum.h"

namespace nsfd
{
  /** The values of sums over all ranks, as many of them on each. Collective. */
  inline std::vector<double> gather_sums(const Communicator &communicator,
                                         const std::vector<OrderFreeSum> &own)
  {
    std::vector<double> values(own.size());
    const auto all = gather_all(communicator, own);
    for (std::size_t k = 0; k < own.size(); ++k) {
      OrderFreeSum sum = all[k];
      for (std::size_t j = k + own.size(); j < all.size(); j += own.size())
        sum.add(all[j]);
      values[k] = sum.value();
    }
    return values;
  }
} // namespace nsfd
