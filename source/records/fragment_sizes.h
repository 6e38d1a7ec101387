#pragma once

#include "fragment_record.h"

#include <optional>
#include <vector>

namespace nsfd
{
  /**
   * How large the fragments are. Sizes are diameters of the disc or ball of the
   * same volume, m; masses in kg (kg/m in two dimensions).
   */
  struct FragmentSizes {
    std::vector<double> sizes; ///< of all, falling: the k-th is N(>=s) = k + 1
    double mean_size = 0., median_size = 0.;
    double mean_size_by_mass = 0.; ///< sum m s / sum m
    double total_mass = 0., mean_mass = 0., median_mass = 0.,
           smallest_mass = 0., largest_mass = 0.;
    double surface = 0.; ///< all of it, both sides of cracks, m^2, m

    /**
     * b of N(>=m) ~ m^-b, the most likely one above the smallest mass:
     * n / sum ln(m / m_smallest). Nothing with fewer than ten fragments, or if
     * all are alike.
     */
    std::optional<double> mass_exponent;

    /** Numbers of sizes in [e_k, e_k+1), e_k+1 = 2 e_k, from the smallest. */
    std::vector<double> edges;
    std::vector<unsigned int> numbers;
  };

  /** Nothing without fragments. */
  std::optional<FragmentSizes>
  fragment_sizes(const std::vector<FragmentRecord> &records,
                 unsigned int dimension);
} // namespace nsfd
