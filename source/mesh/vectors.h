#pragma once

#include "named_mesh.h"

#include <array>
#include <cmath>

/** Of meshes of files. */
namespace nsfd::mesh_vectors
{
  /** Of the space that meshes of files live in, m. */
  using MeshVector = std::array<double, 3>;

  inline MeshVector operator-(const MeshVector &a, const MeshVector &b)
  {
    return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}};
  }

  inline double dot(const MeshVector &a, const MeshVector &b)
  {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  inline double norm(const MeshVector &a) { return std::sqrt(dot(a, a)); }

  inline MeshVector cross(const MeshVector &a, const MeshVector &b)
  {
    return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
             a[0] * b[1] - a[1] * b[0]}};
  }

  inline double determinant(const MeshVector &a, const MeshVector &b,
                            const MeshVector &c)
  {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) +
           a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }

  /** Of vertex @p v. */
  inline MeshVector position(const NamedMesh &mesh, const unsigned int v)
  {
    const double *x = mesh.coordinates.data() + 3 * std::size_t(v);
    return {{x[0], x[1], x[2]}};
  }
} // namespace nsfd::mesh_vectors
