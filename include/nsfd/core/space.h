#pragma once

#include <array>
#include <cmath>

namespace nsfd
{
  using Vec3 = std::array<double, 3>;
  using Mat3 = std::array<Vec3, 3>; ///< rows
  /// w, x, y, z; a unit one turns v to q v q*
  using Quaternion = std::array<double, 4>;

  /** Vectors and rotations in space, for files with large motions. */
  namespace space
  {
    inline Vec3 operator+(const Vec3 &a, const Vec3 &b)
    {
      return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
    }

    inline Vec3 operator-(const Vec3 &a, const Vec3 &b)
    {
      return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    }

    inline Vec3 operator*(const double s, const Vec3 &a)
    {
      return {s * a[0], s * a[1], s * a[2]};
    }

    inline double dot(const Vec3 &a, const Vec3 &b)
    {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }

    inline Vec3 cross(const Vec3 &a, const Vec3 &b)
    {
      return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
              a[0] * b[1] - a[1] * b[0]};
    }

    inline double norm(const Vec3 &a) { return std::sqrt(dot(a, a)); }

    inline Vec3 operator*(const Mat3 &A, const Vec3 &x)
    {
      return {dot(A[0], x), dot(A[1], x), dot(A[2], x)};
    }

    inline Mat3 operator+(const Mat3 &A, const Mat3 &B)
    {
      return {A[0] + B[0], A[1] + B[1], A[2] + B[2]};
    }

    inline Mat3 operator*(const double s, const Mat3 &A)
    {
      return {s * A[0], s * A[1], s * A[2]};
    }

    inline Mat3 transposed(const Mat3 &A)
    {
      return {{{A[0][0], A[1][0], A[2][0]},
               {A[0][1], A[1][1], A[2][1]},
               {A[0][2], A[1][2], A[2][2]}}};
    }

    inline Mat3 operator*(const Mat3 &A, const Mat3 &B)
    {
      const Mat3 Bt = transposed(B);
      return {Bt * A[0], Bt * A[1], Bt * A[2]};
    }

    /** hat(a) x = a x x. */
    inline Mat3 hat(const Vec3 &a)
    {
      return {{{0., -a[2], a[1]}, {a[2], 0., -a[0]}, {-a[1], a[0], 0.}}};
    }

    /** A^{-1} b by Cramer's rule; not finite where A is singular. */
    inline Vec3 solve(const Mat3 &A, const Vec3 &b)
    {
      const Vec3 c0 = cross(A[1], A[2]), c1 = cross(A[2], A[0]),
                 c2 = cross(A[0], A[1]);
      return (1. / dot(A[0], c0)) * (b[0] * c0 + b[1] * c1 + b[2] * c2);
    }

    inline Quaternion product(const Quaternion &p, const Quaternion &q)
    {
      return {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
              p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
              p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
              p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]};
    }

    inline Quaternion normalized(const Quaternion &q)
    {
      const double s =
          1. / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
      return {s * q[0], s * q[1], s * q[2], s * q[3]};
    }

    /** The rotation matrix of a unit quaternion. */
    inline Mat3 rotation(const Quaternion &q)
    {
      const double w = q[0], x = q[1], y = q[2], z = q[3];
      return {{{1. - 2. * (y * y + z * z), 2. * (x * y - w * z),
                2. * (x * z + w * y)},
               {2. * (x * y + w * z), 1. - 2. * (x * x + z * z),
                2. * (y * z - w * x)},
               {2. * (x * z - w * y), 2. * (y * z + w * x),
                1. - 2. * (x * x + y * y)}}};
    }
  } // namespace space
} // namespace nsfd
