#include "conforming_space.h"

#include "core/gather.h"

#include <algorithm>
#include <cmath>
#include <tuple>

// What follows the nodes of larger cells in a space of common nodes.

namespace nsfd
{
  namespace
  {
    using Tie = CoarseSpace::Tie;
    using Masters = std::vector<std::pair<long long, double>>;

    /** That @p face asks for. */
    struct Row {
      long long node;
      std::uint64_t face;
      long long master;
      double weight;

      auto key() const { return std::tie(node, face, master); }
      bool operator<(const Row &other) const { return key() < other.key(); }
    };

    bool are_alike(const Masters &a, const Masters &b)
    {
      return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                        [](const auto &x, const auto &y) {
                          return x.first == y.first &&
                                 std::abs(x.second - y.second) < 1e-9;
                        });
    }

    /** Of a node that may follow others; itself if it does not. */
    Masters masters_of(const std::vector<Tie> &ties, const long long node)
    {
      Masters result;
      for (auto tie = std::lower_bound(
               ties.begin(), ties.end(), node,
               [](const Tie &t, const long long n) { return t.number < n; });
           tie != ties.end() && tie->number == node; ++tie)
        result.emplace_back(tie->master, tie->weight);
      if (result.empty())
        result.emplace_back(node, 1.);
      return result;
    }
  } // namespace

  double ConformingSpace::value_at(const long long unknown,
                                   const std::vector<double> &own,
                                   const std::vector<double> &ghosts) const
  {
    const long long mine = unknown - unknowns_.first;
    return mine >= 0 && mine < static_cast<long long>(own.size())
               ? own[std::size_t(mine)]
               : ghosts[std::size_t(
                     std::lower_bound(ghosts_.begin(), ghosts_.end(), unknown) -
                     ghosts_.begin())];
  }

  /**
   * Of the marked faces, with @p own values for the names of unknowns. A node
   * at several larger cells follows that of the first face, in an order that
   * all ranks know; faces that ask for something else are @p contradicting.
   */
  std::vector<Tie> ConformingSpace::ties_of(const std::vector<char> &faces,
                                            const std::vector<double> &own,
                                            std::vector<char> &contradicting)
  {
    contradicting.assign(faces.size(), 0);
    if (!has_ties_)
      return {};
    std::vector<double> ghosts(ghosts_.size());
    exchange_.fetch(own.data(), ghosts.data());
    const auto name = [&](const long long unknown) {
      return static_cast<long long>(value_at(unknown, own, ghosts));
    };
    std::vector<Row> rows;
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (std::size_t k = 0; faces[f] && k < ties_.of_face[f].size(); ++k)
        for (unsigned int c = 0; c < dim_; ++c) {
          const NodeTies::Node &tie = ties_.of_face[f][k];
          for (const auto &[master, weight] : tie.masters)
            rows.push_back(
                {name(tie.node + c), ties_.key[f], name(master + c), weight});
        }
    rows = gather_all(communicator_, rows);
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end(),
                           [](const Row &a, const Row &b) {
                             return a.key() == b.key();
                           }),
               rows.end());
    const auto follows = [&rows](const long long node) {
      const auto row = std::lower_bound(
          rows.begin(), rows.end(), node,
          [](const Row &r, const long long n) { return r.node < n; });
      return row != rows.end() && row->node == node;
    };
    std::vector<Tie> result;
    std::vector<std::uint64_t> bad; // keys of faces
    Masters taken;
    for (auto row = rows.begin(); row != rows.end();) {
      const long long node = row->node;
      const std::uint64_t face = row->face;
      const bool is_new = result.empty() || result.back().number != node;
      Masters asked;
      bool valid = true;
      for (; row != rows.end() && row->node == node && row->face == face;
           ++row) {
        asked.emplace_back(row->master, row->weight);
        valid = valid && !follows(row->master);
      }
      if (!valid || (!is_new && !are_alike(asked, taken)))
        bad.push_back(face);
      else if (is_new) {
        taken = asked;
        for (const auto &[master, weight] : taken)
          result.push_back({node, master, weight});
      }
    }
    std::sort(bad.begin(), bad.end());
    for (std::size_t f = 0; f < faces.size(); ++f)
      contradicting[f] =
          faces[f] && std::binary_search(bad.begin(), bad.end(), ties_.key[f]);
    return result;
  }

  std::vector<char> ConformingSpace::jumping(const std::vector<char> &joined)
  {
    join(joined);
    const std::size_t n = unknowns_.component.size();
    std::vector<double> first(n), ghosts(ghosts_.size()); // below 2^53
    for (std::size_t i = 0; i < n; ++i)
      first[i] = double(unknowns_.first) + double(i);
    agree(first, true);
    exchange_.fetch(first.data(), ghosts.data());
    joined_ = DisjointSets();
    std::vector<char> contradicting;
    const auto ties = ties_of(joined, first, contradicting);
    const auto name = [&](const long long unknown) {
      return static_cast<long long>(value_at(unknown, first, ghosts));
    };
    std::vector<char> result(joined.size());
    for (std::size_t f = 0; f < joined.size(); ++f) {
      result[f] = !is_complete(f);
      for (std::size_t k = pairs_.start[f]; k < pairs_.start[f + 1]; ++k) {
        const long long own = name(unknowns_.first + pairs_.own[k]),
                        other = name(pairs_.other[k]);
        if (own != other &&
            !are_alike(masters_of(ties, own), masters_of(ties, other)))
          result[f] = 1;
      }
      if (!is_tied(f))
        continue;
      for (const NodeTies::Node &tie : ties_.of_face[f]) {
        Masters asked;
        for (const auto &[master, weight] : tie.masters)
          asked.emplace_back(name(master), weight);
        std::sort(asked.begin(), asked.end());
        if (!are_alike(asked, masters_of(ties, name(tie.node))))
          result[f] = 1;
      }
    }
    return result;
  }
} // namespace nsfd
