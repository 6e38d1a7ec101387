#pragma once

#include "bisection.h"

#include "nsfd/adaptivity/indicator.h"

#include <vector>

namespace nsfd
{
  /** What indicators of points and places see of bisected cells. */
  class LeafView final : public MeshView
  {
  public:
    /** @p points that ask for smaller cells. */
    LeafView(const Bisection &cells, std::vector<Point> points);

    const std::vector<Body> &bodies() const override { return bodies_; }
    const std::vector<Point> &points() const override { return points_; }
    const std::vector<double> &energy() const override { return none(); }
    const std::vector<double> &stress_jump() const override { return none(); }
    // all cells are on one rank
    double sum(const std::vector<double> &terms) const override;
    double max(const double value) const override { return value; }
    std::vector<double> gather(const std::vector<double> &values) const override
    {
      return values;
    }

  private:
    const std::vector<double> &none() const;

    std::vector<Body> bodies_;
    std::vector<Point> points_;
  };
} // namespace nsfd
