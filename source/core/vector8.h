#pragma once

namespace nsfd
{
  /** Eight numbers side by side, in a register where there is one as wide. */
  typedef double Vector8 __attribute__((vector_size(64)));
  /** The same at any double. */
  typedef double Vector8u __attribute__((vector_size(64), aligned(8)));
} // namespace nsfd
