#pragma once

#include "certificate.h"
#include "fragment_sizes.h"

#include <optional>

namespace nsfd
{
  /** What is judged and gathered at the end of a run, as far as there is. */
  struct RunFindings {
    std::optional<Certificate> certificate;
    std::optional<FragmentSizes> fragment_sizes;
  };
} // namespace nsfd
