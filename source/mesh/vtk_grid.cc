#include "vtk_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

namespace nsfd::vtk
{
  namespace
  {
    struct Shape {
      unsigned int dimension;
      std::vector<unsigned int> order; ///< corners in deal.II's order
      bool is_curved;                  ///< has nodes besides its corners
    };

    const std::vector<unsigned int> line = {0, 1}, triangle = {0, 1, 2},
                                    round_quad = {0, 1, 3, 2},
                                    tetrahedron = {0, 1, 2, 3},
                                    round_hex = {0, 1, 3, 2, 4, 5, 7, 6},
                                    prism = {0, 1, 2, 3, 4, 5};

    /** By the number of the type. */
    const std::map<int, Shape> shapes = {
        {3, {1, line, false}},
        {5, {2, triangle, false}},
        {8, {2, {0, 1, 2, 3}, false}}, // pixel
        {9, {2, round_quad, false}},
        {10, {3, tetrahedron, false}},
        {11, {3, {0, 1, 2, 3, 4, 5, 6, 7}, false}}, // voxel
        {12, {3, round_hex, false}},
        {13, {3, prism, false}},
        {21, {1, line, true}},
        {22, {2, triangle, true}},
        {23, {2, round_quad, true}},
        {24, {3, tetrahedron, true}},
        {25, {3, round_hex, true}},
        {26, {3, prism, true}},
        {28, {2, round_quad, true}},
        {29, {3, round_hex, true}},
        {30, {2, round_quad, true}},
        {31, {3, prism, true}},
        {32, {3, prism, true}},
        {33, {3, round_hex, true}},
        {34, {2, triangle, true}},
        // Lagrange and Bezier, of any order
        {68, {1, line, true}},
        {69, {2, triangle, true}},
        {70, {2, round_quad, true}},
        {71, {3, tetrahedron, true}},
        {72, {3, round_hex, true}},
        {73, {3, prism, true}},
        {75, {1, line, true}},
        {76, {2, triangle, true}},
        {77, {2, round_quad, true}},
        {78, {3, tetrahedron, true}},
        {79, {3, round_hex, true}},
        {80, {3, prism, true}}};

    /** Of bodies that are no cells: what they are called. */
    const std::map<int, const char *> foreign = {
        {6, "triangle strips"},    {7, "polygons"},
        {14, "pyramids"},          {15, "pentagonal prisms"},
        {16, "hexagonal prisms"},  {27, "pyramids"},
        {36, "polygons"},          {37, "pyramids"},
        {41, "convex point sets"}, {42, "polyhedra"},
        {74, "pyramids"},          {81, "pyramids"}};

    /// what programs call the numbers of groups: deal.II and others, Gmsh,
    /// meshio, ParaView
    constexpr std::array<const char *, 7> group_names = {
        {"MaterialID", "material", "CellEntityIds", "gmsh:physical",
         "medit:ref", "ObjectId", "cell_tags"}};

    const Array *find_array(const Grid &grid, const std::string &name)
    {
      const auto found =
          std::find_if(grid.cell_arrays.begin(), grid.cell_arrays.end(),
                       [&](const Array &array) {
                         return array.name == name && array.n_components == 1;
                       });
      return found == grid.cell_arrays.end() ? nullptr : &*found;
    }

    class Converter
    {
    public:
      Converter(const Grid &grid, const unsigned int dimension,
                std::vector<std::string> &problems)
          : grid_(grid), problems_(problems)
      {
        mesh_.dimension = dimension;
      }

      NamedMesh convert(const std::string &group_data)
      {
        mesh_.coordinates = grid_.coordinates;
        if (!is_whole() || !choose_groups(group_data))
          return {};
        for (std::size_t c = 0; c < grid_.types.size(); ++c)
          if (!add_cell(c))
            return {};
        if (!refuse_foreign())
          return {};
        add_values();
        note_straight_sides(mesh_, n_curved_);
        return std::move(mesh_);
      }

    private:
      bool fail(const std::string &problem)
      {
        problems_.push_back(problem);
        return false;
      }

      bool is_whole()
      {
        const std::size_t n = grid_.types.size();
        if (n == 0 || grid_.first.size() != n + 1)
          return fail("it has no cells, or not a type for each");
        if (grid_.coordinates.size() % 3 != 0)
          return fail("its points have no three coordinates each");
        // numbers beyond it are no indices, and no doubles are lost below
        if (grid_.coordinates.size() / 3 >
            std::numeric_limits<unsigned int>::max())
          return fail("it has more points than can be counted");
        for (const Array &array : grid_.cell_arrays)
          if (array.values.size() != n * array.n_components)
            return fail(fmt::format("the array `{}` has {} values; {} cells "
                                    "with {} each need {}",
                                    array.name, array.values.size(), n,
                                    array.n_components,
                                    n * array.n_components));
        return true;
      }

