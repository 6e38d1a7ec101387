#pragma once

#include "nsfd/verification/case_input.h"

namespace nsfd::cases
{
  /**
   * A straight fibre along x, pulled out of a rigid matrix at its left end. In
   * the plane it is a strip: its upper half stands on y = 0, where the matrix
   * is, and the top of the mesh is its line of symmetry. What the matrix does
   * to a round fibre by 2/r, perimeter over section, it does to the strip by
   * 1/w, w half of its thickness; with w = r/2 all formulas give the same.
   */
  struct PulledFibre {
    double half_thickness = 0., length = 0., young = 0.;

    explicit PulledFibre(const SceneInput &input)
    {
      demand_box(input);
      demand(
          input.dimension == 2 && input.mesh.lower[0] == 0. &&
              input.mesh.upper[1] > 0.,
          "the case needs a strip that begins at x = 0 and lies above y = 0");
      demand(input.statics && input.statics->steps,
             "the case needs `scheme = quasi-static`");
      half_thickness = input.mesh.upper[1];
      length = input.mesh.upper[0];
      const MaterialInput &fibre =
          material_at(input, {{0.5 * length, 0.5 * half_thickness, 0.}});
      demand(!fibre.rigid && fibre.poisson == 0.,
             "the fibre must be elastic, with `Poisson ratio = 0`");
      young = fibre.young;
    }
  };

  /** Mean errors of the cells of a fibre, relative to the mean exact values. */
  struct FibreErrors {
    double displacement = 0., stress = 0.;
  };

  /**
   * @param u, sigma: exact mean displacement along x and stress at a place, of
   * a strip that is pulled to the left
   */
  template <class Displacement, class Stress>
  FibreErrors fibre_errors(const std::vector<CellState> &cells,
                           const Displacement &u, const Stress &sigma)
  {
    double u_error = 0., u_sum = 0., stress_error = 0., stress_sum = 0.;
    for (const CellState &cell : cells) {
      const double x = cell.centre[0];
      if (cell.centre[1] < 0.)
        continue; // the matrix
      u_error += cell.volume * std::abs(-cell.displacement[0] - u(x));
      u_sum += cell.volume * u(x);
      stress_error += cell.volume * std::abs(cell.stress[0] - sigma(x));
      stress_sum += cell.volume * sigma(x);
    }
    return {u_error / u_sum, stress_error / stress_sum};
  }
} // namespace nsfd::cases
