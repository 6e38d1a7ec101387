#pragma once

#include <cstdint>

namespace nsfd
{
  /** Of the files of fields, interfaces and (VTKHDF) fragments. */
  enum class FieldFormat : std::uint8_t {
    vtu,
    hdf5, ///< with XDMF
    vtkhdf
  };
} // namespace nsfd
