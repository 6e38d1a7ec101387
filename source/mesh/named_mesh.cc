#include "named_mesh.h"

#include "cell_shapes.h"
#include "parameters/formula.h"
#include "parameters/quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>

namespace nsfd
{
  void NamedMesh::Elements::add(const std::vector<unsigned int> &corners,
                                const unsigned int in_set)
  {
    vertices.insert(vertices.end(), corners.begin(), corners.end());
    first.push_back(vertices.size());
    set.push_back(in_set);
  }

  void NamedMesh::Elements::add(const std::vector<unsigned int> &corners,
                                const unsigned int in_set,
                                const std::size_t number)
  {
    add(corners, in_set);
    numbers.push_back(number);
  }

  std::string NamedMesh::Group::label() const
  {
    return name.empty() ? std::to_string(number) : name;
  }

  void note_straight_sides(NamedMesh &mesh, const std::size_t n)
  {
    if (n > 0)
      mesh.notes.push_back(
          fmt::format("{} cells are of higher order in the file: their corners "
                      "are used, their sides are straight",
                      n));
  }

  unsigned int NamedMesh::set_of(std::vector<unsigned int> groups_of_element)
  {
    std::sort(groups_of_element.begin(), groups_of_element.end());
    groups_of_element.erase(
        std::unique(groups_of_element.begin(), groups_of_element.end()),
        groups_of_element.end());
    const auto found = std::find(sets.begin(), sets.end(), groups_of_element);
    if (found == sets.end()) {
      sets.push_back(groups_of_element);
      return unsigned(sets.size() - 1);
    }
    return unsigned(found - sets.begin());
  }

  std::string field_name(const std::string &name_in_file)
  {
    std::string name;
    for (const char c : name_in_file)
      name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    const bool is_taken = name.empty() || is_formula_word(name) ||
                          find_unit(name) ||
                          std::isdigit(static_cast<unsigned char>(name[0]));
    return is_taken ? "cell_" + name : name;
  }

  void add_field(NamedMesh &mesh, const std::string &name_in_file,
                 std::vector<double> values)
  {
    const std::string name = field_name(name_in_file);
    if (!mesh.fields.emplace(name, std::move(values)).second)
      mesh.notes.push_back(fmt::format("the cell data `{}` are left out: there "
                                       "are others that formulas know as `{}`",
                                       name_in_file, name));
    else if (name != name_in_file)
      mesh.notes.push_back(fmt::format(
          "the cell data `{}` are `{}` in formulas", name_in_file, name));
  }

  std::map<std::string, SetsOfNamedGroup> sets_of_groups(const NamedMesh &mesh)
  {
    std::map<std::string, SetsOfNamedGroup> result;
    const auto mark = [&](const std::string &word, const unsigned int g) {
      auto &[of_cells, of_faces] = result[word];
      auto &of =
          mesh.groups[g].dimension == mesh.dimension ? of_cells : of_faces;
      of.resize(mesh.sets.size(), false);
      for (std::size_t s = 0; s < mesh.sets.size(); ++s)
        if (std::binary_search(mesh.sets[s].begin(), mesh.sets[s].end(), g))
          of[s] = true;
    };
    for (unsigned int g = 0; g < mesh.groups.size(); ++g)
      if (!mesh.groups[g].name.empty())
        mark(mesh.groups[g].name, g);
    const auto is_name = [&](const std::string &word) {
      return std::any_of(mesh.groups.begin(), mesh.groups.end(),
                         [&](const auto &group) { return group.name == word; });
    };
    for (unsigned int g = 0; g < mesh.groups.size(); ++g) {
      const std::string number = std::to_string(mesh.groups[g].number);
      if (!is_name(number))
        mark(number, g);
    }
    return result;
  }

  void sort_by_data(NamedMesh &mesh)
  {
    if (mesh.element_data.empty())
      return;
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    std::map<std::vector<double>, unsigned int> set_of_values;
    std::vector<bool> is_taken(mesh.sets.size(), false);
    for (auto &[name, values] : mesh.element_data)
      mesh.cell_data[name].assign(mesh.sets.size(), {{none, none, none}});
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      unsigned int &set = mesh.cells.set[c];
      std::vector<double> key = {double(set)};
      for (const auto &[name, values] : mesh.element_data) {
        const auto found = values.find(mesh.cells.numbers[c]);
        key.push_back(found == values.end() ? 0. : 1.);
        for (unsigned int k = 0; k < 3; ++k)
          key.push_back(found == values.end() ? 0. : found->second[k]);
      }
      const auto [entry, is_new] = set_of_values.emplace(key, set);
      if (is_new) {
        if (is_taken[set]) {
          entry->second = unsigned(mesh.sets.size());
          const auto groups = mesh.sets[set];
          mesh.sets.push_back(groups);
        } else
          is_taken[set] = true;
        std::size_t at = 1;
        for (auto &[name, of_set] : mesh.cell_data) {
          of_set.resize(mesh.sets.size(), {{none, none, none}});
          if (key[at] != 0.)
            of_set[entry->second] = {{key[at + 1], key[at + 2], key[at + 3]}};
          at += 4;
        }
      }
      set = entry->second;
    }
    mesh.element_data.clear();
  }

  std::vector<unsigned int> first_of_groups(const NamedMesh &mesh)
  {
    std::map<std::vector<unsigned int>, unsigned int> first;
    std::vector<unsigned int> result;
    for (unsigned int s = 0; s < mesh.sets.size(); ++s)
      result.push_back(first.emplace(mesh.sets[s], s).first->second);
    return result;
  }

  GrainTable grain_table(const NamedMesh &mesh)
  {
    GrainTable table;
    table.cell_data = mesh.cell_data;
    for (const auto &groups : mesh.sets) {
      const NamedMesh::Group *grain = nullptr;
      for (const unsigned int g : groups)
        if (mesh.groups[g].dimension == mesh.dimension &&
            (grain == nullptr || mesh.groups[g].n_elements < grain->n_elements))
          grain = &mesh.groups[g];
      table.numbers.push_back(grain == nullptr ? 0 : unsigned(grain->number));
    }
    return table;
  }

  std::string count_of_shapes(const NamedMesh &mesh)
  {
    std::map<unsigned int, std::size_t> count;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      ++count[mesh.cells.n_vertices(c)];
    std::string result;
    for (const auto &[n_corners, n] : count) {
      const auto *shape = find_cell_shape(mesh.dimension, n_corners);
      result += fmt::format("{}{} {}", result.empty() ? "" : ", ", n,
                            shape != nullptr ? shape->name : "cells");
    }
    return result;
  }

  bool all_simplices(const NamedMesh &mesh)
  {
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      if (mesh.cells.n_vertices(c) != mesh.dimension + 1)
        return false;
    return true;
  }

  bool mixed_shapes(const NamedMesh &mesh)
  {
    for (std::size_t c = 1; c < mesh.cells.size(); ++c)
      if (mesh.cells.n_vertices(c) != mesh.cells.n_vertices(0))
        return true;
    return false;
  }
} // namespace nsfd
