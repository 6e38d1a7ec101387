#include "read_sections.h"

#include "formula.h"

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

    std::vector<std::string> body_names(const SceneInput &scene)
    {
      std::vector<std::string> names;
      for (const BodyInput &body : scene.bodies)
        names.push_back(body.name);
      return names;
    }

    std::vector<std::string> material_names(const SceneInput &scene)
    {
      std::vector<std::string> names;
      for (const MaterialInput &material : scene.materials)
        names.push_back(material.name);
      return names;
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
      if (rest.front() == '[' && rest.back() == ']')
        rest = rest.substr(1, rest.size() - 2);
      const std::size_t comma = rest.find(',');
      if (comma == std::string::npos ||
          rest.find(',', comma + 1) != std::string::npos) {
        reader.error(
            "where",
            fmt::format("where = {} does not name two materials", value),
            "write for example: between materials [a, b]");
        return where;
      }
      where.materials = {collapse_blanks(rest.substr(0, comma)),
                         collapse_blanks(rest.substr(comma + 1))};
      const std::vector<std::string> known = material_names(scene);
      for (const std::string &name : where.materials)
        if (std::find(known.begin(), known.end(), name) == known.end())
          reader.error("where", fmt::format("there is no material `{}`", name),
                       did_you_mean(name, known,
                                    "name blocks `Material: ...` of this "
                                    "file"));
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
      reader.error(
          "where",
          fmt::format("where = {}: the mesh `{}` has no such group", value,
                      scene.mesh.type),
          did_you_mean(value, known, "write all or an expression of x, y, z"));
    }
  } // namespace

  bool is_side(const std::string &word)
  {
    return std::find(sides.begin(), sides.end(), word) != sides.end();
  }

  Expression read_initial_expression(SectionReader &reader,
                                     const std::string &name,
                                     const std::string &default_text,
                                     const Unit unit, const std::string &text)
  {
    const Expression expression =
        reader.expression(name, default_text, unit, text);
    if (expression.depends_on_time())
      reader.error(name,
                   fmt::format("{} = {} depends on t, but is read once, before "
                               "the first step",
                               name, expression.text()),
                   "write an expression of x, y, z");
    return expression;
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
    const bool is_body =
        std::find(bodies.begin(), bodies.end(), value) != bodies.end();

    if (is_body || (is_number(value) && has_numbered_groups(scene))) {
      where.kind = Where::Kind::group;
      where.name = value;
    } else if (is_side(value)) {
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
    else if (is_number(value) || is_plain_word(value))
      report_unknown_group(reader, value, use, scene);
    else {
      where.kind = Where::Kind::expression;
      where.condition =
          read_initial_expression(reader, "where", "", units::none, text);
    }
    return where;
  }
} // namespace nsfd
