#include "body_view.h"

#include <algorithm>

namespace nsfd
{
  bool is_finite(const Vector3 &v)
  {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
  }

  Vector3 mean_displacement(const Snapshot &snapshot)
  {
    Vector3 sum{};
    double n = 0.;
    for (const auto &polygon : snapshot.polygons)
      for (const auto &u : polygon.displacement)
        if (is_finite(u)) {
          for (unsigned int d = 0; d < 3; ++d)
            sum[d] += u[d];
          ++n;
        }
    if (n > 0.)
      for (auto &component : sum)
        component /= n;
    return sum;
  }

  Projection::Projection(const Snapshot &snapshot, const double magnification)
      : three_dimensional_(snapshot.dimension == 3),
        mean_(mean_displacement(snapshot)), magnification_(magnification)
  {
  }

  Vector3 Projection::deformed(const Vector3 &reference, const Vector3 &u) const
  {
    Vector3 x;
    for (unsigned int d = 0; d < 3; ++d)
      x[d] = reference[d] + mean_[d] + magnification_ * (u[d] - mean_[d]);
    return x;
  }

  Vector3 Projection::to_plane(const Vector3 &x) const
  {
    if (!three_dimensional_)
      return {x[0], x[1], 0.};
    return {(x[0] + x[1]) * std::sqrt(0.5),
            (-x[0] + x[1] + 2. * x[2]) * std::sqrt(1. / 6.),
            (x[0] - x[1] + x[2]) * std::sqrt(1. / 3.)};
  }

  std::vector<Vector3> deformed_corners(const Snapshot::Polygon &polygon,
                                        const Projection &projection)
  {
    std::vector<Vector3> corners;
    for (std::size_t i = 0; i < polygon.reference.size(); ++i) {
      const Vector3 u =
          i < polygon.displacement.size() ? polygon.displacement[i] : Vector3{};
      corners.push_back(projection.deformed(polygon.reference[i], u));
      if (!is_finite(corners.back()))
        return {};
    }
    return corners;
  }

  void Box::add(const Vector3 &x)
  {
    for (unsigned int d = 0; d < 3; ++d) {
      lower[d] = std::min(lower[d], x[d]);
      upper[d] = std::max(upper[d], x[d]);
    }
  }

  double Box::size() const
  {
    return std::max(
        {upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
  }

  namespace
  {
    Vector3 difference(const Vector3 &a, const Vector3 &b)
    {
      return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    }
  } // namespace

  double shade(const std::vector<Vector3> &corners)
  {
    Vector3 normal{};
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      const Vector3 a = difference(corners[i], corners[0]);
      const Vector3 b = difference(corners[i + 1], corners[0]);
      for (unsigned int d = 0; d < 3; ++d)
        normal[d] +=
            a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
    }
    const double length = std::hypot(normal[0], normal[1], normal[2]);
    if (!(length > 0.))
      return 1.;
    const Vector3 light = {0.32, -0.55, 0.77};
    const double cosine =
        (normal[0] * light[0] + normal[1] * light[1] + normal[2] * light[2]) /
        length;
    return 0.62 + 0.40 * std::abs(cosine);
  }

  EdgeFinder::EdgeFinder(const Snapshot &snapshot, const double size,
                         const Projection &projection)
      : cell_(1e-6 * size)
  {
    for (const auto &face : snapshot.faces)
      if (face.beta < 1. || face.contact)
        edges_[key(face.a, face.b)];
    if (edges_.empty())
      return;
    for (const auto &polygon : snapshot.polygons) {
      const auto corners = deformed_corners(polygon, projection);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const std::size_t j = (i + 1) % corners.size();
        const auto found =
            edges_.find(key(polygon.reference[i], polygon.reference[j]));
        if (found != edges_.end())
          found->second.push_back({corners[i], corners[j]});
      }
    }
  }

  const std::vector<EdgeFinder::Edge> &
  EdgeFinder::find(const Snapshot::FacePiece &face) const
  {
    static const std::vector<Edge> none;
    const auto found = edges_.find(key(face.a, face.b));
    return found == edges_.end() ? none : found->second;
  }

  EdgeFinder::Key EdgeFinder::key(const Vector3 &a, const Vector3 &b) const
  {
    // shifted, so that corners of a regular mesh are not on the border
    const auto index = [this](const double x) {
      return std::llround(x / cell_ + 0.1234567);
    };
    std::array<long long, 2> p = {index(a[0]), index(a[1])},
                             q = {index(b[0]), index(b[1])};
    if (q < p)
      std::swap(p, q);
    return {p[0], p[1], q[0], q[1]};
  }
} // namespace nsfd
