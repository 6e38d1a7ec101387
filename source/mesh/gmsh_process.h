#pragma once

#include <optional>

namespace nsfd
{
  /**
   * Gmsh and OpenCASCADE work in a process of their own: this program, started
   * again with a hidden first argument. The first thing that `main` does,
   * before MPI: if this is such a process, do its work and return its exit
   * code. Without this call no mesh goes through Gmsh.
   */
  std::optional<int> run_gmsh_if_asked(int argc, char **argv);
} // namespace nsfd
