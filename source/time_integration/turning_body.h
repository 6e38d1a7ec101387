#pragma once

#include "nsfd/bodies/rigid_step.h"
#include "nsfd/core/space.h"

namespace nsfd
{
  /** The rigid cells of a body in motions of any size: what they are, and
     where. In the plane x and y of vectors, z of rotations. */
  struct TurningBody {
    double mass = 0.; ///< kg, kg/m
    Mat3 inertia{};   ///< about their centre, at rest, kg m^2
    Vec3 rest{};      ///< their centre at rest
    Vec3 centre{};
    Quaternion orientation{{1., 0., 0., 0.}};

    /** Where a place at rest is now. */
    Vec3 place(const Vec3 &at_rest) const
    {
      using namespace space;
      return centre + rotation(orientation) * (at_rest - rest);
    }
    /** Its inertia about its centre, axes of space. */
    Mat3 inertia_now() const
    {
      using namespace space;
      const Mat3 R = rotation(orientation);
      return R * (inertia * transposed(R));
    }

    /**
     * Free flight over @p h of a whole of inertia @p I about @p of_whole, both
     * now: momenta and energy stay, see RigidStep. @p of_whole, @p velocity
     * and @p spin (axes of space) become those at the end. False where a step
     * turns it too far.
     */
    bool fly(double h, double whole_mass, const Mat3 &I, bool in_plane,
             Vec3 &of_whole, const Vec3 &velocity, Vec3 &spin)
    {
      using namespace space;
      const Mat3 R = rotation(orientation);
      const RigidInertia whole =
          in_plane ? plane_inertia(whole_mass, I[2][2])
                   : RigidInertia{whole_mass, transposed(R) * (I * R)};
      RigidState start;
      start.centre = of_whole;
      start.velocity = velocity;
      start.orientation = orientation;
      start.spin = transposed(R) * spin;
      RigidStep step(whole, start, h, 0.5);
      if (!step.solve({}))
        return false;
      const RigidState &end = step.state();
      const Mat3 now = rotation(end.orientation);
      centre = end.centre + now * (transposed(R) * (centre - of_whole));
      of_whole = end.centre;
      orientation = end.orientation;
      spin = now * end.spin;
      return true;
    }
  };
} // namespace nsfd
