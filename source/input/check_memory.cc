#include "core/machine_memory.h"
#include "nsfd/mesh/mesh_type.h"
#include "read_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace nsfd
{
  namespace
  {
    double n_cells(const MeshInput &mesh, const unsigned int dimension)
    {
      const double refined = std::ldexp(1., int(dimension * mesh.refinements));
      const auto type = find_mesh_type(mesh.type);
      double n = type ? type->n_cells(mesh, dimension) : 1.;
      if (mesh.split_simplices)
        n *= dimension + 1;
      if (mesh.split_barycentric)
        n *= dimension == 2 ? 6. : 24.;
      return n * refined;
    }

    /**
     * Bytes per cell as measured with `--check` on 1e3 to 1e4 cells, degrees 1
     * to 4: the mesh, what a face point needs (frames, traces of the cells at
     * both sides, history), and the matrix of bonded faces with its factors,
     * which short steps do without. The true numbers are within a factor of
     * two.
     */
    double bytes_per_cell(const SceneInput &scene)
    {
      const unsigned int dim = scene.dimension;
      const double n_unknowns =
          dim * std::pow(scene.discretization.degree + 1., dim);
      const double n_points =
          dim *
          std::pow(double(scene.discretization.interface_points), dim - 1.);
      const double mesh = dim == 2 ? 600. : 1200.;
      if (scene.time.scheme.at_nodes) // joined cells have no blocks
        return mesh + 650. * n_points +
               (scene.axisymmetric ? 6500. : 0.); // but rings have
      const double point = (dim == 2 ? 600. : 1200.) + 16. * n_unknowns;
      const bool iterates =
          !scene.statics && scene.discretization.degree == 1 &&
          scene.time.step_kind == StepKind::courant && scene.time.step <= 2.;
      const double matrix =
          scene.has_bonded_faces() && !iterates
              ? 2.7 * 8. * n_unknowns * n_unknowns * (2. * dim + 1.)
              : 0.;
      return mesh + n_points * point + matrix;
    }

    /** Ranks of this machine over all, as mpirun says. */
    double share_of_machine()
    {
      const char *all = std::getenv("OMPI_COMM_WORLD_SIZE");
      const char *here = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
      if (all == nullptr || here == nullptr)
        return 1.;
      const double n = std::atof(all), m = std::atof(here);
      return n >= 1. && m >= 1. ? std::min(1., m / n) : 1.;
    }
  } // namespace

  void check_memory(ParameterFile &file, InputErrors &errors,
                    const SceneInput &scene)
  {
    double cells = 0.;
    if (scene.mesh.type == "bodies")
      for (const BodyInput &body : scene.bodies)
        cells += n_cells(body.mesh, scene.dimension);
    else
      cells = n_cells(scene.mesh, scene.dimension);
    const double bytes = cells * bytes_per_cell(scene) * share_of_machine();
    const double available = available_memory();
    if (bytes <= available)
      return;
    SectionReader reader(file.open("Mesh"), errors);
    const char *const entry = scene.mesh.refinements > 0 ? "refinements"
                              : scene.mesh.cells.empty() ? "type"
                                                         : "cells";
    constexpr double gigabyte = 1e9;
    reader.error(
        entry,
        fmt::format("the mesh would have {:.3g} cells, which take about "
                    "{:.3g} GB of memory, and {:.3g} GB are free",
                    cells, bytes / gigabyte, available / gigabyte),
        fmt::format("write fewer cells: at most about {:.2g}",
                    cells * available / bytes));
  }
} // namespace nsfd
