#include "cell_stresses.h"

#include "discretization/axis.h"
#include "discretization/body_shape.h"
#include "discretization/cell_sampler.h"
#include "discretization/cells.h"
#include "discretization/material_histories.h"
#include "materials/strain.h"

#include "nsfd/materials/material_model.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  CellStresses<dim>::CellStresses(const Discretization<dim> &discretization,
                                  const State &state)
      : discretization_(discretization), state_(state)
  {
    const SceneInput &input = discretization.input();
    if (!input.has_history())
      return;
    for (const MaterialInput &material : input.materials) {
      const bool keeps = material.kind == MaterialKind::history_dependent;
      materials_.push_back(
          keeps ? material.model->history_dependent<dim>(
                      material, input.large_motion, input.plane_stress)
                : nullptr);
      if (input.axisymmetric)
        of_rings_.push_back(keeps ? material.model->history_dependent<3>(
                                        material, input.large_motion, false)
                                  : nullptr);
    }
    first_ = first_histories(discretization);
  }

  template <int dim>
  CellStresses<dim>::~CellStresses() = default;

  template <int dim>
  bool CellStresses<dim>::is_history_dependent(const unsigned int body) const
  {
    return any_memory() &&
           materials_[discretization_.cells().body_class(body).material] !=
               nullptr;
  }

  template <int dim>
  const double *CellStresses<dim>::history(const unsigned int body,
                                           const unsigned int q) const
  {
    return state_.material_history.data() + first_[body] +
           q * n_history(discretization_.cells().body_class(body).material);
  }

  template <int dim>
  unsigned int CellStresses<dim>::n_history(const unsigned int material) const
  {
    return of_rings_.empty() ? materials_[material]->n_history()
                             : of_rings_[material]->n_history();
  }

  template <int dim>
  double CellStresses<dim>::plastic_strain(const unsigned int body,
                                           const unsigned int q) const
  {
    const unsigned int m = discretization_.cells().body_class(body).material;
    return of_rings_.empty()
               ? materials_[m]->equivalent_strain(history(body, q))
               : of_rings_[m]->equivalent_strain(history(body, q));
  }

  namespace
  {
    /** F = 1 + gradient becomes (dilatation / det F)^(1/dim) F. */
    template <int dim>
    void strain_by(const double dilatation, double *gradient)
    {
      for (unsigned int c = 0; c < dim; ++c)
        gradient[c * dim + c] += 1.;
      const double share =
          std::pow(dilatation / jacobian<dim>(gradient), 1. / dim);
      for (unsigned int k = 0; k < dim * dim; ++k)
        gradient[k] *= share;
      for (unsigned int c = 0; c < dim; ++c)
        gradient[c * dim + c] -= 1.;
    }

    /** Of a ring at a point of its quadrature, from nodal displacements. */
    template <int dim>
    double hoop_at(const BodyShape<dim> &shape, const unsigned int q,
                   const double *u)
    {
      double radial = 0.;
      for (unsigned int i = 0; i < shape.n_nodes; ++i)
        radial += shape.values[q * shape.n_nodes + i] * u[i * dim];
      return radial / radius_at(shape, shape.positions[q]);
    }
  } // namespace

  template <int dim>
  double CellStresses<dim>::dilatation(const BodyShape<dim> &shape,
                                       const double *u) const
  {
    const SceneInput &input = discretization_.input();
    if (!input.large_motion || !input.time.scheme.at_nodes)
      return 0.;
    double now = 0., volume = 0.;
    for (unsigned int q = 0; q < shape.JxW.size(); ++q) {
      double F[dim * dim] = {};
      for (unsigned int c = 0; c < dim; ++c)
        F[c * dim + c] = 1.;
      for (unsigned int i = 0; i < shape.n_nodes; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            F[c * dim + d] +=
                u[i * dim + c] * shape.gradients[q * shape.n_nodes + i][d];
      const double hoops =
          is_axisymmetric(shape) ? 1. + hoop_at(shape, q, u) : 1.;
      now += shape.JxW[q] * jacobian<dim>(F) * hoops;
      volume += shape.JxW[q];
    }
    return now / volume;
  }

  template <int dim>
  typename CellStresses<dim>::Stress
  CellStresses<dim>::stress(const unsigned int body, const unsigned int q,
                            const double dilatation, const double *gradient,
                            const double hoop) const
  {
    const unsigned int m = discretization_.cells().body_class(body).material;
    if (!of_rings_.empty()) {
      auto F = with_hoop(gradient, hoop);
      if (dilatation > 0.)
        strain_by<3>(dilatation, F.data());
      return of_rings_[m]->stress(F.data(), history(body, q));
    }
    double F[dim * dim];
    std::copy_n(gradient, dim * dim, F);
    if (dilatation > 0.)
      strain_by<dim>(dilatation, F);
    return materials_[m]->stress(F, history(body, q));
  }

  template <int dim>
  typename CellStresses<dim>::Stress
  CellStresses<dim>::visit(const unsigned int body, const dealii::Point<dim> &x,
                           const double *value, const double *gradient)
  {
    if (!is_history_dependent(body))
      return discretization_.stress(body, x, value, gradient);
    if (body != body_)
      point_ = 0;
    body_ = body;
    if (point_ == 0)
      dilatation_ = dilatation(
          *discretization_.cells().shape(body),
          &state_.displacement[discretization_.bodies().first_dof[body]]);
    const unsigned int q = point_++;
    if (point_ == discretization_.cells().class_shape(body).JxW.size())
      point_ = 0; // the next visit of all may begin here
    const double hoop =
        of_rings_.empty()
            ? 0.
            : hoop_strain(x, value, gradient, discretization_.cell_size());
    return stress(body, q, dilatation_, gradient, hoop);
  }

  template <int dim>
  void CellStresses<dim>::visit_all(const std::vector<double> &displacement,
                                    const std::vector<double> &velocity,
                                    const Visitor &visitor)
  {
    std::vector<Stress> viscous; // in the order of the visits
    if (discretization_.input().has_viscous_bodies())
      discretization_.visit_quadrature(
          velocity, [&](const unsigned int body, const dealii::Point<dim> &x,
                        double, const double *value, const double *rate) {
            viscous.push_back(
                discretization_.viscous_stress(body, x, value, rate));
          });
    std::size_t k = 0;
    discretization_.visit_quadrature(
        displacement,
        [&](const unsigned int body, const dealii::Point<dim> &x,
            const double JxW, const double *value, const double *gradient) {
          Stress sigma = visit(body, x, value, gradient);
          if (!viscous.empty())
            for (unsigned int c = 0; c < 6; ++c)
              sigma[c] += viscous[k][c];
          ++k;
          visitor(body, x, JxW, sigma);
        });
  }

  template <int dim>
  std::vector<double>
  CellStresses<dim>::at_nodes(const unsigned int body,
                              const std::vector<double> &nodal) const
  {
    constexpr unsigned int width = 7;
    const auto of_body = discretization_.cells().shape(body);
    const BodyShape<dim> &shape = *of_body;
    const unsigned int n = shape.n_nodes;
    const double *u =
        nodal.data() + discretization_.cells().first_node[body] * dim;
    const double mean = dilatation(shape, u);
    Block mass(n, n), moments(n, width);
    for (unsigned int q = 0; q < shape.JxW.size(); ++q) {
      double gradient[dim * dim] = {};
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            gradient[c * dim + d] +=
                u[i * dim + c] * shape.gradients[q * n + i][d];
      const double hoop = of_rings_.empty() ? 0. : hoop_at(shape, q, u);
      const Stress sigma = stress(body, q, mean, gradient, hoop);
      for (unsigned int i = 0; i < n; ++i) {
        const double N = shape.JxW[q] * shape.values[q * n + i];
        for (unsigned int j = 0; j < n; ++j)
          mass(i, j) += N * shape.values[q * n + j];
        for (unsigned int k = 0; k < 6; ++k)
          moments(i, k) += N * sigma[k];
        moments(i, 6) += N * plastic_strain(body, q);
      }
    }
    Block identity(n, n);
    for (unsigned int i = 0; i < n; ++i)
      identity(i, i) = 1.;
    const Block values =
        product(gram(forward_solve(cholesky(mass), identity)), moments);
    std::vector<double> result;
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int k = 0; k < width; ++k)
        result.push_back(values(i, k));
    return result;
  }

  template <int dim>
  typename CellStresses<dim>::Sample
  CellStresses<dim>::from_nodes(const Sampler<dim> &sampler,
                                const unsigned int q) const
  {
    constexpr unsigned int width = 7;
    const std::size_t n = nodes_.size() / width;
    std::array<double, width> value{};
    std::vector<double> part(n * dim);
    for (unsigned int k = 0; k < width; k += dim) { // it takes dim at a time
      for (std::size_t i = 0; i < n; ++i)
        for (unsigned int c = 0; c < dim && k + c < width; ++c)
          part[i * dim + c] = nodes_[i * width + k + c];
      const auto x = sampler.value(q, part.data());
      for (unsigned int c = 0; c < dim && k + c < width; ++c)
        value[k + c] = x[c];
    }
    Sample result;
    std::copy_n(value.begin(), 6, result.stress.begin());
    result.plastic_strain = std::max(0., value[6]);
    return result;
  }

  template <int dim>
  typename CellStresses<dim>::Sample
  CellStresses<dim>::at(const unsigned int body, const Sampler<dim> &sampler,
                        const unsigned int q,
                        const std::vector<double> &displacement,
                        const std::vector<double> &velocity)
  {
    if (is_history_dependent(body)) {
      if (nodes_.empty() || body != sampled_)
        nodes_ = at_nodes(body, displacement);
      sampled_ = body;
      return from_nodes(sampler, q);
    }
    const auto corners = discretization_.cells().corners[body];
    const std::size_t node = discretization_.cells().first_node[body] * dim;
    const auto x = sampler.position(q, corners);
    Sample result;
    result.stress = discretization_.stress(
        body, x, sampler.value(q, &displacement[node]).begin_raw(),
        sampler.gradient(q, corners, &displacement[node]).data());
    if (discretization_.input().has_viscous_bodies()) {
      const auto viscous = discretization_.viscous_stress(
          body, x, sampler.value(q, &velocity[node]).begin_raw(),
          sampler.gradient(q, corners, &velocity[node]).data());
      for (unsigned int c = 0; c < 6; ++c)
        result.stress[c] += viscous[c];
    }
    return result;
  }

  template class CellStresses<2>;
  template class CellStresses<3>;
} // namespace nsfd
