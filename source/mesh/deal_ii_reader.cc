#include "deal_ii_message.h"
#include "mesh_file.h"

#include <deal.II/grid/grid_in.h>
#include <deal.II/grid/tria.h>

#include <fmt/format.h>

#include <fstream>
#include <map>
#include <sstream>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    class Converter
    {
    public:
      NamedMesh convert(const Triangulation<dim> &triangulation)
      {
        mesh_.dimension = dim;
        for (const Point<dim> &p : triangulation.get_vertices())
          for (unsigned int d = 0; d < 3; ++d)
            mesh_.coordinates.push_back(d < dim ? p[d] : 0.);
        for (const auto &cell : triangulation.active_cell_iterators()) {
          corners_.clear();
          for (const unsigned int v : cell->vertex_indices())
            corners_.push_back(cell->vertex_index(v));
          mesh_.cells.add(corners_, set(dim, int(cell->material_id())));
          for (const unsigned int f : cell->face_indices())
            add_face(cell, f);
        }
        return std::move(mesh_);
      }

    private:
      template <typename Cell>
      void add_face(const Cell &cell, const unsigned int f)
      {
        const auto face = cell->face(f);
        if (!face->at_boundary() || face->boundary_id() == 0)
          return;
        corners_.clear();
        for (const unsigned int v : face->vertex_indices())
          corners_.push_back(face->vertex_index(v));
        mesh_.faces.add(corners_, set(dim - 1, int(face->boundary_id())));
      }

      unsigned int set(const unsigned int dimension, const int number)
      {
        const auto [entry, is_new] = group_.emplace(
            std::pair(dimension, number), unsigned(mesh_.groups.size()));
        if (is_new)
          mesh_.groups.push_back({dimension, number, "", 0, 0});
        return mesh_.set_of({entry->second});
      }

      NamedMesh mesh_;
      std::vector<unsigned int> corners_;
      std::map<std::pair<unsigned int, int>, unsigned int> group_;
    };

    template <int dim>
    NamedMesh read(const std::string &file, std::vector<std::string> &problems)
    {
      NamedMesh mesh;
      try {
        Triangulation<dim> triangulation;
        GridIn<dim> reader(triangulation);
        std::ifstream in(file);
        reader.read_vtu(in);
        Converter<dim> converter;
        mesh = converter.convert(triangulation);
      } catch (const std::exception &exception) {
        problems.push_back(
            fmt::format("the file cannot be read as VTU of deal.II: {}",
                        deal_ii_message(exception)));
      }
      return mesh;
    }
  } // namespace

  NamedMesh read_by_deal_ii(const std::string &file,
                            const unsigned int dimension,
                            std::vector<std::string> &problems)
  {
    return dimension == 2 ? read<2>(file, problems) : read<3>(file, problems);
  }
} // namespace nsfd
