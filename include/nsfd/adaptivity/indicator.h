#pragma once

#include "nsfd/core/registry.h"

#include <array>
#include <cstddef>
#include <vector>

namespace nsfd
{
  class SectionReader;

  /**
   * What an indicator may look at: the bodies of this rank, the points on
   * their faces, and the last state of both. What is not asked for is not
   * computed; the first call of a function may be collective, so that all
   * ranks must ask for the same.
   */
  class MeshView
  {
  public:
    virtual ~MeshView() = default;

    struct Body {
      std::array<double, 3> centre{};
      double size = 0.;    ///< longest edge, m
      double largest = 0.; ///< size of the cell of the first mesh it lies in, m
      unsigned int level = 0; ///< refinements since then
    };
    virtual const std::vector<Body> &bodies() const = 0;

    /** Per body: kinetic and elastic energy, J (J/m in two dimensions). */
    virtual const std::vector<double> &energy() const = 0;

    /**
     * Per body: largest |(sigma_2 - sigma_1) n| over its faces that carry, Pa,
     * of the mean stresses of the two cells.
     */
    virtual const std::vector<double> &stress_jump() const = 0;

    /** A point that may break or is breaking. */
    struct Point {
      std::array<double, 3> position{};
      /// |traction| over strength as the law compares them; while it softens 1
      double utilisation = 0.;
      bool broken = false;
      /// of the cohesive zone, 9 pi/32 E' G/R_max^2, m; largest double if
      /// none of the two bodies is elastic
      double zone = 0.;
    };
    /** The points of this rank with a law that damages. */
    virtual const std::vector<Point> &points() const = 0;

    /** Over all ranks. */
    virtual double sum(const std::vector<double> &terms) const = 0;
    virtual double max(double value) const = 0;
    /** Those of all ranks, one after the other. */
    virtual std::vector<double>
    gather(const std::vector<double> &values) const = 0;
  };

  /**
   * Says how large a cell may be. Registered by name, one file each in
   * adapt/indicators; built from its block `Indicator: name`.
   */
  class Indicator
  {
  public:
    virtual ~Indicator() = default;

    /**
     * Lower @p size, per body, to the largest one that is good enough, m; leave
     * alone what does not matter. A body of at most half its size may become
     * coarser. Collective.
     */
    virtual void limit(const MeshView &view,
                       std::vector<double> &size) const = 0;
    /** It looks at MeshView::bodies() alone. */
    virtual bool is_fixed() const { return false; }
    /** It looks at them and at MeshView::points() alone, each of which asks for
        smaller cells by itself. */
    virtual bool is_of_points() const { return is_fixed(); }
  };

  using IndicatorRegistry = Registry<Indicator, SectionReader &>;
} // namespace nsfd
