#include "nearest_grains.h"

#include "coarse_mesh.h"
#include "core/mix_bits.h"
#include "named_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace nsfd
{
  namespace
  {
    using Place = std::array<double, 3>;

    double squared_distance(const Place &a, const Place &b)
    {
      double sum = 0.;
      for (unsigned int d = 0; d < 3; ++d)
        sum += (a[d] - b[d]) * (a[d] - b[d]);
      return sum;
    }

    class Seeds
    {
    public:
      /** In the box of @p places, drawn in units of its longest side: the same
          in every unit of length. */
      Seeds(const std::vector<Place> &places, const unsigned int n,
            const unsigned int seed)
      {
        lower_.fill(std::numeric_limits<double>::max());
        Place upper;
        upper.fill(-std::numeric_limits<double>::max());
        for (const Place &x : places)
          for (unsigned int d = 0; d < 3; ++d) {
            lower_[d] = std::min(lower_[d], x[d]);
            upper[d] = std::max(upper[d], x[d]);
          }
        for (unsigned int d = 0; d < 3; ++d)
          size_ = std::max(size_, upper[d] - lower_[d]);
        constexpr unsigned int n_candidates = 10;
        std::uint64_t drawn = 0;
        for (unsigned int k = 0; k < n; ++k) {
          Place best{};
          double farthest = -1.;
          for (unsigned int candidate = 0; candidate < n_candidates;
               ++candidate) {
            Place x;
            for (unsigned int d = 0; d < 3; ++d)
              x[d] = uniform(seed, drawn++) * (upper[d] - lower_[d]) / size_;
            double nearest = std::numeric_limits<double>::max();
            for (const Place &other : seeds_)
              nearest = std::min(nearest, squared_distance(x, other));
            if (nearest > farthest) {
              farthest = nearest;
              best = x;
            }
          }
          seeds_.push_back(best);
        }
      }

      unsigned int nearest(Place x) const
      {
        for (unsigned int d = 0; d < 3; ++d)
          x[d] = (x[d] - lower_[d]) / size_;
        const auto found = std::min_element(
            seeds_.begin(), seeds_.end(), [&](const Place &a, const Place &b) {
              return squared_distance(x, a) < squared_distance(x, b);
            });
        return unsigned(found - seeds_.begin());
      }

    private:
      Place lower_;
      double size_ = 0.;
      std::vector<Place> seeds_;
    };
  } // namespace

  void add_grains(NamedMesh &mesh, const unsigned int n,
                  const unsigned int seed)
  {
    std::vector<Place> places(mesh.n_vertices());
    for (std::size_t v = 0; v < places.size(); ++v)
      for (unsigned int d = 0; d < 3; ++d)
        places[v][d] = mesh.coordinates[3 * v + d];
    const Seeds seeds(places, n, seed);
    int number = 0;
    for (const auto &group : mesh.groups)
      if (group.dimension == mesh.dimension)
        number = std::max(number, group.number);
    const auto first = unsigned(mesh.groups.size());
    for (unsigned int k = 0; k < n; ++k)
      mesh.groups.push_back({mesh.dimension, number + int(k) + 1,
                             fmt::format("grain {}", k + 1), 0, 0});
    std::map<std::array<unsigned int, 2>, unsigned int> set_of;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      Place middle{};
      const unsigned int n_corners = mesh.cells.n_vertices(c);
      for (unsigned int i = 0; i < n_corners; ++i)
        for (unsigned int d = 0; d < 3; ++d)
          middle[d] += places[mesh.cells.begin(c)[i]][d] / n_corners;
      const unsigned int grain = seeds.nearest(middle);
      unsigned int &set = mesh.cells.set[c];
      const auto [entry, is_new] =
          set_of.emplace(std::array<unsigned int, 2>{{set, grain}},
                         unsigned(mesh.sets.size()));
      if (is_new) {
        auto groups = mesh.sets[set];
        groups.push_back(first + grain);
        mesh.sets.push_back(groups);
        for (auto &data : mesh.cell_data) {
          const auto values = data.second[set];
          data.second.push_back(values);
        }
      }
      set = entry->second;
      ++mesh.groups[first + grain].n_elements;
    }
  }

  template <int dim>
  void add_grains(CoarseMesh<dim> &mesh, const unsigned int n,
                  const unsigned int seed)
  {
    std::vector<Place> places(mesh.vertices.size(), Place{});
    for (std::size_t v = 0; v < places.size(); ++v)
      for (unsigned int d = 0; d < dim; ++d)
        places[v][d] = mesh.vertices[v][d];
    const Seeds seeds(places, n, seed);
    for (auto &cell : mesh.cells) {
      Place middle{};
      for (const unsigned int v : cell.vertices)
        for (unsigned int d = 0; d < dim; ++d)
          middle[d] += places[v][d] / double(cell.vertices.size());
      cell.material_id = seeds.nearest(middle) + 1;
    }
  }

  template void add_grains(CoarseMesh<2> &, unsigned int, unsigned int);
  template void add_grains(CoarseMesh<3> &, unsigned int, unsigned int);
} // namespace nsfd
