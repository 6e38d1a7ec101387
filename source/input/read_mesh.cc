#include "mesh/mesh_types.h"
#include "mesh/named_mesh.h"
#include "read_named_mesh.h"
#include "read_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /** The type if it fills a box, else null. */
    const MeshType *find_box_type(const std::string &name)
    {
      const MeshType *type = find_mesh_type(name);
      return type != nullptr && type->kind == MeshType::Kind::box ? type
                                                                  : nullptr;
    }

    std::string repeated(const std::string &value, const unsigned int count)
    {
      std::string result = value;
      for (unsigned int i = 1; i < count; ++i)
        result += ", " + value;
      return result;
    }

    /** The type, checked; empty if nothing more can be read. */
    std::string read_type(SectionReader &reader, const unsigned int dimension,
                          const bool is_body)
    {
      const auto value = reader.raw(
          "type", dimension == 2 ? "rectangle" : "brick",
          "rectangle, brick, notched plate, crossed triangles, diagonal "
          "triangles, tetrahedra, bodies, file, voronoi, or a generator of "
          "deal.II");
      if (!value)
        return "";
      const std::string type = collapse_blanks(value->text());
      if (type == "bodies" && !is_body)
        return type;
      std::vector<std::string> names;
      for (const MeshType &known : mesh_types())
        if (!is_body || (known.kind != MeshType::Kind::bodies &&
                         known.kind != MeshType::Kind::named))
          names.push_back(known.name);

      const MeshType *known = find_mesh_type(type);
      if (known != nullptr && known->dimension != 0 &&
          known->dimension != dimension)
        reader.error("type",
                     fmt::format("type = {} needs dimension = {}, not {}", type,
                                 known->dimension, dimension),
                     dimension == 2 ? "write for example: rectangle"
                                    : "write for example: brick");
      else if (known != nullptr && known->kind == MeshType::Kind::named &&
               is_body)
        reader.error("type",
                     fmt::format("type = {} is for section Mesh: it brings its "
                                 "own groups",
                                 type),
                     "take rectangle, brick, triangles, tetrahedra or a "
                     "generator of deal.II");
      else if (std::find(names.begin(), names.end(), type) == names.end())
        reader.error(
            "type", fmt::format("type = {} is not the name of a mesh", type),
            did_you_mean(type, names, "`nsfd --list` prints all names"));
      else
        return type;
      reader.accept_everything();
      return "";
    }

    void read_notch(SectionReader &reader, MeshInput &mesh,
                    const bool can_compare)
    {
      const unsigned int n_before = reader.errors().n_errors();
      mesh.notch_length =
          reader.number("notch length", "", units::length, Range::positive(),
                        "m, from the left side to the tip");
      mesh.notch_height = reader.number("notch height", "", units::length,
                                        Range::any(), "m, y of its middle");
      mesh.notch_width = reader.number(
          "notch width", "0", units::length, Range::non_negative(),
          "m; 0 removes no cells, for an Interface block with broken faces");
      if (!can_compare || reader.errors().n_errors() > n_before)
        return;
      if (mesh.notch_length >= mesh.upper[0] - mesh.lower[0])
        reader.error("notch length",
                     fmt::format("notch length = {:g} goes through the plate",
                                 mesh.notch_length),
                     "it must be shorter than the plate is long");
      if (mesh.notch_height - .5 * mesh.notch_width <= mesh.lower[1] ||
          mesh.notch_height + .5 * mesh.notch_width >= mesh.upper[1])
        reader.error(
            "notch height",
            fmt::format("notch height = {:g}, with a width of {:g}, is "
                        "not inside the plate",
                        mesh.notch_height, mesh.notch_width),
            "write a height between the lower and the upper corner");
    }

    /** More cells than any machine of today holds are a slip of the pen. */
    void check_size(SectionReader &reader, const MeshInput &mesh,
                    const MeshType &type)
    {
      constexpr double most_cells = 1e9;
      double n_cells = type.cells_per_brick *
                       std::pow(2., static_cast<double>(mesh.cells.size()) *
                                        mesh.refinements);
      for (const unsigned int n : mesh.cells)
        n_cells *= n;
      if (n_cells > most_cells)
        reader.error("cells",
                     fmt::format("the mesh would have {:.2g} cells after {} "
                                 "refinements",
                                 n_cells, mesh.refinements),
                     "write fewer cells or refinements");
    }

    void read_box(SectionReader &reader, const unsigned int dimension,
                  const MeshType &type, MeshInput &mesh)
    {
      const unsigned int n_before = reader.errors().n_errors();
      mesh.lower = reader.numbers("lower corner", repeated("0", dimension),
                                  units::length, Range::any(), dimension, "m");
      mesh.upper = reader.numbers("upper corner", "", units::length,
                                  Range::any(), dimension, "m");
      mesh.cells = reader.integers("cells", "", 1, dimension,
                                   "number per direction, before refinement");
      if (mesh.type != "notched plate")
        reader.refuse({"notch length", "notch width", "notch height"},
                      "the mesh `" + mesh.type + "` has no notch");
      // after an error, the numbers are not those of the user
      const bool can_compare = reader.errors().n_errors() == n_before;
      for (unsigned int d = 0; can_compare && d < dimension; ++d)
        if (mesh.upper[d] <= mesh.lower[d])
          reader.error("upper corner",
                       fmt::format("upper corner: {} = {:g} must be greater "
                                   "than {:g} of the lower corner",
                                   "xyz"[d], mesh.upper[d], mesh.lower[d]),
                       "exchange the two corners");
      if (can_compare)
        check_size(reader, mesh, type);
      if (mesh.type == "notched plate")
        read_notch(reader, mesh, can_compare);
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
      if (const MeshType *type = find_box_type(mesh.type)) {
        read_box(reader, dimension, *type, mesh);
        if (type->simplices)
          mesh.split_simplices = read_split(reader);
      } else if (mesh.type == "file")
        read_mesh_from_file(reader, dimension, mesh);
      else if (mesh.type == "voronoi")
        read_voronoi(reader, mesh);
      else if (mesh.type != "bodies")
        mesh.generator_arguments = reader.word(
            "arguments", "", "of the generator, as deal.II takes them: a : b");
      mesh.distortion = reader.number(
          "distortion", "0", units::none, {0., 0.5, false, true},
          "share of the cell size by which interior vertices move");
      mesh.seed = reader.integer("seed", "1", 0,
                                 std::numeric_limits<unsigned int>::max(),
                                 "of the distortion");
      return mesh;
    }

    bool has_simplex_cells(const MeshInput &mesh)
    {
      if (mesh.split_simplices)
        return false;
      if (mesh.named)
        return all_simplices(*mesh.named);
      const MeshType *type = find_box_type(mesh.type);
      return type != nullptr && type->simplices;
    }
  } // namespace

  bool has_numbered_groups(const SceneInput &scene)
  {
    const MeshType *type = find_mesh_type(scene.mesh.type);
    return type != nullptr && type->kind == MeshType::Kind::generator;
  }

  bool has_simplices(const SceneInput &scene)
  {
    return has_simplex_cells(scene.mesh.type == "bodies" &&
                                     !scene.bodies.empty()
                                 ? scene.bodies.front().mesh
                                 : scene.mesh);
  }

  void read_mesh(ParameterFile &file, InputErrors &errors, SceneInput &scene)
  {
    SectionReader reader(file.open("Mesh"), errors);
    scene.mesh = read_one_mesh(reader, scene.dimension, false);

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
      const unsigned int highest = simplices ? 2 : scene.dimension == 2 ? 8 : 4;
      if (degree <= highest)
        return;
      const char *const reason =
          simplices
              ? "deal.II 9.4.1 has no higher element for triangles and "
                "tetrahedra (`split simplices = true` makes quads or hexes of "
                "them)"
              : (scene.dimension == 2 ? "quadrilaterals are tested to degree 8"
                                      : "hexahedra are tested to degree 4");
      reader.error("degree",
                   fmt::format("degree = {} must be at most {} on this mesh: "
                               "{}",
                               degree, highest, reason),
                   fmt::format("write for example: {}", highest));
    }

    unsigned int read_interface_points(SectionReader &reader,
                                       const DiscretizationInput &input)
    {
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
      if (rule == "quarter points" && n_points != 2)
        reader.error("interface points",
                     fmt::format("interface points = {}: the rule `quarter "
                                 "points` has 2 per direction",
                                 n_points),
                     "write 2, or interface quadrature = gauss");
      if (rule == "gauss lobatto" && n_points < 2)
        reader.error("interface points",
                     "interface points = 1: the rule `gauss lobatto` has at "
                     "least 2 per direction",
                     "write 2, or interface quadrature = gauss");
      return n_points;
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
    input.lumped_mass =
        reader.choice("mass", "consistent", {"consistent", "lumped"},
                      "consistent or lumped") == "lumped";
    if (input.lumped_mass && has_simplices(scene) && input.degree == 2)
      reader.error("mass",
                   "mass = lumped with degree = 2 on triangles or tetrahedra "
                   "would leave vertices without mass",
                   "write consistent, or degree = 1");
    input.interface_quadrature =
        reader.choice("interface quadrature", "gauss",
                      {"gauss", "gauss lobatto", "quarter points"},
                      "gauss, gauss lobatto or quarter points");
    input.interface_points = read_interface_points(reader, input);
  }
} // namespace nsfd
