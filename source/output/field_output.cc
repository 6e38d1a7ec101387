#include "nsfd/output/field_output.h"

#include <deal.II/fe/fe.h>
#include <deal.II/grid/reference_cell.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <tuple>
#include <type_traits>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    using Vector3 = std::array<double, 3>;

    template <int dim, typename Vector>
    Vector3 in_space(const Vector &x)
    {
      Vector3 result{};
      for (unsigned int c = 0; c < dim; ++c)
        result[c] = x[c];
      return result;
    }

    /** The entries of all ranks on rank 0, rank by rank. Collective. */
    template <typename T>
    std::vector<T> gather(const Communicator &communicator,
                          const std::vector<T> &own,
                          std::vector<int> &n_per_rank)
    {
      static_assert(std::is_trivially_copyable<T>::value);
      const int n = int(own.size());
      n_per_rank.assign(communicator.size(), 0);
      MPI_Gather(&n, 1, MPI_INT, n_per_rank.data(), 1, MPI_INT, 0,
                 communicator.mpi());
      std::vector<int> first(n_per_rank.size(), 0);
      std::partial_sum(n_per_rank.begin(), n_per_rank.end() - 1,
                       first.begin() + 1);
      std::vector<T> all(
          communicator.is_root() ? first.back() + n_per_rank.back() : 0);
      MPI_Datatype type;
      MPI_Type_contiguous(sizeof(T), MPI_BYTE, &type);
      MPI_Type_commit(&type);
      MPI_Gatherv(own.data(), n, type, all.data(), n_per_rank.data(),
                  first.data(), type, 0, communicator.mpi());
      MPI_Type_free(&type);
      return all;
    }

    template <typename T>
    std::vector<T> gather(const Communicator &communicator,
                          const std::vector<T> &own)
    {
      std::vector<int> n_per_rank;
      return gather(communicator, own, n_per_rank);
    }

    /** Some point of the face holds its two sides together. */
    template <int dim>
    bool carries(const State &state,
                 const typename InterfacePoints<dim>::Face &face)
    {
      for (unsigned int i = face.first; i < face.first + face.count; ++i)
        switch (state.kind[i]) {
        case PointKind::prescribed:
        case PointKind::rigid:
        case PointKind::elastic:
          return true;
        case PointKind::cohesive:
          if (state.beta[i] >= 1e-3)
            return true;
          break;
        case PointKind::free:
          break;
        }
      return false;
    }

    double von_mises(const std::array<double, 6> &s)
    {
      const double xy = s[0] - s[1], yz = s[1] - s[2], zx = s[2] - s[0];
      return std::sqrt((xy * xy + yz * yz + zx * zx) / 2. +
                       3. * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
    }

    /** From the order of deal.II to the cyclic one of VTK. */
    std::vector<unsigned int> cyclic(const unsigned int n_corners)
    {
      switch (n_corners) {
      case 4:
        return {0, 1, 3, 2};
      case 8:
        return {0, 1, 3, 2, 4, 5, 7, 6};
      default:
        std::vector<unsigned int> order(n_corners);
        std::iota(order.begin(), order.end(), 0);
        return order;
      }
    }

    template <int dim>
    Point<dim> centre_of(const std::vector<Point<dim>> &corners)
    {
      Point<dim> centre;
      for (const auto &corner : corners)
        centre += corner / double(corners.size());
      return centre;
    }

    template <int dim>
    std::vector<Point<dim>> face_corners(const ReferenceCell &cell,
                                         const std::vector<Point<dim>> &corners,
                                         const unsigned int face_no)
    {
      std::vector<Point<dim>> result;
      for (unsigned int v = 0;
           v < cell.face_reference_cell(face_no).n_vertices(); ++v)
        result.push_back(corners[cell.face_to_cell_vertices(face_no, v, 1)]);
      return result;
    }

    /** Values and gradients at the same reference points of every body. */
    template <int dim>
    class Sampler
    {
    public:
      Sampler(const FiniteElement<dim, dim> &element,
              const std::vector<Point<dim>> &points)
          : n_nodes_(element.n_dofs_per_cell()),
            n_corners_(element.reference_cell().n_vertices())
      {
        const ReferenceCell cell = element.reference_cell();
        for (const auto &xi : points) {
          for (unsigned int i = 0; i < n_nodes_; ++i) {
            values_.push_back(element.shape_value(i, xi));
            gradients_.push_back(element.shape_grad(i, xi));
          }
          for (unsigned int v = 0; v < n_corners_; ++v) {
            linear_values_.push_back(cell.d_linear_shape_function(xi, v));
            linear_gradients_.push_back(linear_gradient(cell, xi, v));
          }
        }
      }

      Point<dim> position(const unsigned int q,
                          const std::vector<Point<dim>> &corners) const
      {
        Point<dim> x;
        for (unsigned int v = 0; v < n_corners_; ++v)
          x += linear_values_[q * n_corners_ + v] * corners[v];
        return x;
      }

      /** @p u: nodal values of the body. */
      Tensor<1, dim> value(const unsigned int q, const double *u) const
      {
        Tensor<1, dim> result;
        for (unsigned int i = 0; i < n_nodes_; ++i)
          for (unsigned int c = 0; c < dim; ++c)
            result[c] += values_[q * n_nodes_ + i] * u[i * dim + c];
        return result;
      }

      /** [component][direction] */
      std::array<double, dim * dim>
      gradient(const unsigned int q, const std::vector<Point<dim>> &corners,
               const double *u) const
      {
        Tensor<2, dim> jacobian, reference;
        for (unsigned int v = 0; v < n_corners_; ++v)
          jacobian += outer_product(Tensor<1, dim>(corners[v] - corners[0]),
                                    linear_gradients_[q * n_corners_ + v]);
        for (unsigned int i = 0; i < n_nodes_; ++i)
          for (unsigned int c = 0; c < dim; ++c)
            reference[c] += u[i * dim + c] * gradients_[q * n_nodes_ + i];
        const Tensor<2, dim> physical = reference * invert(jacobian);
        std::array<double, dim * dim> result;
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            result[c * dim + d] = physical[c][d];
        return result;
      }

    private:
      /** ReferenceCell of deal.II 9.4 has none for tetrahedra. */
      static Tensor<1, dim> linear_gradient(const ReferenceCell &cell,
                                            const Point<dim> &xi,
                                            const unsigned int v)
      {
        if (!cell.is_simplex())
          return cell.d_linear_shape_function_gradient(xi, v);
        Tensor<1, dim> gradient;
        for (unsigned int c = 0; c < dim; ++c)
          gradient[c] = v == 0 ? -1. : v == c + 1 ? 1. : 0.;
        return gradient;
      }

      unsigned int n_nodes_, n_corners_;
      std::vector<double> values_, linear_values_;
      std::vector<Tensor<1, dim>> gradients_, linear_gradients_;
    };

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
  } // namespace

  // ---------------------------------------------------------------- Fragments

  template <int dim>
  Fragments<dim>::Fragments(const Discretization<dim> &discretization,
                            const Communicator &communicator)
      : discretization_(discretization), communicator_(communicator)
  {
    struct Cell {
      unsigned long long number;
      Vector3 centre;
    };
    const std::size_t n_bodies = discretization.bodies().size();
    std::vector<Cell> own_cells;
    for (unsigned int b = 0; b < n_bodies; ++b)
      own_cells.push_back({discretization.global_cell(b),
                           in_space<dim>(discretization.centre(b))});
    const auto &points = discretization.points();
    std::vector<std::array<unsigned long long, 2>> own_pairs;
    for (unsigned int f = 0; f < points.faces.size(); ++f)
      if (!points.faces[f].boundary && points.faces[f].first < points.n_owned) {
        faces_.push_back(f);
        own_pairs.push_back(points.faces[f].cells);
      }
    const auto cells = gather(communicator, own_cells, n_cells_);
    const auto pairs = gather(communicator, own_pairs);
    of_body_.assign(n_bodies, 0);

    // only rank 0 has anything from here on
    order_.resize(cells.size());
    std::iota(order_.begin(), order_.end(), 0);
    auto by_number = order_;
    std::sort(order_.begin(), order_.end(), [&](const auto a, const auto b) {
      return std::tie(cells[a].centre, cells[a].number) <
             std::tie(cells[b].centre, cells[b].number);
    });
    std::sort(by_number.begin(), by_number.end(),
              [&](const auto a, const auto b) {
                return cells[a].number < cells[b].number;
              });
    const auto index = [&](const unsigned long long number) {
      const auto found = std::lower_bound(
          by_number.begin(), by_number.end(), number,
          [&](const auto a, const auto n) { return cells[a].number < n; });
      AssertThrow(found != by_number.end() && cells[*found].number == number,
                  ExcMessage("a face of a cell that no rank has"));
      return *found;
    };
    for (const auto &pair : pairs)
      pairs_.push_back({{index(pair[0]), index(pair[1])}});
  }

  template <int dim>
  void Fragments<dim>::update(const State &state)
  {
    if (state.broken_area == broken_area_)
      return;
    broken_area_ = state.broken_area;

    const auto &faces = discretization_.points().faces;
    std::vector<unsigned char> own;
    for (const unsigned int f : faces_)
      own.push_back(carries<dim>(state, faces[f]));
    const auto carrying = gather(communicator_, own);

    // union-find on rank 0
    std::vector<unsigned int> parent(order_.size()), fragment(order_.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto find = [&](unsigned int cell) {
      while (parent[cell] != cell)
        cell = parent[cell] = parent[parent[cell]];
      return cell;
    };
    for (std::size_t f = 0; f < carrying.size(); ++f)
      if (carrying[f]) {
        const unsigned int a = find(pairs_[f][0]), b = find(pairs_[f][1]);
        parent[std::max(a, b)] = std::min(a, b);
      }
    constexpr unsigned int none = std::numeric_limits<unsigned int>::max();
    std::vector<unsigned int> number(order_.size(), none);
    count_ = 0;
    for (const unsigned int cell : order_) {
      unsigned int &n = number[find(cell)];
      if (n == none)
        n = count_++;
      fragment[cell] = n;
    }

    std::vector<int> first(n_cells_.size(), 0);
    std::partial_sum(n_cells_.begin(), n_cells_.end() - 1, first.begin() + 1);
    MPI_Scatterv(fragment.data(), n_cells_.data(), first.data(), MPI_UNSIGNED,
                 of_body_.data(), int(of_body_.size()), MPI_UNSIGNED, 0,
                 communicator_.mpi());
    MPI_Bcast(&count_, 1, MPI_UNSIGNED, 0, communicator_.mpi());
  }

  // -------------------------------------------------------------- FieldOutput

  template <int dim>
  FieldOutput<dim>::FieldOutput(const std::string &directory,
                                const Discretization<dim> &discretization,
                                const Communicator &communicator)
      : directory_(directory), discretization_(discretization),
        communicator_(communicator),
        fields_((std::filesystem::path(directory) / "fields.pvd").string()),
        interfaces_(
            (std::filesystem::path(directory) / "interfaces.pvd").string())
  {
    const ReferenceCell cell = discretization.element().reference_cell();
    for (const auto &face : discretization.points().faces) {
      auto &numbers = face_no_.emplace_back();
      for (unsigned int side = 0; side < 2; ++side) {
        numbers[side] = 0;
        if (face.bodies[side] < 0)
          continue;
        const auto corners = discretization.corners(face.bodies[side]);
        double nearest = std::numeric_limits<double>::max();
        for (const unsigned int f : cell.face_indices()) {
          const auto centre = centre_of(face_corners(cell, corners, f));
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
  }

  template <int dim>
  VtuGrid FieldOutput<dim>::volume(const State &state,
                                   const Fragments<dim> &fragments) const
  {
    const auto displacement = discretization_.to_nodal(state.displacement);
    const auto velocity = discretization_.to_nodal(state.velocity);
    const Lattice<dim> lattice(discretization_.element());
    const Sampler<dim> sampler(discretization_.element(), lattice.points);

    VtuGrid grid;
    grid.time = state.time;
    grid.point_data = {{"displacement", 3, {}},
                       {"velocity", 3, {}},
                       {"stress", 6, {}}, // xx yy zz xy yz xz, as ParaView
                       {"von_mises", 1, {}}};
    grid.cell_data = {{"fragment", 1, {}}, {"material", 1, {}}};
    const auto append = [](VtuGrid::Array &array, const auto &values) {
      array.values.insert(array.values.end(), values.begin(), values.end());
    };
    for (unsigned int b = 0; b < discretization_.bodies().size(); ++b) {
      const auto corners = discretization_.corners(b);
      const std::size_t node = discretization_.first_node(b) * dim;
      const auto first = std::int64_t(grid.points.size());
      for (unsigned int q = 0; q < lattice.points.size(); ++q) {
        const double *u = displacement.data() + node;
        const double *v = velocity.data() + node;
        grid.points.push_back(in_space<dim>(sampler.position(q, corners)));
        append(grid.point_data[0], in_space<dim>(sampler.value(q, u)));
        append(grid.point_data[1], in_space<dim>(sampler.value(q, v)));
        const auto stress =
            discretization_.stress(b, sampler.gradient(q, corners, u).data());
        append(grid.point_data[2],
               std::array<double, 6>{{stress[0], stress[1], stress[2],
                                      stress[3], stress[5], stress[4]}});
        grid.point_data[3].values.push_back(von_mises(stress));
      }
      for (auto cell : lattice.cells) {
        for (auto &corner : cell)
          corner += first;
        grid.add_cell(lattice.shape, cell);
        grid.cell_data[0].values.push_back(fragments.of_body()[b]);
        grid.cell_data[1].values.push_back(discretization_.material_of(b));
      }
    }
    return grid;
  }

  template <int dim>
  VtuGrid FieldOutput<dim>::faces(const State &state,
                                  const double time_step) const
  {
    const auto &points = discretization_.points();
    const ReferenceCell cell = discretization_.element().reference_cell();

    VtuGrid grid;
    grid.time = state.time;
    grid.cell_data = {
        {"beta", 1, {}},     {"jump_n", 1, {}}, {"jump", 3, {}},
        {"traction", 3, {}}, {"slip", 1, {}},   {"contact", 1, {}},
        {"kind", 1, {}},     {"block", 1, {}},  {"obstacle", 1, {}}};
    constexpr unsigned int contact = 9, kind = 10, n_values = 13;
    using Values = std::array<double, n_values>; // in the order above

    const auto values_at = [&](const std::size_t i) {
      const double *frame = &points.frame[i * dim * dim];
      const double *u = &state.jump[i * dim], *P = &state.impulse[i * dim];
      Vector3 jump{}, traction{};
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int c = 0; c < dim; ++c) {
          jump[c] += u[r] * frame[r * dim + c];
          if (time_step > 0.)
            traction[c] +=
                P[r] * frame[r * dim + c] / (points.weight[i] * time_step);
        }
      const PointOrigin origin = discretization_.origins()[i];
      return Values{{state.beta[i], u[0], jump[0], jump[1], jump[2],
                     traction[0], traction[1], traction[2], state.slip[i],
                     state.contact[i] ? 1. : 0., double(state.kind[i]),
                     double(origin.block),
                     origin.kind == PointOrigin::Kind::obstacle ? 1. : 0.}};
    };
    const auto add_piece = [&](const VtuCell shape,
                               const std::vector<Point<dim>> &corners,
                               const Values &values) {
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
    };

    for (std::size_t f = 0; f < points.faces.size(); ++f) {
      const auto &face = points.faces[f];
      if (face.first >= points.n_owned ||
          discretization_.origins()[face.first].kind ==
              PointOrigin::Kind::motion)
        continue;
      // the points lie as seen from this side
      const unsigned int side = face.bodies[0] >= 0 ? 0 : 1;
      const unsigned int face_no = face_no_[f][side];
      const auto corners = face_corners(
          cell, discretization_.corners(face.bodies[side]), face_no);

      if (corners.size() == 3) {
        // a triangle as a whole: mean values, the kind of its weakest point
        Values mean{};
        double area = 0.;
        unsigned int weakest = face.first;
        bool touches = false;
        for (unsigned int i = face.first; i < face.first + face.count; ++i) {
          const Values values = values_at(i);
          for (unsigned int k = 0; k < n_values; ++k)
            mean[k] += points.weight[i] * values[k];
          area += points.weight[i];
          touches |= state.contact[i] != 0;
          if (state.beta[i] < state.beta[weakest])
            weakest = i;
        }
        for (double &value : mean)
          value /= area;
        const Values values = values_at(weakest);
        std::copy(values.begin() + kind, values.end(), mean.begin() + kind);
        mean[contact] = touches;
        add_piece(VtuCell::triangle, corners, mean);
        continue;
      }

      const unsigned int n =
          dim == 2 ? face.count
                   : unsigned(std::lround(std::sqrt(double(face.count))));
      const ReferenceCell shape = cell.face_reference_cell(face_no);
      std::array<std::vector<double>, dim - 1> cut;
      for (unsigned int d = 0; d < dim - 1; ++d)
        cut[d] = cuts(corners, &points.position[face.first * dim], n, d);
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
    return grid;
  }

  template <int dim>
  Snapshot FieldOutput<dim>::snapshot(const State &state,
                                      const Fragments<dim> &fragments) const
  {
    const auto &points = discretization_.points();
    const std::size_t n_bodies = discretization_.bodies().size();
    const ReferenceCell cell = discretization_.element().reference_cell();
    const auto displacement = discretization_.to_nodal(state.displacement);
    const auto velocity = discretization_.to_nodal(state.velocity);

    // --- polygons of this rank
    std::vector<double> stress(n_bodies, 0.), volume(n_bodies, 0.);
    discretization_.visit_quadrature(
        displacement,
        [&](const unsigned int body, const Point<dim> &, const double JxW,
            const double *, const double *gradient) {
          stress[body] +=
              JxW * von_mises(discretization_.stress(body, gradient));
          volume[body] += JxW;
        });
    std::vector<Point<dim>> reference_corners;
    for (unsigned int v = 0; v < cell.n_vertices(); ++v)
      reference_corners.push_back(cell.template vertex<dim>(v));
    const Sampler<dim> middle(discretization_.element(),
                              {centre_of(reference_corners)});

    struct Part {
      unsigned long long cell = 0;
      unsigned int face = 0, n_corners = 0, fragment = 0, material = 0;
      double value = 0., speed = 0.;
      Vector3 centre{};
      std::array<Vector3, 4> reference{}, displacement{};
    };
    std::vector<Part> parts;
    const auto add_part = [&](const unsigned int b, const unsigned int face,
                              const std::vector<unsigned int> &vertices) {
      const auto corners = discretization_.corners(b);
      const auto u = discretization_.at_corners(b, displacement);
      Part part;
      part.cell = discretization_.global_cell(b);
      part.face = face;
      part.n_corners = unsigned(vertices.size());
      part.fragment = fragments.of_body()[b];
      part.material = discretization_.material_of(b);
      part.value = stress[b] / volume[b];
      part.speed =
          middle.value(0, velocity.data() + discretization_.first_node(b) * dim)
              .norm();
      part.centre = in_space<dim>(discretization_.centre(b));
      const auto order = cyclic(part.n_corners);
      for (unsigned int v = 0; v < part.n_corners; ++v) {
        const unsigned int corner = vertices[order[v]];
        part.reference[v] = in_space<dim>(corners[corner]);
        part.displacement[v] = in_space<dim>(&u[corner * dim]);
      }
      parts.push_back(part);
    };
    if constexpr (dim == 2) {
      std::vector<unsigned int> all(cell.n_vertices());
      std::iota(all.begin(), all.end(), 0);
      for (unsigned int b = 0; b < n_bodies; ++b)
        add_part(b, 0, all);
    } else {
      // faces are visible unless they carry to a neighbour
      std::vector<char> hidden(n_bodies * cell.n_faces(), 0);
      for (std::size_t f = 0; f < points.faces.size(); ++f) {
        const auto &face = points.faces[f];
        if (!face.boundary && carries<dim>(state, face))
          for (unsigned int side = 0; side < 2; ++side)
            if (face.bodies[side] >= 0)
              hidden[face.bodies[side] * cell.n_faces() + face_no_[f][side]] =
                  1;
      }
      for (unsigned int b = 0; b < n_bodies; ++b)
        for (const unsigned int f : cell.face_indices()) {
          if (hidden[b * cell.n_faces() + f])
            continue;
          std::vector<unsigned int> vertices;
          for (unsigned int v = 0; v < cell.face_reference_cell(f).n_vertices();
               ++v)
            vertices.push_back(cell.face_to_cell_vertices(f, v, 1));
          add_part(b, f, vertices);
        }
    }

    // --- faces of this rank
    struct Joint {
      std::array<unsigned long long, 2> cells{};
      std::array<Vector3, 2> ends{};
      double beta = 0.;
      bool contact = false, can_break = false;
    };
    std::vector<Joint> joints;
    if constexpr (dim == 2)
      for (std::size_t f = 0; f < points.faces.size(); ++f) {
        const auto &face = points.faces[f];
        if (face.boundary || face.first >= points.n_owned)
          continue;
        const auto corners = face_corners(
            cell, discretization_.corners(face.bodies[0]), face_no_[f][0]);
        Joint joint;
        joint.cells = face.cells;
        joint.ends = {{in_space<dim>(corners[0]), in_space<dim>(corners[1])}};
        for (unsigned int i = face.first; i < face.first + face.count; ++i) {
          joint.beta += state.beta[i] / face.count;
          joint.contact |= state.contact[i] != 0;
          joint.can_break |= state.kind[i] == PointKind::cohesive ||
                             state.kind[i] == PointKind::rigid;
        }
        joints.push_back(joint);
      }

    // --- all of them on rank 0, in an order that does not know the ranks
    auto all_parts = gather(communicator_, parts);
    const auto all_joints = gather(communicator_, joints);
    Snapshot snapshot;
    snapshot.time = state.time;
    snapshot.dimension = dim;
    std::sort(all_parts.begin(), all_parts.end(),
              [](const Part &a, const Part &b) {
                return std::tie(a.centre, a.cell, a.face) <
                       std::tie(b.centre, b.cell, b.face);
              });
    std::map<unsigned long long, std::size_t> polygon_of; // by cell
    for (const auto &part : all_parts) {
      polygon_of[part.cell] = snapshot.polygons.size();
      auto &polygon = snapshot.polygons.emplace_back();
      polygon.reference.assign(part.reference.begin(),
                               part.reference.begin() + part.n_corners);
      polygon.displacement.assign(part.displacement.begin(),
                                  part.displacement.begin() + part.n_corners);
      polygon.value = part.value;
      polygon.speed = part.speed;
      polygon.fragment = part.fragment;
      polygon.material = part.material;
    }

    std::vector<std::tuple<std::size_t, std::size_t, std::size_t>> order;
    for (std::size_t j = 0; j < all_joints.size(); ++j)
      order.emplace_back(polygon_of.at(all_joints[j].cells[0]),
                         polygon_of.at(all_joints[j].cells[1]), j);
    std::sort(order.begin(), order.end());
    const auto displacement_at = [&](const std::size_t p, const Vector3 &x) {
      const auto &polygon = snapshot.polygons[p];
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
    };
    for (const auto &[first, second, j] : order) {
      const Joint &joint = all_joints[j];
      std::array<Vector3, 2> mean;
      for (unsigned int e = 0; e < 2; ++e) {
        const Vector3 a = displacement_at(first, joint.ends[e]);
        const Vector3 b = displacement_at(second, joint.ends[e]);
        for (unsigned int c = 0; c < 3; ++c)
          mean[e][c] = (a[c] + b[c]) / 2.;
      }
      snapshot.faces.push_back({joint.ends[0], joint.ends[1], mean[0], mean[1],
                                joint.beta, joint.contact, joint.can_break});
    }
    return snapshot;
  }

  template <int dim>
  void FieldOutput<dim>::write_series(PvdSeries &series,
                                      const std::string &base,
                                      const VtuGrid &grid)
  {
    const std::filesystem::path directory(directory_);
    const auto name = [&](const int rank) {
      return vtu_name(base, number_, unsigned(rank),
                      unsigned(communicator_.size()));
    };
    // what fails on one rank fails on all of them
    const auto together = [&](const auto &action) {
      std::string error;
      try {
        action();
      } catch (const std::exception &exception) {
        error = exception.what();
      }
      if (communicator_.any(!error.empty()))
        throw std::runtime_error(
            error.empty() ? "Another rank could not write its fields." : error);
    };
    together([&]() {
      write_vtu((directory / name(communicator_.rank())).string(), grid);
    });
    together([&]() {
      if (!communicator_.is_root())
        return;
      std::string entry = name(0);
      if (communicator_.size() > 1) {
        std::vector<std::string> pieces;
        for (int rank = 0; rank < communicator_.size(); ++rank)
          pieces.push_back(name(rank));
        entry = std::filesystem::path(vtu_name(base, number_, 0, 1))
                    .replace_extension(".pvtu")
                    .string();
        write_pvtu((directory / entry).string(), grid, pieces);
      }
      series.add(grid.time, entry);
    });
  }

  template <int dim>
  void FieldOutput<dim>::write(const State &state, const double time_step,
                               const Fragments<dim> &fragments)
  {
    write_series(fields_, "fields", volume(state, fragments));
    write_series(interfaces_, "interfaces", faces(state, time_step));
    ++number_;
  }

  template class Fragments<2>;
  template class Fragments<3>;
  template class FieldOutput<2>;
  template class FieldOutput<3>;
} // namespace nsfd
