#pragma once

#include "nsfd/records/run_record.h"

#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

namespace nsfd
{
  using Vector3 = std::array<double, 3>;

  bool is_finite(const Vector3 &v);

  /** Over all corners of a snapshot. */
  Vector3 mean_displacement(const Snapshot &snapshot);

  /** From points of the body to the drawing plane (m, second axis up). */
  class Projection
  {
  public:
    Projection(const Snapshot &snapshot, double magnification);

    Vector3 deformed(const Vector3 &reference, const Vector3 &u) const;

    /** Third entry: larger is nearer to the eye, at (1, -1, 1). */
    Vector3 to_plane(const Vector3 &x) const;

  private:
    bool three_dimensional_;
    Vector3 mean_;
    double magnification_;
  };

  /** Corners that can be drawn; empty if something is not a number. */
  std::vector<Vector3> deformed_corners(const Snapshot::Polygon &polygon,
                                        const Projection &projection);

  /** Which sides of the polygons in space are seen. */
  enum class Seen { front, both };

  /**
   * The same, anticlockwise as the eye sees them: the two flanks of a closed
   * crack in one path do not cancel. Corners go round anticlockwise for who
   * looks at the body; with Seen::front, what faces away is empty.
   */
  std::vector<Vector3> corners_to_eye(const Snapshot::Polygon &polygon,
                                      const Projection &projection, Seen seen);

  /** Axis-parallel box in space or, with two used entries, in the plane. */
  struct Box {
    Vector3 lower{HUGE_VAL, HUGE_VAL, HUGE_VAL},
        upper{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    void add(const Vector3 &x);
    bool empty() const { return !(lower[0] <= upper[0]); }
    double size() const;
  };

  /** 0.62 to 1.02 by the angle to the light, the same for both sides. */
  double shade(const std::vector<Vector3> &corners);

  /**
   * In space, which polygons are flanks of cracks and not of the outer surface:
   * those that have a twin with the same undeformed corners.
   */
  std::vector<char> crack_flanks(const Snapshot &snapshot);

  /**
   * Where the outer surface of a body in space has an edge: lines between
   * polygons whose undeformed planes meet at more than 30 degrees, deformed.
   * @p flank is what crack_flanks() says.
   */
  std::vector<std::array<Vector3, 2>>
  sharp_edges(const Snapshot &snapshot, const std::vector<char> &flank,
              const Projection &projection);

  /** Finds the cell edges on both sides of a face by its undeformed ends. */
  class EdgeFinder
  {
  public:
    using Edge = std::array<Vector3, 2>; ///< deformed ends

    EdgeFinder(const Snapshot &snapshot, double size,
               const Projection &projection);

    const std::vector<Edge> &find(const Snapshot::FacePiece &face) const;

  private:
    using Key = std::array<long long, 4>;
    struct Hash {
      std::size_t operator()(const Key &key) const
      {
        std::size_t hash = 0;
        for (const long long k : key)
          hash = (hash ^ static_cast<std::size_t>(k)) * 0x9E3779B97F4A7C15u;
        return hash ^ hash >> 29;
      }
    };

    Key key(const Vector3 &a, const Vector3 &b) const;

    double cell_;
    std::unordered_map<Key, std::vector<Edge>, Hash> edges_;
  };
} // namespace nsfd
