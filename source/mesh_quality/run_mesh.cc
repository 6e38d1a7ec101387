#include "mesh_command.h"

#include "crack_network.h"

#include "core/communicator.h"
#include "core/exit_code.h"
#include "core/load_plug_in.h"
#include "core/output_folder.h"
#include "discretization/discretization.h"
#include "mesh/coarse_mesh.h"
#include "mesh/mesh_builder.h"
#include "mesh/named_mesh.h"
#include "nsfd/scene/scene_input.h"
#include "records/engineering.h"
#include "simulation/limiting_cells.h"
#include "simulation/print_problems.h"
#include "visualization/rose.h"

#include <deal.II/grid/tria.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** The smallest angle of every cell, the smallest first. */
    template <int dim>
    std::vector<double> smallest_angles(const Triangulation<dim> &triangulation)
    {
      std::vector<double> angles;
      std::vector<Point<dim>> corners;
      for (const auto &cell : triangulation.active_cell_iterators()) {
        corners.clear();
        for (const unsigned int v : cell->vertex_indices())
          corners.push_back(cell->vertex(v));
        angles.push_back(cell_shape(corners).smallest_angle);
      }
      std::sort(angles.begin(), angles.end());
      return angles;
    }

    nlohmann::json json_of(const PathRatio &ratio)
    {
      nlohmann::json result = {
          {"mean", ratio.mean},       {"error", ratio.error},
          {"pairs", ratio.n_pairs},   {"distance", ratio.distance},
          {"spacing", ratio.spacing}, {"directions", nlohmann::json::array()}};
      for (const auto &direction : ratio.directions)
        result["directions"].push_back({{"angle", direction.angle},
                                        {"mean", direction.mean},
                                        {"scatter", direction.scatter},
                                        {"pairs", direction.n_pairs}});
      return result;
    }

    nlohmann::json json_of(const CutRatio &ratio)
    {
      nlohmann::json result = {{"mean", ratio.mean},
                               {"in_this_box", ratio.in_this_box},
                               {"directions", nlohmann::json::array()}};
      for (const auto &direction : ratio.directions)
        result["directions"].push_back(
            {{"normal", direction.normal}, {"ratio", direction.ratio}});
      return result;
    }

    std::string cut_text(const CutRatio &ratio)
    {
      const auto [lowest, highest] = std::minmax_element(
          ratio.directions.begin(), ratio.directions.end(),
          [](const auto &a, const auto &b) { return a.ratio < b.ratio; });
      return fmt::format(
          "  cut ratio  {:.3f} over {} normals, for boxes of many cells; "
          "{:.3f} "
          "in this one\n"
          "             by normal {:.3f} to {:.3f}: the smallest surface of "
          "faces over a plane\n",
          ratio.mean, ratio.directions.size(), ratio.in_this_box, lowest->ratio,
          highest->ratio);
    }

    Rose rose_of(const PathRatio &ratio)
    {
      Rose rose;
      rose.title = "Path ratio of the mesh";
      rose.what = "shortest way along faces over distance";
      rose.mean = ratio.mean;
      for (const auto &direction : ratio.directions) {
        rose.angles.push_back(direction.angle);
        rose.values.push_back(direction.mean);
        rose.scatter.push_back(direction.scatter);
      }
      return rose;
    }

    std::string path_text(const PathRatio &ratio)
    {
      if (ratio.n_pairs == 0)
        return "  path ratio no two points far from each other are joined by "
               "faces that may break\n";
      const auto less = [](const auto &a, const auto &b) {
        return a.mean < b.mean;
      };
      const auto [lowest, highest] = std::minmax_element(
          ratio.directions.begin(), ratio.directions.end(), less);
      return fmt::format(
          "  path ratio {:.4f} +- {:.4f} over {} pairs of points {} ({:.3g} "
          "spacings) apart\n"
          "             by direction {:.4f} (at {:.4g} degrees) to {:.4f} (at "
          "{:.4g})\n"
          "             a crack that needs the toughness G per area of its "
          "faces seems to need {:.3g} % more\n",
          ratio.mean, ratio.error, ratio.n_pairs,
          engineering(ratio.distance, "m"), ratio.distance / ratio.spacing,
          lowest->mean, lowest->angle, highest->mean, highest->angle,
          100. * (ratio.mean - 1.));
    }

    /** The mesh of a scene, what it says, and what was found. */
    template <int dim>
    struct MeshQuality {
      const SceneInput &input;
      std::vector<std::string> problems, warnings;
      std::string text;
      nlohmann::json json;
      std::vector<std::pair<std::string, std::string>> pictures; ///< by name

      void find(const Communicator &communicator);

    private:
      void add_sizes(const Triangulation<dim> &triangulation);
      void add_paths(const Triangulation<dim> &triangulation,
                     const MeshGroups<dim> &groups,
                     const std::vector<unsigned int> &materials);
    };

    template <int dim>
    void MeshQuality<dim>::add_sizes(const Triangulation<dim> &triangulation)
    {
      const MeshReport report = mesh_report<dim>(triangulation);
      const std::vector<double> angles = smallest_angles(triangulation);
      const std::size_t n = angles.size();
      text += fmt::format(
          "  mesh       {} cells, edges {} to {}, lowest height {}\n"
          "  angles     {:.3g} to {:.3g} degrees; the smallest of a cell: one "
          "in a hundred below {:.3g}, half of them below {:.3g}\n",
          report.n_cells, engineering(report.smallest_edge, "m", 4),
          engineering(report.largest_edge, "m", 4),
          engineering(report.smallest_height, "m", 4), report.smallest_angle,
          report.largest_angle, angles[n / 100], angles[n / 2]);
      if (input.mesh.named)
        for (const std::string &note : input.mesh.named->notes)
          text += fmt::format("  note       {}\n", note);
      json["cells"] = report.n_cells;
      json["volume"] = report.volume;
      json["smallest_edge"] = report.smallest_edge;
      json["largest_edge"] = report.largest_edge;
      json["lowest_height"] = report.smallest_height;
      json["smallest_angle"] = report.smallest_angle;
      json["largest_angle"] = report.largest_angle;
      json["angle_of_worst_hundredth"] = angles[n / 100];
    }

    template <>
    void MeshQuality<2>::add_paths(const Triangulation<2> &triangulation,
                                   const MeshGroups<2> &groups,
                                   const std::vector<unsigned int> &materials)
    {
      const PathRatio ratio =
          path_ratio(crack_network(input, triangulation, groups, materials));
      text += path_text(ratio);
      json["path_ratio"] = json_of(ratio);
      pictures.emplace_back("rose.svg",
                            rose_picture(rose_of(ratio), SvgUse::file));
    }

    template <>
    void MeshQuality<3>::add_paths(const Triangulation<3> &triangulation,
                                   const MeshGroups<3> &groups,
                                   const std::vector<unsigned int> &materials)
    {
      double box = 1.;
      for (unsigned int d = 0; d < 3; ++d)
        box *= groups.upper()[d] - groups.lower()[d];
      constexpr double all_of_it = .999;
      if (json["volume"] < all_of_it * box) {
        text += "  cut ratio  not computed: the mesh is no brick\n";
        return;
      }
      const CutRatio ratio =
          cut_ratio(cell_network(input, triangulation, groups, materials));
      text += cut_text(ratio);
      json["cut_ratio"] = json_of(ratio);
    }

    template <int dim>
    void MeshQuality<dim>::find(const Communicator &communicator)
    {
      const auto triangulation =
          build_mesh<dim>(input, communicator.mpi(), problems);
      if (!problems.empty())
        return;
      const MeshGroups<dim> groups(input, *triangulation);
      const auto materials = material_indices<dim>(
          input, groups, *triangulation, problems, warnings);
      if (!problems.empty())
        return;
      add_sizes(*triangulation);
      try {
        const Discretization<dim> discretization(communicator, *triangulation,
                                                 groups, materials, input);
        const std::string limiting =
            limiting_cells(input, discretization, communicator);
        if (!limiting.empty())
          text += "  step       of explicit schemes:\n" + limiting;
      } catch (const std::runtime_error &error) {
        problems.push_back(error.what());
        return;
      }
      add_paths(*triangulation, groups, materials);
    }

    std::string folder_of(const SceneInput &input, const MeshCommand &command)
    {
      return command.output.empty()
                 ? "output/mesh_" +
                       std::filesystem::path(input.file).stem().string()
                 : command.output;
    }

    template <int dim>
    int run(const SceneInput &input, const MeshCommand &command)
    {
      const Communicator communicator(MPI_COMM_SELF);
      MeshQuality<dim> quality{input, {}, {}, "", {}, {}};
      quality.find(communicator);
      print_problems(communicator, input, "warning", quality.warnings);
      print_problems(communicator, input, "error", quality.problems);
      if (!quality.problems.empty())
        return exit_code::bad_input;
      if (!command.quiet)
        std::cout << input.file << ": its mesh\n" << quality.text;
      if (command.check)
        return exit_code::done;
      const std::string folder = folder_of(input, command);
      if (!claim_directory(folder, command.force))
        return exit_code::bad_input;
      OutputFolder::instance().describe(nlohmann::json{
          {"subcommand", "mesh"},
          {"file", input.file},
          {"plug_ins", used_plug_ins()}}.dump());
      std::string names = "mesh.json";
      write_file_atomically(folder + "/mesh.json", quality.json.dump(2) + "\n");
      for (const auto &[name, picture] : quality.pictures) {
        write_file_atomically(folder + "/" + name, picture);
        names += ", " + name;
      }
      OutputFolder::instance().finish();
      if (!command.quiet)
        std::cout << "in " << folder << ": " << names << "\n";
      return exit_code::done;
    }
  } // namespace

  int run_mesh(const SceneInput &input, const MeshCommand &command)
  {
    return input.dimension == 2 ? run<2>(input, command)
                                : run<3>(input, command);
  }
} // namespace nsfd
