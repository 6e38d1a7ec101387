#include "mesh/cell_fields.h"
#include "mesh/named_mesh.h"
#include "mesh/nearest_grains.h"
#include "nsfd/mesh/mesh_type.h"
#include "parameters/parameter_file.h"
#include "read_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /** Those of the program itself, for who has written none of @p names. */
    std::string usual_types(const std::vector<std::string> &names,
                            const unsigned int dimension)
    {
      constexpr unsigned int last_place = 9; // generators of deal.II follow
      std::vector<std::string> own;
      for (const std::string &name : names) {
        const auto type = find_mesh_type(name);
        if (type->place() <= last_place &&
            (type->dimension() == 0 || type->dimension() == dimension))
          own.push_back(name);
      }
      return fmt::format("write one of {}, or a generator of deal.II: "
                         "`nsfd --list` prints all names",
                         fmt::join(own, ", "));
    }

    /** The type, checked; empty if nothing more can be read. */
    std::string read_type(SectionReader &reader, const unsigned int dimension,
                          const bool is_body)
    {
      // who names a file means its mesh
      const char *const usual = !is_body && reader.has("file") ? "file"
                                : dimension == 2               ? "rectangle"
                                                               : "brick";
      const auto value = reader.raw(
          "type", usual,
          "rectangle, brick, notched plate, crossed triangles, diagonal "
          "triangles, tetrahedra, bodies, file, voronoi, isotropic, or a "
          "generator of deal.II");
      if (!value)
        return "";
      const std::string type = collapse_blanks(value->text());
      if (type == "bodies" && !is_body)
        return type;
      std::vector<std::string> names;
      for (const std::string &name : mesh_type_names())
        if (!is_body || find_mesh_type(name)->is_for_bodies())
          names.push_back(name);

      const auto known = find_mesh_type(type);
      if (known && known->dimension() != 0 && known->dimension() != dimension)
        reader.error("type",
                     fmt::format("type = {} needs dimension = {}, not {}", type,
                                 known->dimension(), dimension),
                     dimension == 2 ? "write for example: rectangle"
                                    : "write for example: brick");
      else if (known && known->is_one_mesh() && !known->is_for_bodies() &&
               is_body)
        reader.error("type",
                     fmt::format("type = {} is for section Mesh: it brings its "
                                 "own groups",
                                 type),
                     "take rectangle, brick, triangles, tetrahedra or a "
                     "generator of deal.II");
      else if (std::find(names.begin(), names.end(), type) == names.end())
        reader.error("type",
                     fmt::format("type = {} is not the name of a mesh", type),
                     did_you_mean(type, names, usual_types(names, dimension)));
      else
        return type;
      reader.accept_everything();
      return "";
    }

    bool has_simplex_cells(const MeshInput &mesh)
    {
      if (mesh.split_simplices)
        return false;
      const auto type = find_mesh_type(mesh.type);
      return type && type->has_simplices(mesh);
    }

    /** Why there are no simplices to cut, and what to write; empty: there are.
     */
    std::array<std::string, 2> no_simplices(const MeshInput &mesh,
                                            const unsigned int dimension)
    {
      if (mesh.type == "bodies")
        return {{"the cells are those of the bodies",
                 "write it in the blocks `Body` whose cells are triangles"}};
      if (mesh.split_simplices)
        return {{"`split simplices = true` has made quads and hexes of them",
                 "write one of the two"}};
      if (has_simplex_cells(mesh))
        return {};
      if (dimension == 3)
        return {{"the cells are hexahedra",
                 "take type = tetrahedra or isotropic, or write refinements = "
                 "1"}};
      return {{"the cells are quads",
               mesh.type == "file"
                   ? "mesh the file with triangles (geometries: cell shape = "
                     "triangles), or remove this line"
               : mesh.type == "voronoi"
                   ? "mesh the grains with triangles in a file "
                     "(prm/meshes/polycrystal.geo), or remove this line"
                   : "take type = isotropic, crossed triangles or diagonal "
                     "triangles, or "
                     "remove this line"}};
    }

    /** Entry `split`: of meshes of triangles and tetrahedra. */
    bool read_barycentric(SectionReader &reader, const MeshInput &mesh,
                          const unsigned int dimension)
    {
      const auto type = find_mesh_type(mesh.type);
      // a file that cannot be read has its own error
      const bool is_unread = type->is_one_mesh() && !type->is_for_bodies() &&
                             mesh.named == nullptr;
      const auto [reason, advice] = is_unread ? std::array<std::string, 2>()
                                              : no_simplices(mesh, dimension);
      if (!reason.empty() && !reader.has("split"))
        return false;
      const bool is_wanted =
          reader.choice("split", type->split(mesh), {"none", "barycentric"},
                        dimension == 2
                            ? "none, or barycentric: every triangle into six, "
                              "at its midpoints and centroid"
                            : "none, or barycentric: every tetrahedron into "
                              "twenty-four, at midpoints and centroids") ==
          "barycentric";
      if (is_wanted && !reason.empty())
        reader.error("split",
                     std::string("split = barycentric cuts ") +
                         (dimension == 2 ? "triangles" : "tetrahedra") +
                         ", but " + reason,
                     advice);
      return is_wanted;
    }

    /** Of a mesh that is made without them. */
    void read_grains(SectionReader &reader, MeshInput &mesh)
    {
      const std::string name = "grains",
                        text = "number of grains, each of the cells next to a "
                               "random place; none without it";
      if (!reader.optional(name, text))
        return;
      constexpr unsigned int most_grains = 10000;
      const unsigned int n_before = reader.errors().n_errors();
      mesh.grains = reader.integer(name, "", 1, most_grains, text);
      if (!mesh.named || reader.errors().n_errors() > n_before)
        return;
      NamedMesh with_grains = *mesh.named;
      add_grains(with_grains, mesh.grains, mesh.seed);
      mesh.named = std::make_shared<NamedMesh>(std::move(with_grains));
    }

    MeshInput read_one_mesh(SectionReader &reader, const unsigned int dimension,
                            const bool is_body)
    {
      MeshInput mesh;
      mesh.type = read_type(reader, dimension, is_body);
      if (mesh.type.empty())
        return mesh;

      mesh.refinements = reader.integer("refinements", "0", 0, 20,
                                        "times every cell is halved");
      find_mesh_type(mesh.type)->read(reader, dimension, mesh);
      mesh.split_barycentric = read_barycentric(reader, mesh, dimension);
      mesh.distortion = reader.number(
          "distortion", "0", units::none, {0., 0.5, false, true},
          "share of the shortest edge by which interior vertices move");
      mesh.seed = reader.integer("seed", "1", 0,
                                 std::numeric_limits<unsigned int>::max(),
                                 "of grains and distortion");
      if (!is_body && mesh.type != "voronoi" && mesh.type != "bodies")
        read_grains(reader, mesh);
      return mesh;
    }
  } // namespace

  bool has_numbered_groups(const SceneInput &scene)
  {
    const auto type = find_mesh_type(scene.mesh.type);
    return type && type->has_ids();
  }

  bool has_simplices(const SceneInput &scene)
  {
    return has_simplex_cells(scene.mesh.type == "bodies" &&
                                     !scene.bodies.empty()
                                 ? scene.bodies.front().mesh
                                 : scene.mesh);
  }

  namespace
  {
    /** From here on formulas know the cell data of the mesh by their names. */
    void name_cell_data(SectionReader &reader, const MeshInput &mesh,
                        Constants &names)
    {
      if (!mesh.named || mesh.named->fields.empty())
        return;
      Constant data;
      data.fields = std::make_shared<CellFields>(mesh.named);
      if (mesh.distortion > 0.)
        data.refusal = "cell data belong to cells as the file has them, and "
                       "`distortion` moves their corners";
      for (const auto &[name, values] : mesh.named->fields) {
        if (!names.emplace(name, data).second)
          reader.warning("file",
                         fmt::format("formulas take `{}` for the entry of "
                                     "section Constants, not for the cell data "
                                     "of the mesh",
                                     name),
                         "give the constant another name to use the data");
        ++data.field;
      }
    }
  } // namespace

  void read_mesh(ParameterFile &file, InputErrors &errors, SceneInput &scene)
  {
    SectionReader reader(file.open("Mesh"), errors);
    scene.mesh = read_one_mesh(reader, scene.dimension, false);
    name_cell_data(reader, scene.mesh, file.constants());

    const std::vector<ParameterSection *> blocks = file.open_blocks("Body");
    if (scene.mesh.type == "bodies" && blocks.empty())
      reader.error("type", "type = bodies needs blocks `Body: name`",
                   "add for example: subsection Body: first");
    for (ParameterSection *block : blocks) {
      SectionReader body_reader(*block, errors);
      if (scene.mesh.type != "bodies") {
        if (!scene.mesh.type.empty())
          body_reader.error("",
                            fmt::format("`{}` does not belong here: the mesh "
                                        "is `{}`",
                                        block->name(), scene.mesh.type),
                            "write type = bodies in section Mesh, or remove "
                            "this block");
        body_reader.accept_everything();
        continue;
      }
      BodyInput body;
      body.name = block->block_name();
      body.mesh = read_one_mesh(body_reader, scene.dimension, true);
      if (!scene.bodies.empty() && !body.mesh.type.empty() &&
          has_simplex_cells(body.mesh) !=
              has_simplex_cells(scene.bodies.front().mesh))
        body_reader.error("type",
                          fmt::format("type = {} does not go together with "
                                      "the cells of the first body",
                                      body.mesh.type),
                          "all bodies need triangles and tetrahedra, or none");
      scene.bodies.push_back(body);
    }
  }

  namespace
  {
    void check_degree(SectionReader &reader, const SceneInput &scene)
    {
      const unsigned int degree = scene.discretization.degree;
      const bool simplices = has_simplices(scene);
      const unsigned int highest = simplices                    ? 2
                                   : scene.dimension == 2       ? 8
                                   : scene.time.scheme.at_nodes ? 6
                                                                : 4;
      if (degree <= highest)
        return;
      const char *const reason =
          simplices
              ? "deal.II 9.4.1 has no higher element for triangles and "
                "tetrahedra (`split simplices = true` makes quads or hexes of "
                "them)"
              : (scene.dimension == 2 ? "quadrilaterals are tested to degree 8"
                 : highest == 6 ? "hexahedra of explicit steps are tested to "
                                  "degree 6"
                                : "hexahedra are tested to degree 4");
      reader.error("degree",
                   fmt::format("degree = {} must be at most {} on this mesh: "
                               "{}",
                               degree, highest, reason),
                   fmt::format("write for example: {}", highest));
    }

    unsigned int read_interface_points(SectionReader &reader,
                                       const SceneInput &scene)
    {
      const DiscretizationInput &input = scene.discretization;
      const std::string text = "of the quadrature, per direction of a face: "
                               "`degree + 1` or a number";
      const auto raw =
          reader.raw("interface points", "degree + 1", text, "degree + 1");
      std::string compact = raw ? raw->text() : "degree+1";
      compact.erase(std::remove(compact.begin(), compact.end(), ' '),
                    compact.end());
      constexpr unsigned int most_points = 20;
      const unsigned int n_points =
          compact == "degree+1"
              ? input.degree + 1
              : reader.integer("interface points", "degree + 1", 1, most_points,
                               text);

      const std::string &rule = input.interface_quadrature;
      const bool on_triangles = scene.dimension == 3 && has_simplices(scene);
      if (on_triangles && rule == "quarter points")
        reader.error("interface quadrature",
                     "interface quadrature = quarter points has no points on "
                     "the triangular faces of tetrahedra",
                     "write gauss or gauss lobatto");
      else if (on_triangles && rule == "gauss lobatto" && n_points != 2)
        reader.error("interface points",
                     fmt::format("interface points = {}: on the faces of "
                                 "tetrahedra the rule `gauss lobatto` has 2 "
                                 "per direction, the three vertices",
                                 n_points),
                     "write 2, or interface quadrature = gauss");
      else if (rule == "quarter points" && n_points != 2)
        reader.error("interface points",
                     fmt::format("interface points = {}: the rule `quarter "
                                 "points` has 2 per direction",
                                 n_points),
                     "write 2, or interface quadrature = gauss");
      else if (rule == "gauss lobatto" && n_points < 2)
        reader.error("interface points",
                     "interface points = 1: the rule `gauss lobatto` has at "
                     "least 2 per direction",
                     "write 2, or interface quadrature = gauss");
      return n_points;
    }
    /** What joined cells of the explicit scheme need. */
    void check_nodes(SectionReader &reader, const SceneInput &scene)
    {
      const DiscretizationInput &input = scene.discretization;
      const std::string reason =
          "scheme = explicit has masses and points at the nodes of the cells";
      if (!input.lumped_mass)
        reader.error("mass", "mass = consistent: " + reason, "write lumped");
      if (input.interface_quadrature != "gauss lobatto")
        reader.error("interface quadrature",
                     fmt::format("interface quadrature = {}: {}",
                                 input.interface_quadrature, reason),
                     "write gauss lobatto");
      else if (input.interface_points != input.degree + 1)
        reader.error("interface points",
                     fmt::format("interface points = {}: {}",
                                 input.interface_points, reason),
                     "write degree + 1");
      if (has_simplices(scene) && input.degree > 1)
        reader.error(
            "degree",
            fmt::format("degree = {} on triangles or tetrahedra: their "
                        "nodes have no positive lumped mass",
                        input.degree),
            "write 1, or take scheme = moreau-jean");
    }
  } // namespace

  void read_discretization(ParameterFile &file, InputErrors &errors,
                           SceneInput &scene)
  {
    SectionReader reader(file.open("Discretization"), errors);
    DiscretizationInput &input = scene.discretization;
    constexpr unsigned int absurd_degree = 1000;
    input.degree = reader.integer("degree", "1", 1, absurd_degree,
                                  "of the polynomials in a cell");
    check_degree(reader, scene);
    const bool at_nodes = scene.time.scheme.at_nodes;
    const bool may_crack = std::any_of(
        scene.interfaces.begin(), scene.interfaces.end(),
        [](const InterfaceInput &interface) { return bool(interface.law); });
    // Joined cells part at their nodes: with other points there would be more
    // conditions of contact than motions. Faces that turn as they open roll
    // over their last point that holds: between the ends of the face, a corner
    // would be inside of the other cell. (In space the rows of rigid points at
    // a corner of eight cells depend on each other three times over, and
    // Newton's iteration idles.) Points of a face that is divided in the run
    // keep what they have inside of it. Quasi-static cracks are sharper than
    // nodes: a point behind the front must not carry what one before it does.
    const bool joined = scene.has_bonded_faces() &&
                        !(scene.statics && scene.statics->steps && may_crack),
               turns = scene.large_motion && may_crack && scene.dimension == 2;
    const bool parts_at_corners =
        (joined || turns) &&
        !scene.axisymmetric && // a node on the axis has no area
        !reader.has("interface points") && !file.find("Adaptivity") &&
        !(scene.dimension == 3 && has_simplices(scene) && input.degree > 1);
    input.lumped_mass =
        reader.choice("mass", at_nodes ? "lumped" : "consistent",
                      {"consistent", "lumped"},
                      "consistent or lumped") == "lumped";
    if (input.lumped_mass && has_simplices(scene) && input.degree == 2)
      reader.error("mass",
                   "mass = lumped with degree = 2 on triangles or tetrahedra "
                   "would leave vertices without mass",
                   "write consistent, or degree = 1");
    input.interface_quadrature = reader.choice(
        "interface quadrature",
        at_nodes || parts_at_corners ? "gauss lobatto" : "gauss",
        {"gauss", "gauss lobatto", "quarter points"},
        "gauss, gauss lobatto (tetrahedra: vertices of a face) or quarter "
        "points");
    input.interface_points = read_interface_points(reader, scene);
    if (at_nodes)
      check_nodes(reader, scene);
  }
} // namespace nsfd
