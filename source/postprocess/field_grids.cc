#include "field_grids.h"

#include "bodies/cell_stresses.h"
#include "discretization/cells.h"
#include "discretization/obstacle_of_point.h"
#include "nsfd/scene/scene_input.h"

#include "discretization/cell_sampler.h"

#include "discretization/cell_geometry.h"

#include <deal.II/fe/fe.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** The drawn cells of one body: points in the reference cell. */
    template <int dim>
    struct Lattice {
      std::vector<Point<dim>> points;
      VtuCell shape;
      std::vector<std::vector<std::int64_t>> cells; ///< in the order of VTK

      explicit Lattice(const FiniteElement<dim, dim> &element)
      {
        const ReferenceCell cell = element.reference_cell();
        if (cell.is_simplex()) {
          shape = dim == 2 ? VtuCell::triangle : VtuCell::tetrahedron;
          for (unsigned int v = 0; v < cell.n_vertices(); ++v)
            points.push_back(cell.template vertex<dim>(v));
          cells.emplace_back(points.size());
          std::iota(cells[0].begin(), cells[0].end(), 0);
          return;
        }
        shape = dim == 2 ? VtuCell::quadrilateral : VtuCell::hexahedron;
        const unsigned int n = std::clamp(element.degree, 1u, 4u);
        const auto order = cyclic(cell.n_vertices());
        const unsigned int n_z = dim == 3 ? n : 0;
        for (unsigned int k = 0; k <= n_z; ++k)
          for (unsigned int j = 0; j <= n; ++j)
            for (unsigned int i = 0; i <= n; ++i) {
              const std::array<unsigned int, 3> at = {{i, j, k}};
              Point<dim> xi;
              bool first = true; // corner 0 of a small cell
              for (unsigned int c = 0; c < dim; ++c) {
                xi[c] = double(at[c]) / n;
                first &= at[c] < n;
              }
              if (first) {
                auto &corners = cells.emplace_back();
                for (const unsigned int v : order)
                  corners.push_back(points.size() + (v & 1u) +
                                    (v >> 1 & 1u) * (n + 1) +
                                    (v >> 2 & 1u) * (n + 1) * (n + 1));
              }
              points.push_back(xi);
            }
      }
    };

    /**
     * Where a face with a tensor rule is cut so that every point has its own
     * piece: 0, midpoints between the points, 1, in direction @p d of the face.
     * The rule is symmetric, so that the mean over the other direction lies on
     * the line between the midpoints of the two opposite edges.
     */
    template <int dim>
    std::vector<double> cuts(const std::vector<Point<dim>> &corners,
                             const double *positions, const unsigned int n,
                             const unsigned int d)
    {
      std::array<Point<dim>, 2> ends;
      for (unsigned int v = 0; v < corners.size(); ++v)
        ends[v >> d & 1u] += corners[v] / double(corners.size() / 2);
      const Tensor<1, dim> edge = ends[1] - ends[0];
      const unsigned int n_points = dim == 2 ? n : n * n;
      std::vector<double> abscissae(n, 0.);
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int c = 0; c < dim; ++c)
          abscissae[d == 0 ? q % n : q / n] +=
              (positions[q * dim + c] - ends[0][c]) * edge[c] /
              edge.norm_square() * n / n_points;
      std::vector<double> result = {0.};
      for (unsigned int k = 0; k + 1 < n; ++k)
        result.push_back((abscissae[k] + abscissae[k + 1]) / 2.);
      result.push_back(1.);
      return result;
    }

    /** Of the blocks of a scene, in their order. */
    template <typename Blocks>
    std::vector<std::string> names_of(const Blocks &blocks)
    {
      std::vector<std::string> names;
      for (const auto &block : blocks)
        names.push_back(block.name);
      return names;
    }

    /** The points as pieces of their faces. */
    template <int dim>
    class InterfacePieces
    {
    public:
      using Face = typename InterfacePoints<dim>::Face;

      InterfacePieces(const Discretization<dim> &discretization,
                      const State &state, const double time_step)
          : discretization_(discretization), state_(state),
            time_step_(time_step),
            cell_(discretization.cells().element->reference_cell())
      {
        grid.time = state.time;
        grid.cell_data = {{"beta", 1, {}},
                          {"jump_n", 1, {}, "m"},
                          {"jump", 3, {}, "m"},
                          {"traction", 3, {}, "Pa"},
                          {"slip", 1, {}, "m"},
                          {"contact", 1, {}, "", VtuNumber::code},
                          {"kind", 1, {}, "", VtuNumber::code},
                          {"block", 1, {}, "", VtuNumber::integer},
                          {"obstacle", 1, {}, "", VtuNumber::code}};
        const SceneInput &input = discretization.input();
        grid.names = {{"kind_names",
                       {"prescribed", "elastic", "cohesive", "rigid", "free",
                        "bonded", "separated"}},
                      {"block_names", names_of(input.interfaces)}};
        if (!input.obstacles.empty())
          grid.names.push_back({"obstacle_names", names_of(input.obstacles)});
        const std::size_t n = discretization.points().n_owned,
                          corners = dim == 2 ? 2 : 4;
        grid.reserve(n * corners, n, n * corners);
      }

      /** A face as the body on @p side sees it. */
      void add(const Face &face, const unsigned int side,
               const std::array<unsigned int, 2> &face_no)
      {
        const auto corners = face_corners(
            cell_, discretization_.cells().corners[face.bodies[side]],
            face_no[side]);
        if (corners.size() == 3)
          add_piece(VtuCell::triangle, corners, mean_values(face));
        else
          add_tensor_face(face, cell_.face_reference_cell(face_no[side]),
                          corners);
      }

      VtuGrid grid;

    private:
      static constexpr unsigned int contact = 9, kind = 10, n_values = 13;
      using Values = std::array<double, n_values>; ///< of cell_data, in order

      Values values_at(const std::size_t i) const
      {
        const auto &points = discretization_.points();
        const double *frame = points.axes(i);
        const double *u = &state_.jump[i * dim], *P = &state_.impulse[i * dim];
        Vector3 jump{}, traction{};
        const bool bonded = state_.kind[i] == PointKind::bonded;
        for (unsigned int r = 0; r < dim; ++r)
          for (unsigned int c = 0; c < dim; ++c) {
            jump[c] += u[r] * frame[r * dim + c];
            if (bonded) // sigma n acts on body 1, the impulse on body 2
              traction[c] -=
                  state_.bond_traction[i * dim + r] * frame[r * dim + c];
            else if (time_step_ > 0.)
              traction[c] +=
                  P[r] * frame[r * dim + c] / (points.weight[i] * time_step_);
          }
        if (!state_.pressure.empty()) // the whole reaction: contact and fluid
          for (unsigned int c = 0; c < dim; ++c)
            traction[c] += state_.pressure[i] * frame[c];
        const PointOrigin origin = discretization_.origins()[i];
        return Values{
            {state_.beta[i], u[0], jump[0], jump[1], jump[2], traction[0],
             traction[1], traction[2], state_.slip[i],
             state_.contact[i] ? 1. : 0., double(state_.kind[i]),
             double(origin.block),
             obstacle_of(discretization_.input(), origin) >= 0 ? 1. : 0.}};
      }

      /** Of a triangle as a whole, with the kind of its weakest point. */
      Values mean_values(const Face &face) const
      {
        const auto &weight = discretization_.points().weight;
        Values mean{};
        double area = 0.;
        unsigned int weakest = face.first;
        bool touches = false;
        for (unsigned int i = face.first; i < face.first + face.count; ++i) {
          const Values values = values_at(i);
          for (unsigned int k = 0; k < n_values; ++k)
            mean[k] += weight[i] * values[k];
          area += weight[i];
          touches |= state_.contact[i] != 0;
          if (state_.beta[i] < state_.beta[weakest])
            weakest = i;
        }
        for (double &value : mean)
          value /= area;
        const Values values = values_at(weakest);
        std::copy(values.begin() + kind, values.end(), mean.begin() + kind);
        mean[contact] = touches;
        return mean;
      }

      void add_tensor_face(const Face &face, const ReferenceCell &shape,
                           const std::vector<Point<dim>> &corners)
      {
        const double *positions =
            &discretization_.points().position[face.first * dim];
        const unsigned int n =
            dim == 2 ? face.count
                     : unsigned(std::lround(std::sqrt(double(face.count))));
        std::array<std::vector<double>, dim - 1> cut;
        for (unsigned int d = 0; d < dim - 1; ++d)
          cut[d] = cuts(corners, positions, n, d);
        for (unsigned int q = 0; q < face.count; ++q) {
          std::vector<Point<dim>> piece;
          for (const unsigned int v : cyclic(corners.size())) {
            Point<dim - 1> xi;
            for (unsigned int d = 0; d < dim - 1; ++d)
              xi[d] = cut[d][(d == 0 ? q % n : q / n) + (v >> d & 1u)];
            auto &x = piece.emplace_back();
            for (unsigned int w = 0; w < corners.size(); ++w)
              x += shape.d_linear_shape_function(xi, w) * corners[w];
          }
          add_piece(dim == 2 ? VtuCell::line : VtuCell::quadrilateral, piece,
                    values_at(face.first + q));
        }
      }

      void add_piece(const VtuCell shape,
                     const std::vector<Point<dim>> &corners,
                     const Values &values)
      {
        std::vector<std::int64_t> numbers;
        for (const auto &corner : corners) {
          numbers.push_back(std::int64_t(grid.points.size()));
          grid.points.push_back(in_space<dim>(corner));
        }
        grid.add_cell(shape, numbers);
        const double *value = values.data();
        for (auto &array : grid.cell_data) {
          array.values.insert(array.values.end(), value,
                              value + array.components);
          value += array.components;
        }
      }

      const Discretization<dim> &discretization_;
      const State &state_;
      double time_step_;
      const ReferenceCell cell_;
    };
  } // namespace

  template <int dim>
  FaceNumbers face_numbers(const Discretization<dim> &discretization)
  {
    FaceNumbers result;
    const ReferenceCell cell = discretization.cells().element->reference_cell();
    for (const auto &face : discretization.points().faces) {
      auto &numbers = result.emplace_back();
      for (unsigned int side = 0; side < 2; ++side) {
        numbers[side] = 0;
        if (face.bodies[side] < 0)
          continue;
        const auto corners = discretization.cells().corners[face.bodies[side]];
        double nearest = std::numeric_limits<double>::max();
        for (const unsigned int f : cell.face_indices()) {
          const auto centre = mean(face_corners(cell, corners, f));
          double distance = 0.;
          for (unsigned int c = 0; c < dim; ++c)
            distance += std::pow(centre[c] - face.centre[c], 2);
          if (distance < nearest) {
            nearest = distance;
            numbers[side] = f;
          }
        }
      }
    }
    return result;
  }

  template <int dim>
  VtuGrid volume_grid(const Discretization<dim> &discretization,
                      const State &state, const Fragments<dim> &fragments)
  {
    const auto displacement = discretization.to_nodal(state.displacement);
    const auto velocity = discretization.to_nodal(state.velocity);
    const Lattice<dim> lattice(*discretization.cells().element);
    const Sampler<dim> sampler(*discretization.cells().element, lattice.points);

    VtuGrid grid;
    grid.time = state.time;
    grid.point_data = {{"displacement", 3, {}, "m"},
                       {"velocity", 3, {}, "m/s"},
                       // xx yy zz xy yz xz, as ParaView
                       {"stress", 6, {}, "Pa"},
                       {"von_mises", 1, {}, "Pa"}};
    grid.cell_data = {{"fragment", 1, {}, "", VtuNumber::integer},
                      {"material", 1, {}, "", VtuNumber::integer}};
    grid.names = {
        {"material_names", names_of(discretization.input().materials)}};
    const auto append = [](VtuGrid::Array &array, const auto &values) {
      array.values.insert(array.values.end(), values.begin(), values.end());
    };
    CellStresses<dim> stresses(discretization, state);
    if (stresses.any_memory())
      grid.point_data.push_back({"equivalent_plastic_strain", 1, {}});
    const bool warm = !state.heat.temperature.empty();
    if (warm)
      grid.point_data.push_back({"temperature", 1, {}, "K"});
    const std::size_t n = discretization.bodies().size(),
                      n_cells = n * lattice.cells.size();
    grid.reserve(n * lattice.points.size(), n_cells,
                 n_cells * lattice.cells[0].size());
    const std::vector<unsigned int> fragment = fragments.number_bodies();
    for (unsigned int b = 0; b < discretization.bodies().size(); ++b) {
      const auto corners = discretization.cells().corners[b];
      const std::size_t node = discretization.cells().first_node[b] * dim;
      const auto first = std::int64_t(grid.points.size());
      for (unsigned int q = 0; q < lattice.points.size(); ++q) {
        const double *u = displacement.data() + node;
        const double *v = velocity.data() + node;
        grid.points.push_back(in_space<dim>(sampler.position(q, corners)));
        append(grid.point_data[0], in_space<dim>(sampler.value(q, u)));
        append(grid.point_data[1], in_space<dim>(sampler.value(q, v)));
        const auto [stress, flow] =
            stresses.at(b, sampler, q, displacement, velocity);
        append(grid.point_data[2],
               std::array<double, 6>{{stress[0], stress[1], stress[2],
                                      stress[3], stress[5], stress[4]}});
        grid.point_data[3].values.push_back(von_mises(stress));
        if (stresses.any_memory())
          grid.point_data[4].values.push_back(flow);
        if (warm)
          grid.point_data.back().values.push_back(sampler.linear_value(
              q, &state.heat.temperature[b * corners.size()]));
      }
      for (auto cell : lattice.cells) {
        for (auto &corner : cell)
          corner += first;
        grid.add_cell(lattice.shape, cell);
        grid.cell_data[0].values.push_back(fragment[b]);
        grid.cell_data[1].values.push_back(
            discretization.cells().body_class(b).material);
      }
    }
    return grid;
  }

  template <int dim>
  VtuGrid interface_grid(const Discretization<dim> &discretization,
                         const FaceNumbers &face_numbers, const State &state,
                         const double time_step)
  {
    InterfacePieces<dim> pieces(discretization, state, time_step);
    const auto &points = discretization.points();
    for (std::size_t f = 0; f < points.faces.size(); ++f) {
      const auto &face = points.faces[f];
      if (face.first < points.n_owned &&
          discretization.origins()[face.first].kind !=
              PointOrigin::Kind::motion)
        // the points lie as seen from this side
        pieces.add(face, face.bodies[0] >= 0 ? 0 : 1, face_numbers[f]);
    }
    return std::move(pieces.grid);
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template FaceNumbers face_numbers(const Discretization<dim> &);              \
  template VtuGrid volume_grid(const Discretization<dim> &, const State &,     \
                               const Fragments<dim> &);                        \
  template VtuGrid interface_grid(const Discretization<dim> &,                 \
                                  const FaceNumbers &, const State &, double)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
#undef NSFD_INSTANTIATE
} // namespace nsfd
