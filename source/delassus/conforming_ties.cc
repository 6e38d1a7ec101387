#include "conforming_space.h"

#include "core/gather.h"

#include <algorithm>
#include <cmath>
#include <map>
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
      NodeTies::Kind kind;
      long long body, other; ///< as NodeTies::Follower

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

    /** @p masters by what follows nothing itself, @p of those that do. */
    template <typename MastersOf>
    Masters resolved(const Masters &masters, const MastersOf &of)
    {
      std::map<long long, double> sum;
      for (const auto &[master, weight] : masters)
        for (const auto &[root, share] : of(master))
          sum[root] += weight * share;
      Masters result;
      for (const auto &[root, weight] : sum)
        if (std::abs(weight) > 1e-12)
          result.emplace_back(root, weight);
      return result;
    }

    /**
     * Rigid bodies that hang together: all follow the first of them. From face
     * to face; a face that closes a loop must ask for the same as the others.
     */
    class RigidClusters
    {
    public:
      /** @p rows are of rigid bodies and sorted in their order. */
      RigidClusters(std::vector<Row> rows, std::vector<std::uint64_t> &bad)
      {
        const auto key = [](const Row &row) {
          return std::tie(row.other, row.body, row.face, row.node, row.master);
        };
        std::sort(rows.begin(), rows.end(),
                  [&](const Row &a, const Row &b) { return key(a) < key(b); });
        std::map<long long, bool> is_placed;
        for (const Row &first : rows) {
          if (is_placed[first.other])
            continue;
          is_placed[first.other] = true;
          std::vector<long long> reached{first.other};
          for (std::size_t k = 0; k < reached.size(); ++k) {
            auto row = std::lower_bound(
                rows.begin(), rows.end(), reached[k],
                [](const Row &r, const long long b) { return r.other < b; });
            while (row != rows.end() && row->other == reached[k]) {
              const Row link = *row;
              std::map<long long, Masters> asked;
              for (; row != rows.end() && row->other == link.other &&
                     row->body == link.body && row->face == link.face;
                   ++row)
                asked[row->node].emplace_back(row->master, row->weight);
              bool alike = true;
              for (auto &[node, masters] : asked) {
                masters = resolved(masters,
                                   [this](const long long m) { return of(m); });
                alike = alike && are_alike(masters, of(node));
              }
              if (!is_placed[link.body]) {
                is_placed[link.body] = true;
                reached.push_back(link.body);
                masters_.insert(asked.begin(), asked.end());
              } else if (!alike)
                bad.push_back(link.face);
            }
          }
        }
      }

      Masters of(const long long unknown) const
      {
        const auto found = masters_.find(unknown);
        return found == masters_.end() ? Masters{{unknown, 1.}} : found->second;
      }

      void add_to(std::vector<Tie> &ties) const
      {
        for (const auto &[unknown, masters] : masters_)
          for (const auto &[master, weight] : masters)
            ties.push_back({unknown, master, weight});
        std::stable_sort(
            ties.begin(), ties.end(),
            [](const Tie &a, const Tie &b) { return a.number < b.number; });
      }

    private:
      std::map<long long, Masters> masters_; ///< of unknowns that follow
    };
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
      for (std::size_t k = 0; faces[f] && k < ties_.of_face[f].size(); ++k) {
        const NodeTies::Follower &tie = ties_.of_face[f][k];
        for (const auto &[master, weight] : tie.masters)
          rows.push_back({name(tie.unknown), ties_.key[f], name(master), weight,
                          ties_.kind[f], name(tie.body), name(tie.other)});
      }
    rows = gather_all(communicator_, rows);
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end(),
                           [](const Row &a, const Row &b) {
                             return a.key() == b.key();
                           }),
               rows.end());
    std::vector<std::uint64_t> bad; // keys of faces
    const auto of_nodes =
        std::stable_partition(rows.begin(), rows.end(), [](const Row &row) {
          return row.kind != NodeTies::Kind::both_rigid;
        });
    const RigidClusters clusters({of_nodes, rows.end()}, bad);
    rows.erase(of_nodes, rows.end());
    const auto follows = [&rows](const long long node) {
      const auto row = std::lower_bound(
          rows.begin(), rows.end(), node,
          [](const Row &r, const long long n) { return r.node < n; });
      return row != rows.end() && row->node == node;
    };
    std::vector<Tie> result;
    Masters taken;
    for (auto row = rows.begin(); row != rows.end();) {
      const long long node = row->node;
      const std::uint64_t face = row->face;
      const bool is_new = result.empty() || result.back().number != node,
                 on_rigid = row->kind == NodeTies::Kind::on_rigid;
      Masters asked;
      bool valid = true;
      for (; row != rows.end() && row->node == node && row->face == face;
           ++row) {
        asked.emplace_back(row->master, row->weight);
        valid = valid && !follows(row->master);
      }
      if (on_rigid)
        asked =
            resolved(asked, [&](const long long m) { return clusters.of(m); });
      if (!valid || (!is_new && !are_alike(asked, taken)))
        bad.push_back(face);
      else if (is_new) {
        taken = asked;
        for (const auto &[master, weight] : taken)
          result.push_back({node, master, weight});
      }
    }
    clusters.add_to(result);
    std::sort(bad.begin(), bad.end());
    for (std::size_t f = 0; f < faces.size(); ++f)
      contradicting[f] =
          faces[f] && std::binary_search(bad.begin(), bad.end(), ties_.key[f]);
    return result;
  }

  /** By unknown the first one that is the same if @p joined are joined. */
  std::vector<double> ConformingSpace::names(const std::vector<char> &joined)
  {
    join(joined);
    std::vector<double> first(unknowns_.component.size()); // below 2^53
    for (std::size_t i = 0; i < first.size(); ++i)
      first[i] = double(unknowns_.first) + double(i);
    agree(first, true);
    joined_ = DisjointSets();
    return first;
  }

  std::vector<char>
  ConformingSpace::without_contradiction(std::vector<char> faces)
  {
    for (bool changed = has_ties_; communicator_.any(changed);) {
      changed = false;
      std::vector<char> contradicting;
      ties_of(faces, names(faces), contradicting);
      for (std::size_t f = 0; f < faces.size(); ++f)
        if (contradicting[f]) {
          changed = true;
          faces[f] = 0;
        }
    }
    return faces;
  }

  std::vector<char> ConformingSpace::jumping(const std::vector<char> &joined)
  {
    const std::vector<double> first = names(joined);
    std::vector<double> ghosts(ghosts_.size());
    exchange_.fetch(first.data(), ghosts.data());
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
      for (const NodeTies::Follower &tie : ties_.of_face[f]) {
        Masters asked;
        for (const auto &[master, weight] : tie.masters)
          asked.emplace_back(name(master), weight);
        asked = resolved(
            asked, [&](const long long m) { return masters_of(ties, m); });
        if (!are_alike(asked, masters_of(ties, name(tie.unknown))))
          result[f] = 1;
      }
    }
    return result;
  }
} // namespace nsfd
