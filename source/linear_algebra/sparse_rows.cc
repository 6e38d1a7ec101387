#include "sparse_rows.h"

#include <algorithm>

namespace nsfd
{
  void multiply(const SparseRows &A, const GhostValues &exchange, double *x,
                double *y)
  {
    const int n = A.n_rows();
    const int *column = A.column.data();
    const double *value = A.value.data();
    const auto row = [&](const int i) {
      double sum = 0.;
      for (int k = A.start[i]; k < A.start[i + 1]; ++k)
        sum += value[k] * x[column[k]];
      y[i] = sum;
    };
    exchange.start_fetch(x);
    // columns ascend: a row with ghosts ends with one
    const auto needs_ghosts = [&](const int i) {
      return A.start[i + 1] > A.start[i] && column[A.start[i + 1] - 1] >= n;
    };
    for (int i = 0; i < n; ++i)
      if (!needs_ghosts(i))
        row(i);
    exchange.finish_fetch(x + n);
    if (!A.ghosts.empty())
      for (int i = 0; i < n; ++i)
        if (needs_ghosts(i))
          row(i);
  }

  namespace
  {
    using Entry = SparseEntry;

    /** Rows of P^T A P as far as this rank contributes, ascending. */
    template <typename Take>
    void sum_rows(const SparseRows &A, const CoarseSpace &coarse,
                  const std::vector<long long> &ghost_numbers, const Take &take)
    {
      const int n = A.n_rows();
      // fine rows by coarse row
      std::vector<std::pair<long long, int>> order(n);
      for (int i = 0; i < n; ++i)
        order[i] = {coarse.number[i], i};
      std::sort(order.begin(), order.end());
      std::vector<std::pair<long long, double>> row;
      for (int first = 0; first < n;) {
        int end = first;
        row.clear();
        for (; end < n && order[end].first == order[first].first; ++end) {
          const int i = order[end].second;
          for (int k = A.start[i]; k < A.start[i + 1]; ++k) {
            const int j = A.column[k];
            row.emplace_back(j < n ? coarse.number[j] : ghost_numbers[j - n],
                             A.value[k]);
          }
        }
        // equal columns in the order in which they were met: reproducible
        std::stable_sort(
            row.begin(), row.end(),
            [](const auto &a, const auto &b) { return a.first < b.first; });
        std::size_t kept = 0;
        for (std::size_t k = 1; k < row.size(); ++k)
          if (row[k].first == row[kept].first)
            row[kept].second += row[k].second;
          else
            row[++kept] = row[k];
        row.resize(kept + 1);
        take(order[first].first, row);
        first = end;
      }
    }

    /** Send the rows of other ranks to their owners; returns what arrived. */
    std::vector<Entry> to_owners(const Communicator &communicator,
                                 const CoarseSpace &coarse,
                                 std::vector<Entry> entries)
    {
      const int n = communicator.size();
      const MPI_Comm mpi = communicator.mpi();
      const long long end = coarse.first + coarse.n_own;
      std::vector<long long> ends(n);
      MPI_Allgather(&end, 1, MPI_LONG_LONG, ends.data(), 1, MPI_LONG_LONG, mpi);
      std::sort(entries.begin(), entries.end());
      std::vector<int> out(n, 0), in(n), from(n, 0), to(n, 0);
      for (const Entry &entry : entries)
        out[std::upper_bound(ends.begin(), ends.end(), entry.row) -
            ends.begin()] += int(sizeof(Entry));
      MPI_Alltoall(out.data(), 1, MPI_INT, in.data(), 1, MPI_INT, mpi);
      for (int r = 1; r < n; ++r) {
        from[r] = from[r - 1] + out[r - 1];
        to[r] = to[r - 1] + in[r - 1];
      }
      std::vector<Entry> arrived((to.back() + in.back()) / sizeof(Entry));
      MPI_Alltoallv(entries.data(), out.data(), from.data(), MPI_BYTE,
                    arrived.data(), in.data(), to.data(), MPI_BYTE, mpi);
      std::stable_sort(arrived.begin(), arrived.end());
      return arrived;
    }
  } // namespace

  namespace
  {
    /** Own rows with global @p columns, to local ones. */
    void number_columns(const CoarseSpace &coarse,
                        const std::vector<long long> &columns,
                        SparseRows &result)
    {
      const auto own = [&](const long long column) {
        return column >= coarse.first && column < coarse.first + coarse.n_own;
      };
      for (const long long column : columns)
        if (!own(column))
          result.ghosts.push_back(column);
      std::sort(result.ghosts.begin(), result.ghosts.end());
      result.ghosts.erase(
          std::unique(result.ghosts.begin(), result.ghosts.end()),
          result.ghosts.end());
      result.column.resize(columns.size());
      for (std::size_t k = 0; k < columns.size(); ++k)
        result.column[k] =
            own(columns[k])
                ? int(columns[k] - coarse.first)
                : int(coarse.n_own +
                      (std::lower_bound(result.ghosts.begin(),
                                        result.ghosts.end(), columns[k]) -
                       result.ghosts.begin()));
      // ascending: ghosts of earlier ranks go behind what is owned
      for (int i = 0; i < result.n_rows(); ++i) {
        const auto first = result.column.begin() + result.start[i],
                   last = result.column.begin() + result.start[i + 1];
        const auto owned = [&](const int column) {
          return column < int(coarse.n_own);
        };
        const auto begin = std::find_if(first, last, owned),
                   end = std::find_if_not(begin, last, owned);
        const auto values = result.value.begin();
        std::rotate(values + (first - result.column.begin()),
                    values + (begin - result.column.begin()),
                    values + (end - result.column.begin()));
        std::rotate(first, begin, end);
      }
    }
  } // namespace

  SparseRows sum_at_owners(const Communicator &communicator,
                           const CoarseSpace &coarse,
                           std::vector<SparseEntry> entries)
  {
    SparseRows result;
    result.first_row = coarse.first;
    result.start.assign(coarse.n_own + 1, 0);
    std::vector<long long> columns; // global
    const auto all = to_owners(communicator, coarse, std::move(entries));
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (k > 0 && all[k].row == all[k - 1].row &&
          all[k].column == all[k - 1].column) {
        result.value.back() += all[k].value;
        continue;
      }
      columns.push_back(all[k].column);
      result.value.push_back(all[k].value);
      result.start[all[k].row - coarse.first + 1] = int(columns.size());
    }
    number_columns(coarse, columns, result);
    return result;
  }

  SparseRows coarse_rows(const Communicator &communicator, const SparseRows &A,
                         const CoarseSpace &coarse,
                         const std::vector<long long> &ghost_numbers)
  {
    if (communicator.size() > 1) {
      std::vector<Entry> all;
      sum_rows(A, coarse, ghost_numbers,
               [&](const long long row, auto &entries) {
                 for (const auto &[column, value] : entries)
                   all.push_back({row, column, value});
               });
      return sum_at_owners(communicator, coarse, std::move(all));
    }
    SparseRows result;
    result.first_row = coarse.first;
    result.start.assign(coarse.n_own + 1, 0);
    std::vector<long long> columns; // global
    sum_rows(A, coarse, ghost_numbers, [&](const long long row, auto &entries) {
      for (const auto &[column, value] : entries) {
        columns.push_back(column);
        result.value.push_back(value);
      }
      result.start[row + 1] = int(columns.size());
    });
    number_columns(coarse, columns, result);
    return result;
  }
} // namespace nsfd
