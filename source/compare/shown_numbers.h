#pragma once

#include "comparison.h"

#include <string>
#include <vector>

/** What the text and the page of a comparison show alike. */
namespace nsfd
{
  /** Results and errors always, the rest where it differs; no costs. */
  bool is_shown(const ComparedNumber &number);

  /** "3.20e-04", "0", "n/a" */
  std::string difference_text(double difference);

  /** Name and a verdict per run; of all lines that one of them has. */
  std::vector<std::vector<std::string>>
  certificate_rows(const Comparison &comparison);
} // namespace nsfd
