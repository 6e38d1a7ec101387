#include "mesh_file.h"

#include <fmt/format.h>

#include <fstream>
#include <map>

namespace nsfd
{
  namespace
  {
    struct VtkShape {
      unsigned int dimension;
      std::vector<unsigned int> order; ///< corners in deal.II's order
    };

    /** By the number of the type; those of higher order by their corners. */
    const std::map<int, VtkShape> vtk_shapes = {
        {3, {1, {0, 1}}},
        {5, {2, {0, 1, 2}}},
        {8, {2, {0, 1, 2, 3}}}, // pixel
        {9, {2, {0, 1, 3, 2}}},
        {10, {3, {0, 1, 2, 3}}},
        {11, {3, {0, 1, 2, 3, 4, 5, 6, 7}}}, // voxel
        {12, {3, {0, 1, 3, 2, 4, 5, 7, 6}}},
        {13, {3, {0, 1, 2, 3, 4, 5}}},
        {21, {1, {0, 1}}},
        {22, {2, {0, 1, 2}}},
        {23, {2, {0, 1, 3, 2}}},
        {24, {3, {0, 1, 2, 3}}},
        {25, {3, {0, 1, 3, 2, 4, 5, 7, 6}}}};

    class LegacyVtk
    {
    public:
      explicit LegacyVtk(const std::string &file) : in_(file)
      {
        std::string line;
        std::getline(in_, line);
        is_vtk_ = line.rfind("# vtk DataFile", 0) == 0;
        std::getline(in_, line); // title
        in_ >> format_;
      }

      /** Empty, or what is wrong. */
      std::string read()
      {
        if (!is_vtk_)
          return "this is no VTK file: it does not begin with # vtk DataFile";
        if (format_ != "ASCII")
          return "it is a binary VTK file; write it as ASCII";
        std::string word;
        while (in_ >> word) {
          if (word == "DATASET") {
            in_ >> word;
            if (word != "UNSTRUCTURED_GRID")
              return fmt::format("its data set is {}; an UNSTRUCTURED_GRID is "
                                 "needed",
                                 word);
          } else if (word == "POINTS") {
            std::size_t n = 0;
            in_ >> n >> word;
            read_numbers(3 * n, coordinates);
          } else if (word == "CELLS")
            read_cells();
          else if (word == "CELL_TYPES") {
            std::size_t n = 0;
            in_ >> n;
            read_numbers(n, types);
          } else if (word == "CELL_DATA") {
            in_ >> word;
            in_cell_data_ = true;
          } else if (word == "POINT_DATA")
            in_cell_data_ = false;
          else if (in_cell_data_ && word == "SCALARS")
            read_scalars();
          if (!in_)
            return "it ends early";
        }
        return types.size() + 1 == first.size() && !types.empty()
                   ? ""
                   : "it has no cells, or not a type for each";
      }

      std::vector<double> coordinates;
      std::vector<std::size_t> first = {0}, vertices;
      std::vector<int> types;
      std::vector<int> materials; ///< per cell, or empty

    private:
      template <typename Number>
      void read_numbers(const std::size_t n, std::vector<Number> &numbers)
      {
        for (std::size_t i = 0; i < n && in_; ++i) {
          Number value{};
          if (in_ >> value)
            numbers.push_back(value);
        }
      }

      /** Versions before 5 give the number of corners with every cell. */
      void read_cells()
      {
        std::size_t n = 0, size = 0;
        in_ >> n >> size;
        const auto here = in_.tellg();
        std::string word;
        in_ >> word;
        if (word == "OFFSETS") {
          in_ >> word;
          first.clear();
          read_numbers(n, first);
          in_ >> word >> word; // CONNECTIVITY and a type
          read_numbers(size, vertices);
          return;
        }
        in_.seekg(here);
        for (std::size_t c = 0; c < n && in_; ++c) {
          std::size_t n_corners = 0;
          in_ >> n_corners;
          read_numbers(n_corners, vertices);
          first.push_back(vertices.size());
        }
      }

      void read_scalars()
      {
        std::string name, type, word;
        in_ >> name >> type >> word;
        if (word != "LOOKUP_TABLE")
          in_ >> word;
        in_ >> word;
        if (name != "MaterialID")
          return;
        std::vector<double> values;
        read_numbers(types.size(), values);
        materials.assign(values.begin(), values.end());
      }

      std::ifstream in_;
      std::string format_;
      bool is_vtk_ = false, in_cell_data_ = false;
    };
  } // namespace

  NamedMesh read_vtk(const std::string &file, const unsigned int dimension,
                     std::vector<std::string> &problems)
  {
    LegacyVtk vtk(file);
    NamedMesh mesh;
    mesh.dimension = dimension;
    const std::string problem = vtk.read();
    if (!problem.empty()) {
      problems.push_back(problem);
      return mesh;
    }
    mesh.coordinates = vtk.coordinates;
    std::map<std::pair<unsigned int, int>, unsigned int> group;
    for (std::size_t c = 0; c < vtk.types.size(); ++c) {
      const auto shape = vtk_shapes.find(vtk.types[c]);
      if (shape == vtk_shapes.end())
        continue; // points, polygons, pyramids
      const auto &[d, order] = shape->second;
      if (d > dimension) {
        problems.push_back("it is a mesh of 3 dimensions, the scene has 2; "
                           "write `set dimension = 3` at the top, or bring "
                           "another file");
        return mesh;
      }
      if (d + 1 < dimension)
        continue;
      std::vector<unsigned int> corners;
      for (const unsigned int k : order) {
        const std::size_t at = vtk.first[c] + k;
        if (at >= vtk.vertices.size() ||
            vtk.vertices[at] >= mesh.n_vertices()) {
          problems.push_back(
              fmt::format("cell {} has a vertex that is not there", c));
          return mesh;
        }
        corners.push_back(unsigned(vtk.vertices[at]));
      }
      std::vector<unsigned int> groups;
      if (!vtk.materials.empty()) {
        const auto [entry, is_new] = group.emplace(
            std::pair(d, vtk.materials[c]), unsigned(mesh.groups.size()));
        if (is_new)
          mesh.groups.push_back({d, vtk.materials[c], "", 0, 0});
        groups.push_back(entry->second);
      }
      (d == dimension ? mesh.cells : mesh.faces)
          .add(corners, mesh.set_of(groups), c);
    }
    return mesh;
  }
} // namespace nsfd
