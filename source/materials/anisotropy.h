#pragma once

#include "nsfd/scene/material_input.h"

#include <array>
#include <string>

namespace nsfd
{
  /** Place of the components a, b in the order xx, yy, zz, xy, xz, yz. */
  constexpr unsigned int stress_place(const unsigned int a,
                                      const unsigned int b)
  {
    return a == b ? a : a + b + 2u;
  }

  /**
   * The rows are the axes 1, 2, 3 of the crystal in those of the scene: Bunge,
   * Texture analysis in materials science, 1982, section 2.1.2.
   */
  std::array<std::array<double, 3>, 3> crystal_axes(const EulerAngles &angles);

  /** The inverse; the rows are to be orthonormal and right-handed. */
  EulerAngles euler_angles(const std::array<std::array<double, 3>, 3> &axes);

  /** In the axes of the scene, from those of a crystal: C_ijkl = R_ia R_jb R_kc
      R_ld C_abcd. */
  HookeMatrix turned(const HookeMatrix &stiffness, const EulerAngles &angles);

  /** The inverse in the sense of tensors: eps_ij = S_ijkl sigma_kl. */
  HookeMatrix compliance_of(const HookeMatrix &stiffness);

  /** Positive definite. */
  bool is_stable(const HookeMatrix &stiffness);

  /** With all its extremes over directions. */
  AnisotropicInput anisotropic_of(const HookeMatrix &stiffness);

  /**
   * At a place, in a cell of this id. Not a number where there is none: a grain
   * that the table does not have, a formula that has no value.
   */
  EulerAngles orientation_at(const OrientationInput &orientation,
                             const std::array<double, 3> &x, unsigned int id);

  /** ", grains at random"; empty: the same all over. */
  std::string orientation_text(const OrientationInput &orientation);

  /** By the id of a cell. */
  unsigned int grain_number(const OrientationInput &orientation,
                            unsigned int id);
} // namespace nsfd
