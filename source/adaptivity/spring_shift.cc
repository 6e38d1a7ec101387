#include "spring_shift.h"

#include "discretization/cells.h"
#include "materials/elasticity.h"

#include "discretization/point_places.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** C_N and C_T of a block with springs. */
    std::array<double, 2> stiffness(const InterfaceInput &block)
    {
      if (!block.law)
        return {{block.normal_stiffness, block.tangential_stiffness}};
      const double C = block.law->normal_stiffness();
      return {{C, C * block.law->stiffness_ratio()}};
    }

    /** Of the faces between the two halves of a cell, in each direction. */
    template <int dim>
    std::array<Tensor<1, dim>, dim>
    middle_normals(const std::vector<Point<dim>> &corners)
    {
      std::array<Tensor<1, dim>, dim> along, normal;
      for (unsigned int v = 0; v < corners.size(); ++v)
        for (unsigned int d = 0; d < dim; ++d)
          along[d] += (v >> d & 1u ? 1. : -1.) * corners[v];
      for (unsigned int d = 0; d < dim; ++d) {
        if constexpr (dim == 2) {
          const auto &other = along[1 - d];
          normal[d][0] = other[1];
          normal[d][1] = -other[0];
        } else
          normal[d] =
              cross_product_3d(along[(d + 1) % dim], along[(d + 2) % dim]);
        normal[d] /= normal[d].norm() * (normal[d] * along[d] < 0. ? -1. : 1.);
      }
      return normal;
    }
  } // namespace

  template <int dim>
  SpringShift<dim>::SpringShift(const SceneInput &input,
                                const MeshState<dim> &mesh)
      : input_(input), discretization_(mesh.discretization)
  {
    const auto &bodies = mesh.discretization.bodies();
    bool any = false;
    for (unsigned int b = 0; b < bodies.size(); ++b)
      any = any || mesh.discretization.springs_inside(b) >= 0;
    if (!any)
      return;
    stress_ = mean_stresses(mesh.discretization, mesh.state.displacement);
    held_.assign(bodies.size(), 0);
    broken_.assign(bodies.size(), 0);
    for_all_places(bodies, mesh.discretization.points().n_points,
                   [&](const std::size_t body, const unsigned int slot,
                       const std::size_t i, unsigned int) {
                     const PointOrigin origin =
                         mesh.discretization.origins()[i];
                     const auto face =
                         std::uint8_t(1u << mesh.discretization.cells()
                                                .class_shape(unsigned(body))
                                                .slot_faces[slot]);
                     const bool same =
                         origin.kind == PointOrigin::Kind::interface &&
                         int(origin.block) ==
                             mesh.discretization.springs_inside(unsigned(body));
                     switch (mesh.state.kind[i]) {
                     case PointKind::free:
                       broken_[body] |= face;
                       break;
                     case PointKind::elastic:
                     case PointKind::cohesive:
                       held_[body] |= same ? 0u : face;
                       // damaged and closed: contact, which a spring does not
                       // follow
                       broken_[body] |= mesh.state.beta[i] < 1. &&
                                                !mesh.state.two_sided[i] &&
                                                mesh.state.jump[i * dim] < 0.
                                            ? face
                                            : 0u;
                       break;
                     default:
                       held_[body] |= face;
                     }
                   });
  }

  template <int dim>
  typename SpringShift<dim>::Openings
  SpringShift<dim>::openings(const unsigned int body, const int block,
                             const Stress &stress, const int level) const
  {
    const InterfaceInput &interface = input_.interfaces[unsigned(block)];
    const auto [C_N, C_T] = stiffness(interface);
    const double compliance = std::ldexp(1., -level);
    const auto normals =
        middle_normals<dim>(discretization_.cells().corners[body]);
    Openings result{};
    for (unsigned int d = 0; d < dim; ++d) {
      const Tensor<1, dim> &n = normals[d];
      const auto t = traction_on<dim>(stress, n.begin_raw());
      double pull = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        pull += t[c] * n[c];
      const bool closed =
          pull < 0. && interface.intact == IntactFaces::unilateral;
      for (unsigned int c = 0; c < dim; ++c)
        result[d][c] = compliance * ((closed ? 0. : pull / C_N * n[c]) +
                                     (t[c] - pull * n[c]) / C_T);
    }
    return result;
  }

  template <int dim>
  void SpringShift<dim>::move_apart(const Openings &u, const unsigned int child,
                                    const std::uint8_t held,
                                    const std::uint8_t broken,
                                    double *translation) const
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (held >> (2 * d + (child >> d & 1u)) & 1u)
        return;
    for (unsigned int d = 0; d < dim; ++d) {
      const unsigned int upper = child >> d & 1u;
      if (broken >> (2 * d + upper) & 1u)
        continue;
      for (unsigned int c = 0; c < dim; ++c)
        translation[c] += (upper ? 0.5 : -0.5) * u[d][c];
    }
  }

  template <int dim>
  typename SpringShift<dim>::Translations
  SpringShift<dim>::of_children(const unsigned int body, const int level) const
  {
    constexpr unsigned int n_children = 1u << dim;
    Translations result(n_children * dim, 0.);
    const int block = discretization_.springs_inside(body);
    if (block < 0)
      return result;
    const Openings u = openings(body, block, stress_[body], level);
    for (unsigned int child = 0; child < n_children; ++child)
      move_apart(u, child, held_[body], broken_[body], &result[child * dim]);
    return result;
  }

  template <int dim>
  typename SpringShift<dim>::Translations
  SpringShift<dim>::of_family(const std::vector<unsigned int> &bodies,
                              const int level) const
  {
    Translations result(bodies.size() * dim, 0.);
    const int block = discretization_.springs_inside(bodies[0]);
    if (block < 0)
      return result;
    Stress mean{};
    double volume = 0.;
    std::uint8_t held = 0, broken = 0; // of the parent: by any of its children
    for (unsigned int child = 0; child < bodies.size(); ++child) {
      const unsigned int body = bodies[child];
      volume += discretization_.cells().volume(body);
      for (unsigned int c = 0; c < mean.size(); ++c)
        mean[c] += discretization_.cells().volume(body) * stress_[body][c];
      std::uint8_t outside = 0;
      for (unsigned int face = 0; face < 2 * dim; ++face)
        outside |= std::uint8_t(lies_on_face(child, face) << face);
      held |= held_[body] & outside;
      broken |= broken_[body] & outside;
    }
    for (double &component : mean)
      component /= volume;
    for (unsigned int child = 0; child < bodies.size(); ++child)
      move_apart(openings(bodies[child], block, mean, level), child, held,
                 broken, &result[child * dim]);
    return result;
  }

  template class SpringShift<2>;
  template class SpringShift<3>;
} // namespace nsfd
