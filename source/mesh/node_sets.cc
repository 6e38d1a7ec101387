#include "node_sets.h"

#include "cell_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace nsfd
{
  namespace
  {
    /** A face of a cell by its corners: as they come, and sorted. */
    struct GroupFace {
      std::array<unsigned int, 4> sorted, corners;
      unsigned int n_corners;
      bool is_inner;
    };

    /** Every face once, by the smallest of its corners. */
    std::vector<GroupFace> faces_by_corner(const NamedMesh &mesh)
    {
      constexpr unsigned int none = std::numeric_limits<unsigned int>::max();
      std::vector<GroupFace> faces;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const auto *shape =
            find_cell_shape(mesh.dimension, mesh.cells.n_vertices(c));
        if (shape == nullptr)
          continue;
        for (const auto &corners : shape->faces) {
          GroupFace face{{{none, none, none, none}},
                         {{none, none, none, none}},
                         unsigned(corners.size()),
                         false};
          for (std::size_t i = 0; i < corners.size(); ++i)
            face.corners[i] = mesh.cells.begin(c)[corners[i]];
          face.sorted = face.corners;
          std::sort(face.sorted.begin(), face.sorted.end());
          if (face.sorted[0] < mesh.n_vertices())
            faces.push_back(face);
        }
      }
      std::sort(faces.begin(), faces.end(), [](const auto &a, const auto &b) {
        return a.sorted < b.sorted;
      });
      std::size_t n = 0;
      for (std::size_t f = 0; f < faces.size(); ++f)
        if (n > 0 && faces[n - 1].sorted == faces[f].sorted)
          faces[n - 1].is_inner = true;
        else
          faces[n++] = faces[f];
      faces.resize(n);
      return faces;
    }

    bool is_group_of_cells(const NamedMesh &mesh, const std::string &name)
    {
      return std::any_of(
          mesh.groups.begin(), mesh.groups.end(), [&](const auto &group) {
            return group.dimension == mesh.dimension && group.name == name;
          });
    }
  } // namespace

  unsigned int find_or_add_group(NamedMesh &mesh, const unsigned int dimension,
                                 const std::string &name)
  {
    int number = 0;
    for (unsigned int g = 0; g < mesh.groups.size(); ++g) {
      if (mesh.groups[g].dimension != dimension)
        continue;
      if (mesh.groups[g].name == name)
        return g;
      number = std::max(number, mesh.groups[g].number);
    }
    constexpr int largest = std::numeric_limits<int>::max() - 1;
    mesh.groups.push_back(
        {dimension, std::min(number, largest) + 1, name, 0, 0});
    return unsigned(mesh.groups.size() - 1);
  }

  void add_node_sets(NamedMesh &mesh, const std::vector<NodeSet> &sets)
  {
    if (sets.empty())
      return;
    const std::vector<GroupFace> faces = faces_by_corner(mesh);
    // those whose smallest corner is v begin at first[v]
    std::vector<std::size_t> first(mesh.n_vertices() + 1, 0);
    for (const GroupFace &face : faces)
      ++first[face.sorted[0] + 1];
    for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
      first[v + 1] += first[v];

    std::vector<bool> is_in(mesh.n_vertices(), false);
    std::string left_out;
    for (const NodeSet &set : sets) {
      if (is_group_of_cells(mesh, set.name))
        continue;
      for (const unsigned int v : set.vertices)
        is_in[v] = true;
      std::vector<const GroupFace *> outer, inner;
      std::vector<unsigned int> vertices = set.vertices;
      std::sort(vertices.begin(), vertices.end());
      vertices.erase(std::unique(vertices.begin(), vertices.end()),
                     vertices.end());
      for (const unsigned int v : vertices)
        for (std::size_t f = first[v]; f < first[v + 1]; ++f)
          if (std::all_of(faces[f].corners.begin(),
                          faces[f].corners.begin() + faces[f].n_corners,
                          [&](const unsigned int w) {
                            return w < is_in.size() && is_in[w];
                          }))
            (faces[f].is_inner ? inner : outer).push_back(&faces[f]);
      for (const unsigned int v : set.vertices)
        is_in[v] = false;
      const auto &chosen = outer.empty() ? inner : outer;
      if (chosen.empty()) {
        left_out += (left_out.empty() ? "" : ", ") + set.name;
        continue;
      }
      const unsigned int in_set =
          mesh.set_of({find_or_add_group(mesh, mesh.dimension - 1, set.name)});
      // all elements of a file have numbers, or none
      const bool has_numbers = !mesh.faces.numbers.empty();
      for (const GroupFace *face : chosen) {
        const std::vector<unsigned int> corners(
            face->corners.begin(), face->corners.begin() + face->n_corners);
        if (has_numbers)
          mesh.faces.add(corners, in_set, 0);
        else
          mesh.faces.add(corners, in_set);
      }
    }
    if (!left_out.empty())
      mesh.notes.push_back(fmt::format("sets of nodes that hold no whole face "
                                       "of a cell were left out: {}",
                                       left_out));
  }
} // namespace nsfd
