#pragma once

#include "program.h"

#include <string>
#include <vector>

namespace end_to_end
{
  /** Prints what was measured next to what is allowed, and checks it. */
  void expect_below(const std::string &what, double measured, double tolerance,
                    const std::string &reason = "");

  /**
   * Largest difference of any energy line at any step, each history relative
   * to its own largest energy: the units drop out. NaN if the steps differ.
   * Only rows up to @p n_rows are compared.
   */
  double energy_difference(const History &a, const History &b,
                           std::size_t n_rows = std::size_t(-1));

  /** The same for one column, relative to its own largest entry. */
  double column_difference(const History &a, const std::string &name_a,
                           const History &b, const std::string &name_b,
                           double sign = 1.,
                           std::size_t n_rows = std::size_t(-1));

  /** @p text with @p to wherever it has @p from. */
  std::string replaced(std::string text, const std::string &from,
                       const std::string &to);

  /** Rows before the first that has damage. */
  std::size_t rows_without_damage(const History &history);

  /**
   * Largest difference of an array in all snapshots of two serial runs,
   * relative to the largest entry of @p scale in all snapshots of @p a.
   */
  double field_difference(const Result &a, const Result &b,
                          const std::string &base, const std::string &array,
                          const std::string &scale_base,
                          const std::string &scale);

  /**
   * Of all snapshots: position, displacement, velocity and stress of every
   * point, and the fragment of every cell, in an order of their own. Equal for
   * runs on several ranks that are the same to the last bit.
   */
  std::vector<std::vector<double>> records(const Result &result,
                                           const std::string &base);
} // namespace end_to_end
