#include "mesh_builder.h"

#include "core/communicator.h"

#include "coarse_mesh.h"
#include "named_mesh.h"

#include <deal.II/base/mpi.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <set>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    constexpr std::array<const char *, 6> sides = {
        {"left", "right", "bottom", "top", "back", "front"}};

    template <int dim>
    int side_number(const std::string &name)
    {
      const auto found =
          std::find(sides.begin(), sides.begin() + 2 * dim, name);
      return found == sides.begin() + 2 * dim ? -1 : int(found - sides.begin());
    }

    template <int dim>
    std::pair<Point<dim>, Point<dim>>
    global_box(const Triangulation<dim> &triangulation)
    {
      // largest of -x and of x
      std::array<double, 2 * dim> ends;
      ends.fill(-std::numeric_limits<double>::max());
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
          for (const unsigned int v : cell->vertex_indices())
            for (unsigned int d = 0; d < dim; ++d) {
              ends[d] = std::max(ends[d], -cell->vertex(v)[d]);
              ends[dim + d] = std::max(ends[dim + d], cell->vertex(v)[d]);
            }
      MPI_Allreduce(MPI_IN_PLACE, ends.data(), 2 * dim, MPI_DOUBLE, MPI_MAX,
                    triangulation.get_communicator());
      std::pair<Point<dim>, Point<dim>> box;
      for (unsigned int d = 0; d < dim; ++d) {
        box.first[d] = -ends[d];
        box.second[d] = ends[dim + d];
      }
      return box;
    }

    bool contains(const std::vector<std::string> &list, const std::string &name)
    {
      return std::find(list.begin(), list.end(), name) != list.end();
    }

    /** Ids that no file has given are in no set. */
    bool is_in(const std::vector<bool> &sets, const unsigned int id)
    {
      return id < sets.size() && sets[id];
    }
  } // namespace

  template <int dim>
  MeshGroups<dim>::MeshGroups(const SceneInput &input,
                              const Triangulation<dim> &triangulation)
      : box_(global_box(triangulation))
  {
    if (input.mesh.type == "bodies")
      for (const BodyInput &body : input.bodies)
        bodies_.push_back(body.name);
    std::set<unsigned int> materials, boundaries;
    for (const auto &cell : triangulation.active_cell_iterators()) {
      if (!cell->is_locally_owned())
        continue;
      materials.insert(cell->material_id());
      for (const unsigned int f : cell->face_indices())
        if (cell->face(f)->at_boundary())
          boundaries.insert(cell->face(f)->boundary_id());
    }
    const auto names = [&](std::set<unsigned int> &ids) {
      ids = Utilities::MPI::compute_set_union(ids,
                                              triangulation.get_communicator());
      std::vector<std::string> result;
      for (const unsigned int id : ids)
        result.push_back(std::to_string(id));
      return result;
    };
    material_ids_ = names(materials);
    boundary_ids_ = names(boundaries);

    has_named_ = input.mesh.named != nullptr;
    if (has_named_)
      first_of_groups_ = first_of_groups(*input.mesh.named);
    if (has_named_)
      for (const auto &[group, sets] : sets_of_groups(*input.mesh.named)) {
        named_[group].of_cells = sets.of_cells;
        named_[group].of_faces = sets.of_faces;
      }
  }

  template <int dim>
  bool MeshGroups<dim>::holds_side(const std::string &side,
                                   const Point<dim> &face_centre) const
  {
    const int number = side_number<dim>(side);
    if (number < 0)
      return false;
    const unsigned int d = number / 2;
    const Point<dim> &corner = number % 2 == 0 ? box_.first : box_.second;
    const double size = (box_.second - box_.first).norm();
    return std::abs(face_centre[d] - corner[d]) <= 1e-9 * size;
  }

  template <int dim>
  bool MeshGroups<dim>::holds_material_id(const std::string &group,
                                          const types::material_id id) const
  {
    if (has_named_) {
      const auto found = named_.find(group);
      return found != named_.end() && is_in(found->second.of_cells, id);
    }
    const auto body = std::find(bodies_.begin(), bodies_.end(), group);
    return body != bodies_.end()
               ? id == types::material_id(body - bodies_.begin())
               : group == std::to_string(id);
  }

  template <int dim>
  bool MeshGroups<dim>::between_groups(
      const std::array<std::string, 2> &names,
      const std::array<types::material_id, 2> &ids) const
  {
    if (names[0].empty() && names[1].empty()) {
      const auto groups_of = [this](const types::material_id id) {
        return id < first_of_groups_.size() ? first_of_groups_[id] : id;
      };
      return groups_of(ids[0]) != groups_of(ids[1]);
    }
    const auto in = [&](const unsigned int group, const unsigned int side) {
      return holds_material_id(names[group], ids[side]);
    };
    return (in(0, 0) && in(1, 1)) || (in(0, 1) && in(1, 0));
  }

  template <int dim>
  bool MeshGroups<dim>::holds_cell(const Where &where, const Cell &cell) const
  {
    switch (where.kind) {
    case Where::Kind::all:
      return true;
    case Where::Kind::side:
      for (const unsigned int f : cell->face_indices())
        if (holds_boundary_face(where, cell, f))
          return true;
      return false;
    case Where::Kind::group:
      return holds_material_id(where.name, cell->material_id());
    case Where::Kind::between_materials:
    case Where::Kind::between_groups:
      return false;
    case Where::Kind::expression:
      return where.condition.at(cell->center()) != 0.;
    }
    return false;
  }

  template <int dim>
  bool MeshGroups<dim>::holds_boundary_face(const Where &where,
                                            const Cell &cell,
                                            const unsigned int face_no) const
  {
    const auto face = cell->face(face_no);
    if (!face->at_boundary())
      return false;
    switch (where.kind) {
    case Where::Kind::all:
      return true;
    case Where::Kind::side:
      return holds_side(where.name, asked_at(face->index(), face->center()));
    case Where::Kind::group:
      if (has_named_) {
        const auto group = named_.find(where.name);
        return group != named_.end() &&
               (group->second.of_faces.empty()
                    ? is_in(group->second.of_cells, cell->material_id())
                    : is_in(group->second.of_faces, face->manifold_id()));
      }
      return contains(bodies_, where.name)
                 ? holds_material_id(where.name, cell->material_id())
                 : where.name == std::to_string(face->boundary_id());
    case Where::Kind::between_materials:
    case Where::Kind::between_groups:
      return false;
    case Where::Kind::expression:
      return where.condition.at(asked_at(face->index(), face->center())) != 0.;
    }
    return false;
  }

  template <int dim>
  bool MeshGroups<dim>::holds_interior_face(
      const Where &where, const Point<dim> &face_centre,
      const std::string &material_1, const std::string &material_2,
      const std::array<types::material_id, 2> &material_ids,
      const types::manifold_id face_id) const
  {
    switch (where.kind) {
    case Where::Kind::all:
      return true;
    case Where::Kind::side:
      return false;
    case Where::Kind::between_groups:
      return between_groups(where.materials, material_ids);
    case Where::Kind::group:
      if (const auto group = named_.find(where.name);
          group != named_.end() && !group->second.of_faces.empty())
        return is_in(group->second.of_faces, face_id);
      return holds_material_id(where.name, material_ids[0]) &&
             holds_material_id(where.name, material_ids[1]);
    case Where::Kind::between_materials: {
      const auto &[a, b] = where.materials;
      if (a.empty() && b.empty())
        return material_1 != material_2;
      return (a == material_1 && b == material_2) ||
             (a == material_2 && b == material_1);
    }
    case Where::Kind::expression:
      return where.condition.at(face_centre) != 0.;
    }
    return false;
  }

  template <int dim>
  std::string MeshGroups<dim>::missing(const Where &where) const
  {
    if (where.kind == Where::Kind::side && side_number<dim>(where.name) < 0)
      return fmt::format(
          "there is no side `{}` in {} dimensions; there are {}", where.name,
          dim, fmt::join(sides.begin(), sides.begin() + 2 * dim, ", "));
    // those of a mesh of its own have been compared when the file was read
    if (where.kind != Where::Kind::group || has_named_ ||
        contains(bodies_, where.name) || contains(material_ids_, where.name) ||
        contains(boundary_ids_, where.name))
      return "";
    return fmt::format(
        "the mesh has no group `{}`; there are {}material ids {} and boundary "
        "ids {}",
        where.name,
        bodies_.empty() ? ""
                        : fmt::format("bodies {}, ", fmt::join(bodies_, ", ")),
        fmt::join(material_ids_, ", "), fmt::join(boundary_ids_, ", "));
  }

  template <int dim>
  std::vector<unsigned int>
  material_indices(const SceneInput &input, const MeshGroups<dim> &groups,
                   const Triangulation<dim> &triangulation,
                   std::vector<std::string> &problems,
                   std::vector<std::string> &warnings)
  {
    const auto &materials = input.materials;
    const std::size_t n_problems = problems.size();
    for (const MaterialInput &material : materials) {
      const std::string missing = groups.missing(material.where);
      if (!missing.empty())
        problems.push_back("Material: " + material.name + ": " + missing);
    }

    std::vector<unsigned int> result(triangulation.n_active_cells(),
                                     numbers::invalid_unsigned_int);
    // cells per block, at the end those that have none
    std::vector<unsigned long long> n_cells(materials.size() + 1, 0);
    std::array<double, dim> place;
    place.fill(std::numeric_limits<double>::max());
    for (const auto &cell : triangulation.active_cell_iterators()) {
      if (cell->is_artificial())
        continue;
      // mass stays where it is when the cells of an adaptive mesh change
      typename Triangulation<dim>::cell_iterator owner = cell;
      while (input.adaptivity && owner->level() > 0)
        owner = owner->parent();
      const auto first =
          std::find_if(materials.begin(), materials.end(), [&](const auto &m) {
            return groups.holds_cell(m.where, owner);
          });
      const std::size_t index = first - materials.begin();
      if (first != materials.end())
        result[cell->active_cell_index()] = index;
      if (!cell->is_locally_owned())
        continue;
      ++n_cells[index];
      if (first == materials.end()) {
        std::array<double, dim> centre;
        for (unsigned int d = 0; d < dim; ++d)
          centre[d] = cell->center()[d];
        place = std::min(place, centre);
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, n_cells.data(), int(n_cells.size()),
                  MPI_UNSIGNED_LONG_LONG, MPI_SUM,
                  triangulation.get_communicator());
    if (n_cells.back() > 0) {
      for (const auto &other :
           Utilities::MPI::all_gather(triangulation.get_communicator(), place))
        place = std::min(place, other);
      Point<dim> p;
      for (unsigned int d = 0; d < dim; ++d)
        p[d] = place[d];
      problems.push_back(fmt::format(
          "{} of {} cells have no material, the first at {}; add a `Material:` "
          "section with `where = all` at the end",
          n_cells.back(), triangulation.n_global_active_cells(), text(p)));
    }
    if (problems.size() == n_problems)
      for (std::size_t m = 0; m < materials.size(); ++m)
        if (n_cells[m] == 0)
          warnings.push_back(fmt::format(
              "Material: {}: no cell; `where` holds nowhere, or only "
              "where an earlier section does",
              materials[m].name));
    return result;
  }

  template class MeshGroups<2>;
  template class MeshGroups<3>;
  template std::vector<unsigned int>
  material_indices(const SceneInput &, const MeshGroups<2> &,
                   const Triangulation<2> &, std::vector<std::string> &,
                   std::vector<std::string> &);
  template std::vector<unsigned int>
  material_indices(const SceneInput &, const MeshGroups<3> &,
                   const Triangulation<3> &, std::vector<std::string> &,
                   std::vector<std::string> &);
} // namespace nsfd
