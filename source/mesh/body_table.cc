#include "body_table.h"

#include "mesh_builder.h"
#include "owned_cells.h"

#include "core/disjoint_sets.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <string>
#include <vector>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** Which of all cells are one body: its first cell, by cell. */
    template <int dim>
    std::vector<unsigned int>
    groups_of(const SceneInput &input, const Triangulation<dim> &triangulation,
              const std::vector<unsigned int> &materials)
    {
      const auto cells = all_cells(triangulation);
      std::vector<unsigned int> number(triangulation.n_active_cells()),
          first(cells.size());
      for (unsigned int c = 0; c < cells.size(); ++c)
        number[cells[c]->active_cell_index()] = c;
      DisjointSets bodies(cells.size());
      for (unsigned int c = 0; c < cells.size(); ++c) {
        const unsigned int m = materials[cells[c]->active_cell_index()];
        if (m >= input.materials.size() ||
            !input.materials[m].rigid_bodies.connected)
          continue;
        for (const unsigned int f : cells[c]->face_indices()) {
          if (cells[c]->face(f)->at_boundary())
            continue;
          const unsigned int other = cells[c]->neighbor(f)->active_cell_index();
          if (materials[other] == m)
            bodies.join(c, number[other]);
        }
      }
      for (unsigned int c = 0; c < first.size(); ++c)
        first[c] = bodies.first(c);
      return first;
    }

    template <int dim>
    struct Share {
      Point<dim> place;
      unsigned int cell = 0; ///< the first one of the body
      std::size_t n_cells = 0;
    };

    /** Ranks @p rank to @p rank + n_ranks - 1 for these bodies. */
    template <int dim>
    void halve(typename std::vector<Share<dim>>::iterator begin,
               typename std::vector<Share<dim>>::iterator end, const int rank,
               const int n_ranks, std::vector<int> &rank_of)
    {
      if (n_ranks == 1 || begin == end) {
        for (; begin != end; ++begin)
          rank_of[begin->cell] = rank;
        return;
      }
      Point<dim> low = begin->place, high = low;
      std::size_t n = 0;
      for (auto body = begin; body != end; ++body) {
        n += body->n_cells;
        for (unsigned int d = 0; d < dim; ++d) {
          low[d] = std::min(low[d], body->place[d]);
          high[d] = std::max(high[d], body->place[d]);
        }
      }
      unsigned int along = 0;
      for (unsigned int d = 1; d < dim; ++d)
        if (high[d] - low[d] > high[along] - low[along])
          along = d;
      std::sort(begin, end, [along](const auto &a, const auto &b) {
        return a.place[along] != b.place[along]
                   ? a.place[along] < b.place[along]
                   : a.cell < b.cell;
      });
      const int n_first = n_ranks / 2;
      auto middle = begin;
      // a body goes where most of its cells go
      for (std::size_t before = 0;
           middle != end &&
           (2 * before + middle->n_cells) * std::size_t(n_ranks) <
               2 * n * std::size_t(n_first);
           ++middle)
        before += middle->n_cells;
      halve<dim>(begin, middle, rank, n_first, rank_of);
      halve<dim>(middle, end, rank + n_first, n_ranks - n_first, rank_of);
    }
  } // namespace

  template <int dim>
  BodyTable make_body_table(const SceneInput &input,
                            const Triangulation<dim> &triangulation,
                            const std::vector<unsigned int> &materials)
  {
    const auto cells = all_cells(triangulation);
    const auto group = groups_of(input, triangulation, materials);
    BodyTable table;
    table.body_of_cell.resize(cells.size());
    table.cell_of_global.resize(cells.size());
    for (unsigned int c = 0; c < cells.size(); ++c) {
      table.cell_of_global[cells[c]->global_active_cell_index()] = c;
      if (group[c] != c) {
        table.body_of_cell[c] = table.body_of_cell[group[c]];
        continue;
      }
      table.body_of_cell[c] = unsigned(table.bodies.size());
      BodyTable::Body body;
      body.first_cell = c;
      body.material = materials[cells[c]->active_cell_index()];
      // a mesh of one rank alone knows no subdomains
      body.rank = cells[c]->subdomain_id() == numbers::invalid_subdomain_id
                      ? 0
                      : int(cells[c]->subdomain_id());
      if (input.materials[body.material].rigid)
        body.rigid = int(table.n_rigid++);
      table.bodies.push_back(body);
    }
    return table;
  }

  template <int dim>
  void partition_by_bodies(const SceneInput &input,
                           Triangulation<dim> &triangulation, const int n_ranks)
  {
    std::vector<std::string> problems, warnings; // said by those who ask later
    const auto materials =
        material_indices(input, MeshGroups<dim>(input, triangulation),
                         triangulation, problems, warnings);
    const auto cells = all_cells(triangulation);
    const auto group = groups_of(input, triangulation, materials);
    std::vector<Share<dim>> bodies(cells.size());
    for (unsigned int c = 0; c < cells.size(); ++c) {
      Share<dim> &body = bodies[group[c]];
      body.cell = group[c];
      body.place += Tensor<1, dim>(cells[c]->center());
      ++body.n_cells;
    }
    bodies.erase(
        std::remove_if(bodies.begin(), bodies.end(),
                       [](const auto &body) { return body.n_cells == 0; }),
        bodies.end());
    for (auto &body : bodies)
      body.place /= double(body.n_cells);
    std::vector<int> rank_of(cells.size());
    halve<dim>(bodies.begin(), bodies.end(), 0, n_ranks, rank_of);
    for (unsigned int c = 0; c < cells.size(); ++c)
      cells[c]->set_subdomain_id(types::subdomain_id(rank_of[group[c]]));
  }

#define INSTANTIATE(dim)                                                       \
  template BodyTable make_body_table<dim>(const SceneInput &,                  \
                                          const Triangulation<dim> &,          \
                                          const std::vector<unsigned int> &);  \
  template void partition_by_bodies<dim>(const SceneInput &,                   \
                                         Triangulation<dim> &, int)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
