#include "bisection.h"

#include <algorithm>
#include <set>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    using dealii::Point;

    /** The longest edge is between the last two; of equal ones that with the
        smaller numbers, so that both cells of an edge say the same. */
    std::array<unsigned int, 3>
    longest_last(const std::vector<Point<2>> &vertices,
                 const std::vector<unsigned int> &corners)
    {
      // edges of a lattice differ by round-off
      constexpr double round_off = 1. + 1e-9;
      unsigned int best = 0;
      double longest = 0.;
      std::array<unsigned int, 2> of_best{};
      for (unsigned int k = 0; k < 3; ++k) {
        const unsigned int a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
        const double length = vertices[a].distance(vertices[b]);
        const std::array<unsigned int, 2> ends = {
            {std::min(a, b), std::max(a, b)}};
        if (length > longest * round_off ||
            (length * round_off >= longest && ends < of_best)) {
          best = k;
          longest = length;
          of_best = ends;
        }
      }
      return {
          {corners[best], corners[(best + 1) % 3], corners[(best + 2) % 3]}};
    }
  } // namespace

  Bisection::Edge Bisection::edge(const unsigned int a, const unsigned int b)
  {
    return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
  }

  Bisection::Bisection(CoarseMesh<2> mesh)
      : vertices_(std::move(mesh.vertices)),
        ends_(vertices_.size(), {{none, none}})
  {
    std::unordered_map<Edge, unsigned int> n_cells;
    for (const auto &cell : mesh.cells) {
      if (cell.vertices.size() != 3)
        throw std::logic_error("only triangles are bisected");
      const auto first = unsigned(cells_.size());
      cells_.push_back(
          {longest_last(vertices_, cell.vertices), first, 0, 0, first});
      materials_.push_back(cell.material_id);
      for (unsigned int k = 0; k < 3; ++k)
        ++n_cells[edge(cell.vertices[k], cell.vertices[(k + 1) % 3])];
    }
    // deal.II wants to know which of the lines with an id are inside
    for (const auto &line : mesh.boundary.boundary_lines) {
      const Edge here = edge(line.vertices[0], line.vertices[1]);
      lines_[here] = {n_cells[here] > 1
                          ? dealii::numbers::internal_face_boundary_id
                          : line.boundary_id,
                      line.manifold_id};
    }
    settle();
  }

  double Bisection::longest_edge(const Cell &cell) const
  {
    double longest = 0.;
    for (unsigned int k = 0; k < 3; ++k)
      longest = std::max(longest, vertices_[cell.vertices[k]].distance(
                                      vertices_[cell.vertices[(k + 1) % 3]]));
    return longest;
  }

  void Bisection::settle()
  {
    old_cells_.clear();
    for (unsigned int k = 0; k < cells_.size(); ++k) {
      cells_[k].old = k;
      cells_[k].other = none;
      old_cells_.push_back(cells_[k].vertices);
    }
  }

  Bisection::CellsOf Bisection::cells_of_edges() const
  {
    CellsOf result;
    result.reserve(2 * cells_.size());
    for (unsigned int k = 0; k < cells_.size(); ++k)
      for (unsigned int i = 0; i < 3; ++i) {
        const Edge one =
            edge(cells_[k].vertices[i], cells_[k].vertices[(i + 1) % 3]);
        auto &both =
            result.try_emplace(one, std::array<unsigned int, 2>{{none, none}})
                .first->second;
        both[both[0] == none ? 0 : 1] = k;
      }
    return result;
  }

  unsigned int Bisection::behind(const CellsOf &cells_of,
                                 const unsigned int cell, const Edge edge) const
  {
    const auto &both = cells_of.at(edge);
    return both[both[0] == cell ? 1 : 0];
  }

  /** The cell is cut there by one or two bisections of its own, and so are
      those that this needs. */
  bool Bisection::may_cut(const CellsOf &cells_of, const unsigned int cell,
                          const Edge edge, const unsigned int deepest,
                          const unsigned int rounds) const
  {
    if (cell == none)
      return true;
    const Edge own = cut_edge(cells_[cell]);
    const unsigned int level = cells_[cell].level + (own == edge ? 1 : 2);
    if (level > deepest || rounds == 0)
      return false;
    return own == edge || may_cut(cells_of, behind(cells_of, cell, own), own,
                                  deepest, rounds - 1);
  }

  /** The edges that are cut: a cell that loses one is cut at its own, too. */
  std::unordered_set<Bisection::Edge>
  Bisection::closure(const CellsOf &cells_of,
                     const std::vector<char> &marked) const
  {
    std::unordered_set<Edge> cut;
    std::vector<Edge> open;
    const auto put = [&](const unsigned int k) {
      if (cut.insert(cut_edge(cells_[k])).second)
        open.push_back(cut_edge(cells_[k]));
    };
    for (unsigned int k = 0; k < cells_.size(); ++k)
      if (marked[k] != 0)
        put(k);
    while (!open.empty()) {
      const Edge one = open.back();
      open.pop_back();
      for (const unsigned int k : cells_of.at(one))
        if (k != none)
          put(k);
    }
    return cut;
  }

  bool Bisection::refine(const std::vector<char> &marked,
                         const unsigned int deepest)
  {
    constexpr unsigned int longest_way = 1000; // from cell to cell
    const auto cells_of = cells_of_edges();
    std::vector<char> may(cells_.size(), 0);
    for (unsigned int k = 0; k < cells_.size(); ++k)
      if (marked[k] != 0 && cells_[k].level < deepest) {
        const Edge own = cut_edge(cells_[k]);
        may[k] = may_cut(cells_of, behind(cells_of, k, own), own, deepest,
                         longest_way);
      }
    const auto cut = closure(cells_of, may);
    if (cut.empty())
      return false;
    std::vector<Cell> halves;
    halves.reserve(cells_.size() + 2 * cut.size());
    for (const Cell &cell : cells_)
      halve(cell, cut, halves);
    cells_ = std::move(halves);
    return true;
  }

  unsigned int Bisection::middle(const unsigned int a, const unsigned int b)
  {
    const auto [at, is_new] =
        middles_.try_emplace(edge(a, b), unsigned(vertices_.size()));
    const unsigned int m = at->second;
    if (!is_new)
      return m;
    vertices_.push_back(vertices_[a] + (vertices_[b] - vertices_[a]) / 2.);
    ends_.push_back({{std::min(a, b), std::max(a, b)}});
    const auto line = lines_.find(edge(a, b));
    if (line != lines_.end()) {
      const Ids ids = line->second;
      lines_[edge(a, m)] = lines_[edge(m, b)] = ids;
    }
    return m;
  }

  void Bisection::halve(const Cell &cell, const std::unordered_set<Edge> &cut,
                        std::vector<Cell> &result)
  {
    if (cut.count(cut_edge(cell)) == 0) {
      result.push_back(cell);
      return;
    }
    const auto [a, b, c] = cell.vertices;
    const unsigned int m = middle(std::min(b, c), std::max(b, c));
    Cell half = cell;
    ++half.level;
    half.path = cell.path << 1;
    half.vertices = {{m, a, b}};
    halve(half, cut, result);
    half.path |= 1;
    half.vertices = {{m, c, a}};
    halve(half, cut, result);
  }

  /** The last vertex of a half is its first one: all cells that have it are to
      say so. Halves lie one after the other. */
  std::vector<Bisection::Family> Bisection::families() const
  {
    std::vector<unsigned int> n_cells(vertices_.size(), 0);
    for (const Cell &cell : cells_)
      for (const unsigned int v : cell.vertices)
        ++n_cells[v];
    std::vector<Family> result;
    std::vector<unsigned int> family_of(vertices_.size(), none);
    const auto is_old = [&](const Cell &cell) {
      return cell.vertices == old_cells_[cell.old];
    };
    for (unsigned int k = 0; k + 1 < cells_.size(); ++k) {
      const Cell &one = cells_[k], &two = cells_[k + 1];
      if (one.level == 0 || one.level != two.level || one.first != two.first ||
          (one.path ^ 1) != two.path || (one.path & 1) != 0 || !is_old(one) ||
          !is_old(two))
        continue;
      const unsigned int m = one.vertices[0];
      if (family_of[m] == none) {
        family_of[m] = unsigned(result.size());
        result.push_back({m});
        result.back().pairs[0] = {{k, k + 1}};
      } else
        result[family_of[m]].pairs[1] = {{k, k + 1}};
    }
    const auto is_whole = [&](const Family &family) {
      return n_cells[family.vertex] == (family.pairs[1][0] == none ? 2u : 4u);
    };
    result.erase(
        std::remove_if(result.begin(), result.end(),
                       [&](const Family &family) { return !is_whole(family); }),
        result.end());
    return result;
  }

  Bisection::Cell Bisection::joined(const unsigned int first,
                                    const unsigned int second) const
  {
    const Cell &one = cells_[first], &two = cells_[second];
    Cell whole = one;
    whole.vertices = {{one.vertices[1], one.vertices[2], two.vertices[1]}};
    --whole.level;
    whole.path = one.path >> 1;
    whole.other = two.old;
    return whole;
  }

  void Bisection::join(const std::vector<Family> &families)
  {
    std::vector<char> gone(cells_.size(), 0);
    for (const Family &family : families)
      for (const auto &[first, second] : family.pairs)
        if (first != none) {
          cells_[first] = joined(first, second);
          gone[second] = 1;
        }
    std::size_t n = 0;
    for (std::size_t k = 0; k < cells_.size(); ++k)
      if (gone[k] == 0)
        cells_[n++] = cells_[k];
    cells_.resize(n);
  }

  std::array<unsigned int, 2> Bisection::whole_edge(const unsigned int a,
                                                    const unsigned int b) const
  {
    std::array<unsigned int, 2> edge = {{std::min(a, b), std::max(a, b)}};
    for (;;) {
      const auto &ends = ends_[edge[1]]; // of the later one
      if (ends[0] == none || (ends[0] != edge[0] && ends[1] != edge[0]))
        return edge;
      edge = ends;
    }
  }

  CoarseMesh<2> Bisection::mesh() const
  {
    CoarseMesh<2> result;
    std::vector<unsigned int> number(vertices_.size(), none);
    std::unordered_set<Edge> known;
    for (const Cell &cell : cells_) {
      auto &data = result.cells.emplace_back(3);
      data.material_id = materials_[cell.first];
      for (unsigned int k = 0; k < 3; ++k) {
        unsigned int &n = number[cell.vertices[k]];
        if (n == none) {
          n = unsigned(result.vertices.size());
          result.vertices.push_back(vertices_[cell.vertices[k]]);
        }
        data.vertices[k] = n;
      }
      for (unsigned int k = 0; k < 3 && !lines_.empty(); ++k) {
        const unsigned int a = cell.vertices[k], b = cell.vertices[(k + 1) % 3];
        const auto line = lines_.find(edge(a, b));
        if (line == lines_.end() || !known.insert(edge(a, b)).second)
          continue;
        auto &part = result.boundary.boundary_lines.emplace_back(2);
        part.vertices = {number[a], number[b]};
        part.boundary_id = line->second.boundary;
        part.manifold_id = line->second.manifold;
      }
    }
    return result;
  }

  std::vector<std::uint32_t> Bisection::ids() const
  {
    std::vector<std::uint32_t> result;
    result.reserve(4 * cells_.size());
    for (const Cell &cell : cells_)
      for (const std::uint64_t part :
           {std::uint64_t(cell.first), std::uint64_t(cell.level), cell.path,
            cell.path >> 32})
        result.push_back(std::uint32_t(part));
    return result;
  }

  void Bisection::restore(const std::vector<std::uint32_t> &ids)
  {
    using Id = std::array<std::uint64_t, 3>;
    std::set<Id> wanted;
    for (std::size_t k = 0; k + 4 <= ids.size(); k += 4)
      wanted.insert(
          {{ids[k], ids[k + 1], ids[k + 2] | std::uint64_t(ids[k + 3]) << 32}});
    for (bool coarse = true; coarse;) {
      coarse = false;
      std::vector<char> marked(cells_.size(), 0);
      for (std::size_t k = 0; k < cells_.size(); ++k)
        if (wanted.count(
                {{cells_[k].first, cells_[k].level, cells_[k].path}}) == 0 &&
            cells_[k].level < 63) {
          marked[k] = 1;
          coarse = true;
        }
      coarse = coarse && refine(marked);
    }
    settle();
  }
} // namespace nsfd
