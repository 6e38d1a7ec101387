#include "law_of_shape.h"

namespace nsfd
{
  std::string law_of_shape(const std::string &name)
  {
    if (name == "linear" || name == "linear softening")
      return "softening along a line is `camacho-ortiz` without elasticity "
             "before, `geubelle-baylor` with it (bilinear)";
    if (name == "bilinear" || name == "triangular")
      return "the bilinear law is `geubelle-baylor`";
    if (name == "exponential")
      return "the exponential law is `xu-needleman`";
    if (name == "cohesive" || name == "czm" || name == "cohesive zone")
      return "take for example `camacho-ortiz` where faces have no "
             "compliance "
             "before they break, `geubelle-baylor` where they are springs";
    return "";
  }
} // namespace nsfd
