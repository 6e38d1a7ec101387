#pragma once

#include "nsfd/obstacles/obstacle_shape.h"

namespace nsfd
{
  /** Obstacles of a radius around a centre or an axis; solid or hollow. */
  class RoundObstacle : public ObstacleShape
  {
  public:
    double gap(const ObstacleInput &obstacle, const Vector &x) const override;
    Vector normal(const ObstacleInput &obstacle,
                  const Vector &x) const override;
    double thickness(const ObstacleInput &obstacle) const override;

  protected:
    static void read_radius(SectionReader &reader, ObstacleInput &obstacle);

    /** From the nearest place of the centre or axis to @p x. */
    virtual Vector radial(const ObstacleInput &obstacle,
                          const Vector &x) const = 0;
  };
} // namespace nsfd
