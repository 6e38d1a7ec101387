#include "constant_strain.h"

#include "core/instruction_sets.h"
#include "core/vector8.h"
#include "discretization/cells.h"
#include "linear_algebra/block_kernels.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /// numbers of Hooke's law: lambda and mu, or the upper half of its matrix
    template <int dim, bool isotropic>
    constexpr unsigned int n_moduli = isotropic
                                          ? 2
                                          : (dim *(dim + 1) / 2) *
                                                (dim * (dim + 1) / 2 + 1) / 2;

    template <int dim, bool isotropic>
    constexpr unsigned int per_cell = dim *dim + 1 + n_moduli<dim, isotropic>;

    /** Index of sigma_ab among the components that are kept. */
    constexpr unsigned int component(const unsigned int dim,
                                     const unsigned int a, const unsigned int b)
    {
      return a == b ? a : dim == 2 ? 2u : a + b + 2u; // xy, xz, yz
    }

    NSFD_INLINE const Vector8u &row(const double *values, const unsigned int k)
    {
      return reinterpret_cast<const Vector8u *>(values)[k];
    }

    /** Of one block: gradients from the displacements of its corners. */
    template <int dim>
    NSFD_INLINE void gradient_block(const double *cells, const unsigned int *of,
                                    const double *q, Vector8 (*H)[dim])
    {
      Vector8 u[dim + 1][dim];
      for (unsigned int i = 0; i <= dim; ++i) {
        const double *at[lanes];
        for (unsigned int l = 0; l < lanes; ++l)
          at[l] = q + std::size_t(of[l * (dim + 1) + i]) * dim;
        for (unsigned int c = 0; c < dim; ++c)
          u[i][c] = Vector8{at[0][c], at[1][c], at[2][c], at[3][c],
                            at[4][c], at[5][c], at[6][c], at[7][c]};
      }
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d) {
          H[c][d] = (u[1][c] - u[0][c]) * row(cells, d);
          for (unsigned int i = 2; i <= dim; ++i)
            H[c][d] += (u[i][c] - u[0][c]) * row(cells, (i - 1) * dim + d);
        }
    }

    /** Stresses by lambda and mu. */
    template <int dim>
    NSFD_INLINE void isotropic_block(const double *cells,
                                     const Vector8 (*H)[dim], Vector8 *stresses)
    {
      const Vector8 lambda = row(cells, dim * dim + 1),
                    mu = row(cells, dim * dim + 2);
      Vector8 trace = H[0][0];
      for (unsigned int a = 1; a < dim; ++a)
        trace += H[a][a];
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = a; b < dim; ++b) {
          Vector8 &sigma = stresses[component(dim, a, b)];
          sigma = mu * (H[a][b] + H[b][a]);
          if (a == b)
            sigma += lambda * trace;
        }
    }

    /** Stresses by Hooke's matrix. */
    template <int dim>
    NSFD_INLINE void matrix_block(const double *cells, const Vector8 (*H)[dim],
                                  Vector8 *stresses)
    {
      constexpr unsigned int n = dim * (dim + 1) / 2;
      Vector8 strain[n]; // shear twice, as it stands twice in C : eps
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = a; b < dim; ++b)
          strain[component(dim, a, b)] = a == b ? H[a][a] : H[a][b] + H[b][a];
      unsigned int k = dim * dim + 1;
      for (unsigned int s = 0; s < n; ++s)
        stresses[s] = Vector8{};
      for (unsigned int s = 0; s < n; ++s)
        for (unsigned int t = s; t < n; ++t) {
          const Vector8 C = row(cells, k++);
          stresses[s] += C * strain[t];
          if (t != s)
            stresses[t] += C * strain[s];
        }
    }

    /** tr eps. */
    template <int dim>
    NSFD_INLINE void dilatation_block(const double *cells,
                                      const Vector8 *stresses, Vector8 &result)
    {
      const Vector8 lambda = row(cells, dim * dim + 1),
                    mu = row(cells, dim * dim + 2), zero = {};
      Vector8 trace = stresses[0];
      for (unsigned int a = 1; a < dim; ++a)
        trace += stresses[a];
      const Vector8 stiffness = dim * lambda + 2. * mu;
      result = mu > 0. ? trace / (mu > 0. ? stiffness : zero + 1.) : zero;
    }

    /** The largest sigma : sigma of the lanes. */
    template <int dim>
    NSFD_INLINE double peak_of_block(const Vector8 *stresses)
    {
      Vector8 square = stresses[0] * stresses[0];
      for (unsigned int s = 1; s < dim * (dim + 1) / 2; ++s)
        square += (s < dim ? 1. : 2.) * stresses[s] * stresses[s];
      double peak = square[0];
      for (unsigned int l = 1; l < lanes; ++l)
        peak = square[l] > peak ? square[l] : peak;
      return peak;
    }

    /** -volume sigma grad N_i of its corners. */
    template <int dim>
    NSFD_INLINE void force_block(const double *cells, const Vector8 *sigma,
                                 Vector8 (*F)[dim])
    {
      const Vector8 volume = row(cells, dim * dim);
      for (unsigned int c = 0; c < dim; ++c) {
        F[0][c] = Vector8{};
        for (unsigned int i = 1; i <= dim; ++i) {
          Vector8 sum = sigma[component(dim, 0, c)] * row(cells, (i - 1) * dim);
          for (unsigned int d = 1; d < dim; ++d)
            sum += sigma[component(dim, c < d ? c : d, c < d ? d : c)] *
                   row(cells, (i - 1) * dim + d);
          F[i][c] = -volume * sum;
          F[0][c] -= F[i][c];
        }
      }
    }

    template <int dim, bool isotropic>
    NSFD_INLINE void set_all(const std::size_t n_cells, const double *cells,
                             const unsigned int *of, const double *q,
                             double *stresses, double *peaks, double *f,
                             FrontViscosity *front)
    {
      constexpr unsigned int n_corners = dim + 1,
                             n_stresses = dim * (dim + 1) / 2;
      for (std::size_t first = 0; first < n_cells; first += lanes) {
        const std::size_t block = first / lanes;
        const double *mine = cells + block * per_cell<dim, isotropic> * lanes;
        const unsigned int *corners = of + first * n_corners;
        unsigned int last[n_corners * lanes];
        const auto count =
            unsigned(n_cells - first < lanes ? n_cells - first : lanes);
        if (count < lanes) { // corners beyond the last cell: those of it
          for (unsigned int k = 0; k < n_corners * lanes; ++k)
            last[k] = corners[k < n_corners * count ? k : k % n_corners];
          corners = last;
        }
        Vector8 H[dim][dim], sigma[n_stresses], F[n_corners][dim];
        gradient_block<dim>(mine, corners, q, H);
        if constexpr (isotropic)
          isotropic_block<dim>(mine, H, sigma);
        else
          matrix_block<dim>(mine, H, sigma);
        for (unsigned int s = 0; s < n_stresses; ++s)
          reinterpret_cast<Vector8u *>(stresses)[block * n_stresses + s] =
              sigma[s];
        peaks[block] = peak_of_block<dim>(sigma);
        if (front) {
          Vector8 now;
          if constexpr (isotropic)
            dilatation_block<dim>(mine, sigma, now);
          else {
            now = H[0][0];
            for (unsigned int a = 1; a < dim; ++a)
              now += H[a][a];
          }
          const Vector8 volume = row(mine, dim * dim);
          Vector8 tension;
          front->update_block(first, count, now, volume);
          FrontViscosity::get(&front->tension[first], count, tension);
          for (unsigned int a = 0; a < dim; ++a)
            sigma[a] += tension;
        }
        force_block<dim>(mine, sigma, F);
        for (unsigned int l = 0; l < count; ++l)
          for (unsigned int i = 0; i < n_corners; ++i)
            for (unsigned int c = 0; c < dim; ++c)
              f[std::size_t(corners[l * n_corners + i]) * dim + c] +=
                  F[i][c][l];
      }
    }

    NSFD_CLONES
    void set_plane(const std::size_t n, const double *cells,
                   const unsigned int *of, const double *q, double *stresses,
                   double *peaks, double *f, FrontViscosity *front)
    {
      set_all<2, true>(n, cells, of, q, stresses, peaks, f, front);
    }

    NSFD_CLONES
    void set_space(const std::size_t n, const double *cells,
                   const unsigned int *of, const double *q, double *stresses,
                   double *peaks, double *f, FrontViscosity *front)
    {
      set_all<3, true>(n, cells, of, q, stresses, peaks, f, front);
    }

    NSFD_CLONES
    void set_crystals_plane(const std::size_t n, const double *cells,
                            const unsigned int *of, const double *q,
                            double *stresses, double *peaks, double *f,
                            FrontViscosity *front)
    {
      set_all<2, false>(n, cells, of, q, stresses, peaks, f, front);
    }

    NSFD_CLONES
    void set_crystals_space(const std::size_t n, const double *cells,
                            const unsigned int *of, const double *q,
                            double *stresses, double *peaks, double *f,
                            FrontViscosity *front)
    {
      set_all<3, false>(n, cells, of, q, stresses, peaks, f, front);
    }

    /** Numbers of a cell in cells_. */
    template <int dim>
    constexpr std::size_t numbers_of_cell(const bool isotropic)
    {
      return isotropic ? per_cell<dim, true> : per_cell<dim, false>;
    }

    /** Those of Hooke's law, each @p lanes behind the last one. */
    template <int dim>
    void store_moduli(const LinearElasticity<dim> &law, const bool isotropic,
                      double *to)
    {
      if (isotropic) {
        to[0] = law.lambda;
        to[lanes] = law.mu;
        return;
      }
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = a; b < dim; ++b)
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int d = c; d < dim; ++d) {
              const unsigned int s = component(dim, a, b),
                                 t = component(dim, c, d),
                                 n = dim * (dim + 1) / 2;
              if (s <= t) // s rows of n, n - 1, ... entries before
                to[(s * n - s * (s + 1) / 2 + t) * lanes] =
                    law.modulus(a, b, c, d);
            }
    }
  } // namespace

  template <int dim>
  bool
  ConstantStrainForces<dim>::fits(const Discretization<dim> &discretization)
  {
    const Cells<dim> &cells = discretization.cells();
    for (std::size_t k = 0; k < cells.shapes.size(); ++k) {
      const BodyClass &body = cells.bodies.classes[k];
      const MaterialInput &material =
          discretization.input().materials[body.material];
      if (!cells.shapes[k].reference.is_simplex() ||
          cells.shapes[k].n_nodes != dim + 1 || material.varies_in_cells())
        return false;
    }
    return true;
  }

  template <int dim>
  ConstantStrainForces<dim>::ConstantStrainForces(
      const Discretization<dim> &discretization, FrontViscosity front)
      : CellForces<dim>(std::move(front)),
        n_cells_(discretization.bodies().size())
  {
    const Cells<dim> &cells = discretization.cells();
    const auto &materials = discretization.input().materials;
    isotropic_ = std::all_of(
        materials.begin(), materials.end(),
        [](const MaterialInput &material) { return material.is_isotropic(); });
    const std::size_t n_blocks = (n_cells_ + lanes - 1) / lanes,
                      n_numbers = numbers_of_cell<dim>(isotropic_);
    cells_.assign(n_blocks * n_numbers * lanes, 0.);
    stresses_.assign(n_blocks * n_stresses * lanes, 0.);
    peaks_.assign(n_blocks, 0.);
    for (std::size_t b = 0; b < n_cells_; ++b) {
      const auto of_body = cells.shape(b);
      const BodyShape<dim> &shape = *of_body;
      double *mine =
          cells_.data() + (b / lanes) * n_numbers * lanes + b % lanes;
      for (unsigned int i = 1; i <= dim; ++i)
        for (unsigned int d = 0; d < dim; ++d)
          mine[((i - 1) * dim + d) * lanes] = shape.gradients[i][d];
      mine[dim * dim * lanes] = shape.volume;
      if (shape.elasticity.empty())
        continue; // rigid: no stress
      store_moduli(shape.elasticity[0], isotropic_,
                   mine + (dim * dim + 1) * lanes);
    }
  }

  template <int dim>
  void ConstantStrainForces<dim>::set_forces(CornerGroups<dim> &groups)
  {
    std::fill(groups.force.begin(), groups.force.end(), 0.);
    (dim == 2     ? isotropic_ ? set_plane : set_crystals_plane
     : isotropic_ ? set_space
                  : set_crystals_space)(
        n_cells_, cells_.data(), groups.of_corners().data(),
        groups.displacement.data(), stresses_.data(), peaks_.data(),
        groups.force.data(), this->front_.acts() ? &this->front_ : nullptr);
  }

  template <int dim>
  std::array<double, dim>
  ConstantStrainForces<dim>::corner_force(const std::size_t corner,
                                          const CornerGroups<dim> &) const
  {
    // the same operations as force_block() has for this lane, and their bits
    const std::size_t cell = corner / (dim + 1), block = cell / lanes,
                      lane = cell % lanes;
    const auto i = unsigned(corner % (dim + 1));
    const double *mine =
        cells_.data() + block * numbers_of_cell<dim>(isotropic_) * lanes + lane;
    const double *elastic =
        stresses_.data() + block * n_stresses * lanes + lane;
    const double tension =
        this->front_.acts() ? this->front_.tension[cell] : 0.;
    const auto stress = [&](const unsigned int a, const unsigned int b) {
      const unsigned int s = component(dim, std::min(a, b), std::max(a, b));
      return elastic[s * lanes] + (a == b ? tension : 0.);
    };
    const double volume = mine[dim * dim * lanes];
    std::array<double, dim> force{};
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int j = i == 0 ? 1 : i; j <= (i == 0 ? dim : i); ++j) {
        double sum = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          sum += stress(c, d) * mine[((j - 1) * dim + d) * lanes];
        force[c] = i == 0 ? force[c] + volume * sum : -volume * sum;
      }
    return force;
  }

  template <int dim>
  void ConstantStrainForces<dim>::squared_tractions(
      const StrengthSites<dim> &sites,
      typename StrengthSites<dim>::Near &near) const
  {
    static_assert(lanes == StrengthSites<dim>::cells_of_block,
                  "bounds are of blocks of lanes");
    // |(sigma_1 + sigma_2) n / 2| is not above either norm's largest
    sites.find(peaks_, near);
    for (std::size_t n = 0; n < near.site.size(); ++n) {
      const std::size_t k = near.site[n];
      const auto &cells = sites[k].cells;
      const double *one = stresses_.data() +
                          (cells[0] / lanes) * n_stresses * lanes +
                          cells[0] % lanes,
                   *two = stresses_.data() +
                          (cells[1] / lanes) * n_stresses * lanes +
                          cells[1] % lanes;
      double sigma[n_stresses];
      for (unsigned int s = 0; s < n_stresses; ++s)
        sigma[s] = (one[s * lanes] + two[s * lanes]) / 2.;
      const double *const normal = sites.normal(k);
      std::array<double, dim> t{};
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          t[a] +=
              sigma[component(dim, std::min(a, b), std::max(a, b))] * normal[b];
      near.square[n] = sites.square(k, t);
    }
  }

  template <int dim>
  std::array<double, dim>
  ConstantStrainForces<dim>::traction(const StrengthSites<dim> &sites,
                                      const std::size_t site) const
  {
    std::array<double, dim> result{};
    for (const unsigned int cell : sites[site].cells) {
      const double *sigma =
          stresses_.data() + (cell / lanes) * n_stresses * lanes + cell % lanes;
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          result[a] +=
              sigma[component(dim, std::min(a, b), std::max(a, b)) * lanes] *
              sites.normal(site)[b] / 2.;
    }
    return result;
  }

  template class ConstantStrainForces<2>;
  template class ConstantStrainForces<3>;
} // namespace nsfd
