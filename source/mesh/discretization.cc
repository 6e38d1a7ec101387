#include "nsfd/mesh/discretization.h"

#include "nsfd/input/scene_input.h"
#include "nsfd/mesh/mesh_builder.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_dgq.h>
#include <deal.II/fe/fe_simplex_p.h>
#include <deal.II/grid/cell_id.h>
#include <deal.II/grid/reference_cell.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** Positions and weights on a face of the reference cell. */
    template <int dim>
    Quadrature<dim - 1> interface_quadrature(const DiscretizationInput &input,
                                             const bool triangles)
    {
      if constexpr (dim == 3)
        if (triangles) {
          // deal.II 9.4.1 has no rule of degree 2 that looks the same from
          // both sides of a face
          if (input.interface_points == 2)
            return Quadrature<2>({Point<2>(1. / 6., 1. / 6.),
                                  Point<2>(2. / 3., 1. / 6.),
                                  Point<2>(1. / 6., 2. / 3.)},
                                 {1. / 6., 1. / 6., 1. / 6.});
          return QGaussSimplex<2>(input.interface_points);
        }
      (void)triangles;
      if (input.interface_quadrature == "gauss lobatto")
        return Quadrature<dim - 1>(QGaussLobatto<1>(input.interface_points));
      if (input.interface_quadrature == "quarter points")
        return Quadrature<dim - 1>(
            Quadrature<1>({Point<1>(0.25), Point<1>(0.75)}, {0.5, 0.5}));
      return QGauss<dim - 1>(input.interface_points);
    }

    template <int dim>
    Quadrature<dim> cell_quadrature(const ReferenceCell &cell,
                                    const unsigned int n)
    {
      if (cell.is_simplex())
        return QGaussSimplex<dim>(n);
      return QGauss<dim>(n);
    }

    /** x = sum of linear shape functions times corners. */
    template <int dim>
    Point<dim> map_point(const ReferenceCell &cell,
                         const std::vector<Point<dim>> &corners,
                         const Point<dim> &xi)
    {
      Point<dim> x;
      for (unsigned int v = 0; v < corners.size(); ++v)
        x += cell.d_linear_shape_function(xi, v) * corners[v];
      return x;
    }

    /** Of linear shape function @p v; deal.II 9.4.1 has none for tetrahedra. */
    template <int dim>
    Tensor<1, dim> linear_gradient(const ReferenceCell &cell,
                                   const Point<dim> &xi,
                                   const unsigned int v)
    {
      if (!cell.is_simplex())
        return cell.d_linear_shape_function_gradient(xi, v);
      Tensor<1, dim> gradient;
      for (unsigned int c = 0; c < dim; ++c)
        gradient[c] = v == 0 ? -1. : (c + 1 == v ? 1. : 0.);
      return gradient;
    }

    /** dx_i/dxi_j. */
    template <int dim>
    Tensor<2, dim> jacobian(const ReferenceCell &cell,
                            const std::vector<Point<dim>> &corners,
                            const Point<dim> &xi)
    {
      Tensor<2, dim> J;
      for (unsigned int v = 0; v < corners.size(); ++v) {
        const auto gradient = linear_gradient<dim>(cell, xi, v);
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            J[i][j] += corners[v][i] * gradient[j];
      }
      return J;
    }

    /** A face of a cell: its corners give positions, normals and measures. */
    template <int dim>
    struct FaceGeometry {
      ReferenceCell cell;
      ReferenceCell face;
      std::vector<Point<dim>> corners;   // physical
      std::vector<Point<dim>> reference; // in the reference cell
      Point<dim> inside;                 // centre of the cell

      FaceGeometry(const ReferenceCell &cell_,
                   const std::vector<Point<dim>> &cell_corners,
                   const unsigned int face_no)
          : cell(cell_), face(cell_.face_reference_cell(face_no))
      {
        for (unsigned int v = 0; v < face.n_vertices(); ++v) {
          const unsigned int c = cell.face_to_cell_vertices(face_no, v, 1);
          corners.push_back(cell_corners[c]);
          reference.push_back(cell.template vertex<dim>(c));
        }
        for (const auto &corner : cell_corners)
          inside += corner / double(cell_corners.size());
      }

      Point<dim> at(const std::vector<Point<dim>> &of,
                    const Point<dim - 1> &xi) const
      {
        Point<dim> x;
        for (unsigned int v = 0; v < of.size(); ++v)
          x += face.d_linear_shape_function(xi, v) * of[v];
        return x;
      }
      Point<dim> position(const Point<dim - 1> &xi) const
      {
        return at(corners, xi);
      }
      Point<dim> in_reference_cell(const Point<dim - 1> &xi) const
      {
        return at(reference, xi);
      }

      /** Outward normal times the measure ratio. */
      Tensor<1, dim> normal(const Point<dim - 1> &xi) const
      {
        std::array<Tensor<1, dim>, dim - 1> tangent;
        for (unsigned int v = 0; v < corners.size(); ++v) {
          const auto g = linear_gradient<dim - 1>(face, xi, v);
          for (unsigned int j = 0; j < dim - 1; ++j)
            tangent[j] += g[j] * Tensor<1, dim>(corners[v]);
        }
        Tensor<1, dim> n;
        if constexpr (dim == 2) {
          n[0] = tangent[0][1];
          n[1] = -tangent[0][0];
        } else
          n = cross_product_3d(tangent[0], tangent[1]);
        if (n * (position(xi) - inside) < 0.)
          n = -n;
        return n;
      }
    };

    /** Rows n, t1, t2 of a right-handed local frame. */
    template <int dim>
    std::array<Tensor<1, dim>, dim> local_frame(const Tensor<1, dim> &n)
    {
      std::array<Tensor<1, dim>, dim> frame;
      frame[0] = n;
      if constexpr (dim == 2) {
        frame[1][0] = -n[1];
        frame[1][1] = n[0];
      } else {
        unsigned int axis = 0;
        for (unsigned int i = 1; i < 3; ++i)
          if (std::abs(n[i]) < std::abs(n[axis]) - 1e-12)
            axis = i;
        Tensor<1, 3> e;
        e[axis] = 1.;
        frame[1] = cross_product_3d(n, e);
        frame[1] /= frame[1].norm();
        frame[2] = cross_product_3d(n, frame[1]);
      }
      return frame;
    }

    std::uint64_t hash(const std::string &text)
    {
      std::uint64_t value = 1469598103934665603ull;
      for (const unsigned char c : text)
        value = (value ^ c) * 1099511628211ull;
      // spread: neighbouring cells differ in a few characters only
      value ^= value >> 31;
      value *= 0x9e3779b97f4a7c15ull;
      value ^= value >> 29;
      return value;
    }
  } // namespace

  /** What the bodies of one class share besides their blocks. */
  template <int dim>
  struct Discretization<dim>::Shape {
    ReferenceCell reference;
    std::vector<Point<dim>> corners; // relative to corner 0
    std::vector<Point<dim>> nodes;   // relative to corner 0
    // cell quadrature: positions relative to corner 0, JxW, values, gradients
    std::vector<Point<dim>> positions;
    std::vector<double> JxW;
    std::vector<double> values;             // q x node
    std::vector<Tensor<1, dim>> gradients;  // q x node
    std::vector<Point<dim>> slot_positions; // relative to corner 0
    unsigned int n_nodes = 0;
    Block modes;                       // rigid: nodal value = modes * unknowns
    Block projection;                  // rigid: unknowns = projection * nodal
    std::vector<double> corner_values; // corner x node
    double volume = 0.;
    Point<dim> centre;
  };

  template <int dim>
  Discretization<dim>::~Discretization() = default;

  template <int dim>
  Discretization<dim>::Discretization(
      const Communicator &communicator, const Triangulation<dim> &triangulation,
      const MeshGroups<dim> &groups, const std::vector<unsigned int> &materials,
      const SceneInput &input)
      : communicator_(communicator), input_(input)
  {
    simplices_ = !triangulation.all_reference_cells_are_hyper_cube();
    const unsigned int p = input.discretization.degree;
    if (simplices_)
      element_ = std::make_unique<FE_SimplexDGP<dim>>(p);
    else
      element_ = std::make_unique<FE_DGQ<dim>>(p);
    for (unsigned int b = 0; b < input.boundaries.size(); ++b) {
      const auto &boundary = input.boundaries[b];
      for (unsigned int c = 0; c < dim; ++c)
        if (boundary.velocity[c] || boundary.displacement[c]) {
          driven_.push_back(b);
          break;
        }
    }
    extent_ = (groups.upper() - groups.lower()).norm();
    build_bodies(triangulation, materials);
    build_points(triangulation, groups, materials);

    for (const auto &material : input.materials)
      for (unsigned int c = 0; c < dim; ++c)
        if (!material.body_force[c].is_zero()) {
          has_loads_ = true;
          loads_depend_on_time_ |= material.body_force[c].depends_on_time();
        }
    for (unsigned int c = 0; c < dim; ++c)
      has_loads_ |= input.gravity[c] != 0.;
    for (const auto &boundary : input.boundaries) {
      if (boundary.has_traction || boundary.has_pressure)
        has_loads_ = true;
      loads_depend_on_time_ |= boundary.pressure.depends_on_time();
      for (unsigned int c = 0; c < dim; ++c)
        loads_depend_on_time_ |= boundary.traction[c].depends_on_time();
    }
  }

  template <int dim>
  void
  Discretization<dim>::build_bodies(const Triangulation<dim> &triangulation,
                                    const std::vector<unsigned int> &materials)
  {
    const unsigned int p = input_.discretization.degree;
    std::map<std::vector<long long>, unsigned int> class_by_key;
    first_node_.push_back(0);
    bodies_.first_dof.push_back(0);
    bodies_.first_slot.push_back(0);
    double crossing = std::numeric_limits<double>::max(),
           size = std::numeric_limits<double>::max();

    for (const auto &cell : triangulation.active_cell_iterators()) {
      if (!cell->is_locally_owned())
        continue;
      const ReferenceCell reference = cell->reference_cell();
      const unsigned int material = materials[cell->active_cell_index()];
      std::vector<Point<dim>> corners;
      for (const unsigned int v : cell->vertex_indices())
        corners.push_back(cell->vertex(v));

      // shape rounded to 2^-42 of its size
      double extent = 0.;
      for (const auto &corner : corners)
        for (unsigned int c = 0; c < dim; ++c)
          extent = std::max(extent, std::abs(corner[c] - corners[0][c]));
      int exponent;
      std::frexp(extent, &exponent);
      const double unit = std::ldexp(1., exponent - 42);
      std::vector<long long> key = {static_cast<long long>(material),
                                    static_cast<long long>(corners.size()),
                                    exponent};
      std::vector<Point<dim>> relative(corners.size());
      for (unsigned int v = 0; v < corners.size(); ++v)
        for (unsigned int c = 0; c < dim; ++c) {
          const long long n =
              std::llround((corners[v][c] - corners[0][c]) / unit);
          key.push_back(n);
          relative[v][c] = double(n) * unit;
        }

      const auto [entry, is_new] =
          class_by_key.emplace(key, unsigned(bodies_.classes.size()));
      if (is_new) {
        // --- a new class: quadrature, matrices, traces
        auto shape = std::make_unique<Shape>();
        BodyClass body;
        shape->reference = reference;
        shape->corners = relative;
        const auto &fe = *element_;
        const unsigned int n = fe.n_dofs_per_cell();
        shape->n_nodes = n;
        for (const auto &support : fe.get_unit_support_points())
          shape->nodes.push_back(map_point(reference, relative, support));
        for (unsigned int v = 0; v < corners.size(); ++v)
          for (unsigned int i = 0; i < n; ++i)
            shape->corner_values.push_back(
                fe.shape_value(i, reference.template vertex<dim>(v)));

        const auto quadrature = cell_quadrature<dim>(reference, p + 1);
        for (unsigned int q = 0; q < quadrature.size(); ++q) {
          const Point<dim> xi = quadrature.point(q);
          const auto J = jacobian(reference, relative, xi);
          const double det = determinant(J);
          const auto inverse = invert(J);
          shape->positions.push_back(map_point(reference, relative, xi));
          shape->JxW.push_back(det * quadrature.weight(q));
          shape->volume += shape->JxW.back();
          shape->centre += shape->JxW.back() * shape->positions.back();
          for (unsigned int i = 0; i < n; ++i) {
            shape->values.push_back(fe.shape_value(i, xi));
            const auto g = fe.shape_grad(i, xi);
            Tensor<1, dim> physical;
            for (unsigned int a = 0; a < dim; ++a)
              for (unsigned int b = 0; b < dim; ++b)
                physical[a] += inverse[b][a] * g[b];
            shape->gradients.push_back(physical);
          }
        }
        shape->centre /= shape->volume;

        const auto &parameters = input_.materials[material];
        body.material = material;
        body.rigid = parameters.rigid;

        // scalar mass
        Block scalar(n, n);
        for (unsigned int q = 0; q < shape->JxW.size(); ++q)
          for (unsigned int i = 0; i < n; ++i)
            for (unsigned int j = 0; j < n; ++j)
              scalar(i, input_.discretization.lumped_mass ? i : j) +=
                  parameters.density * shape->JxW[q] *
                  shape->values[q * n + i] * shape->values[q * n + j];
        Block mass(n * dim, n * dim);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            for (unsigned int c = 0; c < dim; ++c)
              mass(i * dim + c, j * dim + c) =
                  i == j ? scalar(i, i) : (scalar(i, j) + scalar(j, i)) / 2.;

        // elastic stiffness: lambda (div)(div) + mu (grad + grad^T) : grad
        Block stiffness(n * dim, n * dim);
        if (!body.rigid) {
          const double E = parameters.young, nu = parameters.poisson;
          const double mu = E / (2. * (1. + nu));
          double lambda = E * nu / ((1. + nu) * (1. - 2. * nu));
          if (dim == 2 && input_.plane_stress)
            lambda = E * nu / (1. - nu * nu);
          for (unsigned int q = 0; q < shape->JxW.size(); ++q)
            for (unsigned int i = 0; i < n; ++i)
              for (unsigned int j = 0; j <= i; ++j) {
                const auto &gi = shape->gradients[q * n + i];
                const auto &gj = shape->gradients[q * n + j];
                for (unsigned int c = 0; c < dim; ++c)
                  for (unsigned int d = 0; d < dim; ++d)
                    stiffness(i * dim + c, j * dim + d) +=
                        shape->JxW[q] *
                        (lambda * gi[c] * gj[d] + mu * gi[d] * gj[c] +
                         (c == d ? mu * (gi * gj) : 0.));
              }
          for (unsigned int j = 0; j < n * dim; ++j)
            for (unsigned int i = 0; i < j; ++i)
              if (i / dim != j / dim)
                stiffness(i, j) = stiffness(j, i);
          for (unsigned int i = 0; i < n * dim; ++i)
            for (unsigned int j = 0; j < i; ++j)
              stiffness(j, i) = stiffness(i, j);
        }

        // traces at the slots: interface points of every face, face by face
        unsigned int n_slots = 0;
        std::vector<double> trace_values;
        for (unsigned int f = 0; f < reference.n_faces(); ++f) {
          const FaceGeometry<dim> face(reference, relative, f);
          const auto points = interface_quadrature<dim>(
              input_.discretization, face.face == ReferenceCells::Triangle);
          for (const auto &xi : points.get_points()) {
            shape->slot_positions.push_back(face.position(xi));
            for (unsigned int i = 0; i < n; ++i)
              trace_values.push_back(
                  fe.shape_value(i, face.in_reference_cell(xi)));
            ++n_slots;
          }
        }
        body.n_slots = n_slots;
        Block trace(n_slots * dim, n * dim);
        for (unsigned int s = 0; s < n_slots; ++s)
          for (unsigned int i = 0; i < n; ++i)
            for (unsigned int c = 0; c < dim; ++c)
              trace(s * dim + c, i * dim + c) = trace_values[s * n + i];

        if (body.rigid) {
          // velocity = translation of the centre + rotation, lengths scaled
          const unsigned int n_modes = dim == 2 ? 3 : 6;
          shape->modes = Block(n * dim, n_modes);
          for (unsigned int i = 0; i < n; ++i) {
            const Tensor<1, dim> r = (shape->nodes[i] - shape->centre) / extent;
            for (unsigned int c = 0; c < dim; ++c)
              shape->modes(i * dim + c, c) = 1.;
            if constexpr (dim == 2) {
              shape->modes(i * dim, 2) = -r[1];
              shape->modes(i * dim + 1, 2) = r[0];
            } else
              for (unsigned int a = 0; a < 3; ++a) {
                Tensor<1, 3> e;
                e[a] = 1.;
                const auto w = cross_product_3d(e, r);
                for (unsigned int c = 0; c < 3; ++c)
                  shape->modes(i * dim + c, 3 + a) = w[c];
              }
          }
          const Block MR = product(mass, shape->modes);
          const Block RT = shape->modes.transposed();
          body.mass = product(RT, MR);
          for (unsigned int i = 0; i < n_modes; ++i)
            for (unsigned int j = 0; j < i; ++j)
              body.mass(j, i) = body.mass(i, j) =
                  (body.mass(i, j) + body.mass(j, i)) / 2.;
          body.trace = product(trace, shape->modes);
          body.n_dofs = n_modes;
          // (R^T M R)^{-1} R^T M
          const Block L = cholesky(body.mass);
          Block identity(n_modes, n_modes);
          for (unsigned int i = 0; i < n_modes; ++i)
            identity(i, i) = 1.;
          shape->projection =
              product(gram(forward_solve(L, identity)), product(RT, mass));
        } else {
          body.mass = std::move(mass);
          body.stiffness = std::move(stiffness);
          body.trace = std::move(trace);
          body.n_dofs = n * dim;
        }
        bodies_.classes.push_back(std::move(body));
        shapes_.push_back(std::move(shape));
      }

      const unsigned int k = entry->second;
      BodyClass &body = bodies_.classes[k];
      body.bodies.push_back(unsigned(bodies_.class_of.size()));
      bodies_.class_of.push_back(k);
      bodies_.first_dof.push_back(bodies_.first_dof.back() + body.n_dofs);
      bodies_.first_slot.push_back(bodies_.first_slot.back() + body.n_slots);
      first_node_.push_back(first_node_.back() + shapes_[k]->n_nodes);
      corners_.push_back(corners);
      global_cell_.push_back(cell->global_active_cell_index());

      // way of a wave through the cell
      double largest_face = 0.;
      for (unsigned int f = 0; f < reference.n_faces(); ++f) {
        const FaceGeometry<dim> face(reference, relative, f);
        const bool triangle = face.face == ReferenceCells::Triangle;
        Point<dim - 1> middle;
        for (unsigned int c = 0; c < dim - 1; ++c)
          middle[c] = triangle ? 1. / 3. : 0.5;
        largest_face = std::max(largest_face, face.normal(middle).norm() *
                                                  (triangle ? 0.5 : 1.));
      }
      const double height = shapes_[k]->volume / largest_face *
                            (reference.is_simplex() ? dim : 1);
      size = std::min(size, height);
      if (!body.rigid)
        crossing = std::min(crossing, height / pressure_wave_speed(material));
    }
    cell_size_ = communicator_.min(size);
    crossing_time_ = communicator_.min(crossing);
    if (crossing_time_ == std::numeric_limits<double>::max())
      crossing_time_ = 0.;
    n_global_cells_ = communicator_.sum_integer(bodies_.size());
  }

  template <int dim>
  void
  Discretization<dim>::build_points(const Triangulation<dim> &triangulation,
                                    const MeshGroups<dim> &groups,
                                    const std::vector<unsigned int> &materials)
  {
    using Face = typename InterfacePoints<dim>::Face;
    struct NewFace {
      Face face;
      PointOrigin origin;
      std::vector<Point<dim>> positions;
      std::vector<std::array<Tensor<1, dim>, dim>> frames;
      std::vector<double> weights;
      bool owned = true;
    };
    std::vector<NewFace> faces;
    std::vector<int> body_of(triangulation.n_active_cells(), -1);
    {
      int body = 0;
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
          body_of[cell->active_cell_index()] = body++;
    }

    const auto make_face = [&](const auto &cell, const unsigned int f,
                               const PointOrigin origin) {
      std::vector<Point<dim>> corners;
      for (const unsigned int v : cell->vertex_indices())
        corners.push_back(cell->vertex(v));
      const FaceGeometry<dim> geometry(cell->reference_cell(), corners, f);
      const auto quadrature = interface_quadrature<dim>(
          input_.discretization, geometry.face == ReferenceCells::Triangle);
      NewFace result;
      result.origin = origin;
      result.face.key = hash(
          cell->id().to_string() + "/" + std::to_string(f) + "/" +
          std::to_string(int(origin.kind)) + "/" +
          std::to_string(
              origin.kind == PointOrigin::Kind::interface ? 0 : origin.block));
      for (const auto &corner : geometry.corners)
        for (unsigned int c = 0; c < dim; ++c)
          result.face.centre[c] += corner[c] / double(geometry.corners.size());
      for (unsigned int q = 0; q < quadrature.size(); ++q) {
        const auto xi = quadrature.point(q);
        Tensor<1, dim> n = geometry.normal(xi);
        const double measure = n.norm();
        n /= measure;
        result.positions.push_back(geometry.position(xi));
        result.frames.push_back(local_frame<dim>(n));
        result.weights.push_back(measure * quadrature.weight(q));
      }
      return result;
    };

    std::map<int, std::vector<std::size_t>> shared; // rank -> faces
    for (const auto &cell : triangulation.active_cell_iterators()) {
      if (!cell->is_locally_owned())
        continue;
      const int body = body_of[cell->active_cell_index()];
      const unsigned int material = materials[cell->active_cell_index()];
      for (const unsigned int f : cell->face_indices()) {
        if (cell->face(f)->at_boundary()) {
          for (unsigned int b = 0; b < input_.boundaries.size(); ++b) {
            const auto &boundary = input_.boundaries[b];
            if (!groups.holds_boundary_face(boundary.where, cell, f))
              continue;
            if (boundary.has_traction || boundary.has_pressure)
              face_loads_.push_back({unsigned(body), f, b});
            if (std::find(driven_.begin(), driven_.end(), b) == driven_.end())
              continue;
            auto face = make_face(cell, f, {PointOrigin::Kind::motion, b});
            for (auto &frame : face.frames)
              for (unsigned int i = 0; i < dim; ++i) {
                frame[i] = Tensor<1, dim>();
                frame[i][i] = 1.; // rows of a support are x, y, z
              }
            face.face.boundary = true;
            face.face.bodies = {{-1, body}};
            faces.push_back(std::move(face));
          }
          for (unsigned int b = 0; b < input_.obstacles.size(); ++b) {
            const auto &obstacle = input_.obstacles[b];
            if (!groups.holds_boundary_face(obstacle.where, cell, f))
              continue;
            auto face = make_face(cell, f, {PointOrigin::Kind::obstacle, b});
            Tensor<1, dim> n;
            for (unsigned int c = 0; c < dim; ++c)
              n[c] = obstacle.normal[c];
            for (auto &frame : face.frames)
              frame = local_frame<dim>(n / n.norm());
            face.face.boundary = true;
            face.face.bodies = {{-1, body}};
            faces.push_back(std::move(face));
          }
          continue;
        }
        const auto neighbor = cell->neighbor(f);
        const bool first = cell->id() < neighbor->id();
        const bool local = neighbor->is_locally_owned();
        if (!first && local)
          continue; // made from the other side
        const unsigned int other = materials[neighbor->active_cell_index()];
        const unsigned int m1 = first ? material : other,
                           m2 = first ? other : material;
        Point<dim> centre;
        for (const unsigned int v : cell->face(f)->vertex_indices())
          centre +=
              cell->face(f)->vertex(v) / double(cell->face(f)->n_vertices());
        int block = -1;
        for (unsigned int b = 0; b < input_.interfaces.size() && block < 0; ++b)
          if (groups.holds_interior_face(input_.interfaces[b].where, centre,
                                         input_.materials[m1].name,
                                         input_.materials[m2].name,
                                         {{cell->material_id(),
                                           neighbor->material_id()}}))
            block = int(b);
        if (block < 0)
          throw std::runtime_error(
              "no Interface block holds for the face at (" +
              std::to_string(centre[0]) + ", " + std::to_string(centre[1]) +
              (dim == 3 ? ", " + std::to_string(centre[dim - 1]) : "") +
              "): add a last block with `set where = all`");
        const PointOrigin origin{PointOrigin::Kind::interface, unsigned(block)};
        auto face =
            first ? make_face(cell, f, origin)
                  : make_face(neighbor, cell->neighbor_face_no(f), origin);
        const int neighbor_body =
            local ? body_of[neighbor->active_cell_index()] : -1;
        face.face.bodies = first ? std::array<int, 2>{{body, neighbor_body}}
                                 : std::array<int, 2>{{neighbor_body, body}};
        face.face.cells = {{cell->global_active_cell_index(),
                            neighbor->global_active_cell_index()}};
        if (!first)
          std::swap(face.face.cells[0], face.face.cells[1]);
        face.owned = first;
        if (!local) {
          face.face.neighbor_rank = int(neighbor->subdomain_id());
        }
        faces.push_back(std::move(face));
      }
    }
    std::stable_partition(faces.begin(), faces.end(),
                          [](const NewFace &f) { return f.owned; });

    // flatten
    auto &points = points_;
    std::size_t n = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      NewFace &face = faces[f];
      face.face.first = unsigned(n);
      face.face.count = unsigned(face.positions.size());
      n += face.positions.size();
      if (face.owned)
        points.n_owned = n;
      for (unsigned int q = 0; q < face.positions.size(); ++q) {
        for (unsigned int c = 0; c < dim; ++c)
          points.position.push_back(face.positions[q][c]);
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int c = 0; c < dim; ++c)
            points.frame.push_back(face.frames[q][i][c]);
        points.weight.push_back(face.weights[q]);
        points.face_of.push_back(unsigned(f));
        origins_.push_back(face.origin);
      }
      if (face.face.neighbor_rank >= 0)
        shared[face.face.neighbor_rank].push_back(f);
      points.faces.push_back(face.face);
    }
    points.n_points = n;
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

    // slots: match by position
    bodies_.slot_point.assign(bodies_.first_slot.back(), unsigned(n));
    bodies_.slot_sign.assign(bodies_.first_slot.back(), 1);
    for (const auto &face : points.faces)
      for (unsigned int side = 0; side < 2; ++side) {
        const int b = face.bodies[side];
        if (b < 0)
          continue;
        const Shape &shape = *shapes_[bodies_.class_of[b]];
        const double tolerance = 1e-7 * shape.corners.back().norm();
        for (unsigned int i = face.first; i < face.first + face.count; ++i) {
          std::size_t best = 0;
          double distance = std::numeric_limits<double>::max();
          for (std::size_t s = 0; s < shape.slot_positions.size(); ++s) {
            double d = 0.;
            for (unsigned int c = 0; c < dim; ++c) {
              const double x = corners_[b][0][c] + shape.slot_positions[s][c] -
                               points.position[i * dim + c];
              d += x * x;
            }
            // a slot at a corner belongs to two faces: take a free one
            const bool taken =
                bodies_.slot_point[bodies_.first_slot[b] + s] < n;
            if (d < distance - tolerance * tolerance ||
                (d < distance + tolerance * tolerance && !taken &&
                 bodies_.slot_point[bodies_.first_slot[b] + best] < n)) {
              distance = d;
              best = s;
            }
          }
          AssertThrow(std::sqrt(distance) < 100. * tolerance,
                      ExcMessage("a face point has no place on its cell"));
          const std::size_t slot = bodies_.first_slot[b] + best;
          if (bodies_.slot_point[slot] < n) {
            bodies_.extra_points.emplace_back(slot, i);
            AssertThrow(side == 1 && face.boundary,
                        ExcMessage("two interface points on one slot"));
          } else {
            bodies_.slot_point[slot] = i;
            bodies_.slot_sign[slot] = side == 1 ? 1 : -1;
          }
        }
      }
    std::sort(bodies_.extra_points.begin(), bodies_.extra_points.end());
  }

  template <int dim>
  double
  Discretization<dim>::pressure_wave_speed(const unsigned int material) const
  {
    const auto &m = input_.materials[material];
    const double E = m.young, nu = m.poisson;
    const double modulus = dim == 2 && input_.plane_stress
                               ? E / (1. - nu * nu)
                               : E * (1. - nu) / ((1. + nu) * (1. - 2. * nu));
    return std::sqrt(modulus / m.density);
  }

  template <int dim>
  double
  Discretization<dim>::shear_wave_speed(const unsigned int material) const
  {
    const auto &m = input_.materials[material];
    return std::sqrt(m.young / (2. * (1. + m.poisson)) / m.density);
  }

  template <int dim>
  std::vector<double>
  Discretization<dim>::to_nodal(const std::vector<double> &unknowns) const
  {
    std::vector<double> nodal(n_nodal(), 0.);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const auto &body = bodies_.classes[bodies_.class_of[b]];
      const double *z = unknowns.data() + bodies_.first_dof[b];
      double *out = nodal.data() + first_node_[b] * dim;
      if (!body.rigid) {
        std::copy_n(z, body.n_dofs, out);
        continue;
      }
      const Block &R = shapes_[bodies_.class_of[b]]->modes;
      for (unsigned int i = 0; i < R.rows; ++i)
        for (unsigned int j = 0; j < R.cols; ++j)
          out[i] += R(i, j) * z[j];
    }
    return nodal;
  }

  template <int dim>
  std::vector<double> Discretization<dim>::interpolate(const Field &field) const
  {
    std::vector<double> unknowns(bodies_.n_dofs(), 0.);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const auto &body = bodies_.classes[bodies_.class_of[b]];
      const Shape &shape = *shapes_[bodies_.class_of[b]];
      std::vector<double> nodal(shape.n_nodes * dim);
      for (unsigned int i = 0; i < shape.n_nodes; ++i)
        field(corners_[b][0] + Tensor<1, dim>(shape.nodes[i]), unsigned(b),
              nodal.data() + i * dim);
      double *out = unknowns.data() + bodies_.first_dof[b];
      if (!body.rigid)
        std::copy(nodal.begin(), nodal.end(), out);
      else
        for (unsigned int j = 0; j < body.n_dofs; ++j)
          for (std::size_t i = 0; i < nodal.size(); ++i)
            out[j] += shape.projection(j, unsigned(i)) * nodal[i];
    }
    return unknowns;
  }

  template <int dim>
  void Discretization<dim>::add_loads(const double t,
                                      std::vector<double> &forces) const
  {
    std::vector<double> nodal(n_nodal(), 0.);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Shape &shape = *shapes_[bodies_.class_of[b]];
      const auto &material = input_.materials[material_of(unsigned(b))];
      for (unsigned int q = 0; q < shape.JxW.size(); ++q) {
        const Point<dim> x =
            corners_[b][0] + Tensor<1, dim>(shape.positions[q]);
        for (unsigned int c = 0; c < dim; ++c) {
          double f = material.density * input_.gravity[c];
          if (!material.body_force[c].is_zero())
            f += material.body_force[c].at(x, t);
          if (f != 0.)
            for (unsigned int i = 0; i < shape.n_nodes; ++i)
              nodal[(first_node_[b] + i) * dim + c] +=
                  shape.JxW[q] * f * shape.values[q * shape.n_nodes + i];
        }
      }
    }
    for (const auto &load : face_loads_) {
      const auto &boundary = input_.boundaries[load.boundary];
      const Shape &shape = *shapes_[bodies_.class_of[load.body]];
      const FaceGeometry<dim> face(shape.reference, shape.corners, load.face);
      Quadrature<dim - 1> quadrature;
      if (face.face == ReferenceCells::Triangle)
        quadrature = QGaussSimplex<dim - 1>(3);
      else
        quadrature = QGauss<dim - 1>(input_.discretization.degree + 2);
      for (unsigned int q = 0; q < quadrature.size(); ++q) {
        const auto xi = quadrature.point(q);
        const Tensor<1, dim> n = face.normal(xi); // times the measure
        const double JxW = n.norm() * quadrature.weight(q);
        const Point<dim> x =
            corners_[load.body][0] + Tensor<1, dim>(face.position(xi));
        const double p =
            boundary.has_pressure ? boundary.pressure.at(x, t) : 0.;
        for (unsigned int c = 0; c < dim; ++c) {
          double f = -p * n[c] * quadrature.weight(q);
          if (boundary.has_traction)
            f += JxW * boundary.traction[c].at(x, t);
          for (unsigned int i = 0; i < shape.n_nodes; ++i)
            nodal[(first_node_[load.body] + i) * dim + c] +=
                f * element_->shape_value(i, face.in_reference_cell(xi));
        }
      }
    }
    // to the unknowns: R^T for rigid bodies
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const auto &body = bodies_.classes[bodies_.class_of[b]];
      const double *in = nodal.data() + first_node_[b] * dim;
      double *out = forces.data() + bodies_.first_dof[b];
      if (!body.rigid)
        for (unsigned int i = 0; i < body.n_dofs; ++i)
          out[i] += in[i];
      else {
        const Block &R = shapes_[bodies_.class_of[b]]->modes;
        for (unsigned int j = 0; j < R.cols; ++j)
          for (unsigned int i = 0; i < R.rows; ++i)
            out[j] += R(i, j) * in[i];
      }
    }
  }

  template <int dim>
  void Discretization<dim>::visit_quadrature(const std::vector<double> &nodal,
                                             const Visitor &visit) const
  {
    double value[dim], gradient[dim * dim];
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Shape &shape = *shapes_[bodies_.class_of[b]];
      const double *u = nodal.data() + first_node_[b] * dim;
      for (unsigned int q = 0; q < shape.JxW.size(); ++q) {
        std::fill(value, value + dim, 0.);
        std::fill(gradient, gradient + dim * dim, 0.);
        for (unsigned int i = 0; i < shape.n_nodes; ++i) {
          const double N = shape.values[q * shape.n_nodes + i];
          const auto &g = shape.gradients[q * shape.n_nodes + i];
          for (unsigned int c = 0; c < dim; ++c) {
            value[c] += N * u[i * dim + c];
            for (unsigned int d = 0; d < dim; ++d)
              gradient[c * dim + d] += g[d] * u[i * dim + c];
          }
        }
        visit(unsigned(b), corners_[b][0] + Tensor<1, dim>(shape.positions[q]),
              shape.JxW[q], value, gradient);
      }
    }
  }

  template <int dim>
  std::array<double, 6>
  Discretization<dim>::stress(const unsigned int body,
                              const double *gradient) const
  {
    const auto &m = input_.materials[material_of(body)];
    std::array<double, 6> sigma{};
    if (m.rigid)
      return sigma;
    const double mu = m.young / (2. * (1. + m.poisson));
    double lambda =
        m.young * m.poisson / ((1. + m.poisson) * (1. - 2. * m.poisson));
    if (dim == 2 && input_.plane_stress)
      lambda = m.young * m.poisson / (1. - m.poisson * m.poisson);
    double trace = 0.;
    for (unsigned int c = 0; c < dim; ++c)
      trace += gradient[c * dim + c];
    for (unsigned int c = 0; c < dim; ++c)
      sigma[c] = lambda * trace + 2. * mu * gradient[c * dim + c];
    if (dim == 2 && !input_.plane_stress)
      sigma[2] = lambda * trace;
    sigma[3] = mu * (gradient[1] + gradient[dim]);
    if (dim == 3) {
      sigma[4] = mu * (gradient[2] + gradient[2 * dim]);
      sigma[5] = mu * (gradient[dim + 2] + gradient[2 * dim + 1]);
    }
    return sigma;
  }

  template <int dim>
  std::vector<Point<dim>>
  Discretization<dim>::corners(const unsigned int body) const
  {
    return corners_[body];
  }

  template <int dim>
  std::vector<double>
  Discretization<dim>::at_corners(const unsigned int body,
                                  const std::vector<double> &nodal) const
  {
    const Shape &shape = *shapes_[bodies_.class_of[body]];
    std::vector<double> result(shape.corners.size() * dim, 0.);
    for (std::size_t v = 0; v < shape.corners.size(); ++v)
      for (unsigned int i = 0; i < shape.n_nodes; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          result[v * dim + c] += shape.corner_values[v * shape.n_nodes + i] *
                                 nodal[(first_node_[body] + i) * dim + c];
    return result;
  }

  template <int dim>
  double Discretization<dim>::volume(const unsigned int body) const
  {
    return shapes_[bodies_.class_of[body]]->volume;
  }

  template <int dim>
  Point<dim> Discretization<dim>::centre(const unsigned int body) const
  {
    return corners_[body][0] +
           Tensor<1, dim>(shapes_[bodies_.class_of[body]]->centre);
  }

  template class Discretization<2>;
  template class Discretization<3>;
} // namespace nsfd
