#pragma once

#include "nsfd/core/space.h"

#include "named_mesh.h"

/** Of meshes of files. */
namespace nsfd::mesh_vectors
{
  using namespace nsfd::space;
  using MeshVector = Vec3; ///< m

  inline double determinant(const Vec3 &a, const Vec3 &b, const Vec3 &c)
  {
    return dot(a, cross(b, c));
  }

  /** Of vertex @p v. */
  inline Vec3 position(const NamedMesh &mesh, const unsigned int v)
  {
    const double *x = mesh.coordinates.data() + 3 * std::size_t(v);
    return {{x[0], x[1], x[2]}};
  }
} // namespace nsfd::mesh_vectors
