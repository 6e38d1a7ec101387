#include "model_checks.h"

#include "discretization/cells.h"

#include "print_problems.h"

#include <deal.II/grid/tria.h>

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  namespace
  {
    std::string after_semicolon(const std::string &sentence)
    {
      return sentence.empty() ? "" : "; " + sentence;
    }

    /** As of materials that own no cell: of faces, and of broken ones. */
    template <int dim>
    void warn_of_unused_interfaces(const SceneInput &input,
                                   const Model<dim> &model,
                                   const Communicator &communicator)
    {
      const auto &origins = model.discretization->origins();
      const std::size_t n_blocks = input.interfaces.size();
      std::vector<char> has_faces(n_blocks, 0), has_broken(n_blocks, 0);
      for (std::size_t i = 0; i < model.discretization->points().n_owned; ++i) {
        if (origins[i].kind != PointOrigin::Kind::interface)
          continue;
        const InterfaceInput &block = input.interfaces[origins[i].block];
        has_faces[origins[i].block] = 1;
        if (block.has_broken && !has_broken[origins[i].block])
          has_broken[origins[i].block] =
              block.broken.at(position_of(model.discretization->points(), i)) !=
              0.;
      }
      // a mesh of single cells has no faces for anyone
      const bool any_faces = communicator.any(
          std::any_of(has_faces.begin(), has_faces.end(),
                      [](const char has) { return has != 0; }));
      std::vector<std::string> warnings;
      for (std::size_t b = 0; b < n_blocks; ++b) {
        const InterfaceInput &block = input.interfaces[b];
        const std::string name = block.section();
        if (!any_faces && block.where.kind == Where::Kind::all)
          continue;
        if (!communicator.any(has_faces[b]))
          warnings.push_back(
              name +
              ": no face; `where` holds nowhere, or only "
              "where an earlier section does" +
              after_semicolon(model.groups->missing(block.where)));
        else if (block.has_broken && !communicator.any(has_broken[b]))
          warnings.push_back(name + "/broken: no point of its faces is broken");
      }
      print_problems(communicator, input, "warning", warnings);
    }
  } // namespace

  /** Blocks that hold nowhere are mistakes. */
  template <int dim>
  void find_unused_blocks(const SceneInput &input, const Model<dim> &model,
                          const Communicator &communicator,
                          std::vector<std::string> &problems)
  {
    const auto check = [&](const std::string &name, const Where &where) {
      bool any = false;
      for (const auto &cell : model.triangulation->active_cell_iterators())
        if (cell->is_locally_owned())
          for (const unsigned int f : cell->face_indices())
            any = any || model.groups->holds_boundary_face(where, cell, f);
      if (!communicator.any(any))
        problems.push_back(name + ": no boundary face of the mesh is there" +
                           after_semicolon(model.groups->missing(where)));
    };
    for (const auto &boundary : input.boundaries)
      check("Boundary: " + boundary.name, boundary.where);
    for (const auto &obstacle : input.obstacles)
      check("Obstacle: " + obstacle.name, obstacle.where);
    if (!input.mesh_changes()) // refined cells have new faces
      warn_of_unused_interfaces(input, model, communicator);
  }

  template void find_unused_blocks(const SceneInput &, const Model<2> &,
                                   const Communicator &,
                                   std::vector<std::string> &);
  template void find_unused_blocks(const SceneInput &, const Model<3> &,
                                   const Communicator &,
                                   std::vector<std::string> &);
} // namespace nsfd
