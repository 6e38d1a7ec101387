#include "rigid_groups.h"

#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

// RigidGroups in motions of any size.

namespace nsfd
{
  using namespace space;

  namespace
  {
    template <int dim>
    dealii::Point<dim> point_of(const Vec3 &x)
    {
      dealii::Point<dim> result;
      for (unsigned int c = 0; c < dim; ++c)
        result[c] = x[c];
      return result;
    }
  } // namespace

  template <int dim>
  Vec3 RigidGroups<dim>::Body::spin() const
  {
    Vec3 result{};
    for (unsigned int k = dim; k < n_motions; ++k)
      result[dim == 2 ? 2 : k - dim] = velocity[k] / size;
    return result;
  }

  template <int dim>
  void RigidGroups<dim>::set_places(const State &state)
  {
    const auto &table = discretization_.body_table();
    const Cells<dim> &cells = discretization_.cells();
    // of equal density in each
    std::vector<std::pair<double, Vec3>> moments(table.n_rigid);
    std::vector<int> owner(table.n_rigid, -1);
    for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
      const int of_cell = body_of_corner_[cells.first_node[b]];
      if (of_cell < 0)
        continue;
      const unsigned int whole =
          table.body_of_cell[table.cell_of_global[cells.global_cell[b]]];
      const auto number = std::size_t(table.bodies[whole].rigid);
      owner[number] = of_cell;
      const auto shape = cells.shape(b);
      for (std::size_t q = 0; q < shape->JxW.size(); ++q) {
        auto &[volume, moment] = moments[number];
        volume += shape->JxW[q];
        moment =
            moment +
            shape->JxW[q] * in_space<dim>(cells.place(b, shape->positions[q]));
      }
    }
    for (Body &body : bodies_)
      body.parts.clear();
    for (std::size_t k = 0; k < owner.size(); ++k)
      if (owner[k] >= 0)
        bodies_[std::size_t(owner[k])].parts.emplace_back(
            k, (1. / moments[k].first) * moments[k].second);
    for (Body &body : bodies_) {
      const auto &[number, rest] = body.parts.front();
      const RigidState given = rigid_state(&state.rigid[13 * number]);
      body.cells.orientation = given.orientation;
      body.cells.centre =
          given.centre + rotation(given.orientation) * (body.cells.rest - rest);
      body.centre = point_of<dim>(body.cells.centre);
    }
    pins_.clear();
    const SceneInput &input = discretization_.input();
    for (const PinInput &pin : input.pins)
      for (const auto &whole : table.bodies)
        if (whole.rigid >= 0 &&
            input.materials[whole.material].name == pin.material) {
          pins_.push_back(
              {std::size_t(owner[std::size_t(whole.rigid)]), pin.at});
          break;
        }
  }

  /** Where places and centres of mass are; velocities become those of these. */
  template <int dim>
  void RigidGroups<dim>::set_centres(const CornerGroups<dim> &groups)
  {
    using Tensor = dealii::Tensor<1, dim>;
    const auto place = [&](const Member &member) {
      return member.rest +
             Tensor(at_node<dim>(groups.displacement, member.group));
    };
    std::vector<double> mass;
    std::vector<Tensor> moment; // of attached masses, about the cells' centre
    for (const Body &body : bodies_) {
      mass.push_back(body.cells.mass);
      moment.emplace_back();
    }
    for (const Member &member : members_) {
      mass[member.body] += member.mass;
      for (unsigned int c = 0; c < dim; ++c)
        moment[member.body][c] +=
            member.mass *
            (place(member)[c] - bodies_[member.body].cells.centre[c]);
    }
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      Body &body = bodies_[b];
      dealii::Point<dim> centre;
      for (unsigned int c = 0; c < dim; ++c)
        centre[c] = body.cells.centre[c] + moment[b][c] / mass[b];
      const Vec3 shift =
          cross(body.spin(), in_space<dim>(centre - body.centre));
      for (unsigned int c = 0; c < dim; ++c)
        body.velocity[c] += shift[c];
      body.centre = centre;
      const auto R = body.motions(point_of<dim>(body.cells.centre));
      const Mat3 I = body.cells.inertia_now();
      for (unsigned int i = 0; i < n_motions; ++i)
        for (unsigned int j = 0; j < n_motions; ++j) {
          double &m = body.rigid_mass[i][j];
          m = 0.;
          for (unsigned int c = 0; c < dim; ++c)
            m += body.cells.mass * R[c][i] * R[c][j];
          if (i >= dim && j >= dim)
            m += (dim == 2 ? I[2][2] : I[i - dim][j - dim]) /
                 (body.size * body.size);
        }
    }
    for (Member &member : members_)
      member.R = bodies_[member.body].motions(place(member));
  }

  template <int dim>
  std::string RigidGroups<dim>::fly(const double h, CornerGroups<dim> &groups)
  {
    const Body *fastest = nullptr; // of those that turn too far
    for (Body &body : bodies_) {
      Mat3 I{};
      for (unsigned int i = dim; i < n_motions; ++i)
        for (unsigned int j = dim; j < n_motions; ++j)
          I[dim == 2 ? 2 : i - dim][dim == 2 ? 2 : j - dim] =
              body.mass[i][j] * body.size * body.size;
      Vec3 centre = in_space<dim>(body.centre), velocity{}, omega = body.spin();
      for (unsigned int c = 0; c < dim; ++c)
        velocity[c] = body.velocity[c];
      if (!body.cells.fly(h, body.mass[0][0], I, dim == 2, centre, velocity,
                          omega)) {
        // not to be a number is to be fastest
        if (!fastest || !(norm(omega) <= norm(fastest->spin())))
          fastest = &body;
        continue;
      }
      body.centre = point_of<dim>(centre);
      for (unsigned int k = dim; k < n_motions; ++k)
        body.velocity[k] = omega[dim == 2 ? 2 : k - dim] * body.size;
    }
    if (fastest) {
      const auto &table = discretization_.body_table();
      const auto &input = discretization_.input();
      const auto of_part = std::find_if(
          table.bodies.begin(), table.bodies.end(),
          [number = fastest->parts.front().first](const auto &one) {
            return one.rigid == int(number);
          });
      std::vector<double> place(dim);
      std::copy_n(fastest->centre.begin_raw(), dim, place.begin());
      return fmt::format("the rigid body of {} at ({:.4g}) m, by {:.2g} rad",
                         input.materials[of_part->material].name,
                         fmt::join(place, ", "), h * norm(fastest->spin()));
    }
    for (Member &member : members_) {
      const Vec3 x =
          bodies_[member.body].cells.place(in_space<dim>(member.rest));
      for (unsigned int c = 0; c < dim; ++c)
        groups.displacement[std::size_t(member.group) * dim + c] =
            x[c] - member.rest[c];
      member.R = bodies_[member.body].motions(point_of<dim>(x));
    }
    scatter(groups);
    return {};
  }

  template <int dim>
  void RigidGroups<dim>::show(State &state) const
  {
    state.rigid.resize(13 * discretization_.body_table().n_rigid);
    for (const Body &body : bodies_) {
      const Vec3 omega = body.spin(),
                 own = transposed(rotation(body.cells.orientation)) * omega;
      for (const auto &[number, rest] : body.parts) {
        const Vec3 x = body.cells.place(rest),
                   turn = cross(omega, x - in_space<dim>(body.centre));
        double *to = &state.rigid[13 * number];
        for (unsigned int c = 0; c < 3; ++c) {
          to[c] = x[c];
          to[3 + c] = (c < dim ? body.velocity[c] : 0.) + turn[c];
          to[10 + c] = own[c];
        }
        std::copy_n(body.cells.orientation.begin(), 4, to + 6);
      }
    }
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template Vec3 RigidGroups<dim>::Body::spin() const;                          \
  template void RigidGroups<dim>::set_places(const State &);                   \
  template void RigidGroups<dim>::set_centres(const CornerGroups<dim> &);      \
  template std::string RigidGroups<dim>::fly(double, CornerGroups<dim> &);     \
  template void RigidGroups<dim>::show(State &) const
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
