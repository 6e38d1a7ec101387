#pragma once

#include "read_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace nsfd
{
  inline const CohesiveLaw &law_of(const LawInput &input, const std::size_t i)
  {
    return *input.curves[i].interaction.law;
  }

  /** curve.csv, or one per block: "curve_stiff joint.csv". */
  inline std::string curve_file(const LawInput &input, const std::size_t i)
  {
    if (input.curves.size() == 1)
      return "curve.csv";
    std::string name = input.curves[i].name;
    std::replace(name.begin(), name.end(), '/', '-');
    return "curve_" + name + ".csv";
  }

  /** @p what is drawn, with the law's name if there is one law. */
  inline std::string chart_title(const LawInput &input, const std::string &what)
  {
    return input.curves.size() == 1
               ? fmt::format("{}: {}", input.curves[0].law_name, what)
               : what;
  }
} // namespace nsfd
