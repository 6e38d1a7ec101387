#include "mesh_quality/mesh_command.h"

#include "common_options.h"
#include "input/read_scene.h"
#include "nsfd/scene/scene_input.h"
#include "parameters/input_errors.h"
#include "processes.h"

#include <iostream>
#include <memory>

namespace nsfd
{
  namespace
  {
    const char *const mesh_footer =
        "Path ratio (2D): the shortest way along faces that may break over "
        "the\n"
        "distance, 240 pairs of points in 24 directions; rose.svg shows it.\n"
        "Cut ratio (3D bricks): the smallest surface of faces between the "
        "cells above\n"
        "and below a plane over the area of the plane, 20 normals; minutes "
        "for 1e6.\n"
        "doc/meshes.md says what meshes have.\n"
        "Example:\n"
        "  nsfd mesh prm/benchmarks/branching_joined.prm --set "
        "'Mesh/seed=2'";

    /** Says what the mesh of a scene does to cracks. */
    class MeshCommandLine final : public Subcommand
    {
    public:
      void declare(CLI::App &app, CommandLine &line) override
      {
        namespace common = common_options;
        app.footer(mesh_footer);
        common::add_file(app, line, "FILE.prm", "the scene with the mesh");
        common::add_set(app, line, "change an entry, 'Section/name=value'",
                        "Mesh/seed=2");
        common::add_output(app, line,
                           "folder for the results, default output/mesh_FILE");
        common::add_force(app, line,
                          "overwrite the results of an earlier look");
        common::add_check(app, line, "print only, write no file");
        common::add_general(app, line);
      }

      void check(CommandLine &line) override
      {
        if (line.file.empty())
          throw WrongUsage("no parameter file is named",
                           "write for example: nsfd mesh prm/quickstart.prm");
      }

      int execute(const CommandLine &line) const override
      {
        return run_on_first_process(line, [&line] {
          InputErrors errors;
          const std::unique_ptr<SceneInput> input =
              read_scene(line.file, line.set, errors);
          std::cerr << errors.report();
          if (!input)
            return exit_code::bad_input;
          return int(run_mesh(
              *input, {line.output, line.force, line.quiet, line.check}));
        });
      }
    };
  } // namespace

  NamedSubcommand mesh_subcommand()
  {
    return {"mesh", "the bias, sizes and angles of the mesh of a scene", "file",
            "look at one mesh at a time", std::make_shared<MeshCommandLine>()};
  }
} // namespace nsfd
