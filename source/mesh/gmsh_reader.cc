#include "gmsh_job.h"

#include "gmsh_session.h"
#include "neper_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <map>
#include <unordered_map>

namespace nsfd
{
  namespace
  {
    /** Gmsh goes round a quad, deal.II goes row by row. */
    std::vector<unsigned int> deal_ii_order(const unsigned int dimension,
                                            const unsigned int n_corners)
    {
      if (dimension == 2 && n_corners == 4)
        return {0, 1, 3, 2};
      if (dimension == 3 && n_corners == 8)
        return {0, 1, 3, 2, 4, 5, 7, 6};
      std::vector<unsigned int> same(n_corners);
      for (unsigned int i = 0; i < n_corners; ++i)
        same[i] = i;
      return same;
    }

    /** Copies the present model of Gmsh. */
    class Collector
    {
    public:
      Collector(const unsigned int dimension, const bool leave_out_others)
          : leave_out_others_(leave_out_others)
      {
        mesh_.dimension = dimension;
      }

      NamedMesh collect(std::vector<std::string> &problems)
      {
        collect_nodes();
        collect_groups(mesh_.dimension);
        collect_groups(mesh_.dimension - 1);
        collect_elements(mesh_.dimension, mesh_.cells, problems);
        collect_elements(mesh_.dimension - 1, mesh_.faces, problems);
        note_straight_sides(mesh_, n_higher_order_);
        if (n_left_out_ > 0)
          mesh_.notes.push_back(
              fmt::format("{} cells are in no physical group and were left out",
                          n_left_out_));
        return std::move(mesh_);
      }

      /** The vertex of a node; one that is not there if there is no node. */
      unsigned int vertex_of(const std::size_t tag) const
      {
        if (!number_.empty())
          return tag < number_.size() ? number_[tag] : no_vertex;
        const auto found = sparse_number_.find(tag);
        return found == sparse_number_.end() ? no_vertex : found->second;
      }

    private:
      static constexpr unsigned int no_vertex =
          std::numeric_limits<unsigned int>::max();

      void collect_nodes()
      {
        std::vector<std::size_t> tags;
        std::vector<double> parameters;
        gmsh::model::mesh::getNodes(tags, mesh_.coordinates, parameters);
        std::size_t largest = 0;
        for (const std::size_t tag : tags)
          largest = std::max(largest, tag);
        if (largest < 4 * tags.size() + 1000) {
          number_.assign(largest + 1, no_vertex);
          for (std::size_t i = 0; i < tags.size(); ++i)
            number_[tags[i]] = unsigned(i);
        } else
          for (std::size_t i = 0; i < tags.size(); ++i)
            sparse_number_[tags[i]] = unsigned(i);
      }

      unsigned int number(const std::size_t tag) const
      {
        return number_.empty() ? sparse_number_.at(tag) : number_.at(tag);
      }

      void add_group(const unsigned int dimension, const int number,
                     const std::string &name)
      {
        group_[{dimension, number}] = unsigned(mesh_.groups.size());
        mesh_.groups.push_back({dimension, number, name, 0, 0});
      }

      void collect_groups(const unsigned int dimension)
      {
        gmsh::vectorpair tags;
        gmsh::model::getPhysicalGroups(tags, int(dimension));
        is_physical_[dimension] = !tags.empty();
        for (const auto &[d, tag] : tags) {
          std::string name;
          gmsh::model::getPhysicalName(d, tag, name);
          add_group(dimension, tag, name);
        }
        if (!tags.empty())
          return;
        gmsh::model::getEntities(tags, int(dimension));
        for (const auto &[d, tag] : tags) {
          std::string name;
          gmsh::model::getEntityName(d, tag, name);
          // CAD files say Shapes/Assembly/Plate
          add_group(dimension, tag, name.substr(name.rfind('/') + 1));
        }
      }

      unsigned int set_of_entity(const unsigned int dimension, const int tag)
      {
        std::vector<int> tags = {tag};
        if (is_physical_[dimension])
          gmsh::model::getPhysicalGroupsForEntity(int(dimension), tag, tags);
        std::vector<unsigned int> groups;
        for (const int t : tags)
          groups.push_back(group_.at({dimension, t}));
        return mesh_.set_of(groups);
      }

