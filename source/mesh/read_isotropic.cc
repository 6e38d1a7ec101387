#include "isotropic_space.h"
#include "mesh_entries.h"
#include "named_mesh_type.h"

#include "nsfd/parameters/section_reader.h"
#include "parameters/input_errors.h"
#include "parameters/parameter_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace nsfd
{
  namespace
  {
    const std::string point_list = "[0, 0], [2 mm, 0], [2 mm, 1 mm]";

    /** [x, y], [x, y], ... */
    std::vector<PlanePoint> read_points(SectionReader &reader,
                                        const std::string &entry,
                                        const SourceText &value)
    {
      std::vector<PlanePoint> points;
      for (const SourceText &part : value.split(',')) {
        const std::string &text = part.text();
        const bool has_brackets =
            text.size() > 2 && text.front() == '[' && text.back() == ']';
        const auto numbers = has_brackets
                                 ? part.part(1, text.size() - 2).split(',')
                                 : std::vector<SourceText>();
        if (numbers.size() != 2) {
          reader.errors().error(
              part.location(), fmt::format("{}: `{}` is no point", entry, text),
              "write points with brackets, for example: " + point_list);
          return {};
        }
        PlanePoint p{};
        for (unsigned int d = 0; d < 2; ++d)
          p[d] = reader.number_in(numbers[d], entry, "1 mm", units::length,
                                  Range::any());
        points.push_back(p);
      }
      return points;
    }

    /** Lower and upper corner; none if they are not right. */
    std::optional<std::array<std::vector<double>, 2>>
    read_box(SectionReader &reader, const unsigned int dimension)
    {
      const unsigned int n_before = reader.errors().n_errors();
      const auto lower =
          reader.numbers("lower corner", dimension == 2 ? "0, 0" : "0, 0, 0",
                         units::length, Range::any(), dimension, "m");
      const auto upper = reader.numbers("upper corner", "", units::length,
                                        Range::any(), dimension, "m");
      for (unsigned int d = 0;
           d < dimension && reader.errors().n_errors() == n_before; ++d)
        if (!(upper[d] > lower[d]))
          reader.error("upper corner",
                       fmt::format("upper corner: {} = {:g} must be greater "
                                   "than {:g} of the lower corner",
                                   "xyz"[d], upper[d], lower[d]),
                       "exchange the two corners");
      if (reader.errors().n_errors() > n_before)
        return {};
      return {{lower, upper}};
    }

    void read_rectangle(SectionReader &reader, PlaneDrawing &drawing)
    {
      if (const auto box = read_box(reader, 2)) {
        const auto &[lower, upper] = *box;
        drawing.boundary = {{{lower[0], lower[1]}},
                            {{upper[0], lower[1]}},
                            {{upper[0], upper[1]}},
                            {{lower[0], upper[1]}}};
      }
    }

    /** name: [x, y], [x, y], ...; name: ... */
    void read_lines(SectionReader &reader, PlaneDrawing &drawing,
                    NamedMesh &mesh)
    {
      const std::string text =
          "in the mesh, which faces follow: `name: [x, y], [x, y]; name: ...`; "
          "each is a group";
      if (!reader.optional("lines", text))
        return;
      const auto value =
          reader.raw("lines", "", text, "notch: [0, 1 mm], [2 mm, 1 mm]");
      if (!value)
        return;
      for (const SourceText &line : value->split(';')) {
        const auto colon = line.text().find(':');
        const std::string name =
            colon == std::string::npos
                ? ""
                : collapse_blanks(line.part(0, colon).text());
        if (name.empty()) {
          reader.errors().error(
              line.location(),
              fmt::format("lines: `{}` has no name", line.text()),
              "write for example: notch: [0, 1 mm], [2 mm, 1 mm]");
          continue;
        }
        const auto points = read_points(reader, "lines", line.part(colon + 1));
        if (points.size() == 1)
          reader.errors().error(
              line.location(),
              fmt::format("lines: `{}` has one point only", name),
              "write the points that it goes through");
        auto group = std::find_if(
            mesh.groups.begin(), mesh.groups.end(),
            [&](const NamedMesh::Group &one) { return one.name == name; });
        if (group == mesh.groups.end())
          group = mesh.groups.insert(
              group, {1, int(mesh.groups.size()) + 1, name, 0, 0});
        const unsigned int set =
            mesh.set_of({unsigned(group - mesh.groups.begin())});
        drawing.paths.push_back({points, set, name});
      }
    }

    /** `size` or `cells`; these are counted once all triangles are cut. */
    void read_size(SectionReader &reader, const unsigned int dimension,
                   const MeshInput &mesh, const double parts,
                   IsotropicRequest &request)
    {
      const std::string size_text = "m, side of the triangles before they are "
                                    "cut; may depend on x and y",
                        cells_text = "number of them, about; or write `size`";
      const bool has_size = reader.optional("size", size_text);
      const bool has_cells = reader.optional("cells", cells_text);
      if (has_size == has_cells)
        reader.error(has_size ? "size" : "",
                     has_size ? "`size` and `cells` say the same"
                              : "neither `size` nor `cells` is given",
                     has_size ? "write one of the two"
                              : "write for example: set size = 1 mm");
      if (has_size) {
        const unsigned int n_before = reader.errors().n_errors();
        request.size.formula =
            reader.expression("size", "", units::length, size_text);
        if (request.size.formula.depends_on_time())
          reader.error("size", "`size` depends on the time t",
                       "write a formula of x, y and z");
        else if (reader.errors().n_errors() == n_before &&
                 !request.size.formula.depends_on_position() &&
                 !(request.size.formula(0., 0., 0.) > 0.))
          reader.error("size",
                       fmt::format("size = {} must be greater than 0",
                                   request.size.formula.text()),
                       "write for example: 1 mm");
        request.size.factor = std::ldexp(1., -int(mesh.refinements));
      }
      constexpr unsigned int most_cells = 1000000000;
      if (has_cells)
        request.n_triangles =
            reader.integer("cells", "", 1, most_cells, cells_text) *
            std::ldexp(1., int(dimension * mesh.refinements)) / parts;
    }

    /** The outline of a mesh, or of one that Gmsh makes of a geometry. */
    PlaneOutline outline_of_file(const MeshFileRequest &request,
                                 NamedMesh &mesh,
                                 std::vector<std::string> &problems)
    {
      mesh = read_mesh_file(request, problems);
      for (std::string &problem : problems)
        problem.insert(0, fmt::format("`{}`: ", request.file));
      mesh.notes.clear();
      for (NamedMesh::Group &group : mesh.groups)
        group.n_elements = group.n_boundary = 0;
      return problems.empty() ? outline_of(mesh) : PlaneOutline();
    }

    IsotropicRequest read_request(SectionReader &reader,
                                  const unsigned int dimension, MeshInput &mesh)
    {
      mesh.split_simplices = read_split(reader);
      // read once more, and checked, where all meshes of simplices are
      const auto split = reader.raw(
          "split", mesh.split_simplices ? "none" : "barycentric",
          dimension == 2 ? "none, or barycentric: every triangle into six, at "
                           "its midpoints and centroid"
                         : "none, or barycentric: every tetrahedron into "
                           "twenty-four, at midpoints and centroids");
      const bool is_cut =
          split && collapse_blanks(split->text()) == "barycentric";
      IsotropicRequest request;
      read_size(reader, dimension, mesh,
                mesh.split_simplices ? dimension + 1.
                : !is_cut            ? 1.
                : dimension == 2     ? 6.
                                     : 24.,
                request);
      request.iterations =
          reader.integer("relaxation", "50", 0, 1000,
                         "steps of Lloyd: more of them make more equal cells");
      request.seed = reader.integer("seed", "1", 0,
                                    std::numeric_limits<unsigned int>::max(),
                                    "of the nodes and the distortion");
      return request;
    }

    /** A brick: other bodies have to come as meshes of files. */
    void read_in_space(SectionReader &reader, MeshInput &mesh)
    {
      const unsigned int n_before = reader.errors().n_errors();
      reader.refuse({"corners", "lines"}, "they are for meshes in the plane");
      reader.refuse({"file", "format", "length unit", "merge vertices",
                     "meshing time", "element size"},
                    "in space the boundary is a brick");
      const auto box = read_box(reader, 3);
      const IsotropicRequest request = read_request(reader, 3, mesh);
      if (!box || reader.errors().n_errors() > n_before)
        return;
      const auto point = [](const std::vector<double> &x) {
        return std::array<double, 3>{{x[0], x[1], x[2]}};
      };
      NamedMesh named;
      std::vector<std::string> problems;
      fill_box_isotropically(point((*box)[0]), point((*box)[1]), request, named,
                             problems);
      if (problems.empty())
        put_in_order(named, 1., false, problems);
      store_named_mesh(reader, reader.has("size") ? "size" : "cells",
                       std::move(named), problems, mesh);
    }

    void read_in_the_plane(SectionReader &reader, MeshInput &mesh)
    {
      const unsigned int n_before = reader.errors().n_errors();
      NamedMesh named;
      PlaneDrawing drawing;
      MeshFileRequest file;
      const bool from_file = reader.has("file");
      bool exists = true;
      const std::string corners_text =
          "of a polygon, in place of `lower corner` and `upper corner`: "
          "[x, y], [x, y], ...";
      if (from_file) {
        exists = read_file_entries(reader, file);
        file.shape = MeshFileRequest::Shape::simplices;
        file.merge_vertices = reader.boolean(
            "merge vertices", false, "join vertices that are at one place");
        file.seconds = read_meshing_time(reader);
        reader.refuse({"lower corner", "upper corner", "corners", "lines"},
                      "the boundary and all lines are those of the file");
      } else if (reader.optional("corners", corners_text)) {
        if (const auto value =
                reader.raw("corners", "", corners_text, point_list))
          drawing.boundary = read_points(reader, "corners", *value);
        reader.refuse({"lower corner", "upper corner"},
                      "`corners` is the boundary");
      } else
        read_rectangle(reader, drawing);
      if (!from_file) {
        reader.refuse({"format", "length unit", "merge vertices",
                       "meshing time", "element size"},
                      "they belong to a `file`");
        read_lines(reader, drawing, named);
      }
      const IsotropicRequest request = read_request(reader, 2, mesh);
      if (from_file) {
        const std::string text =
            "m, of the geometry's curves; without it `size`, if that is one "
            "number, or as the geometry says";
        if (reader.optional("element size", text))
          file.element_size = reader.number("element size", "", units::length,
                                            Range::positive(), text);
        else if (request.n_triangles == 0. &&
                 !request.size.formula.depends_on_position())
          file.element_size =
              request.size.factor * request.size.formula(0., 0., 0.);
      }
      if (!exists || reader.errors().n_errors() > n_before)
        return;
      std::vector<std::string> problems;
      const PlaneOutline outline = from_file
                                       ? outline_of_file(file, named, problems)
                                       : outline_of(drawing, problems);
      if (problems.empty())
        fill_isotropically(outline, request, named, problems);
      if (problems.empty())
        put_in_order(named, 1., false, problems);
      store_named_mesh(reader,
                       from_file               ? "file"
                       : reader.has("corners") ? "corners"
                       : reader.has("size")    ? "size"
                                               : "cells",
                       std::move(named), problems, mesh);
    }

    class IsotropicMesh final : public NamedMeshType
    {
    public:
      explicit IsotropicMesh(const std::string &) {}
      unsigned int place() const override { return 9; }
      const char *split(const MeshInput &mesh) const override
      {
        return mesh.split_simplices ? "none" : "barycentric";
      }
      bool is_cut_straight() const override { return true; }
      void read(SectionReader &reader, const unsigned int dimension,
                MeshInput &mesh) const override
      {
        if (dimension == 2)
          read_in_the_plane(reader, mesh);
        else
          read_in_space(reader, mesh);
        mesh.refinements = 0; // they have made the size smaller
      }
    };

    NSFD_REGISTER(
        MeshTypeRegistry, IsotropicMesh, "isotropic",
        "triangles or tetrahedra without a preferred direction, cut in 6 or "
        "24");
  } // namespace
} // namespace nsfd
