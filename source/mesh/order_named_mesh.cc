#include "named_mesh.h"

#include "cell_shapes.h"
#include "check_cells.h"
#include "core/mix_bits.h"
#include "vectors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_map>

namespace nsfd
{
  namespace
  {
    using namespace mesh_vectors;

    using Elements = NamedMesh::Elements;

    MeshVector middle(const NamedMesh &mesh, const Elements &elements,
                      const std::size_t e)
    {
      MeshVector sum{};
      const unsigned int n = elements.n_vertices(e);
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int d = 0; d < 3; ++d)
          sum[d] += position(mesh, elements.begin(e)[i])[d] / n;
      return sum;
    }

    std::string text(const NamedMesh &mesh, const MeshVector &p)
    {
      return mesh.dimension == 2
                 ? fmt::format("({:g}, {:g})", p[0], p[1])
                 : fmt::format("({:g}, {:g}, {:g})", p[0], p[1], p[2]);
    }

    using Key = std::array<unsigned int, 8>;

    template <typename Number>
    Key key_of(const unsigned int *vertices, const unsigned int n,
               const Number &number)
    {
      Key key;
      key.fill(std::numeric_limits<unsigned int>::max());
      for (unsigned int i = 0; i < n; ++i)
        key[i] = number(vertices[i]);
      std::sort(key.begin(), key.begin() + n);
      return key;
    }

    Key key_of(const unsigned int *vertices, const unsigned int n)
    {
      return key_of(vertices, n, [](const unsigned int v) { return v; });
    }

    /** Keep some elements; in the order of @p kept. */
    Elements select(const Elements &all, const std::vector<std::size_t> &kept)
    {
      Elements result;
      for (const std::size_t e : kept)
        if (all.numbers.empty())
          result.add({all.begin(e), all.begin(e) + all.n_vertices(e)},
                     all.set[e]);
        else
          result.add({all.begin(e), all.begin(e) + all.n_vertices(e)},
                     all.set[e], all.numbers[e]);
      return result;
    }

    void select_values(std::vector<double> &values,
                       const std::vector<std::size_t> &kept)
    {
      for (std::size_t i = 0; i < kept.size(); ++i)
        values[i] = values[kept[i]]; // kept is sorted
      values.resize(kept.size());
    }

    /**
     * Formats that know one group per element store one of two groups twice.
     * Returns how many copies there were. A cell that is twice in the same
     * group is two cells at one place.
     */
    std::size_t join_copies(NamedMesh &mesh, Elements &elements,
                            std::vector<std::string> &problems)
    {
      std::vector<std::pair<Key, std::size_t>> keys;
      for (std::size_t e = 0; e < elements.size(); ++e)
        keys.emplace_back(key_of(elements.begin(e), elements.n_vertices(e)), e);
      std::sort(keys.begin(), keys.end());
      std::vector<std::size_t> kept;
      for (std::size_t i = 0; i < keys.size(); ++i) {
        const std::size_t e = keys[i].second;
        if (i == 0 || keys[i].first != keys[i - 1].first) {
          kept.push_back(e);
          continue;
        }
        auto groups = mesh.sets[elements.set[kept.back()]];
        if (&elements == &mesh.cells && groups.size() < 2 &&
            elements.set[e] == elements.set[kept.back()] && problems.empty())
          problems.push_back(fmt::format("{} is the same as {}",
                                         cell_text(mesh, e),
                                         cell_text(mesh, kept.back())));
        const auto &others = mesh.sets[elements.set[e]];
        groups.insert(groups.end(), others.begin(), others.end());
        elements.set[kept.back()] = mesh.set_of(groups);
      }
      const std::size_t n_copies = elements.size() - kept.size();
      if (n_copies > 0) {
        std::sort(kept.begin(), kept.end());
        elements = select(elements, kept);
        if (&elements == &mesh.cells)
          for (auto &[name, values] : mesh.fields)
            select_values(values, kept);
      }
      return n_copies;
    }

