#pragma once

#include <array>
#include <cmath>
#include <vector>

namespace nsfd
{
  namespace test
  {
    using Vector3 = std::array<double, 3>;

    inline double dot(const Vector3 &a, const Vector3 &b)
    {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }
    inline Vector3 cross(const Vector3 &a, const Vector3 &b)
    {
      return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
              a[0] * b[1] - a[1] * b[0]};
    }

    /** A convex body: corners, normals of its sides, directions of its edges.
     */
    struct Convex {
      std::vector<Vector3> corners, normals, edges;
    };

    struct Separation {
      double distance = -1e300; ///< below zero: the depth of the overlap
      Vector3 normal{};         ///< from the first body to the second
      bool of_edges = false;    ///< across an edge of each body
    };

    /**
     * Two convex bodies are apart exactly if the plane of a side, or one along
     * an edge of each, is between them. The largest distance over these planes,
     * below zero if all of them cut both bodies: how far one has to move.
     */
    inline Separation separation(const Convex &a, const Convex &b)
    {
      Separation result;
      const auto look = [&](const Vector3 &axis, const bool of_edges) {
        double end_a = -1e300, begin_b = 1e300;
        const double length = std::sqrt(dot(axis, axis));
        for (const auto &x : a.corners)
          end_a = std::max(end_a, dot(axis, x) / length);
        for (const auto &x : b.corners)
          begin_b = std::min(begin_b, dot(axis, x) / length);
        if (begin_b - end_a > result.distance)
          result = {begin_b - end_a,
                    {axis[0] / length, axis[1] / length, axis[2] / length},
                    of_edges};
      };
      const auto back = [](const Vector3 &n) {
        return Vector3{-n[0], -n[1], -n[2]};
      };
      for (const auto &n : a.normals)
        look(n, false);
      for (const auto &n : b.normals)
        look(back(n), false);
      for (const auto &s : a.edges)
        for (const auto &t : b.edges) {
          const Vector3 n = cross(s, t);
          if (dot(n, n) < 1e-8 * dot(s, s) * dot(t, t))
            continue;
          look(n, true);
          look(back(n), true);
        }
      return result;
    }
  } // namespace test
} // namespace nsfd
