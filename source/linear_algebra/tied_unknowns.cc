#include "tied_unknowns.h"

#include "sparse_rows.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace nsfd
{
  namespace
  {
    using Tie = CoarseSpace::Tie;

    /** The ties of @p number: none if it follows nothing. */
    std::pair<const Tie *, const Tie *> ties_of(const CoarseSpace &space,
                                                const long long number)
    {
      const auto less = [](const Tie &tie, const long long n) {
        return tie.number < n;
      };
      const Tie *const end = space.ties.data() + space.ties.size();
      const Tie *const first =
          std::lower_bound(space.ties.data(), end, number, less);
      const Tie *last = first;
      while (last != end && last->number == number)
        ++last;
      return {first, last};
    }
  } // namespace

  TiedUnknowns::TiedUnknowns(const Communicator &communicator,
                             const CoarseSpace &space)
      : communicator_(&communicator), space_(&space)
  {
    const long long end = space.first + space.n_own;
    const auto is_own = [&](const long long number) {
      return number >= space.first && number < end;
    };
    std::vector<long long> ghosts;
    for (const Tie &tie : space.ties)
      if (is_own(tie.number) && !is_own(tie.master))
        ghosts.push_back(tie.master);
    std::sort(ghosts.begin(), ghosts.end());
    ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
    n_ghosts_ = ghosts.size();
    exchange_ = GhostValues(communicator, space.first, std::size_t(space.n_own),
                            ghosts);
    for (std::size_t k = 0; k < space.ties.size(); ++k) {
      const Tie &tie = space.ties[k];
      if (!is_own(tie.number))
        continue;
      if (k == 0 || space.ties[k - 1].number != tie.number) {
        tied_.push_back(int(tie.number - space.first));
        first_.push_back(shares_.size());
      }
      shares_.push_back(
          {is_own(tie.master)
               ? int(tie.master - space.first)
               : int(space.n_own + (std::lower_bound(ghosts.begin(),
                                                     ghosts.end(), tie.master) -
                                    ghosts.begin())),
           tie.weight});
    }
    first_.push_back(shares_.size());
  }

  /** @p take (entry of A, part), entry by entry. */
  template <typename Take>
  void TiedUnknowns::for_all_parts(const SparseRows &A, const Take &take) const
  {
    const auto number = [&](const int column) {
      return column < A.n_rows() ? A.first_row + column
                                 : A.ghosts[std::size_t(column - A.n_rows())];
    };
    // of own columns, then ghosts
    std::vector<std::pair<const Tie *, const Tie *>> ties;
    for (std::size_t k = 0; k < std::size_t(A.n_rows()) + A.ghosts.size(); ++k)
      ties.push_back(ties_of(*space_, number(int(k))));
    for (int r = 0; r < A.n_rows(); ++r) {
      const auto [row, row_end] = ties[std::size_t(r)];
      for (int k = A.start[r]; k < A.start[r + 1]; ++k) {
        const int c = A.column[k];
        const auto [column, column_end] = ties[std::size_t(c)];
        const auto take_columns = [&, column = column, column_end = column_end](
                                      const long long at, const double a) {
          if (column == column_end)
            take(std::size_t(k), Part{at, number(c), a});
          for (const Tie *tie = column; tie != column_end; ++tie)
            take(std::size_t(k), Part{at, tie->master, a * tie->weight});
        };
        if (row == row_end)
          take_columns(number(r), 1.);
        for (const Tie *tie = row; tie != row_end; ++tie)
          take_columns(tie->master, tie->weight);
        if (r == c && row != row_end)
          take(std::size_t(k), Part{number(r), number(r), 1.});
      }
    }
  }

  void TiedUnknowns::make_plan(const SparseRows &A)
  {
    plan_ = {};
    plan_.start = A.start;
    plan_.column = A.column;
    std::vector<Part> parts;
    parts.reserve(A.value.size());
    plan_.first.reserve(A.value.size() + 1);
    std::vector<std::size_t> first(A.start.size(), 0); // of rows
    for_all_parts(A, [&](const std::size_t entry, const Part &part) {
      plan_.first.resize(entry + 1, parts.size());
      parts.push_back(part);
      ++first[std::size_t(part.row) + 1];
    });
    plan_.first.resize(A.value.size() + 1, parts.size());
    plan_.target.resize(parts.size());
    plan_.weight.reserve(parts.size());
    for (const Part &part : parts)
      plan_.weight.push_back(part.weight);
    // by rows, then within them
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::pair<int, std::size_t>> places(parts.size());
    auto next = first;
    for (std::size_t k = 0; k < parts.size(); ++k)
      places[next[std::size_t(parts[k].row)]++] = {int(parts[k].column), k};
    SparseRows &result = plan_.result;
    result.start.assign(1, 0);
    for (std::size_t r = 0; r + 1 < first.size(); ++r) {
      std::sort(places.begin() + long(first[r]),
                places.begin() + long(first[r + 1]));
      for (std::size_t k = first[r]; k < first[r + 1]; ++k) {
        if (k == first[r] || places[k - 1].first != places[k].first)
          result.column.push_back(places[k].first);
        plan_.target[places[k].second] = result.column.size() - 1;
      }
      result.start.push_back(int(result.column.size()));
    }
  }

  SparseRows TiedUnknowns::fold(const SparseRows &A)
  {
    if (communicator_->size() > 1) {
      std::vector<SparseEntry> entries;
      entries.reserve(A.value.size());
      for_all_parts(A, [&](const std::size_t entry, const Part &part) {
        entries.push_back(
            {part.row, part.column, part.weight * A.value[entry]});
      });
      return sum_at_owners(*communicator_, *space_, std::move(entries));
    }
    if (plan_.start != A.start || plan_.column != A.column)
      make_plan(A);
    SparseRows result = plan_.result;
    result.value.assign(result.column.size(), 0.);
    for (std::size_t entry = 0; entry < A.value.size(); ++entry)
      for (std::size_t k = plan_.first[entry]; k < plan_.first[entry + 1]; ++k)
        result.value[plan_.target[k]] += plan_.weight[k] * A.value[entry];
    return result;
  }

  void TiedUnknowns::fold(double *b) const
  {
    std::vector<double> ghosts(n_ghosts_, 0.);
    const auto n_own = int(space_->n_own);
    for (std::size_t t = 0; t < tied_.size(); ++t) {
      for (std::size_t k = first_[t]; k < first_[t + 1]; ++k) {
        const Share &share = shares_[k];
        (share.master < n_own ? b[share.master]
                              : ghosts[std::size_t(share.master - n_own)]) +=
            share.weight * b[tied_[t]];
      }
      b[tied_[t]] = 0.;
    }
    exchange_.start_add_back(ghosts.data());
    exchange_.finish_add_back(b);
  }

  void TiedUnknowns::follow(double *x) const
  {
    std::vector<double> ghosts(n_ghosts_);
    exchange_.fetch(x, ghosts.data());
    const auto n_own = int(space_->n_own);
    for (std::size_t t = 0; t < tied_.size(); ++t) {
      double sum = 0.;
      for (std::size_t k = first_[t]; k < first_[t + 1]; ++k) {
        const Share &share = shares_[k];
        sum += share.weight * (share.master < n_own
                                   ? x[share.master]
                                   : ghosts[std::size_t(share.master - n_own)]);
      }
      x[tied_[t]] = sum;
    }
  }
} // namespace nsfd
