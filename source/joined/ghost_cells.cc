#include "ghost_cells.h"

#include "core/gather.h"

#include <algorithm>
#include <stdexcept>

namespace nsfd
{
  GhostCells::GhostCells(const Communicator &communicator,
                         const std::vector<unsigned long long> &numbers,
                         std::vector<std::uint8_t> ghost)
      : communicator_(communicator), ghost_(std::move(ghost)), number_(numbers)
  {
    std::vector<std::size_t> ghosts;
    for (std::size_t b = 0; b < ghost_.size(); ++b)
      (ghost_[b] ? ghosts : own_).push_back(b);
    std::sort(own_.begin(), own_.end(),
              [this](const std::size_t a, const std::size_t b) {
                return number_[a] < number_[b];
              });
    for (std::size_t k = 0; k < own_.size(); ++k)
      if (number_[own_[k]] != number_[own_[0]] + k)
        throw std::logic_error("cells of a rank are not numbered in a row");
    // a rank without cells begins where the one before it ends
    const auto per_rank = gather_all<unsigned long long>(
        communicator, {static_cast<unsigned long long>(own_.size())});
    for (int r = 0; r < communicator.rank(); ++r)
      first_ += per_rank[r];
    all_ = std::make_unique<const Wanted>(*this, 1, std::move(ghosts));
  }

  GhostCells::Wanted::Wanted(const GhostCells &cells, const unsigned int n,
                             std::vector<std::size_t> which)
      : cells_(cells), n_(n), which_(std::move(which))
  {
    const auto number = [&](const std::size_t thing) {
      return static_cast<long long>(cells.number_[thing / n] * n + thing % n);
    };
    std::sort(which_.begin(), which_.end(),
              [&](const std::size_t a, const std::size_t b) {
                return number(a) < number(b);
              });
    std::vector<long long> numbers;
    for (const std::size_t thing : which_)
      numbers.push_back(number(thing));
    values_ = GhostValues(cells.communicator_,
                          static_cast<long long>(cells.first_ * n),
                          cells.own_.size() * n, numbers);
  }
} // namespace nsfd
