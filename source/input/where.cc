#include "read_sections.h"

#include "mesh/named_mesh.h"
#include "nsfd/mesh/mesh_type.h"
#include "parameters/formula.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace nsfd
{
  namespace
  {
    const std::vector<std::string> sides = {"left", "right", "bottom",
                                            "top",  "front", "back"};

    const std::string between = "between materials";
    const std::string between_groups = "between groups";

    bool is_number(const std::string &text)
    {
      return !text.empty() &&
             std::all_of(text.begin(), text.end(), [](const char c) {
               return std::isdigit(static_cast<unsigned char>(c));
             });
    }

    /** One word that is no formula of its own. */
    bool is_plain_word(const std::string &text)
    {
      return !is_number(text) && !is_formula_word(text) &&
             std::all_of(text.begin(), text.end(), [](const char c) {
               return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
             });
    }

    /** Words with blanks between them: the name of a group, not a formula. */
    bool is_plain_text(const std::string &text)
    {
      std::string word;
      bool any_word = false;
      for (const char c : text + " ") {
        if (c != ' ') {
          word += c;
          continue;
        }
        if (!is_number(word) && !is_plain_word(word))
          return false;
        any_word |= !is_number(word);
        word.clear();
      }
      return any_word;
    }

    /** The file of the mesh could not be read: its groups are unknown. */
    bool lacks_its_mesh(const SceneInput &scene)
    {
      const auto type = find_mesh_type(scene.mesh.type);
      return !scene.mesh.named &&
             (scene.mesh.type.empty() ||
              (type && type->is_one_mesh() && !type->is_for_bodies()));
    }

    bool is_among(const std::vector<std::string> &names,
                  const std::string &word)
    {
      return std::find(names.begin(), names.end(), word) != names.end();
    }

    std::vector<std::string> body_names(const SceneInput &scene)
    {
      std::vector<std::string> names;
      for (const BodyInput &body : scene.bodies)
        names.push_back(body.name);
      return names;
    }

    /** What a mesh of its own calls its groups: names, and numbers. */
    std::vector<std::string> group_names(const SceneInput &scene)
    {
      std::vector<std::string> names;
      if (scene.mesh.named)
        for (const NamedMesh::Group &group : scene.mesh.named->groups)
          for (const std::string &word :
               {group.name, std::to_string(group.number)})
            if (!word.empty())
              names.push_back(word);
      return names;
    }

    /** A group that the mesh has must have what the section is about. */
    void check_group(SectionReader &reader, const std::string &word,
                     const WhereUse use, const NamedMesh &mesh)
    {
      const char *const noun = mesh.dimension == 2 ? "curve" : "surface";
      bool has_cells = false, has_faces = false;
      unsigned long long n_faces = 0, n_boundary = 0;
      for (const NamedMesh::Group &group : mesh.groups) {
        if (group.name != word && std::to_string(group.number) != word)
          continue;
        (group.dimension == mesh.dimension ? has_cells : has_faces) = true;
        if (group.dimension == mesh.dimension)
          continue;
        n_faces += group.n_elements;
        n_boundary += group.n_boundary;
      }
      if (use == WhereUse::cells && !has_cells)
        reader.error("where",
                     fmt::format("where = {}: this group is a {}, it has no "
                                 "cells",
                                 word, noun),
                     "write a group of cells; `--check` lists all groups");
      else if (has_faces && use == WhereUse::interior_faces &&
               n_boundary == n_faces)
        reader.error(
            "where",
            fmt::format("where = {}: this group is on the boundary, there are "
                        "no faces between cells",
                        word),
            mesh.notes.empty()
                ? "write a group inside the mesh"
                : "write a group inside the mesh; duplicate vertices "
                  "separate its faces: merge vertices = true joins them");
      else if (has_faces && use == WhereUse::boundary_faces && n_boundary == 0)
        reader.error("where",
                     fmt::format("where = {}: this group is inside the mesh, "
                                 "not on its boundary",
                                 word),
                     "use it in an Interface block");
    }

    /** `between groups`, `between groups [a, b]`. */
    Where read_between_groups(SectionReader &reader, const std::string &value,
                              const std::size_t length, const WhereUse use,
                              const SceneInput &scene)
    {
      Where where;
      where.kind = Where::Kind::between_groups;
      if (use != WhereUse::interior_faces)
        reader.error("where",
                     fmt::format("where = {} is for Interface blocks", value),
                     "write all, a group or an expression");
      std::string rest = collapse_blanks(value.substr(length));
      if (rest.empty())
        return where;
      if (rest.front() == '[' && rest.back() == ']')
        rest = rest.substr(1, rest.size() - 2);
      const std::size_t comma = rest.find(',');
      if (comma == std::string::npos) {
        reader.error("where",
                     fmt::format("where = {} does not name two groups", value),
                     "write for example: between groups [a, b]");
        return where;
      }
      where.materials = {collapse_blanks(rest.substr(0, comma)),
                         collapse_blanks(rest.substr(comma + 1))};
      std::vector<std::string> known = body_names(scene);
      if (scene.mesh.named)
        for (const NamedMesh::Group &group : scene.mesh.named->groups)
          if (group.dimension == scene.mesh.named->dimension) {
            known.push_back(group.label());
            known.push_back(std::to_string(group.number));
          }
      for (const std::string &name : where.materials)
        if (!lacks_its_mesh(scene) &&
            std::find(known.begin(), known.end(), name) == known.end())
          reader.error("where",
                       fmt::format("the mesh has no group of cells `{}`", name),
                       did_you_mean(name, known, "`--check` lists the groups"));
      return where;
    }

    /** `between materials`, `between materials [a, b]`; brackets optional. */
    Where read_between(SectionReader &reader, const std::string &value,
                       const WhereUse use, const SceneInput &scene)
    {
      Where where;
      where.kind = Where::Kind::between_materials;
      if (use != WhereUse::interior_faces)
        reader.error("where",
                     fmt::format("where = {} is for Interface blocks", value),
                     "write all, a group or an expression");
      std::string rest = collapse_blanks(value.substr(between.size()));
      if (rest.empty())
        return where;
      where.materials = read_two_materials(reader, "where", value, rest,
                                           "between materials [a, b]", scene);
      return where;
    }

    /** A word that is none of the known ones. */
    void report_unknown_group(SectionReader &reader, const std::string &value,
                              const WhereUse use, const SceneInput &scene)
    {
      std::vector<std::string> known = {"all"};
      if (use == WhereUse::boundary_faces)
        known.insert(known.end(), sides.begin(), sides.end());
      if (use == WhereUse::interior_faces)
        known.push_back(between);
      for (const std::string &body : body_names(scene))
        known.push_back(body);
      if (scene.mesh.named && scene.mesh.named->fields.count(value) != 0)
        return reader.error(
            "where",
            fmt::format("where = {}: these are cell data, no group", value),
            fmt::format("write a condition, for example: {} == 1", value));
      std::string groups;
      if (scene.mesh.named)
        for (const NamedMesh::Group &group : scene.mesh.named->groups) {
          known.push_back(group.label());
          groups += (groups.empty() ? "its groups are " : ", ") + group.label();
        }
      if (groups.size() > 200)
        groups = "`--check` lists its groups";
      reader.error("where",
                   fmt::format("where = {}: the mesh `{}` has no such group",
                               value, scene.mesh.type),
                   did_you_mean(value, known,
                                groups.empty()
                                    ? "write all or an expression of x, y, z"
                                    : groups));
    }
  } // namespace

  void check_material(SectionReader &reader, const std::string &entry,
                      const std::string &name, const SceneInput &scene)
  {
    std::vector<std::string> known;
    for (const MaterialInput &material : scene.materials)
      known.push_back(material.name);
    if (std::find(known.begin(), known.end(), name) == known.end())
      reader.error(entry, fmt::format("there is no material `{}`", name),
                   did_you_mean(name, known,
                                "name blocks `Material: ...` of this file"));
  }

  std::array<std::string, 2>
  read_two_materials(SectionReader &reader, const std::string &entry,
                     const std::string &value, std::string names,
                     const std::string &example, const SceneInput &scene)
  {
    if (names.front() == '[' && names.back() == ']')
      names = names.substr(1, names.size() - 2);
    const std::size_t comma = names.find(',');
    if (comma == std::string::npos ||
        names.find(',', comma + 1) != std::string::npos) {
      reader.error(
          entry,
          fmt::format("{} = {} does not name two materials", entry, value),
          "write for example: " + example);
      return {};
    }
    const std::array<std::string, 2> result = {
        collapse_blanks(names.substr(0, comma)),
        collapse_blanks(names.substr(comma + 1))};
    for (const std::string &name : result)
      check_material(reader, entry, name, scene);
    return result;
  }

  std::string where_by_name(const std::string &name, const SceneInput &scene)
  {
    const bool is_known = is_among(sides, name) ||
                          is_among(group_names(scene), name) ||
                          is_among(body_names(scene), name);
    return is_known ? name : "";
  }

  Where read_where(SectionReader &reader, const std::string &default_text,
                   const WhereUse use, const SceneInput &scene,
                   const std::string &text)
  {
    Where where;
    const auto raw = reader.raw("where", default_text, text, "all");
    if (!raw)
      return where;
    const std::string value = collapse_blanks(raw->text());
    if (value == "all")
      return where;

    const std::vector<std::string> bodies = body_names(scene);
    const bool is_body = is_among(bodies, value);

    const std::vector<std::string> groups = group_names(scene);
    const bool is_group = is_among(groups, value);
    const bool is_grains =
        (scene.mesh.type == "voronoi" || scene.mesh.grains > 0) &&
        value == "between grains";

    if (is_body || is_group ||
        (is_number(value) &&
         (has_numbered_groups(scene) || scene.mesh.grains > 0))) {
      where.kind = Where::Kind::group;
      where.name = value;
      if (is_group)
        check_group(reader, value, use, *scene.mesh.named);
    } else if (is_grains)
      where = read_between_groups(reader, value, value.size(), use, scene);
    else if (value.compare(0, between_groups.size(), between_groups) == 0)
      where =
          read_between_groups(reader, value, between_groups.size(), use, scene);
    else if (is_among(sides, value)) {
      where.kind = Where::Kind::side;
      where.name = value;
      if (scene.dimension == 2 && (value == "front" || value == "back"))
        reader.error(
            "where",
            fmt::format("the side `{}` exists for dimension = 3 only", value),
            "write left, right, bottom or top");
      else if (use == WhereUse::interior_faces)
        reader.error("where",
                     fmt::format("where = {} is a side of the mesh, and there "
                                 "are no faces between cells",
                                 value),
                     "write all, between materials or an expression");
    } else if (value.compare(0, between.size(), between) == 0)
      where = read_between(reader, value, use, scene);
    else if (is_number(value) || is_plain_word(value) ||
             (scene.mesh.named && is_plain_text(value))) {
      if (!lacks_its_mesh(scene))
        report_unknown_group(reader, value, use, scene);
    } else if (lacks_its_mesh(scene) && is_plain_text(value))
      where.kind = Where::Kind::group;
    else {
      where.kind = Where::Kind::expression;
      where.condition =
          read_initial_expression(reader, "where", "", units::none, text);
    }
    return where;
  }
} // namespace nsfd
