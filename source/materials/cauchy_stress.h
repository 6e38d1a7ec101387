#pragma once

#include <array>

namespace nsfd
{
  struct MaterialInput;

  /**
   * sigma = F S F^T / det F of a material with finite strain, as xx, yy, zz,
   * xy, xz, yz in Pa, from the displacement gradient [component][direction];
   * zeros where det F <= 0. In plane stress the change of thickness is left
   * out.
   */
  template <int dim>
  std::array<double, 6> cauchy_stress(const MaterialInput &material,
                                      bool plane_stress,
                                      const double *gradient);
} // namespace nsfd
