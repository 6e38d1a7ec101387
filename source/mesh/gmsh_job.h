#pragma once

#include "gmsh_reader.h"

#include <boost/serialization/map.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/vector.hpp>

#include <string>
#include <vector>

namespace nsfd
{
  /** What a process that runs Gmsh or HDF5 has to do; it knows nothing else. */
  struct GmshJob {
    enum class Kind { file, regions, exodus };
    Kind kind = Kind::file;
    std::string folder; ///< of its own; `request.file` is in it
    GmshRequest request;
    PlaneRegions regions;
    double memory = 0.; ///< bytes it may have
  };

  /** What comes back. */
  struct GmshResult {
    NamedMesh mesh;
    std::vector<std::string> problems;
  };

  template <typename Archive>
  void serialize(Archive &archive, GmshRequest &request, unsigned int)
  {
    archive &request.file &request.extension &request.dimension &request
        .is_geometry &request.element_size &request.shape &request.seconds;
  }

  template <typename Archive>
  void serialize(Archive &archive, PlaneRegions &regions, unsigned int)
  {
    archive &regions.x &regions.y &regions.corners &regions.names &regions
        .borders;
  }

  template <typename Archive>
  void serialize(Archive &archive, GmshJob &job, unsigned int)
  {
    archive &job.kind &job.folder &job.request &job.regions &job.memory;
  }

  template <typename Archive>
  void serialize(Archive &archive, NamedMesh::Elements &elements, unsigned int)
  {
    archive &elements.first &elements.vertices &elements.set &elements.numbers;
  }

  template <typename Archive>
  void serialize(Archive &archive, NamedMesh::Group &group, unsigned int)
  {
    archive &group.dimension &group.number &group.name &group.n_elements &group
        .n_boundary;
  }

  template <typename Archive>
  void serialize(Archive &archive, NamedMesh &mesh, unsigned int)
  {
    archive &mesh.dimension &mesh.coordinates &mesh.cells &mesh.faces &mesh
        .groups &mesh.sets &mesh.element_data &mesh.fields &mesh.notes;
  }

  template <typename Archive>
  void serialize(Archive &archive, GmshResult &result, unsigned int)
  {
    archive &result.mesh &result.problems;
  }

  /** In this process: only where nothing is lost if it crashes. */
  NamedMesh read_gmsh_here(const GmshRequest &request,
                           std::vector<std::string> &problems);
  NamedMesh mesh_regions_here(const PlaneRegions &regions,
                              const GmshRequest &request,
                              std::vector<std::string> &problems);
} // namespace nsfd
