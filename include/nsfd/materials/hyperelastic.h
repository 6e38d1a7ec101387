#pragma once

#include <array>
#include <memory>

namespace nsfd
{
  /**
   * The entries of a symmetric matrix, each once and as it stands in it: 11,
   * 22, 12 in the plane and 11, 22, 33, 12, 13, 23 in space.
   */
  template <int dim>
  using Voigt = std::array<double, dim *(dim + 1) / 2>;

  /**
   * Row-major: entry (i, j) is A_abcd for i = ab, j = cd of a tensor that is
   * symmetric in a, b and in c, d. An off-diagonal pair j counts twice in A:C.
   */
  template <int dim>
  using VoigtBlock =
      std::array<double, dim *(dim + 1) / 2 * (dim * (dim + 1) / 2)>;

  /** How often entry @p i stands in the matrix. */
  template <int dim>
  constexpr double voigt_weight(const unsigned int i)
  {
    return i < dim ? 1. : 2.;
  }

  /** Place of the entry in row @p a and column @p b. */
  template <int dim>
  constexpr unsigned int voigt_place(const unsigned int a, const unsigned int b)
  {
    return a == b ? a : dim == 2 ? 2u : a + b + 2u;
  }

  /** A:B = sum_ab A_ab B_ab. */
  template <int dim>
  double contract(const Voigt<dim> &A, const Voigt<dim> &B);

  double determinant(const Voigt<2> &A);
  double determinant(const Voigt<3> &A);

  /**
   * An energy of finite strain, in J per volume before deformation (area in
   * the plane), of C = F^T F. In the plane F33 = 1. Stresses are second
   * Piola-Kirchhoff ones, S = 2 dW/dC, in Pa. Where det C <= 0 the energy is
   * infinite and functions of stress return false.
   */
  template <int dim>
  class Hyperelastic
  {
  public:
    virtual ~Hyperelastic() = default;

    virtual double energy(const Voigt<dim> &C) const = 0;

    /** @p S and, if asked for, @p tangent = dS/dC. */
    virtual bool stress(const Voigt<dim> &C, Voigt<dim> &S,
                        VoigtBlock<dim> *tangent = nullptr) const = 0;

    /**
     * A mean stress of the way from @p C0 to @p C1, the same back, with
     * S:(C1 - C0) / 2 = W(C1) - W(C0) to round-off however near they are;
     * @p tangent = dS/dC1, for neo-Hooke without symmetry of pairs.
     */
    virtual bool average_stress(const Voigt<dim> &C0, const Voigt<dim> &C1,
                                Voigt<dim> &S,
                                VoigtBlock<dim> *tangent = nullptr) const = 0;

    /** lambda + 2 mu of small strain, Pa. */
    virtual double modulus() const = 0;
  };

  /**
   * The stress of a step with @p theta: the mean one and, for theta > 1/2,
   * (theta - 1/2) (S(C1) - S(C0)), whose work @p dissipated on the strain
   * dE = (C1 - C0) / 2 is not stored.
   */
  template <int dim>
  struct StepStress {
    Voigt<dim> S;
    VoigtBlock<dim> tangent; ///< dS/dC1, if asked for
    double dissipated = 0.;  ///< (theta - 1/2) dS:dE, J per volume
  };

  /** False where det C0 <= 0 or det C1 <= 0. */
  template <int dim>
  bool step_stress(const Hyperelastic<dim> &material, const Voigt<dim> &C0,
                   const Voigt<dim> &C1, double theta, bool with_tangent,
                   StepStress<dim> &result);

  /**
   * Saint-Venant Kirchhoff, W = lambda/2 (tr E)^2 + mu E:E with
   * E = (C - 1) / 2. Plane stress is for the plane: throws invalid_argument in
   * space.
   */
  template <int dim>
  std::unique_ptr<const Hyperelastic<dim>>
  make_saint_venant_kirchhoff(double young, double poisson, bool plane_stress);

  /**
   * Compressible neo-Hooke, W = mu/2 (tr C - dim - ln det C) +
   * lambda/8 (ln det C)^2. Not in plane stress.
   */
  template <int dim>
  std::unique_ptr<const Hyperelastic<dim>> make_neo_hooke(double young,
                                                          double poisson);
} // namespace nsfd
