#pragma once

#include "mesh_file.h"

#include <string>
#include <vector>

namespace nsfd
{
  class SectionReader;
  struct MeshInput;

  /** Entry `split simplices`. */
  bool read_split(SectionReader &reader);

  /** Entry `meshing time`: s of CPU. */
  double read_meshing_time(SectionReader &reader);

  /**
   * Entries `file`, `format`, `length unit`. False if the file cannot be
   * opened, which is reported.
   */
  bool read_file_entries(SectionReader &reader, MeshFileRequest &request);

  /** Reports the problems at @p entry, or keeps the mesh. */
  void store_named_mesh(SectionReader &reader, const std::string &entry,
                        NamedMesh &&named,
                        const std::vector<std::string> &problems,
                        MeshInput &mesh);
} // namespace nsfd
