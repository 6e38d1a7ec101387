#include "stress_report.h"

#include "core/gather.h"
#include "discretization/cells.h"
#include "discretization/loads.h"
#include "discretization/point_factors.h"
#include "nsfd/cohesive_laws/law_point.h"
#include "nsfd/core/per_extent.h"
#include "nsfd/scene/scene_input.h"
#include "records/engineering.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** The forces of the cells around a node, or of some of them. */
    template <int dim>
    struct NodeForce {
      std::array<long long, dim> key{}; ///< its place
      std::array<double, dim> place{}, force{}, size{};
      std::array<bool, dim> given{}; ///< a motion is prescribed

      bool operator<(const NodeForce &other) const { return key < other.key; }
    };

    /** By node of a body and component: a motion is prescribed there. */
    template <int dim>
    std::vector<char> driven_nodes(const SceneInput &input,
                                   const Discretization<dim> &discretization)
    {
      const Cells<dim> &cells = discretization.cells();
      const Bodies &bodies = cells.bodies;
      std::vector<char> result(cells.n_nodal(), 0);
      const auto take = [&](const std::size_t b, const std::size_t slot,
                            const unsigned int point) {
        if (point >= discretization.points().n_points)
          return;
        const PointOrigin &origin = discretization.origins()[point];
        if (origin.kind != PointOrigin::Kind::motion)
          return;
        const auto &boundary = input.boundaries[origin.block];
        const auto &shape = cells.class_shape(b);
        const auto &place = shape.slot_places[slot - bodies.first_slot[b]];
        for (unsigned int i = 0; i < shape.n_nodes; ++i)
          for (unsigned int c = 0; c < dim; ++c)
            if ((boundary.velocity[c] || boundary.displacement[c]) &&
                std::abs(cells.element->shape_value(i, place)) > 1e-12)
              result[(cells.first_node[b] + i) * dim + c] = 1;
      };
      for (std::size_t b = 0; b < bodies.size(); ++b)
        for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
             ++s)
          take(b, s, bodies.slot_point[s]);
      for (const auto &[slot, point] : bodies.extra_points) {
        const auto after = std::upper_bound(bodies.first_slot.begin(),
                                            bodies.first_slot.end(), slot);
        take(std::size_t(after - bodies.first_slot.begin()) - 1, slot, point);
      }
      return result;
    }

    /** Nodes of all cells, those at one place together. Collective. */
    template <int dim>
    std::vector<NodeForce<dim>>
    forces_at_nodes(const SceneInput &input,
                    const Discretization<dim> &discretization,
                    const Communicator &communicator)
    {
      const Cells<dim> &cells = discretization.cells();
      std::vector<double> forces(cells.bodies.n_dofs(), 0.);
      discretization.add_loads(0., forces);
      const auto driven = driven_nodes(input, discretization);
      const double unit = 1e-6 * discretization.cell_size();
      std::vector<NodeForce<dim>> own;
      for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
        if (cells.body_class(b).undeformed)
          continue;
        const auto of_body = cells.shape(b);
        const BodyShape<dim> &shape = *of_body;
        for (unsigned int i = 0; i < shape.n_nodes; ++i) {
          auto &node = own.emplace_back();
          const auto x = cells.place(b, shape.nodes[i]);
          for (unsigned int c = 0; c < dim; ++c) {
            node.place[c] = x[c];
            // nodes are at round numbers more often than not
            node.key[c] = std::llround(x[c] / unit + 0.3125);
            node.force[c] = forces[cells.bodies.first_dof[b] + i * dim + c];
            node.size[c] = std::abs(node.force[c]);
            node.given[c] = driven[(cells.first_node[b] + i) * dim + c] != 0;
          }
        }
      }
      auto all = gather(communicator, own);
      std::stable_sort(all.begin(), all.end());
      std::vector<NodeForce<dim>> result;
      for (const auto &one : all) {
        if (result.empty() || result.back().key != one.key) {
          result.push_back(one);
          continue;
        }
        for (unsigned int c = 0; c < dim; ++c) {
          result.back().force[c] += one.force[c];
          result.back().size[c] += one.size[c];
          result.back().given[c] |= one.given[c];
        }
      }
      return result;
    }

    template <int dim>
    std::string residual_line(const std::vector<NodeForce<dim>> &nodes,
                              const bool axisymmetric)
    {
      double largest = 0., worst = 0., of_worst = 0.;
      std::array<double, dim> place{};
      for (const auto &node : nodes)
        for (unsigned int c = 0; c < dim; ++c) {
          largest = std::max(largest, node.size[c]);
          if (node.given[c] || !(std::abs(node.force[c]) > worst))
            continue;
          worst = std::abs(node.force[c]);
          of_worst = node.size[c];
          place = node.place;
        }
      if (worst <= 1e-12 * largest)
        return fmt::format("  stress     the initial stress is in equilibrium: "
                           "residual force {:.2g} of the largest\n",
                           largest > 0. ? worst / largest : 0.);
      std::string at;
      for (const double x : place)
        at += (at.empty() ? "" : ", ") + engineering(x, "m");
      return fmt::format(
          "  stress     residual force of the initial stress: {} at ({}), "
          "{:.2g} "
          "of the forces there and\n"
          "             {:.2g} of the largest at a node: the run begins with a "
          "motion\n"
          "             change: tractions sigma_0 n on free sides, or a "
          "prescribed motion\n",
          engineering(worst, "N" + per_extent(dim, axisymmetric), 4), at,
          worst / of_worst, worst / largest);
    }

    /** R_0 is beyond what is there to carry it. */
    template <int dim>
    bool exceeds(const InterfaceInput &block,
                 const Discretization<dim> &discretization, const std::size_t i)
    {
      const double *const t =
          discretization.loads().initial_stress()->local_traction(i);
      double shear = 0.;
      for (unsigned int c = 1; c < dim; ++c)
        shear = std::hypot(shear, t[c]);
      const auto x = position_of(discretization.points(), i);
      const bool broken = block.law_name == "contact" ||
                          (block.has_broken && block.broken.at(x, 0.) != 0.);
      constexpr double round_off = 1e-12;
      if (broken)
        return t[0] > round_off * shear ||
               shear > (1. + round_off) * block.friction * std::max(0., -t[0]);
      if (!block.law)
        return false;
      const auto factors =
          point_factors<dim>(block, &x[0], discretization.extent());
      const LawPoint law(*block.law, factors.strength,
                         factors.strength / factors.toughness, block.plateau);
      return law.template effective_traction<dim>(
                 t[0], t + 1,
                 block.friction_exponent == 0. ? block.friction : 0.) >
             (1. + round_off) * law.strength();
    }
  } // namespace

  template <int dim>
  std::string initial_stress_report(const SceneInput &input,
                                    const Discretization<dim> &discretization,
                                    const Communicator &communicator)
  {
    if (!discretization.loads().initial_stress())
      return "";
    std::string text;
    bool divided = false;
    for (const auto &shape : discretization.cells().shapes)
      divided = divided || shape.divided != 0;
    if (communicator.any(divided))
      text = "  stress     with cells of two sizes side by side no residual "
             "force is computed\n";
    else
      text = residual_line(forces_at_nodes(input, discretization, communicator),
                           input.axisymmetric);
    const auto &origins = discretization.origins();
    std::vector<unsigned long long> beyond(input.interfaces.size(), 0),
        all = beyond;
    for (std::size_t i = 0; i < discretization.points().n_owned; ++i)
      if (origins[i].kind == PointOrigin::Kind::interface) {
        const unsigned int b = origins[i].block;
        ++all[b];
        beyond[b] += exceeds(input.interfaces[b], discretization, i);
      }
    for (std::size_t b = 0; b < beyond.size(); ++b) {
      const auto n = communicator.sum_integer(beyond[b]),
                 of = communicator.sum_integer(all[b]);
      if (n > 0)
        text += fmt::format("             on {} of {} points of Interface: {} "
                            "the initial traction is beyond what they carry\n",
                            n, of, input.interfaces[b].name);
    }
    return text;
  }

  template std::string initial_stress_report(const SceneInput &,
                                             const Discretization<2> &,
                                             const Communicator &);
  template std::string initial_stress_report(const SceneInput &,
                                             const Discretization<3> &,
                                             const Communicator &);
} // namespace nsfd
