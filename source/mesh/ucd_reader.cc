#include "mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

namespace nsfd
{
  namespace
  {
    struct UcdShape {
      unsigned int dimension;
      std::vector<unsigned int> order; ///< from going round to row by row
    };

    const std::map<std::string, UcdShape> ucd_shapes = {
        {"line", {1, {0, 1}}},
        {"tri", {2, {0, 1, 2}}},
        {"quad", {2, {0, 1, 3, 2}}},
        {"tet", {3, {0, 1, 2, 3}}},
        {"prism", {3, {0, 1, 2, 3, 4, 5}}},
        {"hex", {3, {0, 1, 3, 2, 4, 5, 7, 6}}}};

    /** Lines that say something; the first ones may be comments. */
    std::string content_of(const std::string &file)
    {
      std::ifstream in(file);
      std::string line, text;
      while (std::getline(in, line)) {
        const auto first = line.find_first_not_of(" \t\r");
        if (first != std::string::npos && line[first] != '#')
          text += line + "\n";
      }
      return text;
    }
  } // namespace

  NamedMesh read_ucd(const std::string &file, const unsigned int dimension,
                     std::vector<std::string> &problems)
  {
    std::istringstream in(content_of(file));
    NamedMesh mesh;
    mesh.dimension = dimension;
    std::size_t n_nodes = 0, n_cells = 0, n_data[3] = {0, 0, 0};
    in >> n_nodes >> n_cells >> n_data[0] >> n_data[1] >> n_data[2];
    std::map<long, unsigned int> node;
    for (std::size_t i = 0; i < n_nodes && in; ++i) {
      long label = 0;
      double x[3] = {0., 0., 0.};
      in >> label >> x[0] >> x[1] >> x[2];
      node[label] = unsigned(i);
      mesh.coordinates.insert(mesh.coordinates.end(), x, x + 3);
    }
    std::map<std::pair<unsigned int, int>, unsigned int> group;
    for (std::size_t i = 0; i < n_cells && in; ++i) {
      long label = 0;
      int number = 0;
      std::string type;
      in >> label >> number >> type;
      const auto shape = ucd_shapes.find(type);
      if (in && shape == ucd_shapes.end()) {
        problems.push_back(fmt::format(
            "cell {} is of the type `{}`; there are line, tri, quad, tet, "
            "prism and hex",
            label, type));
        return mesh;
      }
      if (!in)
        break;
      const auto &[d, order] = shape->second;
      std::vector<unsigned int> round(order.size()), corners;
      for (unsigned int &v : round) {
        long n = 0;
        in >> n;
        const auto found = node.find(n);
        if (in && found == node.end()) {
          problems.push_back(
              fmt::format("cell {} has a node {} that is not there", label, n));
          return mesh;
        }
        v = in ? found->second : 0;
      }
      if (d + 1 < dimension)
        continue;
      if (d > dimension) {
        problems.push_back("it is a mesh of 3 dimensions, the scene has 2; "
                           "write `set dimension = 3` at the top, or bring "
                           "another file");
        return mesh;
      }
      for (const unsigned int k : order)
        corners.push_back(round[k]);
      const auto [entry, is_new] =
          group.emplace(std::pair(d, number), unsigned(mesh.groups.size()));
      if (is_new)
        mesh.groups.push_back({d, number, "", 0, 0});
      (d == dimension ? mesh.cells : mesh.faces)
          .add(corners, mesh.set_of({entry->second}), std::size_t(label));
    }
    if (!in || n_nodes == 0)
      problems.push_back("it ends early, or is no UCD mesh: numbers of nodes "
                         "and cells, nodes, cells");
    return mesh;
  }
} // namespace nsfd
