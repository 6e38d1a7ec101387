#include "constant_strain.h"

#include "core/instruction_sets.h"
#include "discretization/cells.h"
#include "linear_algebra/block_kernels.h"
#include "nsfd/scene/scene_input.h"

namespace nsfd
{
  namespace
  {
    template <int dim>
    constexpr unsigned int per_cell = dim *dim + 3;

    /** Index of sigma_ab among the components that are kept. */
    constexpr unsigned int component(const unsigned int dim,
                                     const unsigned int a, const unsigned int b)
    {
      return a == b ? a : dim == 2 ? 2u : a + b + 2u; // xy, xz, yz
    }

    /** Of one block: stresses from the displacements of its corners. */
    template <int dim>
    NSFD_INLINE void strain_block(const double *cells, const unsigned int *of,
                                  const double *q, double *stresses)
    {
      double u[dim + 1][dim][lanes];
      for (unsigned int l = 0; l < lanes; ++l)
        for (unsigned int i = 0; i <= dim; ++i)
          for (unsigned int c = 0; c < dim; ++c)
            u[i][c][l] = q[std::size_t(of[l * (dim + 1) + i]) * dim + c];
      double H[dim][dim][lanes];
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int l = 0; l < lanes; ++l) {
            double sum = 0.;
            for (unsigned int i = 1; i <= dim; ++i)
              sum += (u[i][c][l] - u[0][c][l]) *
                     cells[((i - 1) * dim + d) * lanes + l];
            H[c][d][l] = sum;
          }
      const double *lambda = cells + (dim * dim + 1) * lanes,
                   *mu = lambda + lanes;
      for (unsigned int l = 0; l < lanes; ++l) {
        double trace = 0.;
        for (unsigned int a = 0; a < dim; ++a)
          trace += H[a][a][l];
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = a; b < dim; ++b)
            stresses[component(dim, a, b) * lanes + l] =
                mu[l] * (H[a][b][l] + H[b][a][l]) +
                (a == b ? lambda[l] * trace : 0.);
      }
    }

    /** tr eps of all lanes. */
    template <int dim>
    NSFD_INLINE void dilatation_block(const double *cells,
                                      const double *stresses, double *result)
    {
      const double *lambda = cells + (dim * dim + 1) * lanes,
                   *mu = lambda + lanes;
      double trace[lanes] = {};
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int l = 0; l < lanes; ++l)
          trace[l] += stresses[a * lanes + l];
      for (unsigned int l = 0; l < lanes; ++l)
        result[l] = mu[l] > 0. ? trace[l] / (dim * lambda[l] + 2. * mu[l]) : 0.;
    }

    /** The largest sigma : sigma of the lanes. */
    template <int dim>
    NSFD_INLINE double peak_of_block(const double *stresses)
    {
      double square[lanes] = {};
      for (unsigned int s = 0; s < dim * (dim + 1) / 2; ++s)
        for (unsigned int l = 0; l < lanes; ++l)
          square[l] += (s < dim ? 1. : 2.) * stresses[s * lanes + l] *
                       stresses[s * lanes + l];
      double peak = 0.;
      for (unsigned int l = 0; l < lanes; ++l)
        peak = square[l] > peak ? square[l] : peak;
      return peak;
    }

    /** -volume sigma grad N_i of its corners. */
    template <int dim>
    NSFD_INLINE void force_block(const double *cells, const double *elastic,
                                 const double *tension, double (*F)[dim][lanes])
    {
      const double *volume = cells + dim * dim * lanes;
      double stresses[dim * (dim + 1) / 2 * lanes];
      for (unsigned int s = 0; s < dim * (dim + 1) / 2; ++s)
        for (unsigned int l = 0; l < lanes; ++l)
          stresses[s * lanes + l] =
              elastic[s * lanes + l] + (s < dim && tension ? tension[l] : 0.);
      for (unsigned int c = 0; c < dim; ++c) {
        for (unsigned int l = 0; l < lanes; ++l)
          F[0][c][l] = 0.;
        for (unsigned int i = 1; i <= dim; ++i)
          for (unsigned int l = 0; l < lanes; ++l) {
            double sum = 0.;
            for (unsigned int d = 0; d < dim; ++d)
              sum += stresses[component(dim, c < d ? c : d, c < d ? d : c) *
                                  lanes +
                              l] *
                     cells[((i - 1) * dim + d) * lanes + l];
            F[i][c][l] = -volume[l] * sum;
            F[0][c][l] += volume[l] * sum;
          }
      }
    }

    template <int dim>
    NSFD_INLINE void set_all(const std::size_t n_cells, const double *cells,
                             const unsigned int *of, const double *q,
                             double *stresses, double *peaks, double *f,
                             FrontViscosity *front)
    {
      constexpr unsigned int n_corners = dim + 1,
                             n_stresses = dim * (dim + 1) / 2;
      double F[n_corners][dim][lanes];
      for (std::size_t first = 0; first < n_cells; first += lanes) {
        const std::size_t block = first / lanes;
        const double *mine = cells + block * per_cell<dim> * lanes;
        double *sigma = stresses + block * n_stresses * lanes;
        const unsigned int *corners = of + first * n_corners;
        unsigned int last[n_corners * lanes];
        const auto count =
            unsigned(n_cells - first < lanes ? n_cells - first : lanes);
        if (count < lanes) { // corners beyond the last cell: those of it
          for (unsigned int k = 0; k < n_corners * lanes; ++k)
            last[k] = corners[k < n_corners * count ? k : k % n_corners];
          strain_block<dim>(mine, last, q, sigma);
        } else
          strain_block<dim>(mine, corners, q, sigma);
        peaks[block] = peak_of_block<dim>(sigma);
        double tension[lanes] = {};
        if (front) {
          double now[lanes];
          dilatation_block<dim>(mine, sigma, now);
          const double *volume = mine + dim * dim * lanes;
          if (count == lanes)
            front->update_block<lanes>(first, now, volume);
          else
            for (unsigned int l = 0; l < count; ++l)
              front->update(first + l, now[l], volume[l]);
          for (unsigned int l = 0; l < count; ++l)
            tension[l] = front->tension[first + l];
        }
        force_block<dim>(mine, sigma, front ? tension : nullptr, F);
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
      set_all<2>(n, cells, of, q, stresses, peaks, f, front);
    }

    NSFD_CLONES
    void set_space(const std::size_t n, const double *cells,
                   const unsigned int *of, const double *q, double *stresses,
                   double *peaks, double *f, FrontViscosity *front)
    {
      set_all<3>(n, cells, of, q, stresses, peaks, f, front);
    }

    template <int dim>
    NSFD_INLINE void square_all(const StrengthSites &sites,
                                const double *stresses, const double *peaks,
                                double *squares)
    {
      constexpr unsigned int n_stresses = dim * (dim + 1) / 2;
      constexpr double quiet =
          StrengthSites::looked_at * StrengthSites::looked_at;
      const double *least = sites.least.data();
      const std::size_t n = sites.size();
      const auto *cells = sites.cells.data();
      const double *normals = sites.normal.data(),
                   *weights = sites.shear_weight.data();
      for (std::size_t k = 0; k < n; ++k) {
        // |(sigma_1 + sigma_2) n / 2| is not above either norm's largest
        const double peak_1 = peaks[cells[k][0] / lanes],
                     peak_2 = peaks[cells[k][1] / lanes];
        if ((peak_1 > peak_2 ? peak_1 : peak_2) < quiet * least[k]) {
          squares[k] = 0.;
          continue;
        }
        double sigma[n_stresses];
        const double *one = stresses +
                            (cells[k][0] / lanes) * n_stresses * lanes +
                            cells[k][0] % lanes,
                     *two = stresses +
                            (cells[k][1] / lanes) * n_stresses * lanes +
                            cells[k][1] % lanes;
        for (unsigned int s = 0; s < n_stresses; ++s)
          sigma[s] = (one[s * lanes] + two[s * lanes]) / 2.;
        const double *n_k = normals + k * dim;
        double square = 0., pull = 0.;
        for (unsigned int a = 0; a < dim; ++a) {
          double t = 0.;
          for (unsigned int b = 0; b < dim; ++b)
            t += sigma[component(dim, a < b ? a : b, a < b ? b : a)] * n_k[b];
          square += t * t;
          pull += t * n_k[a];
        }
        const double shear = square - pull * pull;
        squares[k] = (pull > 0. ? pull * pull : 0.) + weights[k] * shear;
      }
    }

    NSFD_CLONES
    void square_plane(const StrengthSites &sites, const double *stresses,
                      const double *peaks, double *squares)
    {
      square_all<2>(sites, stresses, peaks, squares);
    }

    NSFD_CLONES
    void square_space(const StrengthSites &sites, const double *stresses,
                      const double *peaks, double *squares)
    {
      square_all<3>(sites, stresses, peaks, squares);
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
          cells.shapes[k].n_nodes != dim + 1 || material.transverse ||
          material.graded)
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
    const std::size_t n_blocks = (n_cells_ + lanes - 1) / lanes;
    cells_.assign(n_blocks * per_cell<dim> * lanes, 0.);
    stresses_.assign(n_blocks * n_stresses * lanes, 0.);
    peaks_.assign(n_blocks, 0.);
    for (std::size_t b = 0; b < n_cells_; ++b) {
      const auto of_body = cells.shape(b);
      const BodyShape<dim> &shape = *of_body;
      double *mine =
          cells_.data() + (b / lanes) * per_cell<dim> * lanes + b % lanes;
      for (unsigned int i = 1; i <= dim; ++i)
        for (unsigned int d = 0; d < dim; ++d)
          mine[((i - 1) * dim + d) * lanes] = shape.gradients[i][d];
      mine[dim * dim * lanes] = shape.volume;
      if (shape.elasticity.empty())
        continue; // rigid: no stress
      mine[(dim * dim + 1) * lanes] = shape.elasticity[0].lambda;
      mine[(dim * dim + 2) * lanes] = shape.elasticity[0].mu;
    }
  }

  template <int dim>
  void ConstantStrainForces<dim>::set_forces(CornerGroups<dim> &groups)
  {
    std::fill(groups.force.begin(), groups.force.end(), 0.);
    (dim == 2 ? set_plane : set_space)(
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
    const double *mine = cells_.data() + block * per_cell<dim> * lanes + lane;
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
      const StrengthSites &sites, std::vector<double> &squares) const
  {
    squares.resize(sites.size());
    (dim == 2 ? square_plane : square_space)(sites, stresses_.data(),
                                             peaks_.data(), squares.data());
  }

  template <int dim>
  std::array<double, dim>
  ConstantStrainForces<dim>::traction(const StrengthSites &sites,
                                      const std::size_t site) const
  {
    std::array<double, dim> result{};
    for (const unsigned int cell : sites.cells[site]) {
      const double *sigma =
          stresses_.data() + (cell / lanes) * n_stresses * lanes + cell % lanes;
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          result[a] +=
              sigma[component(dim, std::min(a, b), std::max(a, b)) * lanes] *
              sites.normal[site * dim + b] / 2.;
    }
    return result;
  }

  template class ConstantStrainForces<2>;
  template class ConstantStrainForces<3>;
} // namespace nsfd