      void collect_elements(const unsigned int dimension,
                            NamedMesh::Elements &elements,
                            std::vector<std::string> &problems)
      {
        gmsh::vectorpair entities;
        gmsh::model::getEntities(entities, int(dimension));
        for (const auto &[d, tag] : entities) {
          std::vector<int> types;
          std::vector<std::vector<std::size_t>> tags, nodes;
          gmsh::model::mesh::getElements(types, tags, nodes, d, tag);
          const unsigned int set = set_of_entity(dimension, tag);
          const bool is_cell = dimension == mesh_.dimension;
          for (std::size_t t = 0; t < types.size(); ++t) {
            if (set == 0 && is_physical_[dimension] && leave_out_others_) {
              if (is_cell)
                n_left_out_ += tags[t].size();
            } else
              collect_type(types[t], tags[t], nodes[t], set, is_cell, elements,
                           problems);
          }
        }
      }

      void collect_type(const int type, const std::vector<std::size_t> &tags,
                        const std::vector<std::size_t> &nodes,
                        const unsigned int set, const bool is_cell,
                        NamedMesh::Elements &elements,
                        std::vector<std::string> &problems)
      {
        std::string name;
        int dimension, order, n_nodes, n_corners;
        std::vector<double> coordinates;
        gmsh::model::mesh::getElementProperties(
            type, name, dimension, order, n_nodes, coordinates, n_corners);
        const std::size_t n = nodes.size() / std::size_t(n_nodes);
        if (dimension == 3 && n_corners == 5) {
          problems.push_back(fmt::format(
              "{} cells are pyramids; mesh without them: only triangles, "
              "quads, tetrahedra, hexes and prisms can be used",
              n));
          return;
        }
        const auto order_of =
            deal_ii_order(unsigned(dimension), unsigned(n_corners));
        std::vector<unsigned int> corners(order_of.size());
        for (std::size_t e = 0; e < n; ++e) {
          for (std::size_t i = 0; i < corners.size(); ++i)
            corners[i] = number(nodes[e * std::size_t(n_nodes) + order_of[i]]);
          // cells of a geometry are in no file
          if (leave_out_others_)
            elements.add(corners, set);
          else
            elements.add(corners, set, tags[e]);
        }
        if (order > 1 && is_cell)
          n_higher_order_ += n;
      }

      NamedMesh mesh_;
      bool leave_out_others_;
      std::vector<unsigned int> number_; ///< by tag of the node
      std::map<std::size_t, unsigned int> sparse_number_; ///< if tags are wild
      std::map<std::pair<unsigned int, int>, unsigned int> group_;
      std::map<unsigned int, bool> is_physical_;
      std::size_t n_higher_order_ = 0, n_left_out_ = 0;
    };

    /** A number per cell, not a number where the file has none. */
    std::vector<double> by_cell(const NamedMesh &mesh,
                                const std::vector<std::size_t> &tags,
                                const std::vector<std::vector<double>> &data)
    {
      std::unordered_map<std::size_t, double> of_tag;
      for (std::size_t k = 0; k < tags.size(); ++k)
        if (!data[k].empty())
          of_tag[tags[k]] = data[k][0];
      std::vector<double> values;
      for (const std::size_t number : mesh.cells.numbers) {
        const auto found = of_tag.find(number);
        values.push_back(found != of_tag.end()
                             ? found->second
                             : std::numeric_limits<double>::quiet_NaN());
      }
      return values;
    }

    /** $ElementData of one component or three, by its name. */
    void collect_data(NamedMesh &mesh)
    {
      std::vector<int> views;
      gmsh::view::getTags(views);
      for (const int view : views) {
        std::string kind, name;
        std::vector<std::size_t> tags;
        std::vector<std::vector<double>> data;
        double time = 0.;
        int n_components = 0;
        gmsh::view::getModelData(view, 0, kind, tags, data, time, n_components);
        gmsh::option::getString(
            fmt::format("View[{}].Name", gmsh::view::getIndex(view)), name);
        if (kind != "ElementData")
          continue;
        if (n_components == 1)
          add_field(mesh, name, by_cell(mesh, tags, data));
        if (n_components != 3)
          continue;
        auto &values = mesh.element_data[name];
        for (std::size_t k = 0; k < tags.size(); ++k)
          if (data[k].size() >= 3)
            values[tags[k]] = {data[k][0], data[k][1], data[k][2]};
      }
    }

