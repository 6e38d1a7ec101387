#include "group_report.h"

#include "mesh/named_mesh.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    struct Use {
      std::string block;
      const Where *where;
      bool is_about_cells;
    };

    std::vector<Use> all_uses(const SceneInput &input)
    {
      std::vector<Use> uses;
      const auto add = [&](const char *kind, const auto &blocks,
                           const bool is_about_cells) {
        for (const auto &block : blocks)
          uses.push_back({std::string(kind) + ": " + block.name, &block.where,
                          is_about_cells});
      };
      add("Material", input.materials, true);
      for (const auto &block : input.interfaces)
        if (block.obstacle < 0) // those are named by their obstacles
          uses.push_back({block.section(), &block.where, false});
      add("Boundary", input.boundaries, false);
      add("Obstacle", input.obstacles, false);
      return uses;
    }

    bool has_faces_of(const NamedMesh &mesh, const std::string &word)
    {
      return std::any_of(
          mesh.groups.begin(), mesh.groups.end(), [&](const auto &group) {
            return group.dimension < mesh.dimension &&
                   (group.name == word || std::to_string(group.number) == word);
          });
    }

    /** Cells of this name are meant only where no faces have it. */
    bool names(const Use &use, const NamedMesh &mesh,
               const NamedMesh::Group &group)
    {
      const bool is_cells = group.dimension == mesh.dimension;
      const auto is_meant = [&](const std::string &word) {
        return word == group.name || word == std::to_string(group.number);
      };
      const Where &where = *use.where;
      if (where.kind == Where::Kind::between_groups)
        return is_cells &&
               (is_meant(where.materials[0]) || is_meant(where.materials[1]));
      if (where.kind != Where::Kind::group || !is_meant(where.name))
        return false;
      return is_cells ==
             (use.is_about_cells || !has_faces_of(mesh, where.name));
    }

    std::string blocks_that_name(const NamedMesh &mesh,
                                 const NamedMesh::Group &group,
                                 const std::vector<Use> &uses)
    {
      std::string blocks;
      for (const Use &use : uses)
        if (names(use, mesh, group))
          blocks += (blocks.empty() ? "" : ", ") + use.block;
      return blocks;
    }

    /** A surface of a geometry of which the mesh has no element says nothing.
     */
    bool is_empty(const NamedMesh::Group &group)
    {
      return group.name.empty() && group.n_elements == 0;
    }

    std::string describe(const NamedMesh &mesh, const NamedMesh::Group &group)
    {
      static const char *const nouns[] = {"point", "curve", "surface",
                                          "volume"};
      std::string text = group.name.empty() ? "" : group.name + " ";
      text += fmt::format("({} {}): ", nouns[group.dimension], group.number);
      if (group.dimension == mesh.dimension)
        return text + fmt::format("{} cells", group.n_elements);
      const auto n_inner = group.n_elements - group.n_boundary;
      if (n_inner == 0)
        return text + fmt::format("{} faces on the boundary", group.n_elements);
      if (group.n_boundary == 0)
        return text + fmt::format("{} faces between cells", group.n_elements);
      return text + fmt::format("{} faces, {} of them on the boundary",
                                group.n_elements, group.n_boundary);
    }

    std::string describe_values(const std::string &name,
                                const std::vector<double> &values)
    {
      double least = std::numeric_limits<double>::infinity(), most = -least;
      std::size_t n_missing = 0;
      for (const double value : values) {
        n_missing += std::isnan(value);
        least = std::fmin(least, value);
        most = std::fmax(most, value);
      }
      return fmt::format(
          "{} in formulas: {:g} to {:g}{}", name, least, most,
          n_missing == 0 ? "" : fmt::format(", {} cells without", n_missing));
    }

    void add_notes(const NamedMesh &mesh, std::vector<ReportLine> &lines)
    {
      for (const std::string &note : mesh.notes)
        lines.push_back({"mesh note", note});
    }
  } // namespace

  std::vector<ReportLine> group_report(const SceneInput &input)
  {
    std::vector<ReportLine> lines;
    if (!input.mesh.named)
      return lines;
    const NamedMesh &mesh = *input.mesh.named;
    lines.push_back(
        {"cells",
         count_of_shapes(mesh) +
             (input.mesh.split_simplices ? ", split at their midpoints"
              : input.mesh.split_barycentric
                  ? (input.dimension == 2 ? ", each cut into six"
                                          : ", each cut into twenty-four")
                  : "")});
    const std::vector<Use> uses = all_uses(input);
    constexpr unsigned int n_shown = 12; // of those that nothing names
    unsigned int n_unused = 0;
    for (const NamedMesh::Group &group : mesh.groups) {
      const std::string blocks = blocks_that_name(mesh, group, uses);
      if (!blocks.empty())
        lines.push_back(
            {"group", describe(mesh, group) + ", used by " + blocks});
      else if (!is_empty(group) && ++n_unused <= n_shown)
        lines.push_back({"group", describe(mesh, group) + ", not used"});
    }
    if (n_unused > n_shown)
      lines.push_back({"group", fmt::format("and {} more that are not used",
                                            n_unused - n_shown)});
    for (const auto &[name, values] : mesh.fields)
      lines.push_back({"cell data", describe_values(name, values)});
    add_notes(mesh, lines);
    return lines;
  }

  std::vector<ReportLine> short_group_report(const SceneInput &input)
  {
    std::vector<ReportLine> lines;
    if (!input.mesh.named)
      return lines;
    const NamedMesh &mesh = *input.mesh.named;
    const std::vector<Use> uses = all_uses(input);
    std::vector<std::string> used, unused;
    for (const NamedMesh::Group &group : mesh.groups) {
      const bool is_used = !blocks_that_name(mesh, group, uses).empty();
      if (is_used || !is_empty(group))
        (is_used ? used : unused).push_back(group.label());
    }
    const auto list = [](std::vector<std::string> words) {
      constexpr std::size_t n_shown = 6;
      const std::size_t n = words.size();
      if (n > n_shown)
        words.resize(n_shown);
      return n == 0 ? "none"
                    : fmt::format("{}{}", fmt::join(words, ", "),
                                  n > n_shown
                                      ? fmt::format(" and {} more", n - n_shown)
                                      : "");
    };
    lines.push_back({"groups", fmt::format("used: {}; not used: {}", list(used),
                                           list(unused))});
    add_notes(mesh, lines);
    return lines;
  }
} // namespace nsfd