    void flatten(NamedMesh &mesh, std::vector<std::string> &problems)
    {
      if (mesh.dimension == 3)
        return;
      MeshVector lower, upper;
      lower.fill(std::numeric_limits<double>::max());
      upper.fill(-std::numeric_limits<double>::max());
      for (const unsigned int v : mesh.cells.vertices)
        for (unsigned int d = 0; d < 3; ++d) {
          lower[d] = std::min(lower[d], position(mesh, v)[d]);
          upper[d] = std::max(upper[d], position(mesh, v)[d]);
        }
      const MeshVector extent = upper - lower;
      if (extent[2] > 1e-6 * std::max(extent[0], extent[1]))
        problems.push_back(fmt::format(
            "the mesh is not in a plane z = const: z goes from {:g} to {:g}; "
            "in two dimensions it must be in the plane of x and y",
            lower[2], upper[2]));
      for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
        mesh.coordinates[3 * v + 2] = 0.;
    }

    /** Positive if the corners are in deal.II's order. */
    double orientation(const NamedMesh &mesh, const CellShapeTopology &shape,
                       const std::size_t c)
    {
      const unsigned int *v = mesh.cells.begin(c);
      double sum = 0.;
      for (unsigned int i = 0; i < shape.n_corners; ++i) {
        const MeshVector origin = position(mesh, v[i]);
        const auto edge = [&](const unsigned int d) {
          return position(mesh, v[shape.edges[i][d]]) - origin;
        };
        sum += determinant(edge(0), edge(1),
                           mesh.dimension == 3 ? edge(2)
                                               : MeshVector{{0., 0., 1.}});
      }
      return sum;
    }