    void set_options(const GmshRequest &request)
    {
      using gmsh::option::setNumber;
      using Shape = GmshRequest::Shape;
      gmsh::option::setString("Geometry.OCCTargetUnit", "MM");
      if (!request.is_geometry)
        return;
      if (request.element_size > 0.) {
        // the subdivision below halves the edges
        const double size =
            (request.shape == Shape::cubes ? 2. : 1.) * request.element_size;
        setNumber("Mesh.MeshSizeMin", size);
        setNumber("Mesh.MeshSizeMax", size);
      }
      if (request.shape == Shape::cubes)
        // all triangles into quads, or all tetrahedra into hexes
        setNumber("Mesh.SubdivisionAlgorithm", request.dimension - 1);
      if (request.shape == Shape::cubes && request.dimension == 2)
        setNumber("Mesh.RecombineAll", 1);
      if (request.shape == Shape::simplices) {
        setNumber("Mesh.RecombineAll", 0);
        setNumber("Mesh.SubdivisionAlgorithm", 0);
      }
    }

    std::string complaint(const std::string &what, const GmshSession &session)
    {
      return fmt::format("{}: Gmsh says `{}`", what, session.error());
    }

    /** More cells than any machine of today holds are a slip of the pen. */
    bool is_of_sane_size(const GmshRequest &request,
                         std::vector<std::string> &problems)
    {
      constexpr double most_cells = 1e9;
      double x[2][3];
      gmsh::model::getBoundingBox(-1, -1, x[0][0], x[0][1], x[0][2], x[1][0],
                                  x[1][1], x[1][2]);
      double n_cells = request.element_size > 0. ? 1. : 0.;
      for (unsigned int d = 0; d < request.dimension; ++d)
        n_cells *= (x[1][d] - x[0][d]) / request.element_size;
      if (!(n_cells > most_cells))
        return true;
      problems.push_back(fmt::format(
          "about {:.2g} cells of size {:g} fill the box around the geometry, "
          "{:g} x {:g}{} in the unit of the file; write a larger `element "
          "size` or another `length unit`",
          n_cells, request.element_size, x[1][0] - x[0][0], x[1][1] - x[0][1],
          request.dimension == 3 ? fmt::format(" x {:g}", x[1][2] - x[0][2])
                                 : ""));
      return false;
    }

    bool make_cells(GmshSession &session, const GmshRequest &request,
                    std::vector<std::string> &problems)
    {
      if (!is_of_sane_size(request, problems))
        return false;
      set_options(request);
      if (session.run(
              [&] { gmsh::model::mesh::generate(int(request.dimension)); }))
        return true;
      problems.push_back(complaint("the geometry cannot be meshed", session));
      return false;
    }

    /** Cells in the file, or a body to be filled with them. */
    bool has_dimension(const GmshRequest &request,
                       std::vector<std::string> &problems)
    {
      gmsh::vectorpair entities;
      int highest = 0;
      for (const int d : {1, 2, 3}) {
        gmsh::model::getEntities(entities, d);
        for (const auto &[e, tag] : entities) {
          std::vector<int> types;
          std::vector<std::vector<std::size_t>> tags, nodes;
          if (!request.is_geometry)
            gmsh::model::mesh::getElements(types, tags, nodes, e, tag);
          if (request.is_geometry || !types.empty())
            highest = d;
        }
      }
      if (highest == int(request.dimension))
        return true;
      const std::string what = request.is_geometry ? "geometry" : "mesh";
      if (highest < 2)
        problems.push_back(fmt::format("the file has no {} of {} dimensions",
                                       what, request.dimension));
      else
        problems.push_back(fmt::format(
            "it is a {} of {} dimensions, the scene has {}; write "
            "`set dimension = {}` at the top, or bring another file",
            what, highest, request.dimension, highest));
      return false;
    }
  } // namespace

