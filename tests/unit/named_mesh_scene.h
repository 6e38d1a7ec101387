#pragma once

#include "input/read_scene.h"
#include "mesh/mesh_builder.h"
#include "mesh/named_mesh.h"

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>

namespace nsfd
{
  namespace test
  {
    /** The name of a test whose parameter is that of a file. */
    template <typename Info>
    std::string file_as_name(const Info &info)
    {
      std::string name = info.param;
      for (char &c : name)
        if (c == '.')
          c = '_';
      return name;
    }

    /** A scene of one material with these lines in its section Mesh. */
    inline std::string mesh_scene(const unsigned int dimension,
                                  const std::string &mesh_lines,
                                  const std::string &more = "")
    {
      return "set dimension = " + std::to_string(dimension) +
             "\nsubsection Mesh\n" + mesh_lines +
             "\nend\nsubsection Material: bulk\n  set Young modulus = 1\n"
             "  set Poisson ratio = 0.3\n  set density = 1\nend\n" +
             more +
             "subsection Interface: all\n  set law = elastic\n"
             "  set normal stiffness = 1\n  set tangential stiffness = 1\nend\n"
             "subsection Time\n  set end = 1\n  set step = 1\nend\n";
    }

    /** What is wrong with such a scene; empty if nothing is. */
    inline std::string errors_of(const std::string &scene)
    {
      InputErrors errors;
      read_scene_text(scene, "test.prm", {}, errors);
      return errors.has_errors() ? errors.report() : "";
    }

    /** Input and mesh of a scene that must be right. */
    template <int dim>
    struct BuiltMesh {
      explicit BuiltMesh(const std::string &scene)
      {
        InputErrors errors;
        input = read_scene_text(scene, "test.prm", {}, errors);
        EXPECT_TRUE(input) << errors.report();
        if (!input)
          return;
        std::vector<std::string> problems;
        triangulation = build_mesh<dim>(*input, MPI_COMM_WORLD, problems);
        EXPECT_TRUE(problems.empty()) << problems.front();
        if (triangulation)
          groups = std::make_unique<MeshGroups<dim>>(*input, *triangulation);
      }

      const NamedMesh &named() const { return *input->mesh.named; }

      /** Sum over the cells where a group of the mesh holds. */
      double volume(const std::string &group) const
      {
        double sum = 0.;
        for (const auto &cell : triangulation->active_cell_iterators())
          if (cell->is_locally_owned() &&
              groups->holds_cell(where(group), cell))
            sum += cell->measure();
        return of_all_ranks(sum);
      }

      double boundary_area(const std::string &group) const
      {
        double sum = 0.;
        for (const auto &cell : triangulation->active_cell_iterators())
          for (const unsigned int f : cell->face_indices())
            if (cell->is_locally_owned() &&
                groups->holds_boundary_face(where(group), cell, f))
              sum += cell->face(f)->measure();
        return of_all_ranks(sum);
      }

      double inner_area(const Where &where) const
      {
        double sum = 0.;
        for (const auto &cell : triangulation->active_cell_iterators())
          for (const unsigned int f : cell->face_indices()) {
            const auto face = cell->face(f);
            if (!cell->is_locally_owned() || face->at_boundary())
              continue; // half of a face for each of its cells
            if (groups->holds_interior_face(
                    where, face->center(), "", "",
                    {{cell->material_id(), cell->neighbor(f)->material_id()}},
                    face->manifold_id()))
              sum += face->measure() / 2.;
          }
        return of_all_ranks(sum);
      }
      double inner_area(const std::string &group) const
      {
        return inner_area(where(group));
      }

      static double of_all_ranks(const double sum)
      {
        return dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
      }

      static Where where(const std::string &group)
      {
        Where result;
        result.kind = group == "all" ? Where::Kind::all : Where::Kind::group;
        result.name = group;
        return result;
      }

      std::unique_ptr<SceneInput> input;
      std::unique_ptr<dealii::Triangulation<dim>> triangulation;
      std::unique_ptr<MeshGroups<dim>> groups;
    };

    /** A file of the test's own, gone with the object. */
    class TemporaryFile
    {
    public:
      TemporaryFile(const std::string &name, const std::string &content)
          : path_(testing::TempDir() + "nsfd_" + name)
      {
        // each rank its own, and whole at once: others may read it already
        const std::string own = path_ + "." + std::to_string(getpid());
        std::ofstream(own, std::ios::binary) << content;
        std::filesystem::rename(own, path_);
      }
      ~TemporaryFile() { std::remove(path_.c_str()); }
      TemporaryFile(const TemporaryFile &) = delete;
      TemporaryFile &operator=(const TemporaryFile &) = delete;

      const std::string &path() const { return path_; }
      /** Entries of a section Mesh that read it. */
      std::string entries(const std::string &more = "") const
      {
        return "set type = file\nset file = " + path_ + "\n" + more;
      }

    private:
      std::string path_;
    };
  } // namespace test
} // namespace nsfd
