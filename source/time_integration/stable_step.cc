#include "stable_step.h"

#include "discretization/body_frequency.h"

#include <algorithm>
#include <limits>

namespace nsfd
{
  double stable_step(const Bodies &bodies)
  {
    double largest = 0.;
    for (const BodyClass &body : bodies.classes)
      largest = std::max(largest, highest_frequency(body));
    return largest > 0. ? 2. / largest
                        : std::numeric_limits<double>::infinity();
  }
} // namespace nsfd
