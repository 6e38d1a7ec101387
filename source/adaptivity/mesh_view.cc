#include "mesh_view.h"

#include "core/gather.h"
#include "discretization/cells.h"
#include "materials/elasticity.h"

#include "family.h"

#include "discretization/point_places.h"
#include "nonsmooth/point_law.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /** Of the softer one of the two materials of a face; 0: both are rigid. */
    template <int dim>
    double plane_strain_modulus(const SceneInput &input,
                                const Discretization<dim> &discretization,
                                const std::array<int, 2> &bodies)
    {
      double modulus = std::numeric_limits<double>::max();
      for (const int b : bodies) {
        if (b < 0)
          continue;
        const auto &softest =
            discretization.cells().class_shape(unsigned(b)).extremes.softest;
        if (softest.young > 0.) // not rigid
          modulus = std::min(
              modulus,
              softest.young / (input.plane_stress
                                   ? 1.
                                   : 1. - softest.poisson * softest.poisson));
      }
      return modulus;
    }

    /** Something holds the two sides of a point together. */
    bool joins(const State &state, const std::size_t i)
    {
      return state.kind[i] != PointKind::free && state.beta[i] > 0.;
    }
  } // namespace

  template <int dim>
  double cohesive_zone(const SceneInput &input,
                       const Discretization<dim> &discretization,
                       const OneStepProblem<dim> &problem, const std::size_t i)
  {
    constexpr double pi = 3.14159265358979323846;
    const auto &points = discretization.points();
    const auto &interaction = problem.interactions[problem.interaction[i]];
    const double strength =
        LawPoint(*interaction.law, problem.strength_factor[i],
                 problem.opening_factor[i], interaction.plateau)
            .strength();
    const double toughness = interaction.law->toughness() *
                             problem.strength_factor[i] /
                             problem.opening_factor[i];
    return 9. * pi / 32. * toughness / (strength * strength) *
           plane_strain_modulus(input, discretization,
                                points.faces[points.face_of[i]].bodies);
  }

  template <int dim>
  StateView<dim>::StateView(const SceneInput &input, const MeshState<dim> &mesh,
                            const std::vector<unsigned int> &levels)
      : input_(input), mesh_(mesh), bodies_(levels.size())
  {
    const auto &discretization = mesh.discretization;
    for (unsigned int b = 0; b < bodies_.size(); ++b) {
      Body &body = bodies_[b];
      const auto corners = discretization.cells().corners[b];
      const auto centre = discretization.cells().centre(b);
      for (unsigned int c = 0; c < dim; ++c)
        body.centre[c] = centre[c];
      for (unsigned int v = 0; v < corners.size(); ++v)
        for (unsigned int d = 0; d < dim; ++d)
          if (!(v >> d & 1u))
            body.size =
                std::max(body.size, corners[v].distance(corners[v | 1u << d]));
      body.level = levels[b];
      body.largest = std::ldexp(body.size, int(levels[b]));
    }
  }

  template <int dim>
  const std::vector<double> &StateView<dim>::energy() const
  {
    if (energy_)
      return *energy_;
    energy_.emplace(bodies_.size(), 0.);
    const State &state = mesh_.state;
    const auto &bodies = mesh_.discretization.bodies();
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const BodyClass &body = bodies.classes[bodies.class_of[b]];
      const double *q = state.displacement.data() + bodies.first_dof[b];
      const double *v = state.velocity.data() + bodies.first_dof[b];
      (*energy_)[b] =
          half_product(body.mass, v) + half_product(body.stiffness, q);
    }
    return *energy_;
  }

  template <int dim>
  std::vector<std::array<double, 6>>
  mean_stresses(const Discretization<dim> &discretization,
                const std::vector<double> &displacement)
  {
    std::vector<std::array<double, 6>> mean(discretization.bodies().size());
    discretization.visit_quadrature(
        discretization.to_nodal(displacement),
        [&](const unsigned int body, const dealii::Point<dim> &x,
            const double JxW, const double *value, const double *gradient) {
          const auto stress = discretization.stress(body, x, value, gradient);
          for (unsigned int c = 0; c < 6; ++c)
            mean[body][c] +=
                JxW / discretization.cells().volume(body) * stress[c];
        });
    return mean;
  }

  template <int dim>
  const std::vector<double> &StateView<dim>::stress_jump() const
  {
    if (stress_jump_)
      return *stress_jump_;
    stress_jump_.emplace(bodies_.size(), 0.);
    const auto &points = mesh_.discretization.points();
    const auto stress =
        mean_stresses(mesh_.discretization, mesh_.state.displacement);
    std::array<std::vector<double>, 2> traction;
    traction.fill(std::vector<double>(points.n_points * dim, 0.));
    const auto places =
        point_places(mesh_.discretization.bodies(), points.n_points);
    for (unsigned int side = 0; side < 2; ++side)
      for (std::size_t i = 0; i < points.n_points; ++i)
        if (places[side][i].body >= 0) {
          const auto t =
              traction_on<dim>(stress[places[side][i].body], points.axes(i));
          std::copy(t.begin(), t.end(), &traction[side][i * dim]);
        }
    mesh_.delassus.exchange({{traction[0].data(), traction[1].data()}}, dim);
    for (const auto &face : points.faces) {
      if (face.boundary)
        continue;
      for (unsigned int i = face.first; i < face.first + face.count; ++i) {
        if (!joins(mesh_.state, i))
          continue;
        double square = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          square +=
              std::pow(traction[1][i * dim + c] - traction[0][i * dim + c], 2);
        for (const int b : face.bodies)
          if (b >= 0)
            (*stress_jump_)[b] =
                std::max((*stress_jump_)[b], std::sqrt(square));
      }
    }
    return *stress_jump_;
  }

  template <int dim>
  double StateView<dim>::utilisation(const std::size_t i) const
  {
    const State &state = mesh_.state;
    const auto &problem = mesh_.problem;
    if (state.beta[i] < 1. && state.beta[i] > 0.)
      return 1.;
    std::array<double, dim> traction{};
    for (unsigned int c = 0; c < dim; ++c)
      if (state.kind[i] == PointKind::bonded)
        traction[c] = state.bond_traction[i * dim + c];
      else if (problem.time_step > 0.)
        traction[c] = -state.impulse[i * dim + c] /
                      (problem.weight[i] * problem.time_step);
    return effective_traction<dim>(problem, i, traction[0],
                                   traction.data() + 1) /
           point_strength<dim>(problem, i);
  }

  template <int dim>
  const std::vector<MeshView::Point> &StateView<dim>::points() const
  {
    if (points_)
      return *points_;
    points_.emplace();
    const auto &points = mesh_.discretization.points();
    const auto &problem = mesh_.problem;
    for (std::size_t i = 0; i < points.n_points; ++i) {
      const auto &law = problem.interactions[problem.interaction[i]].law;
      if (!law)
        continue;
      Point point;
      for (unsigned int c = 0; c < dim; ++c)
        point.position[c] = points.position[i * dim + c];
      point.broken = mesh_.state.beta[i] <= 0.;
      point.utilisation = point.broken ? 0. : utilisation(i);
      point.zone = cohesive_zone<dim>(input_, mesh_.discretization, problem, i);
      points_->push_back(point);
    }
    return *points_;
  }

  template <int dim>
  double StateView<dim>::sum(const std::vector<double> &terms) const
  {
    return mesh_.delassus.communicator().sum(terms);
  }

  template <int dim>
  double StateView<dim>::max(const double value) const
  {
    return mesh_.delassus.communicator().max(value);
  }

  template <int dim>
  std::vector<double>
  StateView<dim>::gather(const std::vector<double> &values) const
  {
    return gather_all(mesh_.delassus.communicator(), values);
  }

  template std::vector<std::array<double, 6>>
  mean_stresses(const Discretization<2> &, const std::vector<double> &);
  template std::vector<std::array<double, 6>>
  mean_stresses(const Discretization<3> &, const std::vector<double> &);
  template double cohesive_zone(const SceneInput &, const Discretization<2> &,
                                const OneStepProblem<2> &, std::size_t);
  template double cohesive_zone(const SceneInput &, const Discretization<3> &,
                                const OneStepProblem<3> &, std::size_t);
  template class StateView<2>;
  template class StateView<3>;
} // namespace nsfd
