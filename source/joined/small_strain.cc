#include "small_strain.h"

#include "discretization/cells.h"

#include <cmath>

namespace nsfd
{
  namespace
  {
    /** 2 eps, what histories of small strain know as C. */
    template <int dim>
    Voigt<dim> twice_strain(const finite::Matrix<dim> &H)
    {
      Voigt<dim> C;
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = a; b < dim; ++b)
          C[voigt_place<dim>(a, b)] = H[a * dim + b] + H[b * dim + a];
      return C;
    }

    template <int dim>
    finite::Matrix<dim> as_matrix(const Voigt<dim> &S)
    {
      finite::Matrix<dim> sigma;
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          sigma[a * dim + b] = S[voigt_place<dim>(a, b)];
      return sigma;
    }

    template <int dim, int sdim>
    finite::Matrix<sdim> elastic_stress(const LinearElasticity<dim> &law,
                                        const finite::Matrix<sdim> &H)
    {
      constexpr unsigned int at[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
      auto stress = law.stress(finite::in_plane<dim, sdim>(H).data());
      if (sdim > dim)
        law.add_hoop(H.back(), stress);
      finite::Matrix<sdim> sigma;
      for (unsigned int a = 0; a < sdim; ++a)
        for (unsigned int b = 0; b < sdim; ++b)
          sigma[a * sdim + b] = stress[at[a][b]];
      return sigma;
    }
  } // namespace

  template <int dim, int sdim>
  bool
  set_small_strain(const Discretization<dim> &discretization,
                   CellHistories<dim, sdim> &histories, const std::size_t cell,
                   const unsigned int q, const unsigned int n_same,
                   const finite::Matrix<sdim> &H, SmallStrain<sdim> &result)
  {
    if (histories.of(cell)) {
      typename CellHistories<dim, sdim>::Stress at;
      if (!histories.set_point(cell, q, n_same, twice_strain<sdim>(H), at))
        return false;
      result = {as_matrix<sdim>(at.S), at.energy, at.plastic, at.viscous};
      return true;
    }
    const auto &elasticity =
        discretization.cells().class_shape(cell).elasticity;
    result.sigma = elastic_stress<dim, sdim>(at_place(elasticity, q), H);
    result.energy = finite::product<sdim>(result.sigma, H) / 2.;
    return std::isfinite(result.energy);
  }

  template <int dim, int sdim>
  finite::Matrix<sdim>
  small_stress_beside(const Discretization<dim> &discretization,
                      const CellHistories<dim, sdim> &histories,
                      const std::size_t cell, const unsigned int q,
                      const unsigned int slot, const finite::Matrix<sdim> &H)
  {
    if (histories.of(cell)) {
      Voigt<sdim> S;
      return histories.beside(cell, q, twice_strain<sdim>(H), S)
                 ? as_matrix<sdim>(S)
                 : finite::Matrix<sdim>{};
    }
    const auto &shape = discretization.cells().class_shape(cell);
    const std::size_t at_slot = shape.JxW.size() + slot;
    return elastic_stress<dim, sdim>(
        at_place(shape.elasticity,
                 at_slot < shape.elasticity.size() ? at_slot : q),
        H);
  }

#define NSFD_INSTANTIATE(dim, sdim)                                            \
  template bool set_small_strain(                                              \
      const Discretization<dim> &, CellHistories<dim, sdim> &, std::size_t,    \
      unsigned int, unsigned int, const finite::Matrix<sdim> &,                \
      SmallStrain<sdim> &);                                                    \
  template finite::Matrix<sdim> small_stress_beside(                           \
      const Discretization<dim> &, const CellHistories<dim, sdim> &,           \
      std::size_t, unsigned int, unsigned int, const finite::Matrix<sdim> &)
  NSFD_INSTANTIATE(2, 2);
  NSFD_INSTANTIATE(2, 3);
  NSFD_INSTANTIATE(3, 3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
