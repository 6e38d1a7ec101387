#pragma once

#include <string>

namespace nsfd
{
  struct SceneInput;

  /** What was asked for: `nsfd mesh FILE` and its options. */
  struct MeshCommand {
    std::string output; ///< empty: output/mesh_NAME of NAME.prm
    bool force = false, quiet = false, check = false;
  };

  /**
   * Print the sizes, the angles and the bias of the mesh of a scene, and draw
   * the bias by direction. On one process.
   *
   * @return exit_code::done, or bad_input with every problem named
   */
  int run_mesh(const SceneInput &input, const MeshCommand &command);
} // namespace nsfd
