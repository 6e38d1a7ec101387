#include "core/mix_bits.h"
#include "mesh_topology.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** A plane convex face: is @p p on it, up to @p tolerance? */
    template <int dim>
    bool lies_on(const Point<dim> &p, const std::vector<Point<dim>> &face,
                 const double tolerance)
    {
      if constexpr (dim == 2) {
        const Tensor<1, 2> edge = face[1] - face[0], q = p - face[0];
        const double along = q * edge / edge.norm();
        return along > -tolerance && along < edge.norm() + tolerance &&
               std::abs(q[0] * edge[1] - q[1] * edge[0]) <
                   tolerance * edge.norm();
      } else {
        // triangles (0, 1, 2) and, of a quad in lexicographic order, (3, 2, 1)
        for (unsigned int part = 0; part + 2 < face.size(); ++part) {
          const Point<dim> &o = face[part == 0 ? 0 : 3];
          const Tensor<1, dim> a = face[part == 0 ? 1 : 2] - o,
                               b = face[part == 0 ? 2 : 1] - o, q = p - o;
          const Tensor<1, dim> normal = cross_product_3d(a, b);
          const double area_2 = normal.norm_square();
          const double s = cross_product_3d(q, b) * normal / area_2,
                       t = cross_product_3d(a, q) * normal / area_2;
          if (std::abs(q * normal) < tolerance * std::sqrt(area_2) &&
              s > -1e-9 && t > -1e-9 && s + t < 1. + 1e-9)
            return true;
        }
        return false;
      }
    }

    /** Vertices of different bodies at one place get one number. */
    template <int dim>
    void glue(CoarseMesh<dim> &mesh, const double tolerance)
    {
      const std::vector<bool> at_boundary = boundary_vertices(mesh);
      std::vector<unsigned int> body(mesh.vertices.size(), no_vertex);
      for (const auto &cell : mesh.cells)
        for (const unsigned int v : cell.vertices)
          body[v] = cell.material_id;

      using Bin = std::array<std::int64_t, 3>;
      const auto hash = [](const Bin &bin) {
        return mixed(bin[0] + mixed(bin[1] + mixed(bin[2])));
      };
      const Point<dim> lower = bounding_box(mesh.vertices).first;
      std::unordered_map<Bin, std::vector<unsigned int>, decltype(hash)> bins(
          16, hash);
      std::vector<unsigned int> number(mesh.vertices.size());
      for (unsigned int v = 0; v < mesh.vertices.size(); ++v) {
        number[v] = v;
        if (!at_boundary[v])
          continue;
        Bin bin{};
        for (unsigned int d = 0; d < dim; ++d)
          bin[d] =
              std::llround((mesh.vertices[v][d] - lower[d]) / (2. * tolerance));
        for (unsigned int n = 0; n < (dim == 2 ? 9 : 27); ++n) {
          const Bin near = {{bin[0] + n % 3 - 1, bin[1] + n / 3 % 3 - 1,
                             dim == 2 ? 0 : bin[2] + n / 9 - 1}};
          const auto found = bins.find(near);
          if (found != bins.end())
            for (const unsigned int w : found->second)
              if (body[w] != body[v] &&
                  mesh.vertices[v].distance(mesh.vertices[w]) <= tolerance)
                number[v] = std::min(number[v], number[w]);
        }
        bins[bin].push_back(v);
      }
      renumber(mesh, number);
      remove_unused_vertices(mesh);
    }

    /** Boundary ids stay only where the face still is at the boundary. */
    template <int dim>
    void drop_inner_boundary_ids(CoarseMesh<dim> &mesh)
    {
      std::set<FaceKey> inner;
      for_each_face(sorted_faces(mesh),
                    [&](const CellFace &face, std::size_t n) {
                      if (n > 1)
                        inner.insert(face.key);
                    });
      const auto drop = [&](auto &objects) {
        objects.erase(
            std::remove_if(objects.begin(), objects.end(),
                           [&](const auto &object) {
                             return inner.count(face_key(object.vertices)) != 0;
                           }),
            objects.end());
      };
      if (dim == 2)
        drop(mesh.boundary.boundary_lines);
      else
        drop(mesh.boundary.boundary_quads);
    }

    /** Faces of two bodies that lie on each other without being one face. */
    template <int dim>
    void find_unmatched_faces(const CoarseMesh<dim> &mesh,
                              const std::vector<BodyInput> &bodies,
                              const double tolerance,
                              std::vector<std::string> &problems)
    {
      struct Item {
        std::vector<Point<dim>> corners, probes;
        std::pair<Point<dim>, Point<dim>> box;
      };
      std::vector<std::vector<Item>> items(bodies.size());
      for_each_face(sorted_faces(mesh),
                    [&](const CellFace &face, std::size_t n) {
                      if (n > 1)
                        return;
                      const auto &cell = mesh.cells[face.cell];
                      Item item;
                      Point<dim> middle;
                      const auto faces = cell_faces<dim>(cell.vertices.size());
                      for (const unsigned int i : faces[face.number])
                        item.corners.push_back(mesh.vertices[cell.vertices[i]]);
                      for (const auto &p : item.corners)
                        middle += p / double(item.corners.size());
                      for (const auto &p : item.corners)
                        item.probes.push_back(p + 1e-3 * (middle - p));
                      item.probes.push_back(middle);
                      item.box = bounding_box(item.corners);
                      items[cell.material_id].push_back(item);
                    });
      const auto apart = [&](const auto &a, const auto &b) {
        for (unsigned int d = 0; d < dim; ++d)
          if (a.first[d] > b.second[d] + tolerance ||
              b.first[d] > a.second[d] + tolerance)
            return true;
        return false;
      };
      std::vector<std::pair<Point<dim>, Point<dim>>> boxes;
      for (auto &list : items) {
        std::vector<Point<dim>> corners;
        for (const auto &item : list)
          corners.insert(corners.end(), item.corners.begin(),
                         item.corners.end());
        boxes.push_back(bounding_box(corners));
        std::sort(list.begin(), list.end(), [](const Item &a, const Item &b) {
          return a.box.first[0] < b.box.first[0];
        });
      }
      const auto overlap = [&](const Item &a, const Item &b) {
        const auto any_on = [&](const Item &probing, const Item &face) {
          return std::any_of(probing.probes.begin(), probing.probes.end(),
                             [&](const auto &p) {
                               return lies_on(p, face.corners, tolerance);
                             });
        };
        return any_on(a, b) || any_on(b, a);
      };
      for (unsigned int a = 0; a < bodies.size(); ++a)
        for (unsigned int b = a + 1; b < bodies.size(); ++b) {
          if (items[a].empty() || items[b].empty() || apart(boxes[a], boxes[b]))
            continue;
          std::vector<const Item *> near;
          double width = 0.;
          for (const auto &item : items[b])
            if (!apart(item.box, boxes[a])) {
              near.push_back(&item);
              width = std::max(width, item.box.second[0] - item.box.first[0]);
            }
          const Item *found = nullptr;
          for (const auto &item : items[a]) {
            auto other = std::lower_bound(near.begin(), near.end(),
                                          item.box.first[0] - width - tolerance,
                                          [](const Item *i, const double x) {
                                            return i->box.first[0] < x;
                                          });
            for (; found == nullptr && other != near.end() &&
                   (*other)->box.first[0] <= item.box.second[0] + tolerance;
                 ++other)
              if (!apart(item.box, (*other)->box) && overlap(item, **other))
                found = &item;
          }
          if (found != nullptr)
            problems.push_back(fmt::format(
                "bodies `{}` and `{}` touch at {}, but their faces do not "
                "match "
                "there, so nothing would act between them; give both the same "
                "cells along the contact or leave a gap",
                bodies[a].name, bodies[b].name, text(found->probes.back())));
        }
    }

    bool fills_box(const MeshInput &mesh)
    {
      const auto type = find_mesh_type(mesh.type);
      return type && type->fills_box();
    }

    template <int dim>
    void find_overlapping_boxes(const std::vector<BodyInput> &bodies,
                                const std::vector<CoarseMesh<dim>> &meshes,
                                const double tolerance,
                                std::vector<std::string> &problems)
    {
      for (unsigned int a = 0; a < bodies.size(); ++a)
        for (unsigned int b = a + 1; b < bodies.size(); ++b) {
          if (!fills_box(bodies[a].mesh) || !fills_box(bodies[b].mesh))
            continue;
          const auto box_a = bounding_box(meshes[a].vertices),
                     box_b = bounding_box(meshes[b].vertices);
          bool overlap = true;
          for (unsigned int d = 0; d < dim; ++d)
            overlap &= std::min(box_a.second[d], box_b.second[d]) >
                       std::max(box_a.first[d], box_b.first[d]) + tolerance;
          if (overlap)
            problems.push_back(fmt::format("bodies `{}` and `{}` overlap",
                                           bodies[a].name, bodies[b].name));
        }
    }
  } // namespace

  template <int dim>
  CoarseMesh<dim> merge_bodies(const std::vector<BodyInput> &bodies,
                               const std::vector<CoarseMesh<dim>> &meshes,
                               const bool surfaces_meet,
                               std::vector<std::string> &problems)
  {
    CoarseMesh<dim> all;
    double shortest = std::numeric_limits<double>::max();
    for (unsigned int b = 0; b < meshes.size(); ++b) {
      const unsigned int first = all.vertices.size();
      const auto append = [&](auto objects, auto &list) {
        for (auto &object : objects) {
          for (unsigned int &v : object.vertices)
            v += first;
          list.push_back(object);
        }
      };
      const std::size_t first_cell = all.cells.size();
      append(meshes[b].cells, all.cells);
      for (std::size_t c = first_cell; c < all.cells.size(); ++c)
        all.cells[c].material_id = b;
      append(meshes[b].boundary.boundary_lines, all.boundary.boundary_lines);
      append(meshes[b].boundary.boundary_quads, all.boundary.boundary_quads);
      all.vertices.insert(all.vertices.end(), meshes[b].vertices.begin(),
                          meshes[b].vertices.end());
      if (!meshes[b].cells.empty() && !all.cells.empty() &&
          meshes[b].cells[0].vertices.size() != all.cells[0].vertices.size()) {
        problems.push_back(fmt::format(
            "bodies `{}` and `{}` have cells of different kinds; use either "
            "quads and hexes or triangles and tetrahedra for all bodies",
            bodies[0].name, bodies[b].name));
        return {};
      }
      for (const double edge : shortest_edges(meshes[b]))
        shortest = std::min(shortest, edge);
    }
    if (all.cells.empty())
      return all;
    // no closer than the rounding of the coordinates allows
    const auto box = bounding_box(all.vertices);
    double extent = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      extent =
          std::max({extent, std::abs(box.first[d]), std::abs(box.second[d])});
    const double tolerance = std::max(1e-10 * shortest, 4e-16 * extent);

    find_overlapping_boxes(bodies, meshes, tolerance, problems);
    if (!problems.empty())
      return all;
    glue(all, tolerance);
    drop_inner_boundary_ids(all);
    for_each_face(sorted_faces(all), [&](const CellFace &face, std::size_t n) {
      if (n > 2 && problems.empty())
        problems.push_back(fmt::format(
            "{} cells meet at one face of body `{}` near {}; bodies overlap", n,
            bodies[all.cells[face.cell].material_id].name,
            text(centre(all, all.cells[face.cell]))));
    });
    if (!surfaces_meet)
      find_unmatched_faces(all, bodies, tolerance, problems);
    return all;
  }

  template CoarseMesh<2> merge_bodies(const std::vector<BodyInput> &,
                                      const std::vector<CoarseMesh<2>> &, bool,
                                      std::vector<std::string> &);
  template CoarseMesh<3> merge_bodies(const std::vector<BodyInput> &,
                                      const std::vector<CoarseMesh<3>> &, bool,
                                      std::vector<std::string> &);
} // namespace nsfd