  namespace
  {
    /** What a file says besides cells and groups. */
    void add_data(const GmshRequest &request, const Collector &collector,
                  NamedMesh &mesh, std::vector<std::string> &problems)
    {
      collect_data(mesh);
      if (request.extension != ".msh" || !problems.empty())
        return;
      std::ifstream in(request.file, std::ios::binary);
      add_neper_sections(
          in, mesh,
          [&](const std::size_t node) { return collector.vertex_of(node); },
          problems);
    }
  } // namespace

  NamedMesh read_gmsh_here(const GmshRequest &request,
                           std::vector<std::string> &problems)
  {
    GmshSession session;
    // before the file, which may know better
    set_options(request);
    if (!session.run([&] { gmsh::open(request.file); })) {
      problems.push_back(complaint("the file cannot be read", session));
      return {};
    }
    NamedMesh mesh;
    const bool done = session.run([&] {
      if (has_dimension(request, problems) &&
          (!request.is_geometry || make_cells(session, request, problems))) {
        Collector collector(request.dimension, request.is_geometry);
        mesh = collector.collect(problems);
        if (!request.is_geometry)
          add_data(request, collector, mesh, problems);
      }
    });
    if (!done && problems.empty())
      problems.push_back(complaint("the file cannot be used", session));
    return mesh;
  }

  namespace
  {
    /** Adds each side once; negative numbers run backwards. */
    class Sides
    {
    public:
      int of(const unsigned int a, const unsigned int b)
      {
        const auto key = std::minmax(a, b);
        auto [entry, is_new] = number_.emplace(key, 0);
        if (is_new)
          entry->second = gmsh::model::geo::addLine(int(key.first) + 1,
                                                    int(key.second) + 1);
        ++n_regions_[entry->second];
        return a < b ? entry->second : -entry->second;
      }

      std::vector<int> between_regions() const
      {
        std::vector<int> lines;
        for (const auto &[line, n] : n_regions_)
          if (n > 1)
            lines.push_back(line);
        return lines;
      }

    private:
      std::map<std::pair<unsigned int, unsigned int>, int> number_;
      std::map<int, unsigned int> n_regions_;
    };

    void add_regions(const PlaneRegions &regions, const double element_size)
    {
      namespace geo = gmsh::model::geo;
      for (std::size_t v = 0; v < regions.x.size(); ++v)
        geo::addPoint(regions.x[v], regions.y[v], 0., element_size, int(v) + 1);
      Sides sides;
      for (std::size_t r = 0; r < regions.corners.size(); ++r) {
        const auto &corners = regions.corners[r];
        std::vector<int> loop;
        for (std::size_t i = 0; i < corners.size(); ++i)
          loop.push_back(
              sides.of(corners[i], corners[(i + 1) % corners.size()]));
        geo::addPlaneSurface({geo::addCurveLoop(loop)}, int(r) + 1);
      }
      geo::synchronize();
      for (std::size_t r = 0; r < regions.corners.size(); ++r) {
        gmsh::model::addPhysicalGroup(2, {int(r) + 1}, int(r) + 1);
        gmsh::model::setPhysicalName(2, int(r) + 1, regions.names[r]);
      }
      const std::vector<int> inner = sides.between_regions();
      if (inner.empty())
        return;
      gmsh::model::addPhysicalGroup(1, inner, 1);
      gmsh::model::setPhysicalName(1, 1, regions.borders);
    }
  } // namespace

  NamedMesh mesh_regions_here(const PlaneRegions &regions,
                              const GmshRequest &request,
                              std::vector<std::string> &problems)
  {
    GmshSession session;
    NamedMesh mesh;
    const bool done = session.run([&] {
      add_regions(regions, request.element_size);
      if (make_cells(session, request, problems))
        mesh = Collector(2, true).collect(problems);
    });
    if (!done && problems.empty())
      problems.push_back(complaint("the regions cannot be meshed", session));
    return mesh;
  }
} // namespace nsfd
