#pragma once

#include "bisection.h"

#include "nsfd/adaptivity/indicator.h"

#include <vector>

namespace nsfd
{
  /** What indicators of points and places see of bisected cells. Those that
      cannot be halved any more are no bodies of it. */
  class LeafView final : public MeshView
  {
  public:
    /** Of cells of less than @p deepest bisections. */
    LeafView(const Bisection &cells, unsigned int deepest);

    /** The points that ask for smaller cells. */
    void set_points(std::vector<Point> points) { points_ = std::move(points); }
    /** Of a body. */
    unsigned int cell(const std::size_t body) const { return cell_[body]; }

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
    std::vector<unsigned int> cell_;
    std::vector<Point> points_;
  };
} // namespace nsfd
