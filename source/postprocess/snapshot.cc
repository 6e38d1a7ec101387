#include "snapshot.h"

#include "bodies/cell_stresses.h"
#include "core/gather.h"
#include "discretization/cell_sampler.h"
#include "discretization/cells.h"
#include "heat/body_heat.h"

#include "discretization/cell_geometry.h"

#include <deal.II/fe/fe.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** A polygon on its way to rank 0: a cell, or a visible face of one. */
    struct Part {
      unsigned long long cell = 0;
      unsigned int face = 0, n_corners = 0, fragment = 0, material = 0;
      double value = 0., speed = 0., warmth = 0.;
      Vector3 centre{};
      std::array<Vector3, 4> reference{}, displacement{};
    };

    /** The polygons of the cells of this rank. */
    template <int dim>
    class PartMaker
    {
    public:
      PartMaker(const Discretization<dim> &discretization, const State &state,
                const Fragments<dim> &fragments);

      std::vector<Part> cells();
      std::vector<Part> visible_faces(const FaceNumbers &face_numbers,
                                      const State &state);

    private:
      Part make(unsigned int body, unsigned int face,
                const std::vector<unsigned int> &vertices) const;

      const Discretization<dim> &discretization_;
      const std::vector<unsigned int> fragment_;
      const ReferenceCell cell_;
      const std::size_t n_bodies_;
      const std::vector<double> displacement_, velocity_; ///< nodal
      const Sampler<dim> middle_;
      std::vector<double> stress_; ///< von Mises, mean over the body
      std::vector<double> warmth_; ///< likewise; empty: there is no heat
    };

    template <int dim>
    std::vector<Point<dim>> reference_corners(const ReferenceCell &cell)
    {
      std::vector<Point<dim>> corners;
      for (unsigned int v = 0; v < cell.n_vertices(); ++v)
        corners.push_back(cell.template vertex<dim>(v));
      return corners;
    }

    template <int dim>
    PartMaker<dim>::PartMaker(const Discretization<dim> &discretization,
                              const State &state,
                              const Fragments<dim> &fragments)
        : discretization_(discretization), fragment_(fragments.number_bodies()),
          cell_(discretization.cells().element->reference_cell()),
          n_bodies_(discretization.bodies().size()),
          displacement_(discretization.to_nodal(state.displacement)),
          velocity_(discretization.to_nodal(state.velocity)),
          middle_(*discretization.cells().element,
                  {mean(reference_corners<dim>(cell_))}),
          stress_(n_bodies_, 0.)
    {
      std::vector<double> volume(n_bodies_, 0.);
      CellStresses<dim>(discretization, state)
          .visit_all(displacement_, velocity_,
                     [&](const unsigned int body, const Point<dim> &,
                         const double JxW,
                         const std::array<double, 6> &stress) {
                       stress_[body] += JxW * von_mises(stress);
                       volume[body] += JxW;
                     });
      for (std::size_t b = 0; b < n_bodies_; ++b)
        stress_[b] /= volume[b];
      const auto &T = state.heat.temperature;
      if (T.empty())
        return;
      const auto before = initial_temperatures(discretization);
      const std::size_t n = T.size() / n_bodies_;
      for (std::size_t b = 0; b < n_bodies_; ++b) {
        double sum = 0.;
        for (std::size_t k = b * n; k < (b + 1) * n; ++k)
          sum += T[k] - before[k];
        warmth_.push_back(sum / double(n));
      }
    }

    template <int dim>
    Part PartMaker<dim>::make(const unsigned int b, const unsigned int face,
                              const std::vector<unsigned int> &vertices) const
    {
      const auto corners = discretization_.cells().corners[b];
      const auto u = discretization_.cells().at_corners(b, displacement_);
      const double *v =
          velocity_.data() + discretization_.cells().first_node[b] * dim;
      Part part;
      part.cell = discretization_.cells().global_cell[b];
      part.face = face;
      part.n_corners = unsigned(vertices.size());
      part.fragment = fragment_[b];
      part.material = discretization_.cells().body_class(b).material;
      part.value = stress_[b];
      if (!warmth_.empty())
        part.warmth = warmth_[b];
      part.speed = middle_.value(0, v).norm();
      part.centre = in_space<dim>(discretization_.cells().centre(b));
      const auto order = cyclic(part.n_corners);
      for (unsigned int i = 0; i < part.n_corners; ++i) {
        const unsigned int corner = vertices[order[i]];
        part.reference[i] = in_space<dim>(corners[corner]);
        part.displacement[i] = in_space<dim>(&u[corner * dim]);
      }
      return part;
    }

    /** Turn the corners so that they go round anticlockwise from outside. */
    void turn_outwards(Part &part)
    {
      Vector3 normal{}, middle{};
      const Vector3 *x = part.reference.data();
      for (unsigned int i = 0; i < part.n_corners; ++i)
        for (unsigned int d = 0; d < 3; ++d) {
          const unsigned int e = (d + 1) % 3, f = (d + 2) % 3,
                             j = (i + 1) % part.n_corners;
          normal[d] += x[i][e] * x[j][f] - x[i][f] * x[j][e];
          middle[d] += x[i][d] / part.n_corners;
        }
      double outwards = 0.;
      for (unsigned int d = 0; d < 3; ++d)
        outwards += normal[d] * (middle[d] - part.centre[d]);
      if (outwards < 0.) {
        std::reverse(part.reference.begin(),
                     part.reference.begin() + part.n_corners);
        std::reverse(part.displacement.begin(),
                     part.displacement.begin() + part.n_corners);
      }
    }

    template <int dim>
    std::vector<Part> PartMaker<dim>::cells()
    {
      std::vector<unsigned int> all(cell_.n_vertices());
      std::iota(all.begin(), all.end(), 0);
      std::vector<Part> parts;
      for (unsigned int b = 0; b < n_bodies_; ++b)
        parts.push_back(make(b, 0, all));
      return parts;
    }

    /** Those that do not carry to a neighbour. */
    template <int dim>
    std::vector<Part>
    PartMaker<dim>::visible_faces(const FaceNumbers &face_numbers,
                                  const State &state)
    {
      const auto &faces = discretization_.points().faces;
      std::vector<char> hidden(n_bodies_ * cell_.n_faces(), 0);
      for (std::size_t f = 0; f < faces.size(); ++f)
        if (!faces[f].boundary &&
            connection<dim>(state, faces[f]) != Connection::open)
          for (unsigned int side = 0; side < 2; ++side)
            if (faces[f].bodies[side] >= 0)
              hidden[faces[f].bodies[side] * cell_.n_faces() +
                     face_numbers[f][side]] = 1;
      std::vector<Part> parts;
      for (unsigned int b = 0; b < n_bodies_; ++b)
        for (const unsigned int f : cell_.face_indices()) {
          if (hidden[b * cell_.n_faces() + f])
            continue;
          std::vector<unsigned int> vertices;
          for (unsigned int v = 0;
               v < cell_.face_reference_cell(f).n_vertices(); ++v)
            vertices.push_back(cell_.face_to_cell_vertices(f, v, 1));
          parts.push_back(make(b, f, vertices));
          turn_outwards(parts.back());
        }
      return parts;
    }

    /** An edge between two cells of a plane mesh on its way to rank 0. */
    struct Joint {
      std::array<unsigned long long, 2> cells{};
      std::array<Vector3, 2> ends{};
      double beta = 0.;
      bool contact = false, can_break = false;
    };

    std::vector<Joint> make_joints(const Discretization<2> &discretization,
                                   const FaceNumbers &face_numbers,
                                   const State &state)
    {
      const auto &points = discretization.points();
      const ReferenceCell cell =
          discretization.cells().element->reference_cell();
      std::vector<Joint> joints;
      for (std::size_t f = 0; f < points.faces.size(); ++f) {
        const auto &face = points.faces[f];
        if (face.boundary || face.first >= points.n_owned)
          continue;
        const auto corners =
            face_corners(cell, discretization.cells().corners[face.bodies[0]],
                         face_numbers[f][0]);
        Joint joint;
        joint.cells = face.cells;
        joint.ends = {{in_space<2>(corners[0]), in_space<2>(corners[1])}};
        for (unsigned int i = face.first; i < face.first + face.count; ++i) {
          joint.beta += state.beta[i] / face.count;
          joint.contact |= state.contact[i] != 0;
          joint.can_break |= state.kind[i] == PointKind::cohesive ||
                             state.kind[i] == PointKind::rigid;
        }
        joints.push_back(joint);
      }
      return joints;
    }

    using PolygonOfCell = std::map<unsigned long long, std::size_t>;

    /** In an order that does not know the ranks. */
    PolygonOfCell add_polygons(std::vector<Part> parts, Snapshot &snapshot)
    {
      std::sort(parts.begin(), parts.end(), [](const Part &a, const Part &b) {
        return std::tie(a.centre, a.cell, a.face) <
               std::tie(b.centre, b.cell, b.face);
      });
      PolygonOfCell polygon_of;
      for (const auto &part : parts) {
        polygon_of[part.cell] = snapshot.polygons.size();
        auto &polygon = snapshot.polygons.emplace_back();
        polygon.reference.assign(part.reference.begin(),
                                 part.reference.begin() + part.n_corners);
        polygon.displacement.assign(part.displacement.begin(),
                                    part.displacement.begin() + part.n_corners);
        polygon.value = part.value;
        polygon.speed = part.speed;
        polygon.warmth = part.warmth;
        polygon.fragment = part.fragment;
        polygon.material = part.material;
      }
      return polygon_of;
    }

    /** Of the corner that is nearest to @p x. */
    Vector3 displacement_at(const Snapshot::Polygon &polygon, const Vector3 &x)
    {
      std::size_t best = 0;
      double nearest = std::numeric_limits<double>::max();
      for (std::size_t v = 0; v < polygon.reference.size(); ++v) {
        const double distance = std::hypot(polygon.reference[v][0] - x[0],
                                           polygon.reference[v][1] - x[1]);
        if (distance < nearest) {
          nearest = distance;
          best = v;
        }
      }
      return polygon.displacement[best];
    }

    void add_faces(const std::vector<Joint> &joints,
                   const PolygonOfCell &polygon_of, Snapshot &snapshot)
    {
      std::vector<std::tuple<std::size_t, std::size_t, std::size_t>> order;
      for (std::size_t j = 0; j < joints.size(); ++j)
        order.emplace_back(polygon_of.at(joints[j].cells[0]),
                           polygon_of.at(joints[j].cells[1]), j);
      std::sort(order.begin(), order.end());
      for (const auto &[first, second, j] : order) {
        const Joint &joint = joints[j];
        std::array<Vector3, 2> mean;
        for (unsigned int e = 0; e < 2; ++e) {
          const Vector3 a =
              displacement_at(snapshot.polygons[first], joint.ends[e]);
          const Vector3 b =
              displacement_at(snapshot.polygons[second], joint.ends[e]);
          for (unsigned int c = 0; c < 3; ++c)
            mean[e][c] = (a[c] + b[c]) / 2.;
        }
        snapshot.faces.push_back({joint.ends[0], joint.ends[1], mean[0],
                                  mean[1], joint.beta, joint.contact,
                                  joint.can_break});
      }
    }
  } // namespace

  template <int dim>
  Snapshot take_snapshot(const Discretization<dim> &discretization,
                         const Communicator &communicator,
                         const FaceNumbers &face_numbers, const State &state,
                         const Fragments<dim> &fragments)
  {
    Snapshot snapshot;
    snapshot.time = state.time;
    snapshot.dimension = dim;
    PartMaker<dim> maker(discretization, state, fragments);
    if constexpr (dim == 2) {
      const auto polygon_of =
          add_polygons(gather(communicator, maker.cells()), snapshot);
      const auto joints = gather(
          communicator, make_joints(discretization, face_numbers, state));
      add_faces(joints, polygon_of, snapshot);
    } else
      add_polygons(
          gather(communicator, maker.visible_faces(face_numbers, state)),
          snapshot);
    return snapshot;
  }

  template Snapshot take_snapshot(const Discretization<2> &,
                                  const Communicator &, const FaceNumbers &,
                                  const State &, const Fragments<2> &);
  template Snapshot take_snapshot(const Discretization<3> &,
                                  const Communicator &, const FaceNumbers &,
                                  const State &, const Fragments<3> &);
} // namespace nsfd
