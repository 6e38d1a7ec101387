#include "family.h"

#include <deal.II/fe/fe.h>
#include <deal.II/lac/full_matrix.h>

#include <cmath>

namespace nsfd
{
  using namespace dealii;

  double half_product(const Block &A, const double *x)
  {
    double sum = 0.;
    for (unsigned int j = 0; j < A.cols; ++j)
      for (unsigned int i = 0; i < A.rows; ++i)
        sum += x[i] * A(i, j) * x[j];
    return sum / 2.;
  }

  template <int dim>
  std::vector<double> in_child(const FiniteElement<dim, dim> &element,
                               const unsigned int child, const double *x,
                               const std::size_t n)
  {
    const FullMatrix<double> &P = element.get_prolongation_matrix(child);
    std::vector<double> result(n, 0.);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i % dim; j < n; j += dim)
        result[i] += P(unsigned(i / dim), unsigned(j / dim)) * x[j];
    return result;
  }

  void Family::add(const Bodies &bodies, const State &state,
                   const unsigned int body, const double *translation,
                   const unsigned int dim)
  {
    const std::size_t first = bodies.first_dof[body];
    classes.push_back(&bodies.classes[bodies.class_of[body]]);
    displacement.emplace_back(state.displacement.begin() +
                                  std::ptrdiff_t(first),
                              state.displacement.begin() +
                                  std::ptrdiff_t(bodies.first_dof[body + 1]));
    for (std::size_t i = 0; i < displacement.back().size(); ++i)
      displacement.back()[i] -= translation[i % dim];
    velocity.push_back(state.velocity.data() + first);
  }

  template <int dim>
  ParentMotion motion_of_parent(const FiniteElement<dim, dim> &element,
                                const Family &family)
  {
    const unsigned int n_nodes = element.n_dofs_per_cell(), n = n_nodes * dim;
    ParentMotion parent{std::vector<double>(n, 0.), std::vector<double>(n, 0.)};
    std::vector<unsigned int> children_at(n_nodes, 0);
    const auto &nodes = element.get_unit_support_points();
    for (unsigned int c = 0; c < family.classes.size(); ++c) {
      const FullMatrix<double> &P = element.get_prolongation_matrix(c);
      const Block &M = family.classes[c]->mass;
      for (unsigned int j = 0; j < n; ++j) {
        double Mv = 0.;
        for (unsigned int k = 0; k < n; ++k)
          Mv += M(j, k) * family.velocity[c][k];
        for (unsigned int i = 0; i < n_nodes; ++i)
          parent.momentum[i * dim + j % dim] += P(j / dim, i) * Mv;
      }
      for (unsigned int i = 0; i < n_nodes; ++i) {
        Point<dim> xi;
        bool inside = true;
        for (unsigned int d = 0; d < dim; ++d) {
          xi[d] = 2. * nodes[i][d] - double(c >> d & 1u);
          inside = inside && xi[d] > -1e-12 && xi[d] < 1. + 1e-12;
        }
        if (!inside)
          continue;
        ++children_at[i];
        for (unsigned int j = 0; j < n_nodes; ++j) {
          const double N = element.shape_value(j, xi);
          for (unsigned int d = 0; d < dim; ++d)
            parent.displacement[i * dim + d] +=
                N * family.displacement[c][j * dim + d];
        }
      }
    }
    for (unsigned int i = 0; i < n; ++i)
      parent.displacement[i] /= children_at[i / dim];
    return parent;
  }

  template <int dim>
  FamilyEnergy energy_of_family(const FiniteElement<dim, dim> &element,
                                const Family &family)
  {
    const ParentMotion parent = motion_of_parent<dim>(element, family);
    const auto n = unsigned(parent.momentum.size());
    double elastic = 0., elastic_after = 0., kinetic = 0.;
    Block mass(n, n); // of the parent: sum of P^T M P
    for (unsigned int c = 0; c < family.classes.size(); ++c) {
      const FullMatrix<double> &P = element.get_prolongation_matrix(c);
      const BodyClass &child = *family.classes[c];
      elastic += half_product(child.stiffness, family.displacement[c].data());
      elastic_after += half_product(
          child.stiffness,
          in_child<dim>(element, c, parent.displacement.data(), n).data());
      kinetic += half_product(child.mass, family.velocity[c]);
      for (unsigned int k = 0; k < n; ++k) {
        std::vector<double> column(n, 0.);
        column[k] = 1.;
        column = in_child<dim>(element, c, column.data(), n);
        for (unsigned int i = 0; i < n; ++i) {
          double Mx = 0.;
          for (unsigned int j = k % dim; j < n; j += dim)
            Mx += child.mass(i, j) * column[j];
          for (unsigned int l = i % dim; l < n; l += dim)
            mass(l, k) += P(i / dim, l / dim) * Mx;
        }
      }
    }
    Block momentum(n, 1);
    for (unsigned int i = 0; i < n; ++i)
      momentum(i, 0) = parent.momentum[i];
    const Block scaled = forward_solve(cholesky(mass), momentum);
    double kinetic_after = 0.;
    for (unsigned int i = 0; i < n; ++i)
      kinetic_after += scaled(i, 0) * scaled(i, 0) / 2.;
    return {kinetic + elastic, std::abs(kinetic_after - kinetic) +
                                   std::abs(elastic_after - elastic)};
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::vector<double> in_child(const FiniteElement<dim, dim> &,       \
                                        unsigned int, const double *,          \
                                        std::size_t);                          \
  template ParentMotion motion_of_parent(const FiniteElement<dim, dim> &,      \
                                         const Family &);                      \
  template FamilyEnergy energy_of_family(const FiniteElement<dim, dim> &,      \
                                         const Family &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
#undef NSFD_INSTANTIATE
} // namespace nsfd
