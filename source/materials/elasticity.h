#pragma once

#include "material_extremes.h"

#include <deal.II/base/point.h>

#include <array>
#include <memory>

namespace nsfd
{
  struct AnisotropicInput;
  struct MaterialInput;

  /** What a material that may vary is at one place. */
  struct LocalModuli {
    double young = 0., poisson = 0., density = 0.;
    std::array<double, 3> orientation{}; ///< EulerAngles of an anisotropic one

    bool operator==(const LocalModuli &other) const
    {
      return young == other.young && poisson == other.poisson &&
             density == other.density && orientation == other.orientation;
    }
  };

  /** At the place @p x, in a cell of this id (see GrainTable). */
  template <int dim>
  LocalModuli local_moduli(const MaterialInput &material,
                           const dealii::Point<dim> &x, unsigned int id);
  /** All over, of a material that does not vary. */
  LocalModuli local_moduli(const MaterialInput &material);

  /**
   * Linear elasticity: plane strain or stress, or in space. Isotropic; or
   * transversely isotropic about an axis a of length 1,
   *
   *     sigma = lambda tr(e) 1 + 2 mu e + alpha (a.ea 1 + tr(e) aa)
   *             + 2 delta (a ea + ea a) + beta (a.ea) aa
   *
   * (Spencer, Deformations of fibre-reinforced materials, 1972), mu the shear
   * modulus across the axis and mu + delta along it. In plane problems these
   * are the components in the plane; an axis normal to it leaves an isotropic
   * plane. Or of any symmetry, by Hooke's matrix: in plane strain its part of
   * the plane, in plane stress what is left of it where the stresses zz, xz, yz
   * are zero; lambda and mu are then the means over all directions (Voigt).
   */
  template <int dim>
  class LinearElasticity
  {
  public:
    /** @p plane_stress counts in two dimensions only. */
    LinearElasticity(const MaterialInput &material, bool plane_stress);
    LinearElasticity(const MaterialInput &material, const LocalModuli &local,
                     bool plane_stress);
    /** The viscous stress of rates: lambda = zeta - 2/3 eta, mu = eta. */
    static LinearElasticity viscous(const MaterialInput &material);

    double lambda, mu; ///< as they act in the plane

    /** g_k C_ckdl h_l: row c, column d for the gradients g and h. */
    template <typename Vector>
    double coupling(const unsigned int c, const unsigned int d, const Vector &g,
                    const Vector &h) const
    {
      const double value = lambda * g[c] * h[d] + mu * g[d] * h[c] +
                           (c == d ? mu * (g * h) : 0.);
      return symmetry_ == Symmetry::isotropic ? value
             : symmetry_ == Symmetry::axial ? value + axis_coupling(c, d, g, h)
                                            : matrix_coupling(c, d, g, h);
    }

    /** C_abcd; lambda and mu say it all where it is isotropic. */
    double modulus(unsigned int a, unsigned int b, unsigned int c,
                   unsigned int d) const;
    bool is_isotropic() const { return symmetry_ == Symmetry::isotropic; }

    /** xx, yy, zz, xy, xz, yz from a gradient [component][direction]. */
    std::array<double, 6> stress(const double *gradient) const;

    /** What a strain along zz, which is 0 in the plane, adds to the @p stress
        of an isotropic material: that along the hoops of a ring. */
    void add_hoop(double strain, std::array<double, 6> &stress) const;

    /** Of the fastest and of the slowest plane wave, in any direction. */
    double pressure_wave_speed() const { return speeds_[1]; }
    double shear_wave_speed() const { return speeds_[0]; }

    /** Of one place. */
    MaterialExtremes extremes() const;

  private:
    LinearElasticity() = default;
    void set_isotropic(double young, double poisson);
    void set_transverse(const MaterialInput &material);
    void set_speeds_about_axis();
    void set_matrix(const AnisotropicInput &input,
                    const std::array<double, 3> &orientation);
    void set_speeds_in_plane();

    template <typename Vector>
    double axis_coupling(const unsigned int c, const unsigned int d,
                         const Vector &g, const Vector &h) const
    {
      const double ag = axis_ * g, ah = axis_ * h, aa = axis_[c] * axis_[d];
      return alpha_ * (g[c] * axis_[d] * ah + axis_[c] * ag * h[d]) +
             delta_ * (axis_[c] * ah * g[d] + aa * (g * h) +
                       (c == d ? ag * ah : 0.) + ag * axis_[d] * h[c]) +
             beta_ * aa * ag * ah;
    }

    /** Rows of Hooke's matrix: xx, yy(, zz), xy(, xz, yz). */
    static constexpr unsigned int place(const unsigned int a,
                                        const unsigned int b)
    {
      return a == b ? a : dim == 2 ? 2u : a + b + 2u;
    }

    template <typename Vector>
    double matrix_coupling(const unsigned int c, const unsigned int d,
                           const Vector &g, const Vector &h) const
    {
      double sum = 0.;
      for (unsigned int k = 0; k < dim; ++k) {
        const auto &row = matrix_->C[place(c, k)];
        double of_row = 0.;
        for (unsigned int l = 0; l < dim; ++l)
          of_row += row[place(d, l)] * h[l];
        sum += g[k] * of_row;
      }
      return sum;
    }

    enum class Symmetry { isotropic, axial, none };
    static constexpr unsigned int n_strains = dim * (dim + 1) / 2;
    struct Matrix {
      std::array<std::array<double, n_strains>, n_strains> C;
      std::array<double, n_strains> across; ///< of sigma_zz in plane strain
    };

    bool plane_stress_ = false;
    Symmetry symmetry_ = Symmetry::isotropic;
    double lambda_zz_ = 0.; ///< of sigma_zz in plane strain
    double alpha_ = 0., delta_ = 0., beta_ = 0.;
    dealii::Tensor<1, dim> axis_;
    std::shared_ptr<const Matrix> matrix_; ///< of Symmetry::none
    double density_ = 0.;
    std::array<double, 2> speeds_{}; ///< slowest, fastest
    MaterialExtremes::Moduli stiffest_, softest_;
  };

  /** Of more than one place; @p all starts empty. */
  void widen(const MaterialExtremes &one, MaterialExtremes &all);

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
