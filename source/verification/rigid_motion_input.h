#pragma once

#include "nsfd/verification/case_input.h"

#include "nsfd/bodies/rigid_step.h"
#include "nsfd/core/archive.h"

#include <string>
#include <vector>

/** What the cases of rigid bodies with large motions share. */
namespace nsfd::cases
{
  inline void demand_rigid(const SceneInput &input)
  {
    demand(input.large_motion, "the case needs motion = large");
    for (const MaterialInput &material : input.materials)
      demand(material.rigid, "every material must be rigid");
  }

  /** Mass and principal inertia as the first material states them. */
  inline RigidInertia stated_inertia(const SceneInput &input)
  {
    const RigidInput &rigid = input.materials[0].rigid_bodies;
    demand(rigid.mass && rigid.inertia,
           "the material must state mass and principal inertia");
    RigidInertia body;
    body.mass = *rigid.mass;
    for (unsigned int i = 0; i < 3; ++i)
      body.inertia[i][i] = (*rigid.inertia)[i];
    return body;
  }

  /** I / (m R^2) of a homogeneous disc or ball. */
  inline double gyration_of_ball(const SceneInput &input)
  {
    for (const MaterialInput &material : input.materials)
      demand(material.rigid_bodies.ball && !material.rigid_bodies.inertia,
             "the bodies must be homogeneous balls: surface = ball");
    return input.dimension == 2 ? 0.5 : 0.4;
  }

  inline const ObstacleInput &only_plane(const SceneInput &input)
  {
    demand(input.obstacles.size() == 1 &&
               input.obstacles[0].shape_name == "plane" &&
               !input.obstacles[0].moves(),
           "the case needs one Obstacle, a plane at rest");
    return input.obstacles[0];
  }

  inline const std::vector<RigidState> &bodies_of(const StepView &view,
                                                  const std::size_t n)
  {
    demand(
        view.rigid_bodies && view.rigid_bodies->size() == n,
        "the case is about " + std::to_string(n) + " rigid bodies, not " +
            std::to_string(view.rigid_bodies ? view.rigid_bodies->size() : 0));
    return *view.rigid_bodies;
  }

  /** Angular velocity in space. */
  inline Vec3 spatial_spin(const RigidState &body)
  {
    using namespace space;
    return rotation(body.orientation) * body.spin;
  }

  /** Of a body in the plane, in (-pi, pi]. */
  inline double plane_angle(const RigidState &body)
  {
    return 2. * std::atan2(body.orientation[3], body.orientation[0]);
  }

  /** An angle that goes on beyond pi, if it turns by less than pi per step. */
  class Turning
  {
  public:
    void start(const double angle)
    {
      last_ = angle;
      turned_ = 0.;
    }
    void go_on(const double angle)
    {
      turned_ += std::remainder(angle - last_, 2. * std::acos(-1.));
      last_ = angle;
    }
    double turned() const { return turned_; }
    void serialize(Archive &archive, const std::string &name)
    {
      archive.numbers(name, last_, turned_);
    }

  private:
    double last_ = 0., turned_ = 0.;
  };

  inline void serialize(Archive &archive, const std::string &name, Vec3 &v)
  {
    archive.numbers(name, v[0], v[1], v[2]);
  }

  /** y after @p h of y' = @p rate(y), by the classical rule of order 4. */
  template <std::size_t n, typename Rate>
  std::array<double, n>
  runge_kutta(const Rate &rate, const std::array<double, n> &y, const double h)
  {
    const auto moved = [&y](const std::array<double, n> &k, const double s) {
      std::array<double, n> z;
      for (std::size_t i = 0; i < n; ++i)
        z[i] = y[i] + s * k[i];
      return z;
    };
    const auto k1 = rate(y), k2 = rate(moved(k1, h / 2.)),
               k3 = rate(moved(k2, h / 2.)), k4 = rate(moved(k3, h));
    std::array<double, n> result;
    for (std::size_t i = 0; i < n; ++i)
      result[i] = y[i] + h / 6. * (k1[i] + 2. * (k2[i] + k3[i]) + k4[i]);
    return result;
  }
} // namespace nsfd::cases
