#include "block_forces.h"

#include "block_products.h"
#include "constant_strain.h"
#include "finite_forces.h"
#include "tensor_forces.h"

#include "discretization/axis.h"
#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /** To the mean divergence of motions of the nodes, that of the strain along
        the hoops. */
    template <int dim>
    void add_hoop(const BodyShape<dim> &shape, std::vector<double> &mean)
    {
      for (unsigned int q = 0; q < shape.JxW.size(); ++q)
        for (unsigned int i = 0; i < shape.n_nodes; ++i)
          mean[i * dim] += shape.JxW[q] / shape.volume *
                           shape.values[q * shape.n_nodes + i] /
                           radius_at(shape, shape.positions[q]);
      hold_nodes<dim>(shape.on_axis, mean.data());
    }
  } // namespace

  template <int dim>
  BlockForces<dim>::BlockForces(const Discretization<dim> &discretization,
                                const JoinedMesh<dim> &mesh,
                                FrontViscosity front)
      : CellForces<dim>(std::move(front)), discretization_(discretization),
        mesh_(mesh), forces_(mesh.n_corners() * dim),
        tractions_(discretization, &BodyClass::traction)
  {
    for (const BodyShape<dim> &shape : discretization.cells().shapes) {
      auto &mean = divergence_.emplace_back(shape.n_nodes * dim, 0.);
      for (unsigned int q = 0; q < shape.JxW.size(); ++q)
        for (unsigned int j = 0; j < mean.size(); ++j)
          mean[j] += shape.JxW[q] / shape.volume *
                     shape.gradients[q * shape.n_nodes + j / dim][j % dim];
      if (is_axisymmetric(shape))
        add_hoop(shape, mean);
    }
  }

  template <int dim>
  void BlockForces<dim>::set_forces(CornerGroups<dim> &groups)
  {
    const Bodies &bodies = discretization_.bodies();
    for_block_products(
        bodies, groups, groups.displacement, &BodyClass::stiffness,
        &BodyClass::traction,
        [&](const unsigned int b, const unsigned int l,
            const std::vector<double> &x, const std::vector<double> &y,
            const std::vector<double> &t) {
          const BodyClass &body = bodies.classes[bodies.class_of[b]];
          double *forces = &forces_[bodies.first_dof[b]];
          for (unsigned int j = 0; j < body.n_dofs; ++j)
            forces[j] = y[j * lanes + l];
          if (this->front_.acts()) {
            const auto &mean = divergence_[bodies.class_of[b]];
            const double volume = discretization_.cells().volume(b);
            double now = 0.;
            for (unsigned int j = 0; j < body.n_dofs; ++j)
              now += mean[j] * x[j * lanes + l];
            this->front_.update(b, now, volume);
            for (unsigned int j = 0; j < body.n_dofs; ++j)
              forces[j] += volume * this->front_.tension[b] * mean[j];
          }
          for (unsigned int j = 0; j < body.traction.rows; ++j)
            tractions_.of_body(b)[j] = t[j * lanes + l];
        });
    std::fill(groups.force.begin(), groups.force.end(), 0.);
    for (std::size_t i = 0; i < mesh_.n_corners(); ++i)
      for (unsigned int c = 0; c < dim; ++c)
        groups.force[groups.of(i) * dim + c] -= forces_[i * dim + c];
  }

  template <int dim>
  std::array<double, dim>
  BlockForces<dim>::corner_force(const std::size_t corner,
                                 const CornerGroups<dim> &) const
  {
    std::array<double, dim> force;
    for (unsigned int c = 0; c < dim; ++c)
      force[c] = -forces_[corner * dim + c];
    return force;
  }

  template <int dim>
  std::array<double, dim>
  BlockForces<dim>::traction(const StrengthSites<dim> &sites,
                             const std::size_t site) const
  {
    const auto &weight = discretization_.points().weight;
    std::array<double, dim> result{};
    const unsigned int first = sites[site].first_point,
                       last = first + sites[site].n_points;
    double length = 0.;
    for (unsigned int i = first; i < last; ++i)
      length += weight[i];
    for (unsigned int i = first; i < last; ++i) {
      const auto mean = tractions_.mean(i);
      for (unsigned int c = 0; c < dim; ++c)
        result[c] += weight[i] / length * mean[c];
    }
    return result;
  }

  template <int dim>
  void BlockForces<dim>::squared_tractions(
      const StrengthSites<dim> &sites,
      typename StrengthSites<dim>::Near &near) const
  {
    near.site.clear();
    near.square.clear();
    for (unsigned int k = 0; k < sites.size(); ++k)
      if (!sites.is_released(k)) {
        near.site.push_back(k);
        near.square.push_back(sites.square(k, traction(sites, k)));
      }
  }

  namespace
  {
    template <int dim>
    std::unique_ptr<CellForces<dim>>
    elastic_forces(const Discretization<dim> &discretization,
                   const JoinedMesh<dim> &mesh, FrontViscosity front,
                   const GhostCells *ghosts)
    {
      const auto everywhere = [&](const bool here) {
        return ghosts ? !ghosts->anywhere(!here) : here;
      };
      // only blocks have the strain along hoops
      if (discretization.input().axisymmetric)
        return std::make_unique<BlockForces<dim>>(discretization, mesh,
                                                  std::move(front));
      if (everywhere(ConstantStrainForces<dim>::fits(discretization)))
        return std::make_unique<ConstantStrainForces<dim>>(discretization,
                                                           std::move(front));
      if (everywhere(TensorForces<dim>::fits(discretization)))
        return std::make_unique<TensorForces<dim>>(discretization, mesh,
                                                   std::move(front));
      return std::make_unique<BlockForces<dim>>(discretization, mesh,
                                                std::move(front));
    }
  } // namespace

  template <int dim>
  std::unique_ptr<CellForces<dim>>
  make_cell_forces(const Discretization<dim> &discretization,
                   const JoinedMesh<dim> &mesh, FrontViscosity front,
                   const GhostCells *ghosts, const GhostCells *divided)
  {
    const SceneInput &input = discretization.input();
    std::unique_ptr<CellForces<dim>> forces;
    constexpr int of_rings = dim == 2 ? 3 : dim;
    if (input.iterates() && input.axisymmetric)
      forces = std::make_unique<FiniteForces<dim, of_rings>>(
          discretization, mesh, std::move(front), ghosts, divided);
    else if (input.iterates())
      forces = std::make_unique<FiniteForces<dim>>(
          discretization, mesh, std::move(front), ghosts, divided);
    else
      forces = elastic_forces(discretization, mesh, std::move(front), ghosts);
    if (discretization.input().has_viscous_bodies())
      forces->set_viscous(
          std::make_unique<ViscousForces<dim>>(discretization, mesh));
    return forces;
  }

  template class BlockForces<2>;
  template class BlockForces<3>;
  template std::unique_ptr<CellForces<2>>
  make_cell_forces(const Discretization<2> &, const JoinedMesh<2> &,
                   FrontViscosity, const GhostCells *, const GhostCells *);
  template std::unique_ptr<CellForces<3>>
  make_cell_forces(const Discretization<3> &, const JoinedMesh<3> &,
                   FrontViscosity, const GhostCells *, const GhostCells *);
} // namespace nsfd
