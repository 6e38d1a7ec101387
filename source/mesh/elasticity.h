#pragma once

#include <array>

namespace nsfd
{
  struct MaterialInput;

  /** Isotropic linear elasticity: plane strain or stress, or in space. */
  template <int dim>
  class LinearElasticity
  {
  public:
    /** @p plane_stress counts in two dimensions only. */
    LinearElasticity(const MaterialInput &material, bool plane_stress);

    double lambda, mu; ///< as they act in the plane

    /** xx, yy, zz, xy, xz, yz from a gradient [component][direction]. */
    std::array<double, 6> stress(const double *gradient) const;

    double pressure_wave_speed() const;
    double shear_wave_speed() const;

  private:
    double young_, poisson_, density_;
    bool plane_stress_;
  };

  /** sigma n, sigma as xx, yy, zz, xy, xz, yz. */
  template <int dim>
  std::array<double, dim> traction_on(const std::array<double, 6> &stress,
                                      const double *normal)
  {
    constexpr unsigned int at[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    std::array<double, dim> result{};
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int d = 0; d < dim; ++d)
        result[c] += stress[at[c][d]] * normal[d];
    return result;
  }
} // namespace nsfd
