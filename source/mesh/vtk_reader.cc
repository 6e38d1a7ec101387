#include "mesh_file.h"
#include "vtk_grid.h"

namespace nsfd
{
  NamedMesh read_vtk(const MeshFileRequest &request,
                     std::vector<std::string> &problems)
  {
    const vtk::Grid grid = request.format == MeshFormat::vtk
                               ? vtk::read_legacy(request.file, problems)
                               : vtk::read_xml(request.file, problems);
    if (!problems.empty())
      return {};
    return vtk::mesh_of(grid, request.dimension, request.group_data, problems);
  }
} // namespace nsfd
