#include "crack_shape.h"

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nsfd
{
  namespace
  {
    using Vector = std::array<double, 3>;

    double product(const Vector &a, const Vector &b)
    {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }

    template <int dim>
    void find_axes(const std::vector<BrokenPoint> &points, CrackShape &shape)
    {
      Vector middle{};
      for (const BrokenPoint &point : points)
        for (unsigned int c = 0; c < 3; ++c)
          middle[c] += point.area / shape.area * point.position[c];
      dealii::SymmetricTensor<2, dim> moment;
      for (const BrokenPoint &point : points)
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = c; d < dim; ++d)
            moment[c][d] += point.area / shape.area *
                            (point.position[c] - middle[c]) *
                            (point.position[d] - middle[d]);
      const auto found = dealii::eigenvectors(moment);
      shape.axes[2] = {0., 0., 1.};
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int c = 0; c < dim; ++c)
          shape.axes[a][c] = found[a].second[c];
    }

    /** Of the union of intervals. */
    double covered(std::vector<std::array<double, 2>> intervals)
    {
      std::sort(intervals.begin(), intervals.end());
      double length = 0., up_to = -std::numeric_limits<double>::max();
      for (const auto &[begin, end] : intervals)
        if (end > up_to) {
          length += end - std::max(begin, up_to);
          up_to = end;
        }
      return length;
    }
  } // namespace

  CrackShape crack_shape(const std::vector<BrokenPoint> &points,
                         const unsigned int dimension)
  {
    CrackShape shape;
    for (const BrokenPoint &point : points)
      shape.area += point.area;
    if (!(shape.area > 0.))
      return shape;
    if (dimension == 2)
      find_axes<2>(points, shape);
    else
      find_axes<3>(points, shape);

    std::vector<std::array<double, 2>> pieces;
    double lower = std::numeric_limits<double>::max(), upper = -lower;
    for (const BrokenPoint &point : points) {
      const double a = product(point.ends[0], shape.axes[0]),
                   b = product(point.ends[1], shape.axes[0]);
      pieces.push_back({std::min(a, b), std::max(a, b)});
      lower = std::min(lower, pieces.back()[0]);
      upper = std::max(upper, pieces.back()[1]);
      shape.projected +=
          point.area * std::abs(product(point.normal, shape.axes[2]));
    }
    shape.extent = upper - lower;
    if (dimension == 2)
      shape.projected = covered(std::move(pieces));
    if (shape.projected > 0.)
      shape.tortuosity = shape.area / shape.projected;
    return shape;
  }

  double crack_angle(const CrackShape &shape)
  {
    const double angle =
        std::atan2(shape.axes[0][1], shape.axes[0][0]) * 180. / M_PI;
    return angle > 90. ? angle - 180. : angle <= -90. ? angle + 180. : angle;
  }

  double angle_between(const double first, const double second)
  {
    const double angle = std::abs(std::remainder(first - second, 180.));
    return std::min(angle, 180. - angle);
  }
} // namespace nsfd
