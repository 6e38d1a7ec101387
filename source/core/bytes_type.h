#pragma once

#include <mpi.h>

#include <cstddef>

namespace nsfd
{
  /** So many bytes at once, for MPI: its counts are then counts of these. */
  class BytesType
  {
  public:
    explicit BytesType(const std::size_t n_bytes)
    {
      MPI_Type_contiguous(int(n_bytes), MPI_BYTE, &type_);
      MPI_Type_commit(&type_);
    }
    ~BytesType() { MPI_Type_free(&type_); }
    BytesType(const BytesType &) = delete;
    BytesType &operator=(const BytesType &) = delete;
    operator MPI_Datatype() const { return type_; }

  private:
    MPI_Datatype type_;
  };
} // namespace nsfd
