#pragma once

#include "nsfd/scene/material_input.h"

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * A mesh with groups of cells and of faces, as a file brings it: plain data,
   * no mesh library. Cells may be triangles, quads, tetrahedra, hexes, prisms,
   * in any mixture; their corners are in deal.II's order.
   */
  struct NamedMesh {
    /** Cells, or faces of cells that belong to a group. */
    struct Elements {
      std::vector<std::size_t> first = {0};
      std::vector<unsigned int> vertices; ///< element e from first[e] on
      std::vector<unsigned int> set;      ///< per element, into `sets`
      /// per element, in the file; empty if there they have none
      std::vector<std::size_t> numbers;

      std::size_t size() const { return set.size(); }
      unsigned int n_vertices(const std::size_t e) const
      {
        return unsigned(first[e + 1] - first[e]);
      }
      const unsigned int *begin(const std::size_t e) const
      {
        return vertices.data() + first[e];
      }
      void add(const std::vector<unsigned int> &corners, unsigned int in_set);
      void add(const std::vector<unsigned int> &corners, unsigned int in_set,
               std::size_t number);
    };

    struct Group {
      unsigned int dimension = 0; ///< that of its elements
      int number = 0;
      std::string name; ///< may be empty
      unsigned long long n_elements = 0;
      unsigned long long n_boundary = 0; ///< faces with a cell on one side only

      /** Name, or number if it has none. */
      std::string label() const;
    };

    unsigned int dimension = 2;
    std::vector<double> coordinates; ///< x, y, z per vertex
    Elements cells, faces;
    std::vector<Group> groups;
    /// what groups an element belongs to, as indices; the first is empty
    std::vector<std::vector<unsigned int>> sets = {{}};
    /// three values that a file gives its cells: by name, then by the number
    /// of the cell in the file
    std::map<std::string, std::map<std::size_t, std::vector<double>>>
        element_data;
    /// a number of each cell, in the order of `cells`, by a name that formulas
    /// may use; not a number where the file has none
    std::map<std::string, std::vector<double>> fields;
    /// three values, by name and set, after sort_by_data()
    std::map<std::string, std::vector<std::array<double, 3>>> cell_data;
    /// what has been changed, and what is odd: a sentence each
    std::vector<std::string> notes;

    std::size_t n_vertices() const { return coordinates.size() / 3; }
    /** Index of the set of these groups, made if need be. */
    unsigned int set_of(std::vector<unsigned int> groups_of_element);
  };

  /**
   * The name by which formulas know a field: letters, digits and _. What means
   * something in every formula, such as `t` or `mm`, gets `cell_` before it.
   */
  std::string field_name(const std::string &name_in_file);

  /**
   * A number of each cell under the name for formulas. A note says what it is
   * called if that is another one, and which of two fields of one name is left.
   */
  void add_field(NamedMesh &mesh, const std::string &name_in_file,
                 std::vector<double> values);

  /** A note that @p n cells are of higher order in the file; none of none. */
  void note_straight_sides(NamedMesh &mesh, std::size_t n);

  /** By set; empty vectors if no element of this kind can belong to it. */
  struct SetsOfNamedGroup {
    std::vector<bool> of_cells, of_faces;
  };

  /**
   * By name and by number. A name stands for all groups that have it; a number
   * means nothing where it is the name of another group.
   */
  std::map<std::string, SetsOfNamedGroup> sets_of_groups(const NamedMesh &mesh);

  /**
   * Cells of different data become those of different sets, which may have the
   * same groups. Cells without data have values that are not a number.
   */
  void sort_by_data(NamedMesh &mesh);

  /** Per set, the first one that has the same groups. */
  std::vector<unsigned int> first_of_groups(const NamedMesh &mesh);

  /** The grain of a set is the smallest group of cells in it, 0 if there is
      none; its number is that of the group. */
  GrainTable grain_table(const NamedMesh &mesh);

  /**
   * Put a mesh as it comes out of a file in order: scaled by @p unit, plane in
   * two dimensions, each cell and face once, cells of positive volume that do
   * not overlap, no unused vertex; with @p merge_vertices those at one place
   * become one. What was done goes into the notes, what cannot be repaired into
   * @p problems.
   */
  void put_in_order(NamedMesh &mesh, double unit, bool merge_vertices,
                    std::vector<std::string> &problems);

  /** "120 quads, 3 triangles" */
  std::string count_of_shapes(const NamedMesh &mesh);

  /** True if all cells are triangles or tetrahedra. */
  bool all_simplices(const NamedMesh &mesh);
  bool mixed_shapes(const NamedMesh &mesh);
} // namespace nsfd
