#pragma once

namespace nsfd
{
  class SectionReader;
  struct MeshInput;

  /** Entries of `type = file`; reads the file, too. */
  void read_mesh_from_file(SectionReader &reader, unsigned int dimension,
                           MeshInput &mesh);

  /** Entry `split simplices`. */
  bool read_split(SectionReader &reader);

  /** Entries of `type = voronoi`; makes the mesh, too. */
  void read_voronoi(SectionReader &reader, MeshInput &mesh);
} // namespace nsfd