    void turn_cells(NamedMesh &mesh)
    {
      std::size_t n_turned = 0;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const unsigned int n = mesh.cells.n_vertices(c);
        const auto *shape = find_cell_shape(mesh.dimension, n);
        if (shape == nullptr || orientation(mesh, *shape, c) >= 0.)
          continue;
        ++n_turned;
        unsigned int *v = mesh.cells.vertices.data() + mesh.cells.first[c];
        const std::vector<unsigned int> old(v, v + n);
        for (unsigned int i = 0; i < n; ++i)
          v[i] = old[shape->mirrored[i]];
      }
      if (n_turned > 0)
        mesh.notes.push_back(fmt::format(
            "{} of {} cells had a negative {}: their corners were put in the "
            "other order",
            n_turned, mesh.cells.size(),
            mesh.dimension == 2 ? "area" : "volume"));
    }

    double shortest_edge(const NamedMesh &mesh)
    {
      double shortest = std::numeric_limits<double>::max();
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const auto *shape =
            find_cell_shape(mesh.dimension, mesh.cells.n_vertices(c));
        if (shape == nullptr)
          continue;
        const unsigned int *v = mesh.cells.begin(c);
        for (unsigned int i = 0; i < shape->n_corners; ++i)
          for (const unsigned int j : shape->edges[i]) {
            const double length =
                norm(position(mesh, v[j]) - position(mesh, v[i]));
            if (length > 0.)
              shortest = std::min(shortest, length);
          }
      }
      return shortest;
    }

    /** Per vertex the first one at its place. */
    std::vector<unsigned int> first_at_place(const NamedMesh &mesh,
                                             const double tolerance)
    {
      using Bin = std::array<std::int64_t, 3>;
      const auto hash = [](const Bin &bin) {
        return mixed(std::uint64_t(bin[0]) +
                     mixed(std::uint64_t(bin[1]) + mixed(bin[2])));
      };
      std::unordered_map<Bin, std::vector<unsigned int>, decltype(hash)> bins(
          mesh.n_vertices(), hash);
      const MeshVector origin = position(mesh, 0);
      std::vector<unsigned int> number(mesh.n_vertices());
      for (unsigned int v = 0; v < number.size(); ++v) {
        number[v] = v;
        const MeshVector x = position(mesh, v);
        Bin bin{};
        for (unsigned int d = 0; d < mesh.dimension; ++d)
          bin[d] = std::llround((x[d] - origin[d]) / (2. * tolerance));
        for (unsigned int n = 0; n < (mesh.dimension == 2 ? 9 : 27); ++n) {
          const Bin near = {
              {bin[0] + int(n % 3) - 1, bin[1] + int(n / 3 % 3) - 1,
               mesh.dimension == 2 ? 0 : bin[2] + int(n / 9) - 1}};
          const auto found = bins.find(near);
          if (found != bins.end())
            for (const unsigned int w : found->second)
              if (norm(x - position(mesh, w)) <= tolerance)
                number[v] = std::min(number[v], number[w]);
        }
        bins[bin].push_back(v);
      }
      return number;
    }

    struct Face {
      Key key;
      std::size_t cell;
      unsigned int number;
      bool operator<(const Face &other) const
      {
        return key < other.key || (key == other.key && cell < other.cell);
      }
    };

    template <typename Number>
    std::vector<Face> sorted_faces(const NamedMesh &mesh, const Number &number)
    {
      std::vector<Face> faces;
      std::vector<unsigned int> corners;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const auto *shape =
            find_cell_shape(mesh.dimension, mesh.cells.n_vertices(c));
        for (unsigned int f = 0; shape != nullptr && f < shape->faces.size();
             ++f) {
          corners.clear();
          for (const unsigned int i : shape->faces[f])
            corners.push_back(mesh.cells.begin(c)[i]);
          faces.push_back(
              {key_of(corners.data(), unsigned(corners.size()), number), c, f});
        }
      }
      std::sort(faces.begin(), faces.end());
      return faces;
    }

    std::vector<Face> sorted_faces(const NamedMesh &mesh)
    {
      return sorted_faces(mesh, [](const unsigned int v) { return v; });
    }

    /** Vertices at one place: joined, or reported. */
    void treat_coincident(NamedMesh &mesh, const bool merge)
    {
      // far below any edge, above what seven digits in a file leave
      const double tolerance = 1e-5 * shortest_edge(mesh);
      const auto number = first_at_place(mesh, tolerance);
      std::size_t n_vertices = 0, n_faces = 0;
      for (unsigned int v = 0; v < number.size(); ++v)
        n_vertices += number[v] != v;
      if (n_vertices == 0)
        return;
      const auto joined = [&](const unsigned int v) { return number[v]; };
      const auto count = [](const std::vector<Face> &faces) {
        std::size_t n = 0;
        for (std::size_t i = 0; i < faces.size(); ++i)
          n += i == 0 || faces[i].key != faces[i - 1].key;
        return n;
      };
      n_faces = count(sorted_faces(mesh)) - count(sorted_faces(mesh, joined));
      if (!merge) {
        mesh.notes.push_back(fmt::format(
            "{} vertices have another one at their place, and {} pairs of "
            "faces lie on each other without being joined: nothing acts "
            "between them; `set merge vertices = true` joins them",
            n_vertices, n_faces));
        return;
      }
      for (Elements *elements : {&mesh.cells, &mesh.faces})
        for (unsigned int &v : elements->vertices)
          v = number[v];
      mesh.notes.push_back(
          fmt::format("{} vertices were joined with another one at their "
                      "place, {} pairs of faces became one",
                      n_vertices, n_faces));
    }

    void drop_unused_vertices(NamedMesh &mesh)
    {
      constexpr unsigned int unused = std::numeric_limits<unsigned int>::max();
      std::vector<unsigned int> number(mesh.n_vertices(), unused);
      for (const unsigned int v : mesh.cells.vertices)
        number[v] = 0;
      std::size_t n = 0;
      for (std::size_t v = 0; v < number.size(); ++v)
        if (number[v] != unused) {
          std::copy_n(mesh.coordinates.begin() + 3 * v, 3,
                      mesh.coordinates.begin() + 3 * n);
          number[v] = unsigned(n++);
        }
      mesh.coordinates.resize(3 * n);
      // faces of no cell go with their vertices
      std::vector<std::size_t> kept;
      for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        if (std::all_of(mesh.faces.begin(f),
                        mesh.faces.begin(f) + mesh.faces.n_vertices(f),
                        [&](const auto v) { return number[v] != unused; }))
          kept.push_back(f);
      if (kept.size() < mesh.faces.size()) {
        mesh.notes.push_back(fmt::format(
            "{} elements of lower dimension are on no cell and were left out",
            mesh.faces.size() - kept.size()));
        mesh.faces = select(mesh.faces, kept);
      }
      for (Elements *elements : {&mesh.cells, &mesh.faces})
        for (unsigned int &v : elements->vertices)
          v = number[v];
    }

    void count_groups(NamedMesh &mesh)
    {
      for (const unsigned int set : mesh.cells.set)
        for (const unsigned int g : mesh.sets[set])
          ++mesh.groups[g].n_elements;
      for (const unsigned int set : mesh.faces.set)
        for (const unsigned int g : mesh.sets[set])
          ++mesh.groups[g].n_elements;
    }

    /** Faces of groups must be faces of cells; those on the boundary count. */
    void match_faces(NamedMesh &mesh, std::vector<std::string> &problems)
    {
      const std::vector<Face> faces = sorted_faces(mesh);
      for (std::size_t i = 0; i + 2 < faces.size(); ++i)
        if (faces[i].key == faces[i + 2].key) {
          problems.push_back(fmt::format(
              "three cells meet at one face: {}, {} and {}; cells overlap",
              cell_text(mesh, faces[i].cell),
              cell_text(mesh, faces[i + 1].cell),
              cell_text(mesh, faces[i + 2].cell)));
          return;
        }
      std::vector<std::size_t> kept;
      std::vector<bool> at_boundary;
      for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        const Face wanted = {
            key_of(mesh.faces.begin(f), mesh.faces.n_vertices(f)), 0, 0};
        const auto found = std::lower_bound(faces.begin(), faces.end(), wanted);
        if (found == faces.end() || found->key != wanted.key)
          continue;
        kept.push_back(f);
        at_boundary.push_back(found + 1 == faces.end() ||
                              (found + 1)->key != wanted.key);
      }
      if (kept.size() < mesh.faces.size()) {
        std::size_t first = 0;
        while (first < kept.size() && kept[first] == first)
          ++first;
        mesh.notes.push_back(fmt::format(
            "{} elements of lower dimension are no face of a cell, the first "
            "at {}; they were left out",
            mesh.faces.size() - kept.size(),
            text(mesh, middle(mesh, mesh.faces, first))));
        mesh.faces = select(mesh.faces, kept);
      }
      for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        if (at_boundary[f])
          for (const unsigned int g : mesh.sets[mesh.faces.set[f]])
            ++mesh.groups[g].n_boundary;
    }

    bool is_finite(const NamedMesh &mesh, std::vector<std::string> &problems)
    {
      for (std::size_t i = 0; i < mesh.coordinates.size(); ++i)
        if (!std::isfinite(mesh.coordinates[i])) {
          problems.push_back(fmt::format(
              "a coordinate of the vertex that comes as number {} is not a "
              "finite number",
              i / 3 + 1));
          return false;
        }
      return true;
    }

    bool has_vertices(const NamedMesh &mesh, std::vector<std::string> &problems)
    {
      for (const Elements *elements : {&mesh.cells, &mesh.faces})
        for (const unsigned int v : elements->vertices)
          if (v >= mesh.n_vertices()) {
            problems.push_back("a cell has a vertex that is not there");
            return false;
          }
      for (std::size_t c = 0; c < mesh.cells.size(); ++c)
        if (find_cell_shape(mesh.dimension, mesh.cells.n_vertices(c)) ==
            nullptr) {
          problems.push_back(fmt::format("{} has {} corners",
                                         cell_text(mesh, c),
                                         mesh.cells.n_vertices(c)));
          return false;
        }
      return true;
    }
  } // namespace

  void put_in_order(NamedMesh &mesh, const double unit,
                    const bool merge_vertices,
                    std::vector<std::string> &problems)
  {
    if (mesh.cells.size() == 0) {
      problems.push_back(
          mesh.dimension == 3 && mesh.faces.size() > 0
              ? "it is a mesh of 2 dimensions, the scene has 3; write `set "
                "dimension = 2` at the top, or bring another file"
              : "the mesh has no cell");
      return;
    }
    // 5 mm are exactly the double 5e-3
    const double parts = unit < 1. ? std::round(1. / unit) : 1.;
    const bool divide = unit < 1. && std::abs(parts * unit - 1.) < 1e-12;
    for (double &x : mesh.coordinates)
      x = divide ? x / parts : x * unit;
    if (!has_vertices(mesh, problems) || !is_finite(mesh, problems))
      return;
    flatten(mesh, problems);
    treat_coincident(mesh, merge_vertices);
    if (const std::size_t n = join_copies(mesh, mesh.cells, problems))
      mesh.notes.push_back(fmt::format(
          "{} cells were there more than once and became one each", n));
    join_copies(mesh, mesh.faces, problems);
    turn_cells(mesh);
    drop_unused_vertices(mesh);
    match_faces(mesh, problems);
    count_groups(mesh);
    if (problems.empty())
      check_cells(mesh, problems);
  }
} // namespace nsfd
