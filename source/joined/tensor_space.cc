#include "tensor_kernels_impl.h"

namespace nsfd
{
  NSFD_TENSOR_DIMENSION(3)
} // namespace nsfd
