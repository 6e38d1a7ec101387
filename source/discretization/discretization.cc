#include "discretization.h"

#include "axis.h"
#include "cells.h"
#include "face_points.h"
#include "loads.h"
#include "materials/anisotropy.h"
#include "materials/elasticity.h"

#include "materials/cauchy_stress.h"

#include "mesh/mesh_builder.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    bool is_driven(const BoundaryInput &boundary)
    {
      for (unsigned int c = 0; c < dim; ++c)
        if (boundary.velocity[c] || boundary.displacement[c])
          return true;
      return false;
    }

    /** Nodal forces of a body as generalised ones: R^T for a rigid body. */
    void add_to_unknowns(const BodyClass &body, const Block &modes,
                         const double *in, double *out)
    {
      if (!body.rigid)
        for (unsigned int i = 0; i < body.n_dofs; ++i)
          out[i] += in[i];
      else
        for (unsigned int j = 0; j < modes.cols; ++j)
          for (unsigned int i = 0; i < modes.rows; ++i)
            out[j] += modes(i, j) * in[i];
    }
    /**
     * A graded constant of @p material lies in @p range, without its ends, over
     * all its cells. @throws std::runtime_error on all ranks if not.
     */
    void check_range(const MaterialInput &material, const char *name,
                     const Expression &field, double lowest, double highest,
                     const std::array<double, 2> &range,
                     const Communicator &communicator)
    {
      lowest = communicator.min(lowest);
      highest = communicator.max(highest);
      const bool no_cells = lowest > highest;
      if (no_cells || (lowest > range[0] && highest < range[1]))
        return;
      std::string what;
      if (std::isinf(lowest))
        what = "it is not a number in a cell of the block";
      else if (lowest <= range[0])
        what = fmt::format("it falls to {:.4g} in its cells", lowest);
      else
        what = fmt::format("it rises to {:.4g} in its cells", highest);
      throw std::runtime_error(fmt::format(
          "Material: {}/{} = {} must be {}, but {}", material.name, name,
          field.text(),
          std::isinf(range[1])
              ? "positive"
              : fmt::format("above {:g} and below {:g}", range[0], range[1]),
          what));
    }

    /** Collective. @throws std::runtime_error on all ranks. */
    void check_orientation(const MaterialInput &material, const unsigned int m,
                           const std::map<unsigned int, unsigned int> &without,
                           const Communicator &communicator)
    {
      if (!material.anisotropic)
        return;
      constexpr double none = std::numeric_limits<double>::infinity();
      const auto found = without.find(m);
      const double id = communicator.min(
          found == without.end() ? none : double(found->second));
      if (id == none)
        return;
      const OrientationInput &orientation = material.anisotropic->orientation;
      const unsigned int grain = grain_number(orientation, unsigned(id));
      if (orientation.kind == OrientationInput::Kind::table)
        throw std::runtime_error(fmt::format(
            "Material: {}/orientation file: grain {} has cells but no line in "
            "`{}`, which has {} grains; add one, or give the grain a block of "
            "its own",
            material.name, grain, orientation.source,
            orientation.of_grain.size()));
      throw std::runtime_error(fmt::format(
          "Material: {}/{} is not a number in cells of grain {}", material.name,
          orientation.kind == OrientationInput::Kind::cell_data
              ? fmt::format("orientation data = {}", orientation.source)
              : "Euler angles",
          grain));
    }

    template <int dim>
    void check_graded(const SceneInput &input, const Cells<dim> &cells,
                      const Communicator &communicator)
    {
      const std::array<double, 2> positive = {
          {0., std::numeric_limits<double>::infinity()}};
      for (const auto &[m, range] : cells.graded) {
        const MaterialInput &material = input.materials[m];
        check_orientation(material, m, cells.without_orientation, communicator);
        if (!material.graded)
          continue;
        check_range(material, "density", material.graded->density,
                    range[0].density, range[1].density, positive, communicator);
        if (material.rigid || !material.is_isotropic())
          continue;
        check_range(material, "Young modulus", material.graded->young,
                    range[0].young, range[1].young, positive, communicator);
        check_range(material, "Poisson ratio", material.graded->poisson,
                    range[0].poisson, range[1].poisson, {-1., 0.5},
                    communicator);
      }
    }

    template <int dim>
    void check_absorbing(const std::vector<AbsorbingFace> &faces,
                         const Cells<dim> &cells, const SceneInput &input,
                         const Communicator &communicator)
    {
      double rigid = -1.;
      for (const auto &face : faces)
        if (cells.body_class(face.body).undeformed)
          rigid = cells.body_class(face.body).material;
      rigid = communicator.max(rigid);
      if (rigid >= 0.)
        throw std::runtime_error(fmt::format(
            "an absorbing side has cells of the rigid material {}, in which "
            "there are no waves",
            input.materials[std::size_t(rigid)].name));
    }

    /**
     * No cell of an axisymmetric scene lies behind the axis. Collective.
     * @throws std::runtime_error on all ranks.
     */
    template <int dim>
    void check_radii(const Triangulation<dim> &triangulation,
                     const Communicator &communicator)
    {
      Point<dim> worst;
      bool behind = false;
      for (const auto &cell : triangulation.active_cell_iterators())
        for (const unsigned int v : cell->vertex_indices())
          if (cell->is_locally_owned() &&
              cell->vertex(v)[0] < -axis_tolerance * cell->diameter() &&
              (!behind || cell->vertex(v)[0] < worst[0])) {
            behind = true;
            worst = cell->vertex(v);
          }
      if (!communicator.any(behind))
        return;
      const double lowest = communicator.min(worst[0]);
      const double height = communicator.min(
          worst[0] == lowest ? worst[1]
                             : std::numeric_limits<double>::infinity());
      throw std::runtime_error(fmt::format(
          "plane = axisymmetric: x is the distance from the axis x = 0, and a "
          "cell of the mesh reaches to ({:.6g}, {:.6g}); move the mesh to x >= "
          "0",
          lowest, height));
    }

    /** Of an axisymmetric scene with that of the strain along the hoops. */
    template <int dim>
    std::array<double, 6>
    stress_of(const Discretization<dim> &mesh, const LinearElasticity<dim> &law,
              const Point<dim> &x, const double *value, const double *gradient)
    {
      auto stress = law.stress(gradient);
      if (mesh.input().axisymmetric)
        law.add_hoop(hoop_strain(x, value, gradient, mesh.cell_size()), stress);
      return stress;
    }

    /** Of all ranks. */
    void share(const Communicator &communicator, MaterialExtremes &all)
    {
      const bool none = all.fastest == 0.;
      constexpr double infinity = std::numeric_limits<double>::infinity();
      const auto share_moduli = [&](MaterialExtremes::Moduli &mine,
                                    const double sign) {
        const double young =
            sign * communicator.max(none ? -infinity : sign * mine.young);
        mine.poisson =
            communicator.max(none || mine.young != young ? -1. : mine.poisson);
        mine.young = young;
      };
      share_moduli(all.stiffest, 1.);
      share_moduli(all.softest, -1.);
      all.slowest = communicator.min(none ? infinity : all.slowest);
      all.fastest = communicator.max(all.fastest);
      all.densest = communicator.max(all.densest);
    }

    /** Of a body that varies within; only its formulas depend on the place. */
    template <int dim>
    LocalModuli moduli_at(const BodyShape<dim> &shape,
                          const MaterialInput &material, const Point<dim> &x)
    {
      LocalModuli local = local_moduli<dim>(material, x, 0);
      if (material.anisotropic &&
          !material.anisotropic->orientation.depends_on_place())
        local.orientation = shape.moduli[0].orientation;
      return local;
    }

    /** Rigid ones, and graded ones of no cell, have none. */
    template <int dim>
    std::vector<MaterialExtremes>
    material_extremes(const SceneInput &input, const Cells<dim> &cells,
                      const Communicator &communicator)
    {
      std::vector<MaterialExtremes> result(input.materials.size());
      for (unsigned int m = 0; m < result.size(); ++m) {
        const MaterialInput &material = input.materials[m];
        if (!material.rigid && !material.varies())
          result[m] =
              LinearElasticity<dim>(material, input.plane_stress).extremes();
        if (material.rigid || !material.varies())
          continue;
        for (std::size_t k = 0; k < cells.shapes.size(); ++k)
          if (cells.bodies.classes[k].material == m)
            widen(cells.shapes[k].extremes, result[m]);
        share(communicator, result[m]);
      }
      return result;
    }
  } // namespace

  template <int dim>
  Discretization<dim>::~Discretization() = default;

  template <int dim>
  Discretization<dim>::Discretization(Discretization &&) noexcept = default;

  template <int dim>
  Discretization<dim> &
  Discretization<dim>::operator=(Discretization &&) noexcept = default;

  template <int dim>
  Discretization<dim>::Discretization(
      const Communicator &communicator, const Triangulation<dim> &triangulation,
      const MeshGroups<dim> &groups, const std::vector<unsigned int> &materials,
      const SceneInput &input, const CellSet set)
      : input_(&input), extent_((groups.upper() - groups.lower()).norm())
  {
    if (input.axisymmetric)
      check_radii(triangulation, communicator);
    auto loads =
        std::make_unique<Loads<dim>>(triangulation, groups, input, set);
    for (unsigned int b = 0; b < input.boundaries.size(); ++b)
      if (is_driven<dim>(input.boundaries[b]))
        driven_.push_back(b);
    auto cells = std::make_unique<Cells<dim>>(triangulation, materials, input,
                                              set, loads->absorbing_faces());
    check_absorbing(loads->absorbing_faces(), *cells, input, communicator);
    auto faces = make_face_points(communicator, triangulation, groups,
                                  materials, driven_, input, set);
    points_ = std::move(faces.points);
    origins_ = std::move(faces.origins);
    springs_inside_ = std::move(faces.springs_inside);
    obstacle_faces_ = std::move(faces.obstacle_faces);
    inner_faces_ = std::move(faces.inner_faces);
    fill_slots(points_, *cells);
    cells->n_global = triangulation.n_global_active_cells();
    cells_ = std::move(cells);
    loads->set_initial_stress(
        InitialStress<dim>::make(input, *cells_, points_, origins_));
    loads_ = std::move(loads);
    check_graded(input, *cells_, communicator);
    extremes_ = material_extremes(input, *cells_, communicator);

    double size = std::numeric_limits<double>::max(), crossing = size;
    const auto take = [&](const BodyShape<dim> &shape, const bool rigid) {
      size = std::min(size, shape.height);
      if (!rigid)
        crossing = std::min(crossing, shape.height / shape.extremes.fastest);
    };
    for (std::size_t k = 0; k < cells_->shapes.size(); ++k) {
      const BodyClass &body = bodies().classes[k];
      const bool rigid = input.materials[body.material].rigid;
      if (!cells_->differ())
        take(cells_->shapes[k], rigid);
      else
        for (const unsigned int b : body.bodies)
          take(*cells_->shape(b), rigid);
    }
    cell_size_ = communicator.min(size);
    crossing_time_ = communicator.min(crossing);
    if (crossing_time_ == std::numeric_limits<double>::max())
      crossing_time_ = 0.;
    if (input.has_body_table())
      body_table_ = std::make_unique<BodyTable>(
          make_body_table(input, triangulation, materials));
  }

  template <int dim>
  const Bodies &Discretization<dim>::bodies() const
  {
    return cells_->bodies;
  }

  template <int dim>
  std::array<double, 6>
  Discretization<dim>::stress(const unsigned int body, const Point<dim> &x,
                              const double *value, const double *gradient) const
  {
    const auto &material = input_->materials[cells_->body_class(body).material];
    if (material.rigid)
      return {};
    if (input_->axisymmetric && material.kind == MaterialKind::finite_strain)
      return cauchy_stress<3>(
          material, false,
          with_hoop(gradient, hoop_strain(x, value, gradient, cell_size_))
              .data());
    if (material.kind == MaterialKind::finite_strain)
      return cauchy_stress<dim>(material, input_->plane_stress, gradient);
    const auto &shape = cells_->class_shape(body);
    auto stress =
        shape.elasticity.size() == 1
            ? stress_of(*this, shape.elasticity[0], x, value, gradient)
            : stress_of(*this,
                        LinearElasticity<dim>(
                            material,
                            moduli_at(shape, material,
                                      a_little_inside(x, cells_->centre(body))),
                            input_->plane_stress),
                        x, value, gradient);
    if (material.initial_stress.is_given()) {
      const auto initial = InitialStress<dim>::at(material, x);
      for (unsigned int k = 0; k < stress.size(); ++k)
        stress[k] += initial[k];
    }
    return stress;
  }

  template <int dim>
  std::array<double, 6>
  Discretization<dim>::viscous_stress(const unsigned int body,
                                      const Point<dim> &x, const double *value,
                                      const double *rate) const
  {
    return stress_of(*this,
                     LinearElasticity<dim>::viscous(
                         input_->materials[cells_->body_class(body).material]),
                     x, value, rate);
  }

  template <int dim>
  void Discretization<dim>::add_loads(const double t,
                                      std::vector<double> &forces,
                                      const LoadClock &clock) const
  {
    std::vector<double> nodal(cells_->n_nodal(), 0.);
    loads_->add(*cells_, t, clock, nodal);
    for (std::size_t b = 0; b < bodies().size(); ++b)
      add_to_unknowns(cells_->body_class(b), cells_->class_shape(b).modes,
                      nodal.data() + cells_->first_node[b] * dim,
                      forces.data() + bodies().first_dof[b]);
  }

  template <int dim>
  std::vector<double>
  Discretization<dim>::to_nodal(const std::vector<double> &unknowns) const
  {
    std::vector<double> nodal(cells_->n_nodal(), 0.);
    for (std::size_t b = 0; b < bodies().size(); ++b) {
      const auto &body = cells_->body_class(b);
      const double *z = unknowns.data() + bodies().first_dof[b];
      double *out = nodal.data() + cells_->first_node[b] * dim;
      if (!body.rigid) {
        std::copy_n(z, body.n_dofs, out);
        continue;
      }
      const Block &R = cells_->class_shape(b).modes;
      for (unsigned int i = 0; i < R.rows; ++i)
        for (unsigned int j = 0; j < R.cols; ++j)
          out[i] += R(i, j) * z[j];
    }
    return nodal;
  }

  template <int dim>
  std::vector<double> Discretization<dim>::interpolate(const Field &field) const
  {
    std::vector<double> unknowns(bodies().n_dofs(), 0.);
    for (std::size_t b = 0; b < bodies().size(); ++b) {
      const auto &body = cells_->body_class(b);
      const auto of_body = cells_->shape(b);
      const BodyShape<dim> &shape = *of_body;
      std::vector<double> nodal(shape.n_nodes * dim);
      for (unsigned int i = 0; i < shape.n_nodes; ++i)
        field(cells_->place(b, shape.nodes[i]), unsigned(b),
              nodal.data() + i * dim);
      hold_nodes<dim>(shape.on_axis, nodal.data());
      double *out = unknowns.data() + bodies().first_dof[b];
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
  void Discretization<dim>::visit_quadrature(const std::vector<double> &nodal,
                                             const Visitor &visit) const
  {
    double value[dim], gradient[dim * dim];
    for (std::size_t b = 0; b < bodies().size(); ++b) {
      const auto of_body = cells_->shape(b);
      const BodyShape<dim> &shape = *of_body;
      const double *u = nodal.data() + cells_->first_node[b] * dim;
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
        visit(unsigned(b), cells_->place(b, shape.positions[q]), shape.JxW[q],
              value, gradient);
      }
    }
  }

  template class Discretization<2>;
  template class Discretization<3>;
} // namespace nsfd
