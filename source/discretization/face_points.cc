#include "face_points.h"

#include "axis.h"
#include "face_key.h"
#include "interface_quadrature.h"
#include "mesh/owned_cells.h"
#include "spring_shares.h"

#include "cell_geometry.h"
#include "core/communicator.h"
#include "mesh/mesh_builder.h"
#include "nsfd/scene/scene_input.h"
#include "obstacle_of_point.h"

#include <deal.II/grid/tria.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** A face with its points, in the order in which they are found. */
    template <int dim>
    struct NewFace {
      typename InterfacePoints<dim>::Face face;
      PointOrigin origin;
      bool owned = true;
      unsigned int found = 0; ///< as which one
    };

    /** Goes through the faces of the cells of this rank. */
    template <int dim>
    class FaceCollector
    {
    public:
      using Cell = typename Triangulation<dim>::active_cell_iterator;

      FaceCollector(const Triangulation<dim> &triangulation,
                    const MeshGroups<dim> &groups,
                    const std::vector<unsigned int> &materials,
                    const std::vector<unsigned int> &driven,
                    const SceneInput &input, CellSet set);

      using Frame = std::array<Tensor<1, dim>, dim>;
      static constexpr unsigned int n_axes = dim * dim;

      std::vector<NewFace<dim>> faces;
      InterfacePoints<dim> points; ///< theirs: positions, frames and weights
      std::vector<int> springs_inside; ///< per body, or empty: none
      std::vector<ObstacleFace> obstacle_faces;
      std::vector<InnerFace> inner_faces;
      /// centre of the first face, by its coordinates, that no block holds for
      std::optional<Point<dim>> without_block;

    private:
      NewFace<dim> make_face(const Cell &cell, unsigned int face_no,
                             PointOrigin origin, const Frame *frame = nullptr);
      void add_frames(const std::vector<double> &frames);
      void add_boundary(const Cell &cell, unsigned int face_no);
      bool is_inner(const Cell &cell, const Cell &neighbor) const;
      void add_interior(const Cell &cell, unsigned int face_no);
      void add_between(const Cell &cell_1, unsigned int face_no_1,
                       const Cell &cell_2);
      unsigned int block_of(const Cell &first, const Cell &second,
                            const Point<dim> &centre,
                            types::manifold_id face_id);

      const MeshGroups<dim> &groups_;
      const std::vector<unsigned int> &materials_, &driven_;
      const SceneInput &input_;
      const SpringShares<dim> shares_;
      std::array<Quadrature<dim - 1>, 2> quadratures_; ///< second: of triangles
      std::string text_;                               ///< of a face
      std::vector<Point<dim>> corners_;                ///< of its cell
      std::vector<double> frames_;                     ///< of its points
      std::vector<int> body_of_; ///< by active cell index, -1 if not ours

      bool is_ours(const Cell &cell) const
      {
        return body_of_[cell->active_cell_index()] >= 0;
      }
    };

    template <int dim>
    FaceCollector<dim>::FaceCollector(
        const Triangulation<dim> &triangulation, const MeshGroups<dim> &groups,
        const std::vector<unsigned int> &materials,
        const std::vector<unsigned int> &driven, const SceneInput &input,
        const CellSet set)
        : groups_(groups), materials_(materials), driven_(driven),
          input_(input), shares_(input, groups, materials),
          body_of_(bodies_of_cells(triangulation, set))
    {
      points.frame_of_face = true; // until one has several
      for (const auto &cell : cells_of(triangulation, set)) {
        if (shares_.any())
          springs_inside.push_back(shares_.inside(cell));
        for (const unsigned int f : cell->face_indices()) {
          if (cell->face(f)->at_boundary())
            add_boundary(cell, f);
          else
            add_interior(cell, f);
        }
      }
    }

    /** In the frame of the face, or in @p frame. */
    template <int dim>
    NewFace<dim> FaceCollector<dim>::make_face(const Cell &cell,
                                               const unsigned int f,
                                               const PointOrigin origin,
                                               const Frame *const frame)
    {
      corners_.clear();
      for (const unsigned int v : cell->vertex_indices())
        corners_.push_back(cell->vertex(v));
      const FaceGeometry<dim> geometry(cell->reference_cell(), corners_, f);
      auto &quadrature = quadratures_[geometry.is_triangle()];
      if (quadrature.size() == 0)
        quadrature = interface_quadrature<dim>(input_.discretization,
                                               geometry.is_triangle());
      NewFace<dim> result;
      result.origin = origin;
      const bool inside = origin.kind == PointOrigin::Kind::interface && !frame;
      text_.clear();
      add_cell_id(cell->id(), text_);
      text_ += '/' + std::to_string(f) + '/' +
               std::to_string(int(origin.kind)) + '/' +
               std::to_string(inside ? 0 : origin.block);
      result.face.key = hash_of(text_);
      const Point<dim> centre = geometry.centre();
      for (unsigned int c = 0; c < dim; ++c)
        result.face.centre[c] = centre[c];
      result.face.first = unsigned(points.n_points);
      result.face.count = quadrature.size();
      points.n_points += quadrature.size();
      frames_.clear();
      for (unsigned int q = 0; q < quadrature.size(); ++q) {
        const auto xi = quadrature.point(q);
        Tensor<1, dim> n = geometry.normal(xi);
        const double measure = n.norm();
        n /= measure;
        const Point<dim> position = geometry.position(xi);
        const Frame axes = frame ? *frame : local_frame<dim>(n);
        for (unsigned int c = 0; c < dim; ++c)
          points.position.push_back(position[c]);
        for (const auto &axis : axes)
          for (unsigned int c = 0; c < dim; ++c)
            frames_.push_back(axis[c]);
        points.weight.push_back(measure * quadrature.weight(q));
      }
      if (input_.axisymmetric)
        weigh_rings(input_.discretization, result.face.first, points);
      add_frames(frames_);
      return result;
    }

    /** Of the points of the next face. */
    template <int dim>
    void FaceCollector<dim>::add_frames(const std::vector<double> &frames)
    {
      const auto one = frames.begin() + n_axes;
      bool same = true;
      for (auto frame = one; same && frame != frames.end(); frame += n_axes)
        same = std::equal(frames.begin(), one, frame);
      if (points.frame_of_face && !same) {
        std::vector<double> of_faces;
        of_faces.swap(points.frames);
        auto frame = of_faces.begin();
        for (const auto &face : faces) {
          for (unsigned int q = 0; q < face.face.count; ++q)
            points.frames.insert(points.frames.end(), frame, frame + n_axes);
          frame += n_axes;
        }
        points.frame_of_face = false;
      }
      points.frames.insert(points.frames.end(), frames.begin(),
                           points.frame_of_face ? one : frames.end());
    }

    template <int dim>
    void FaceCollector<dim>::add_boundary(const Cell &cell,
                                          const unsigned int f)
    {
      if (input_.axisymmetric && is_on_axis(cell->face(f)))
        return;
      const auto add = [&](NewFace<dim> face) {
        face.face.boundary = true;
        face.face.bodies = {{-1, body_of_[cell->active_cell_index()]}};
        faces.push_back(std::move(face));
      };
      for (const unsigned int b : driven_) {
        if (!groups_.holds_boundary_face(input_.boundaries[b].where, cell, f))
          continue;
        Frame axes; // rows of a support are x, y, z
        for (unsigned int i = 0; i < dim; ++i)
          axes[i][i] = 1.;
        add(make_face(cell, f, {PointOrigin::Kind::motion, b}, &axes));
      }
      for (unsigned int b = 0; b < input_.obstacles.size(); ++b) {
        const auto &obstacle = input_.obstacles[b];
        if (!groups_.holds_boundary_face(obstacle.where, cell, f))
          continue;
        if (input_.large_motion) {
          obstacle_faces.push_back(
              {unsigned(body_of_[cell->active_cell_index()]), f, b});
          continue;
        }
        Tensor<1, dim> n;
        for (unsigned int c = 0; c < dim; ++c)
          n[c] = obstacle.normal[c];
        const Frame axes = local_frame<dim>(n / n.norm());
        add(make_face(cell, f, origin_at_obstacle(input_, b), &axes));
      }
    }

    /** Both cells belong to one rigid body, which is whole on its rank. */
    template <int dim>
    bool FaceCollector<dim>::is_inner(const Cell &cell,
                                      const Cell &neighbor) const
    {
      const unsigned int m = materials_[cell->active_cell_index()];
      return input_.large_motion && cell->is_locally_owned() &&
             m == materials_[neighbor->active_cell_index()] &&
             input_.materials[m].rigid_bodies.connected;
    }

    /**
     * Body 1 is the cell with the smaller id; of two sizes the smaller cell,
     * whose face it is. A face is made once on a rank: from its body 1 if that
     * is ours.
     */
    template <int dim>
    void FaceCollector<dim>::add_interior(const Cell &cell,
                                          const unsigned int f)
    {
      if (cell->face(f)->has_children()) {
        const unsigned int face_no = cell->neighbor_of_neighbor(f);
        for (unsigned int c = 0; c < cell->face(f)->n_children(); ++c) {
          const Cell small(cell->neighbor_child_on_subface(f, c));
          if (!small->is_artificial() && !is_ours(small))
            add_between(small, face_no, cell);
        }
        return;
      }
      const Cell neighbor(cell->neighbor(f));
      if (neighbor->is_artificial()) // behind a ghost
        return;
      if (is_inner(cell, neighbor)) {
        if (cell->id() < neighbor->id())
          inner_faces.push_back(
              {{{unsigned(body_of_[cell->active_cell_index()]),
                 unsigned(body_of_[neighbor->active_cell_index()])}},
               {{f, cell->neighbor_face_no(f)}}});
        return;
      }
      if (cell->neighbor_is_coarser(f) || cell->id() < neighbor->id())
        add_between(cell, f, neighbor);
      else if (!is_ours(neighbor))
        add_between(neighbor, cell->neighbor_face_no(f), cell);
    }

    /**
     * The face of the first mesh that a face of an adaptive one is a part of: a
     * block that holds for it holds for all its parts.
     */
    template <int dim>
    typename Triangulation<dim>::face_iterator
    first_face(typename Triangulation<dim>::cell_iterator cell,
               const unsigned int face_no)
    {
      while (cell->level() > 0) {
        const auto parent = cell->parent();
        bool is_part = false;
        for (unsigned int c = 0; c < parent->face(face_no)->n_children(); ++c)
          is_part =
              is_part || parent->face(face_no)->child(c) == cell->face(face_no);
        if (!is_part)
          break;
        cell = parent;
      }
      return cell->face(face_no);
    }

    /** One of the cells is ours. */
    template <int dim>
    void FaceCollector<dim>::add_between(const Cell &cell_1,
                                         const unsigned int face_no_1,
                                         const Cell &cell_2)
    {
      const auto at = input_.adaptivity ? first_face<dim>(cell_1, face_no_1)
                                        : cell_1->face(face_no_1);
      Point<dim> centre;
      for (const unsigned int v : at->vertex_indices())
        centre += at->vertex(v) / double(at->n_vertices());
      centre = groups_.asked_at(at->index(), centre);
      const unsigned int block =
          block_of(cell_1, cell_2, centre, at->manifold_id());
      auto face = make_face(cell_1, face_no_1,
                            {PointOrigin::Kind::interface, block,
                             shares_.of_face(cell_1, cell_2, block)});
      face.face.bodies = {{body_of_[cell_1->active_cell_index()],
                           body_of_[cell_2->active_cell_index()]}};
      face.face.materials = {{materials_[cell_1->active_cell_index()],
                              materials_[cell_2->active_cell_index()]}};
      face.face.cells = {{cell_1->global_active_cell_index(),
                          cell_2->global_active_cell_index()}};
      face.owned = is_ours(cell_1);
      for (const Cell *one : {&cell_1, &cell_2})
        if (!is_ours(*one))
          face.face.neighbor_rank = int((*one)->subdomain_id());
      faces.push_back(std::move(face));
    }

    template <int dim>
    bool comes_before(const Point<dim> &a, const Point<dim> &b)
    {
      for (unsigned int c = 0; c < dim; ++c)
        if (a[c] != b[c])
          return a[c] < b[c];
      return false;
    }

    /** The first one that holds; a face without one is kept. */
    template <int dim>
    unsigned int FaceCollector<dim>::block_of(const Cell &first,
                                              const Cell &second,
                                              const Point<dim> &centre,
                                              const types::manifold_id face_id)
    {
      const auto material = [&](const Cell &cell) -> const std::string & {
        return input_.materials[materials_[cell->active_cell_index()]].name;
      };
      for (unsigned int b = 0; b < input_.interfaces.size(); ++b)
        if (input_.interfaces[b].obstacle < 0 &&
            groups_.holds_interior_face(
                input_.interfaces[b].where, centre, material(first),
                material(second),
                {{first->material_id(), second->material_id()}}, face_id))
          return b;
      if (!without_block || comes_before(centre, *without_block))
        without_block = centre;
      return 0;
    }

    /** All ranks throw, and name the same face, if one of them has such one. */
    template <int dim>
    void demand_blocks(const Communicator &communicator,
                       const std::optional<Point<dim>> &without_block)
    {
      bool here = without_block.has_value();
      if (!communicator.any(here))
        return;
      Point<dim> first;
      for (unsigned int c = 0; c < dim; ++c) {
        first[c] = communicator.min(here ? (*without_block)[c]
                                         : std::numeric_limits<double>::max());
        here = here && (*without_block)[c] == first[c];
      }
      throw std::runtime_error(
          "no Interface block holds for the face at (" +
          std::to_string(first[0]) + ", " + std::to_string(first[1]) +
          (dim == 3 ? ", " + std::to_string(first[dim - 1]) : "") +
          "): add a last block with `set where = all`");
    }

    /**
     * The faces and their points, those of this rank first, otherwise in the
     * order in which they were found.
     */
    template <int dim>
    InterfacePoints<dim> owned_first(std::vector<NewFace<dim>> &faces,
                                     InterfacePoints<dim> &&found)
    {
      for (unsigned int f = 0; f < faces.size(); ++f)
        faces[f].found = f;
      const auto others =
          std::stable_partition(faces.begin(), faces.end(),
                                [](const auto &face) { return face.owned; });
      InterfacePoints<dim> points;
      points.n_points = found.n_points;
      // one after the other: there is never more than one of them twice
      const auto move = [&](std::vector<double> &from, const unsigned int width,
                            const bool of_faces, std::vector<double> &to) {
        to.reserve(from.size());
        for (const auto &face : faces) {
          const auto first =
              from.begin() +
              long(std::size_t(of_faces ? face.found : face.face.first) *
                   width);
          to.insert(to.end(), first,
                    first + (of_faces ? 1 : face.face.count) * width);
        }
        from = std::vector<double>();
      };
      points.frame_of_face = found.frame_of_face;
      move(found.position, dim, false, points.position);
      move(found.frames, dim * dim, points.frame_of_face, points.frames);
      move(found.weight, 1, false, points.weight);
      if (!found.lengths.empty())
        move(found.lengths, 1, false, points.lengths);
      unsigned int first = 0;
      for (auto face = faces.begin(); face != faces.end(); ++face) {
        if (face == others)
          points.n_owned = first;
        face->face.first = first;
        first += face->face.count;
      }
      if (others == faces.end())
        points.n_owned = first;
      return points;
    }

    /** Points of shared faces by rank, in an order that both ranks know. */
    template <int dim>
    void set_neighbors(InterfacePoints<dim> &points)
    {
      std::map<int, std::vector<std::size_t>> shared; // rank -> faces
      for (std::size_t f = 0; f < points.faces.size(); ++f)
        if (points.faces[f].neighbor_rank >= 0)
          shared[points.faces[f].neighbor_rank].push_back(f);
      for (auto &[rank, list] : shared) {
        std::sort(list.begin(), list.end(),
                  [&](const std::size_t a, const std::size_t b) {
                    return points.faces[a].key < points.faces[b].key;
                  });
        typename InterfacePoints<dim>::Neighbor neighbor;
        neighbor.rank = rank;
        for (const std::size_t f : list)
          for (unsigned int q = 0; q < points.faces[f].count; ++q) {
            neighbor.points.push_back(points.faces[f].first + q);
            neighbor.side.push_back(points.faces[f].bodies[0] >= 0 ? 0 : 1);
          }
        points.neighbors.push_back(std::move(neighbor));
      }
    }
  } // namespace

  template <int dim>
  FacePoints<dim> make_face_points(const Communicator &communicator,
                                   const Triangulation<dim> &triangulation,
                                   const MeshGroups<dim> &groups,
                                   const std::vector<unsigned int> &materials,
                                   const std::vector<unsigned int> &driven,
                                   const SceneInput &input, const CellSet set)
  {
    FaceCollector<dim> collector(triangulation, groups, materials, driven,
                                 input, set);
    demand_blocks(communicator, collector.without_block);
    FacePoints<dim> result;
    result.springs_inside = std::move(collector.springs_inside);
    result.obstacle_faces = std::move(collector.obstacle_faces);
    result.inner_faces = std::move(collector.inner_faces);
    auto &points = result.points;
    points = owned_first(collector.faces, std::move(collector.points));
    points.faces.reserve(collector.faces.size());
    points.face_of.reserve(points.n_points);
    result.origins.reserve(points.n_points);
    for (const auto &face : collector.faces) {
      points.face_of.insert(points.face_of.end(), face.face.count,
                            unsigned(points.faces.size()));
      result.origins.insert(result.origins.end(), face.face.count, face.origin);
      points.faces.push_back(face.face);
    }
    set_neighbors(points);
    return result;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template FacePoints<dim> make_face_points(                                   \
      const Communicator &, const Triangulation<dim> &,                        \
      const MeshGroups<dim> &, const std::vector<unsigned int> &,              \
      const std::vector<unsigned int> &, const SceneInput &, CellSet)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
