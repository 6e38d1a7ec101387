#include "body_shape.h"

#include "absorbing_sides.h"

#include "axis.h"
#include "interface_quadrature.h"

#include "cell_geometry.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/lapack_full_matrix.h>
#include <deal.II/lac/vector.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    Quadrature<dim> cell_quadrature(const ReferenceCell &cell,
                                    const SceneInput &input)
    {
      const unsigned int n = input.discretization.degree + 1;
      if (input.axisymmetric)
        return ring_quadrature<dim>(cell, n);
      if (cell.is_simplex())
        return QGaussSimplex<dim>(n);
      return QGauss<dim>(n);
    }

    /** Volume over the largest face, the lowest height of a simplex: in the
        half-plane, as set_axis() comes later. */
    template <int dim>
    double height(const BodyShape<dim> &shape)
    {
      double largest_face = 0.;
      for (unsigned int f = 0; f < shape.reference.n_faces(); ++f)
        largest_face = std::max(
            largest_face,
            FaceGeometry<dim>(shape.reference, shape.corners, f).measure());
      return shape.volume / largest_face *
             (shape.reference.is_simplex() ? dim : 1);
    }

    /** Velocity = translation of the centre + rotation, lengths scaled; of
        axisymmetric bodies the translation along the axis. */
    template <int dim>
    Block rigid_modes(const BodyShape<dim> &shape, const double size)
    {
      if (is_axisymmetric(shape))
        return motion_along_axis(shape);
      Block modes(shape.n_nodes * dim, dim == 2 ? 3 : 6);
      for (unsigned int i = 0; i < shape.n_nodes; ++i) {
        const Tensor<1, dim> r = (shape.nodes[i] - shape.centre) / size;
        for (unsigned int c = 0; c < dim; ++c)
          modes(i * dim + c, c) = 1.;
        if constexpr (dim == 2) {
          modes(i * dim, 2) = -r[1];
          modes(i * dim + 1, 2) = r[0];
        } else
          for (unsigned int a = 0; a < 3; ++a) {
            Tensor<1, 3> e;
            e[a] = 1.;
            const auto w = cross_product_3d(e, r);
            for (unsigned int c = 0; c < 3; ++c)
              modes(i * dim + c, 3 + a) = w[c];
          }
      }
      return modes;
    }

    /** The same motions R with R^T M R = 1. */
    Block of_unit_mass(const Block &R, const Block &mass)
    {
      const Block RT = R.transposed();
      return forward_solve(cholesky(product(RT, product(mass, R))), RT)
          .transposed();
    }

    /** To the unknowns of a rigid body, from the blocks of its nodes. */
    template <int dim>
    void make_rigid(const double size, BodyShape<dim> &shape, BodyClass &body)
    {
      shape.modes = rigid_modes(shape, size);
      const unsigned int n = shape.modes.cols;
      shape.nodal_mass = body.mass;
      const Block &nodal_mass = shape.nodal_mass;
      const Block RT = shape.modes.transposed();
      body.mass = product(RT, product(nodal_mass, shape.modes));
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < i; ++j)
          body.mass(j, i) = body.mass(i, j) =
              (body.mass(i, j) + body.mass(j, i)) / 2.;
      body.trace = product(body.trace, shape.modes);
      body.n_dofs = n;
      // (R^T M R)^{-1} R^T M
      Block identity(n, n);
      for (unsigned int i = 0; i < n; ++i)
        identity(i, i) = 1.;
      shape.projection =
          product(gram(forward_solve(cholesky(body.mass), identity)),
                  product(RT, nodal_mass));
    }

    /**
     * The largest eigenvalue of B u = Lambda K u for B = G^T G, both blind to
     * rigid motions @p modes: K is made definite on them.
     */
    double largest_ratio(const Block &G, const Block &K, const Block &modes)
    {
      const unsigned int n = K.rows;
      double trace = 0., size = 0.;
      for (unsigned int i = 0; i < n; ++i) {
        trace += K(i, i) / n;
        for (unsigned int k = 0; k < modes.cols; ++k)
          size += modes(i, k) * modes(i, k) / modes.cols;
      }
      Block definite = K;
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          for (unsigned int k = 0; k < modes.cols; ++k)
            definite(i, j) += trace / size * modes(i, k) * modes(j, k);
      // B and K in the coordinates of L^T u: eigenvalues of the Gram matrix
      const Block scaled =
          gram(forward_solve(cholesky(definite), G.transposed()).transposed());
      LAPACKFullMatrix<double> matrix(n);
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          matrix(i, j) = scaled(i, j);
      double bound = 0.;
      for (unsigned int i = 0; i < n; ++i)
        bound += scaled(i, i);
      Vector<double> eigenvalues;
      FullMatrix<double> eigenvectors;
      matrix.compute_eigenvalues_symmetric(0., 1.1 * bound, 0., eigenvalues,
                                           eigenvectors);
      return *std::max_element(eigenvalues.begin(), eigenvalues.end());
    }

    /** The largest ratio of sum over slots w |traction|^2 to u.K u, in Pa/m. */
    template <int dim>
    double traction_bound(const BodyShape<dim> &shape, const BodyClass &body)
    {
      Block weighted = body.traction;
      for (unsigned int k = 0; k < weighted.rows; ++k) {
        const double weight = slot_area(shape, k / dim);
        for (unsigned int j = 0; j < weighted.cols; ++j)
          weighted(k, j) *= std::sqrt(weight);
      }
      return largest_ratio(weighted, body.stiffness, body.rigid_motions);
    }
  } // namespace

  template <int dim>
  ClassBuilder<dim>::ClassBuilder(const FiniteElement<dim> &element,
                                  const SceneInput &input)
      : element_(element), input_(input),
        cell_rule_(cell_quadrature<dim>(element.reference_cell(), input)),
        face_rule_(interface_quadrature<dim>(
            input.discretization, element.reference_cell().is_simplex())),
        no_blocks_(input.time.scheme.at_nodes &&
                   element.reference_cell().is_simplex() &&
                   input.discretization.degree == 1 && !input.axisymmetric &&
                   std::none_of(input.materials.begin(), input.materials.end(),
                                [](const MaterialInput &material) {
                                  return material.rigid ||
                                         material.varies_in_cells() ||
                                         material.is_viscous();
                                }))
  {
    const auto cell = element.reference_cell();
    if (!cell.is_simplex())
      return;
    for (unsigned int f = 0; f <= dim; ++f) {
      opposite_[f] = dim * (dim + 1) / 2; // the sum of all corners
      for (unsigned int v = 0; v < dim; ++v)
        opposite_[f] -= cell.face_to_cell_vertices(f, v, 1);
    }
  }

  template <int dim>
  void ClassBuilder<dim>::build(const ReferenceCell &reference,
                                const std::vector<Point<dim>> &corners,
                                const double size, const double corner_radius,
                                const unsigned int material,
                                const unsigned int divided,
                                const std::vector<LocalModuli> &moduli,
                                BodyShape<dim> &shape, BodyClass &body) const
  {
    const MaterialInput &input = input_.materials[material];
    shape.reference = reference;
    shape.divided = divided;
    shape.corners = corners;
    shape.moduli = moduli;
    set_tables(shape);
    shape.corner_radius = corner_radius;
    if (input_.axisymmetric)
      set_axis(shape);
    set_elasticity(shape, material);
    body.material = material;
    body.undeformed = input.rigid;
    body.rigid =
        input.rigid && !input_.large_motion && !input_.time.scheme.at_nodes;
    set_slots(shape);
    if (has_no_blocks()) {
      body.n_slots = unsigned(shape.slot_positions.size());
      body.n_dofs = shape.n_nodes * dim;
      return;
    }
    // joined cells of a rigid body have its inertia, not that of their nodes
    const bool joined = input_.time.scheme.at_nodes;
    body.mass = mass(shape, input_.discretization.lumped_mass &&
                                !(joined && input.rigid));
    body.trace = trace(shape);
    body.n_slots = unsigned(shape.slot_positions.size());
    body.n_dofs = shape.n_nodes * dim;
    if (body.rigid)
      make_rigid(size, shape, body);
    else if (input.rigid) { // nodes that a rigid body moves
      body.stiffness = Block(body.n_dofs, body.n_dofs);
      body.rigid_motions = of_unit_mass(rigid_modes(shape, size), body.mass);
      if (input_.has_bonded_faces())
        body.traction = Block(body.n_slots * dim, body.n_dofs);
    } else {
      body.stiffness = stiffness(shape, shape.elasticity);
      body.rigid_motions = of_unit_mass(rigid_modes(shape, size), body.mass);
      if (input_.has_bonded_faces()) {
        body.traction = traction(shape, body, shape.elasticity);
        body.traction_bound = traction_bound(shape, body);
      }
    }
    if (input.is_viscous()) {
      const std::vector<LinearElasticity<dim>> viscosity = {
          LinearElasticity<dim>::viscous(input)};
      body.damping = stiffness(shape, viscosity);
      if (input_.has_bonded_faces())
        body.viscous_traction = traction(shape, body, viscosity);
    }
  }

  template <int dim>
  void ClassBuilder<dim>::add_absorbing(const unsigned int faces,
                                        const BodyShape<dim> &shape,
                                        BodyClass &body) const
  {
    if (faces == 0 || body.undeformed)
      return; // those are refused
    body.absorbing = Block(body.n_dofs, body.n_dofs);
    const auto add = [](const Block &block, Block &to) {
      for (std::size_t k = 0; k < block.values.size(); ++k)
        to.values[k] += block.values[k];
    };
    for (unsigned int f = 0; f < shape.reference.n_faces(); ++f)
      if (faces >> f & 1u)
        add(absorbing_block(element_, shape, f), body.absorbing);
    hold_unknowns(shape, body.absorbing);
    if (body.damping.rows == 0)
      body.damping = Block(body.n_dofs, body.n_dofs);
    add(body.absorbing, body.damping);
  }

  template <int dim>
  std::vector<Point<dim>>
  ClassBuilder<dim>::moduli_places(const ReferenceCell &reference,
                                   const std::vector<Point<dim>> &corners,
                                   const unsigned int divided) const
  {
    BodyShape<dim> shape;
    shape.reference = reference;
    shape.divided = divided;
    shape.corners = corners;
    set_tables(shape);
    auto places = shape.positions;
    if (input_.has_bonded_faces()) {
      set_slots(shape);
      for (const auto &slot : shape.slot_positions)
        places.push_back(a_little_inside(slot, shape.centre));
    }
    return places;
  }

  template <int dim>
  void ClassBuilder<dim>::set_elasticity(BodyShape<dim> &shape,
                                         const unsigned int material) const
  {
    const MaterialInput &input = input_.materials[material];
    for (const LocalModuli &local : shape.moduli)
      if (input.rigid)
        shape.extremes.densest =
            std::max(shape.extremes.densest, local.density);
      else {
        shape.elasticity.emplace_back(input, local, input_.plane_stress);
        widen(shape.elasticity.back().extremes(), shape.extremes);
      }
  }

  template <int dim>
  void ClassBuilder<dim>::set_tables(BodyShape<dim> &shape) const
  {
    const unsigned int n = element_.n_dofs_per_cell();
    shape.n_nodes = n;
    for (unsigned int v = 0; v < shape.corners.size(); ++v)
      for (unsigned int i = 0; i < n; ++i)
        shape.corner_values.push_back(
            element_.shape_value(i, shape.reference.template vertex<dim>(v)));
    for (unsigned int q = 0; q < cell_rule_.size(); ++q)
      for (unsigned int i = 0; i < n; ++i)
        shape.values.push_back(element_.shape_value(i, cell_rule_.point(q)));
    set_cell(shape);
  }

  template <int dim>
  void ClassBuilder<dim>::set_cell(BodyShape<dim> &shape) const
  {
    const auto &reference = shape.reference;
    const unsigned int n = shape.n_nodes;
    for (const auto &support : element_.get_unit_support_points())
      shape.nodes.push_back(map_point(reference, shape.corners, support));
    for (unsigned int q = 0; q < cell_rule_.size(); ++q) {
      const Point<dim> xi = cell_rule_.point(q);
      const auto J = jacobian(reference, shape.corners, xi);
      const auto inverse = invert(J);
      shape.positions.push_back(map_point(reference, shape.corners, xi));
      shape.JxW.push_back(determinant(J) * cell_rule_.weight(q));
      shape.volume += shape.JxW.back();
      shape.centre += shape.JxW.back() * shape.positions.back();
      for (unsigned int i = 0; i < n; ++i) {
        const auto g = element_.shape_grad(i, xi);
        Tensor<1, dim> physical;
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            physical[a] += inverse[b][a] * g[b];
        shape.gradients.push_back(physical);
      }
    }
    shape.centre /= shape.volume;
    shape.height = height(shape);
  }

  template <int dim>
  void ClassBuilder<dim>::set_slots(BodyShape<dim> &shape) const
  {
    const bool has_places = !shape.slot_places.empty();
    for (unsigned int f = 0; f < shape.reference.n_faces(); ++f) {
      const FaceGeometry<dim> face(shape.reference, shape.corners, f);
      const bool halves = (shape.divided >> f & 1u) != 0;
      const unsigned int n_parts = halves ? 1u << (dim - 1) : 1;
      for (unsigned int part = 0; part < n_parts; ++part)
        for (unsigned int q = 0; q < face_rule_.size(); ++q) {
          Point<dim - 1> xi = face_rule_.point(q);
          if (halves)
            for (unsigned int d = 0; d < dim - 1; ++d)
              xi[d] = (xi[d] + double(part >> d & 1u)) / 2.;
          shape.slot_positions.push_back(face.position(xi));
          shape.slot_normals.push_back(face.normal(xi) * face_rule_.weight(q) /
                                       double(n_parts));
          if (has_places)
            continue;
          shape.slot_places.push_back(face.in_reference_cell(xi));
          shape.slot_faces.push_back(f);
        }
    }
    if (is_axisymmetric(shape))
      set_slot_radii(shape);
  }

  template <int dim>
  Block ClassBuilder<dim>::mass(const BodyShape<dim> &shape,
                                const bool lumped) const
  {
    const unsigned int n = shape.n_nodes;
    Block scalar(n, n);
    for (unsigned int q = 0; q < shape.JxW.size(); ++q)
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          scalar(i, lumped ? i : j) += at_place(shape.moduli, q).density *
                                       shape.JxW[q] * shape.values[q * n + i] *
                                       shape.values[q * n + j];
    Block mass(n * dim, n * dim);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        for (unsigned int c = 0; c < dim; ++c)
          mass(i * dim + c, j * dim + c) =
              i == j ? scalar(i, i) : (scalar(i, j) + scalar(j, i)) / 2.;
    hold_unknowns(shape, mass);
    return mass;
  }

  /** grad : D : grad */
  template <int dim>
  Block ClassBuilder<dim>::stiffness(
      const BodyShape<dim> &shape,
      const std::vector<LinearElasticity<dim>> &local) const
  {
    const unsigned int n = shape.n_nodes;
    Block stiffness(n * dim, n * dim);
    for (unsigned int q = 0; q < shape.JxW.size(); ++q)
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j <= i; ++j) {
          const auto &gi = shape.gradients[q * n + i];
          const auto &gj = shape.gradients[q * n + j];
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int d = 0; d < dim; ++d)
              stiffness(i * dim + c, j * dim + d) +=
                  shape.JxW[q] * at_place(local, q).coupling(c, d, gi, gj);
        }
    if (is_axisymmetric(shape))
      add_hoop(shape, local, stiffness);
    // symmetric to the last bit: the upper half is a copy of the lower one
    for (unsigned int i = 0; i < n * dim; ++i)
      for (unsigned int j = 0; j < i; ++j)
        stiffness(j, i) = stiffness(i, j);
    hold_unknowns(shape, stiffness);
    return stiffness;
  }

  template <int dim>
  Block ClassBuilder<dim>::trace(const BodyShape<dim> &shape) const
  {
    const unsigned int n = shape.n_nodes;
    const unsigned int n_slots = unsigned(shape.slot_places.size());
    Block trace(n_slots * dim, n * dim);
    for (unsigned int s = 0; s < n_slots; ++s)
      for (unsigned int i = 0; i < n; ++i) {
        const double value = element_.shape_value(i, shape.slot_places[s]);
        for (unsigned int c = 0; c < dim; ++c)
          trace(s * dim + c, i * dim + c) = value;
      }
    hold_columns(shape, trace);
    return trace;
  }

  template <int dim>
  Block ClassBuilder<dim>::traction(
      const BodyShape<dim> &shape, const BodyClass &body,
      const std::vector<LinearElasticity<dim>> &local) const
  {
    const unsigned int n = shape.n_nodes;
    Block traction(body.n_slots * dim, n * dim);
    for (unsigned int s = 0; s < body.n_slots; ++s) {
      const auto &place = shape.slot_places[s];
      const auto &law = at_place(local, shape.JxW.size() + s);
      const auto inverse =
          invert(jacobian(shape.reference, shape.corners, place));
      const Tensor<1, dim> normal =
          shape.slot_normals[s] / shape.slot_normals[s].norm();
      for (unsigned int i = 0; i < n; ++i) {
        const auto reference_gradient = element_.shape_grad(i, place);
        Tensor<1, dim> g;
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            g[a] += inverse[b][a] * reference_gradient[b];
        // sigma n of a displacement N_i e_d
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            traction(s * dim + c, i * dim + d) = law.coupling(c, d, normal, g);
        if (!is_axisymmetric(shape))
          continue;
        const double hoop = hoop_of_node(shape, shape.slot_positions[s],
                                         element_.shape_value(i, place), g);
        for (unsigned int c = 0; c < dim; ++c)
          traction(s * dim + c, i * dim) += law.lambda * hoop * normal[c];
      }
    }
    hold_columns(shape, traction);
    return traction;
  }

  template class ClassBuilder<2>;
  template class ClassBuilder<3>;
} // namespace nsfd
