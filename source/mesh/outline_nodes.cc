#include "plane_outline.h"

#include "size_field.h"

#include "core/mix_bits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    constexpr unsigned int none = std::numeric_limits<unsigned int>::max();

    PlanePoint between(const PlanePoint &a, const PlanePoint &b, const double t)
    {
      // exact where a coordinate is that of both
      return {{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])}};
    }

    double distance(const PlanePoint &a, const PlanePoint &b)
    {
      return std::hypot(b[0] - a[0], b[1] - a[1]);
    }

    /** A line through points of the outline, from one that stays to another. */
    struct Chain {
      std::vector<unsigned int> points; ///< closed: the first is the last
      unsigned int set;
    };

    /** Takes an outline apart into chains. */
    class Chains
    {
    public:
      explicit Chains(const PlaneOutline &outline)
          : outline_(outline), at_(outline.points.size()),
            is_used_(outline.lines.size(), false)
      {
        for (unsigned int l = 0; l < outline.lines.size(); ++l)
          for (const unsigned int p :
               {outline.lines[l].first, outline.lines[l].last})
            at_[p].push_back(l);
      }

      std::vector<Chain> all()
      {
        std::vector<Chain> chains;
        for (unsigned int p = 0; p < at_.size(); ++p)
          if (stays(p))
            for (const unsigned int l : at_[p])
              if (!is_used_[l])
                chains.push_back(from(p, l));
        // closed ones without a corner
        for (unsigned int l = 0; l < is_used_.size(); ++l)
          if (!is_used_[l])
            chains.push_back(from(outline_.lines[l].first, l));
        return chains;
      }

      bool stays(const unsigned int p) const
      {
        if (at_[p].size() != 2)
          return !at_[p].empty();
        const auto &lines = outline_.lines;
        const unsigned int a = at_[p][0], b = at_[p][1];
        if (lines[a].set != lines[b].set)
          return true;
        const PlanePoint &x = outline_.points[p],
                         &from = outline_.points[other(a, p)],
                         &to = outline_.points[other(b, p)];
        const double dot = (x[0] - from[0]) * (to[0] - x[0]) +
                           (x[1] - from[1]) * (to[1] - x[1]);
        const double cosine = dot / (distance(from, x) * distance(x, to));
        if (outline_.keeps_straight_points && cosine > 1. - 1e-12)
          return true;
        // a circle of eighteen sides or more has no corner
        constexpr double cosine_of_corner = .939;
        return cosine < cosine_of_corner;
      }

    private:
      unsigned int other(const unsigned int line, const unsigned int p) const
      {
        const auto &l = outline_.lines[line];
        return l.first == p ? l.last : l.first;
      }

      Chain from(const unsigned int start, unsigned int line)
      {
        Chain chain{{start}, outline_.lines[line].set};
        for (unsigned int p = start;;) {
          is_used_[line] = true;
          p = other(line, p);
          chain.points.push_back(p);
          if (stays(p) || p == start)
            return chain;
          line = at_[p][0] == line ? at_[p][1] : at_[p][0];
        }
      }

      const PlaneOutline &outline_;
      std::vector<std::vector<unsigned int>> at_; ///< lines at points
      std::vector<bool> is_used_;
    };

    /** How many nodes far a place of a chain is from its start. */
    struct Mark {
      double count;
      PlanePoint place;
    };

    std::vector<Mark> marks(const Chain &chain, const PlaneOutline &outline,
                            const SizeField &size)
    {
      constexpr std::size_t most_marks = 4000000;
      constexpr double piece = .25; // of the size, over which it changes little
      std::vector<Mark> result = {{0., outline.points[chain.points[0]]}};
      for (std::size_t i = 1; i < chain.points.size(); ++i) {
        const PlanePoint &a = outline.points[chain.points[i - 1]],
                         &b = outline.points[chain.points[i]];
        const double length = distance(a, b);
        for (double s = 0.; s < length;) {
          const double next =
              std::min(length, s + piece * size(between(a, b, s / length)));
          const double middle = size(between(a, b, .5 * (s + next) / length));
          const PlanePoint place =
              next < length ? between(a, b, next / length) : b;
          result.push_back({result.back().count + (next - s) / middle, place});
          if (result.size() > most_marks)
            throw std::runtime_error(
                "a line would have more than a million nodes; write a larger "
                "`size`");
          if (!(next > s))
            break;
          s = next;
        }
      }
      return result;
    }

    /** Which a chain needs to keep its two sides apart. */
    long fewest_parts(const Chain &chain, const PlaneOutline &outline)
    {
      if (chain.points.front() == chain.points.back())
        return 3;
      double length = 0.;
      for (std::size_t i = 1; i < chain.points.size(); ++i)
        length += distance(outline.points[chain.points[i - 1]],
                           outline.points[chain.points[i]]);
      constexpr double bent = 1.1;
      return length > bent * distance(outline.points[chain.points.front()],
                                      outline.points[chain.points.back()])
                 ? 2
                 : 1;
    }
  } // namespace

  OutlineNodes place_nodes(const PlaneOutline &outline, const SizeField &size,
                           const unsigned int seed)
  {
    OutlineNodes nodes;
    std::vector<unsigned int> number(outline.points.size(), none);
    const auto number_of = [&](const unsigned int p) {
      if (number[p] == none) {
        number[p] = unsigned(nodes.points.size());
        nodes.points.push_back(outline.points[p]);
      }
      return number[p];
    };
    constexpr double unevenness = .3; // of the distance of nodes
    std::uint64_t n_random = 0;
    for (const Chain &chain : Chains(outline).all()) {
      const std::vector<Mark> line = marks(chain, outline, size);
      const double length = line.back().count;
      const auto n =
          std::max(fewest_parts(chain, outline), std::lround(length));
      unsigned int last = number_of(chain.points.front());
      std::size_t m = 1;
      for (long i = 1; i <= n; ++i) {
        unsigned int next = 0;
        if (i == n)
          next = number_of(chain.points.back());
        else {
          const double count =
              length / double(n) *
              (double(i) + unevenness * (uniform(seed, n_random++) - .5));
          while (m + 1 < line.size() && line[m].count < count)
            ++m;
          const Mark &a = line[m - 1], &b = line[m];
          next = unsigned(nodes.points.size());
          nodes.points.push_back(between(
              a.place, b.place, (count - a.count) / (b.count - a.count)));
        }
        nodes.edges.push_back({{last, next}});
        nodes.set.push_back(chain.set);
        last = next;
      }
    }
    return nodes;
  }
} // namespace nsfd
