#include "body_layout.h"

#include "discretization/body_shape.h"
#include "discretization/cell_geometry.h"
#include "discretization/cells.h"
#include "discretization/slot_gradients.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/fe/fe.h>

#include <algorithm>

namespace nsfd
{
  using namespace dealii;
  using namespace space;

  namespace
  {
    constexpr double pi = 3.14159265358979323846;
    constexpr unsigned int none = ~0u;

    /**
     * Of a node of a shape, whose corners are rounded, see RoundedCorners: that
     * of the corner where it is one, so that bodies which stand on each other
     * touch without a gap.
     */
    template <int dim>
    Point<dim> node_place(const Point<dim> &node,
                          const std::vector<Point<dim>> &rounded,
                          const std::vector<Point<dim>> &corners)
    {
      constexpr double same = 1e-10;
      for (std::size_t v = 0; v < corners.size(); ++v)
        if (node.distance(rounded[v]) <=
            same * corners[v].distance(corners[v == 0 ? 1 : 0]))
          return corners[v];
      return corners[0] + Tensor<1, dim>(node);
    }
  } // namespace

  template <int dim>
  BodyLayout<dim>::BodyLayout(const SceneInput &input,
                              const Discretization<dim> &discretization)
      : input_(input), discretization_(discretization),
        nodes_per_cell_(discretization.cells().element->n_dofs_per_cell())
  {
    for (unsigned int c = 0; c < discretization.bodies().size(); ++c) {
      const auto of_body = discretization.cells().shape(c);
      const BodyShape<dim> &shape = *of_body;
      const auto &corners = discretization.cells().corners[c];
      for (const Place &node : shape.nodes) {
        const Place place = node_place<dim>(node, shape.corners, corners);
        for (unsigned int d = 0; d < dim; ++d)
          rest_.push_back(place[d]);
      }
    }
    make_bodies();
    make_slots();
    set_slot_gradients();
  }

  template <int dim>
  void BodyLayout<dim>::make_bodies()
  {
    const BodyTable &table = discretization_.body_table();
    own_body_.assign(table.bodies.size(), -1);
    own_cell_.assign(table.n_cells(), none);
    int n_rigid_bodies = 0;
    for (unsigned int c = 0; c < discretization_.bodies().size(); ++c) {
      const unsigned int cell =
          table.cell_of_global[discretization_.cells().global_cell[c]];
      const unsigned int b = table.body_of_cell[cell];
      own_cell_[cell] = c;
      if (own_body_[b] < 0) {
        own_body_[b] = int(bodies_.size());
        MovingBody &body = bodies_.emplace_back();
        body.number = b;
        body.material = table.bodies[b].material;
        if (table.is_rigid(b)) {
          body.rigid = n_rigid_bodies++;
          body.rigid_number = std::size_t(table.bodies[b].rigid);
        }
      }
      body_of_.push_back(unsigned(own_body_[b]));
      bodies_[body_of_[c]].cells.push_back(c);
    }
    for (MovingBody &body : bodies_)
      if (body.is_rigid())
        set_inertia(body);
  }

  /** Of its cells, of the ball around them, or as the input says. */
  template <int dim>
  void BodyLayout<dim>::set_inertia(MovingBody &body) const
  {
    const auto &material = input_.materials[body.material];
    const auto &given = material.rigid_bodies;
    double mass = 0.;
    Vec3 centre{};
    const auto for_points = [&](const auto &visit) {
      for (const unsigned int c : body.cells) {
        const auto of_body = discretization_.cells().shape(c);
        const BodyShape<dim> &shape = *of_body;
        const Place corner = discretization_.cells().corners[c][0];
        for (std::size_t q = 0; q < shape.JxW.size(); ++q)
          visit(material.density * shape.JxW[q],
                in_space(Vector(corner) + Vector(shape.positions[q])));
      }
    };
    for_points([&](const double m, const Vec3 &x) {
      mass += m;
      centre = centre + m * x;
    });
    centre = (1. / mass) * centre;
    Mat3 inertia{};
    for_points([&](const double m, const Vec3 &x) {
      const Vec3 r = x - centre;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          inertia[i][j] += m * ((i == j ? dot(r, r) : 0.) - r[i] * r[j]);
    });
    const double of_cells = mass;
    if (given.ball) {
      for (const unsigned int c : body.cells)
        for (const Place &corner : discretization_.cells().corners[c])
          body.radius =
              std::max(body.radius, norm(in_space(Vector(corner)) - centre));
      const double R = body.radius;
      mass =
          material.density * (dim == 2 ? pi * R * R : 4. / 3. * pi * R * R * R);
      inertia = {};
      for (unsigned int i = 0; i < 3; ++i)
        inertia[i][i] = (dim == 2 ? 0.5 : 0.4) * mass * R * R;
    }
    if (given.mass) {
      inertia = (*given.mass / mass) * inertia;
      mass = *given.mass;
    }
    if (given.inertia) {
      inertia = {};
      for (unsigned int i = 0; i < 3; ++i)
        inertia[i][i] = (*given.inertia)[i];
    }
    body.inertia = dim == 2 ? plane_inertia(mass, inertia[2][2])
                            : RigidInertia{mass, inertia};
    body.centre = centre;
    body.extra_weight = mass - of_cells;
  }

  template <int dim>
  void BodyLayout<dim>::make_slots()
  {
    const std::size_t n_points = discretization_.points().n_points;
    slots_.resize(bodies_.size());
    const Bodies &cells = discretization_.bodies();
    const auto add = [&](const std::size_t c, const unsigned int slot,
                         const unsigned int point, const int sign) {
      if (point < n_points)
        slots_[body_of_[c]].push_back(
            {unsigned(c), slot, point, static_cast<signed char>(sign)});
    };
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (std::size_t s = cells.first_slot[c]; s < cells.first_slot[c + 1];
           ++s)
        add(c, unsigned(s - cells.first_slot[c]), cells.slot_point[s],
            cells.slot_sign[s]);
    for (const auto &[slot, point] : cells.extra_points) {
      const std::size_t c =
          std::size_t(std::upper_bound(cells.first_slot.begin(),
                                       cells.first_slot.end(), slot) -
                      cells.first_slot.begin()) -
          1;
      add(c, unsigned(slot - cells.first_slot[c]), point, 1);
    }
  }

  template <int dim>
  void BodyLayout<dim>::set_slot_gradients()
  {
    const auto &element = *discretization_.cells().element;
    for (const auto &body : discretization_.bodies().classes) {
      auto &gradients = slot_gradients_.emplace_back();
      if (body.bodies.empty())
        continue;
      const auto of_body = discretization_.cells().shape(body.bodies[0]);
      gradients = nsfd::slot_gradients<dim>(*of_body, element);
    }
  }

  template class BodyLayout<2>;
  template class BodyLayout<3>;
} // namespace nsfd