      bool choose_groups(const std::string &wanted)
      {
        if (!wanted.empty()) {
          groups_ = find_array(grid_, wanted);
          std::vector<std::string> names;
          for (const Array &array : grid_.cell_arrays)
            if (array.n_components == 1)
              names.push_back(array.name);
          if (groups_ == nullptr)
            return fail(fmt::format(
                "it has no cell data `{}` of one component for `group data`; "
                "{}",
                wanted,
                names.empty()
                    ? "it has none at all"
                    : fmt::format("it has {}", fmt::join(names, ", "))));
        }
        for (const char *name : group_names)
          if (groups_ == nullptr)
            groups_ = find_array(grid_, name);
        if (groups_ == nullptr)
          return true;
        for (std::size_t c = 0; c < groups_->values.size(); ++c) {
          const double value = groups_->values[c];
          if (value == std::floor(value) &&
              std::abs(value) < std::numeric_limits<int>::max())
            continue;
          // what only looks like the number of a group is a field
          groups_ = nullptr;
          return wanted.empty() ||
                 fail(fmt::format("`group data` = {}: the value {:g} of cell "
                                  "{} is no whole number",
                                  wanted, value, c));
        }
        return true;
      }

      bool add_cell(const std::size_t c)
      {
        const double begin = grid_.first[c], end = grid_.first[c + 1];
        if (!(begin >= 0. && end >= begin &&
              end <= double(grid_.points.size())))
          return fail(fmt::format("the points of cell {} are not there", c));
        const auto n = std::size_t(end - begin);
        int type = int(std::clamp(grid_.types[c], -1., 1000.));
        if (type == 7 && (n == 3 || n == 4))
          type = n == 3 ? 5 : 9;
        const auto shape = shapes.find(type);
        if (shape == shapes.end()) {
          const auto known = foreign.find(type);
          if (known != foreign.end())
            ++n_foreign_[known->second];
          else if (type > 4) // vertices and lines are no faces of any cell
            ++n_foreign_[fmt::format("of VTK's type {}", type)];
          return true;
        }
        const auto &[d, order, is_curved] = shape->second;
        if (d > mesh_.dimension)
          return fail("it is a mesh of 3 dimensions, the scene has 2; write "
                      "`set dimension = 3` at the top, or bring another file");
        if (d + 1 < mesh_.dimension)
          return true;
        if (n < order.size())
          return fail(fmt::format("cell {} has {} points, its type {} needs {}",
                                  c, n, type, order.size()));
        std::vector<unsigned int> corners;
        for (const unsigned int k : order) {
          const double point = grid_.points[std::size_t(begin) + k];
          if (!(point >= 0. && point < double(mesh_.n_vertices())))
            return fail(
                fmt::format("cell {} has a vertex that is not there", c));
          corners.push_back(unsigned(point));
        }
        const bool is_cell = d == mesh_.dimension;
        (is_cell ? mesh_.cells : mesh_.faces).add(corners, set_of(d, c), c);
        n_curved_ += is_curved && is_cell;
        return true;
      }

      unsigned int set_of(const unsigned int dimension, const std::size_t c)
      {
        if (groups_ == nullptr)
          return 0;
        const auto [entry, is_new] =
            set_.emplace(std::pair(dimension, int(groups_->values[c])), 0);
        if (is_new) {
          mesh_.groups.push_back(
              {dimension, int(groups_->values[c]), "", 0, 0});
          entry->second = unsigned(mesh_.sets.size());
          mesh_.sets.push_back({unsigned(mesh_.groups.size() - 1)});
        }
        return entry->second;
      }

      bool refuse_foreign()
      {
        std::string list;
        for (const auto &[name, n] : n_foreign_)
          list += fmt::format("{}{} {}", list.empty() ? "" : ", ", n, name);
        return list.empty() ||
               fail(fmt::format("it has cells that cannot be used: {}; mesh "
                                "with triangles, quads, tetrahedra, hexes or "
                                "prisms",
                                list));
      }

      void add_values()
      {
        const auto &numbers = mesh_.cells.numbers;
        for (const Array &array : grid_.cell_arrays) {
          if (array.n_components == 1) {
            std::vector<double> values;
            values.reserve(numbers.size());
            for (const std::size_t c : numbers)
              values.push_back(array.values[c]);
            add_field(mesh_, array.name, std::move(values));
          } else if (array.n_components == 3) {
            auto &values = mesh_.element_data[array.name];
            for (const std::size_t c : numbers) {
              const auto at = array.values.begin() + std::ptrdiff_t(3 * c);
              values.emplace_hint(values.end(), c,
                                  std::vector<double>(at, at + 3));
            }
          }
        }
      }

      const Grid &grid_;
      std::vector<std::string> &problems_;
      const Array *groups_ = nullptr;
      NamedMesh mesh_;
      std::map<std::pair<unsigned int, int>, unsigned int> set_; ///< of a group
      std::map<std::string, std::size_t> n_foreign_;
      std::size_t n_curved_ = 0;
    };
  } // namespace

  NamedMesh mesh_of(const Grid &grid, const unsigned int dimension,
                    const std::string &group_data,
                    std::vector<std::string> &problems)
  {
    return Converter(grid, dimension, problems).convert(group_data);
  }
} // namespace nsfd::vtk
