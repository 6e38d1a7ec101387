#pragma once

#include <map>
#include <optional>
#include <string>

namespace nsfd
{
  /** The first number of a value in SI: "8, 1" is 8, "0.2 us" 2e-7. */
  std::optional<double> number_of_value(const std::string &value);

  /** A name that formulas can write: "time step" is time_step. */
  std::string formula_name(const std::string &name);
} // namespace nsfd
