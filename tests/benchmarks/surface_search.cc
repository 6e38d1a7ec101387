// Prints the cost of contact search in heaps of loose square and cubic cells,
// in microseconds per facet: all candidates searched, and a step that keeps
// them. Cells are numbered row by row or at random.

#include "contact_detection/surface_search.h"
#include "core/stopwatch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

using namespace nsfd;

namespace
{
  constexpr double gap = 0.02, reach = 0.05; // in sizes of a cell

  template <int dim>
  struct Heap {
    Surfaces<dim> surfaces;
    std::vector<double> x;
  };

  /** Corner c of a cell has bit d of c as its coordinate d. */
  const std::vector<std::array<unsigned int, 4>> square_sides{
      {0, 1}, {1, 3}, {3, 2}, {2, 0}};
  const std::vector<std::array<unsigned int, 4>> cube_sides{
      {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
      {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

  template <int dim>
  void add_cell(Heap<dim> &heap, const unsigned int body)
  {
    auto &surfaces = heap.surfaces;
    for (auto side : dim == 2 ? square_sides : cube_sides) {
      const auto facet = static_cast<unsigned int>(surfaces.facets.size());
      for (auto &vertex : side)
        vertex += static_cast<unsigned int>(surfaces.n_vertices);
      const unsigned int n = dim == 2 ? 2 : 4;
      surfaces.facets.push_back({side, n, body, facet});
      for (unsigned int i = 0; i < n; ++i)
        surfaces.points.push_back({side[i], facet});
    }
    surfaces.n_vertices += 1u << dim;
  }

  /** n^dim cells, each with neighbours at `gap` on all sides. */
  template <int dim>
  Heap<dim> cells(const unsigned int n, const bool shuffled)
  {
    std::vector<unsigned int> sites(
        static_cast<unsigned int>(std::lround(std::pow(n, dim))));
    std::iota(sites.begin(), sites.end(), 0u);
    std::mt19937 random(1);
    if (shuffled)
      std::shuffle(sites.begin(), sites.end(), random);
    std::uniform_real_distribution<double> shift(-gap / 8., gap / 8.);
    Heap<dim> heap;
    for (unsigned int body = 0; body < sites.size(); ++body) {
      add_cell<dim>(heap, body);
      for (unsigned int corner = 0; corner < 1u << dim; ++corner)
        for (unsigned int d = 0, site = sites[body]; d < dim; ++d, site /= n)
          heap.x.push_back(site % n * (1. + gap) + (corner >> d & 1) +
                           shift(random));
    }
    return heap;
  }

  struct Cost {
    double search = 0., kept = 0.; ///< us per facet
  };

  template <int dim>
  Cost measure(const Heap<dim> &heap)
  {
    const auto n_facets = static_cast<double>(heap.surfaces.facets.size());
    const auto apart = [](unsigned int, unsigned int) { return false; };
    SurfaceSearch<dim> search;
    NearPairs<dim> pairs;
    const auto seconds = [&](const bool fresh) {
      const auto rounds = static_cast<unsigned int>(3. + 2e5 / n_facets);
      double best = 1e300;
      for (unsigned int i = 0; i < rounds; ++i) {
        if (fresh)
          search.topology_changed();
        const double start = wall_seconds();
        search.find(heap.surfaces, heap.x.data(), reach, apart, pairs);
        best = std::min(best, wall_seconds() - start);
      }
      return 1e6 * best / n_facets;
    };
    const double fresh = seconds(true);
    return {fresh, seconds(false)};
  }

  void print(const Cost &cost)
  {
    fmt::print(" {:8.3f} {:7.3f}", cost.search, cost.kept);
  }

  template <int dim>
  void table(const std::vector<unsigned int> &cells_along)
  {
    fmt::print("{}D  facets   search    kept  shuffled: search  kept\n", dim);
    for (const unsigned int n : cells_along) {
      fmt::print("{:10}", 2 * dim * std::lround(std::pow(n, dim)));
      for (const bool shuffled : {false, true}) {
        auto heap = cells<dim>(n, shuffled);
        set_edges<dim>(heap.surfaces, heap.x.data(),
                       [](unsigned int) { return false; });
        print(measure<dim>(heap));
        if (heap.surfaces.edges.empty())
          continue;
        heap.surfaces.edges.clear();
        fmt::print(" (");
        print(measure<dim>(heap));
        fmt::print(")");
      }
      fmt::print("\n");
    }
  }
} // namespace

int main()
{
  table<2>({16, 50, 158, 500});
  table<3>({5, 12, 26, 55});
}
