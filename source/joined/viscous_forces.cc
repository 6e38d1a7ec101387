#include "viscous_forces.h"

#include "block_products.h"
#include "hanging_nodes.h"

#include "discretization/cells.h"
#include "discretization/point_places.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  ViscousForces<dim>::ViscousForces(const Discretization<dim> &discretization,
                                    const JoinedMesh<dim> &mesh)
      : discretization_(discretization), mesh_(mesh),
        of_corners_(mesh.n_corners() * dim, 0.)
  {
    const Bodies &bodies = discretization.bodies();
    const std::size_t n = discretization.points().n_points;
    first_traction_.push_back(0);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      first_traction_.push_back(
          first_traction_.back() +
          bodies.classes[bodies.class_of[b]].viscous_traction.rows);
    // the last place is of bodies without
    tractions_.assign(first_traction_.back() + dim, 0.);
    place_.assign(n, {{first_traction_.back(), first_traction_.back()}});
    for_all_places(bodies, n,
                   [&](const std::size_t body, const unsigned int slot,
                       const std::size_t point, const unsigned int side) {
                     if (acts_in(body))
                       place_[point][side] =
                           first_traction_[body] + std::size_t(slot) * dim;
                   });
  }

  template <int dim>
  void ViscousForces<dim>::set(const CornerGroups<dim> &groups,
                               const HangingNodes<dim> &hanging)
  {
    const Bodies &bodies = discretization_.bodies();
    for_block_products(
        bodies, groups, groups.velocity, &BodyClass::damping,
        &BodyClass::viscous_traction,
        [&](const unsigned int b, const unsigned int l,
            const std::vector<double> &, const std::vector<double> &y,
            const std::vector<double> &t) {
          const BodyClass &body = bodies.classes[bodies.class_of[b]];
          for (unsigned int j = 0; j < body.n_dofs; ++j)
            of_corners_[bodies.first_dof[b] + j] = -y[j * lanes + l];
          for (unsigned int j = 0; j < body.viscous_traction.rows; ++j)
            tractions_[first_traction_[b] + j] = t[j * lanes + l];
        });
    of_groups_.assign(groups.size() * dim, 0.);
    for (std::size_t i = 0; i < mesh_.n_corners(); ++i)
      for (unsigned int c = 0; c < dim; ++c)
        of_groups_[groups.of(i) * dim + c] += of_corners_[i * dim + c];
    hanging.collect(groups, of_groups_, shares_);
  }

  template <int dim>
  void ViscousForces<dim>::gather(const std::size_t node,
                                  const CornerGroups<dim> &groups,
                                  const HangingNodes<dim> &hanging)
  {
    of_groups_.resize(groups.size() * dim);
    for (const unsigned int corner : mesh_.corners_of_node(node))
      std::fill_n(&of_groups_[groups.of(corner) * dim], dim, 0.);
    for (const unsigned int corner : mesh_.corners_of_node(node))
      for (unsigned int c = 0; c < dim; ++c)
        of_groups_[groups.of(corner) * dim + c] +=
            of_corners_[std::size_t(corner) * dim + c];
    hanging.add_shares(node, groups, shares_, of_groups_);
  }

  template <int dim>
  std::array<double, dim>
  ViscousForces<dim>::traction(const std::size_t point) const
  {
    std::array<double, dim> t;
    for (unsigned int c = 0; c < dim; ++c)
      t[c] = (tractions_[place_[point][0] + c] -
              tractions_[place_[point][1] + c]) /
             2.;
    return t;
  }

  template class ViscousForces<2>;
  template class ViscousForces<3>;
} // namespace nsfd
