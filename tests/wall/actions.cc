#include "draft.h"

#include <fmt/format.h>

#include <algorithm>

// Supports, drives, obstacles, pins: what acts on bodies from outside.

namespace wall
{
  std::vector<std::string> Touch::entries() const
  {
    std::vector<std::string> lines;
    if (friction > 0.)
      lines.push_back(fmt::format("friction = {:.2f}", friction));
    if (restitution > 0.)
      lines.push_back(fmt::format("restitution = {:.2f}", restitution));
    return lines;
  }

  Touch draw_touch(Draw &draw)
  {
    Touch touch;
    if (!draw.chance(0.25))
      touch.friction = draw.between(0., draw.chance(0.7) ? 0.8 : 2.);
    if (draw.chance(0.4))
      touch.restitution = draw.chance(0.1) ? 1. : draw.between(0., 1.);
    return touch;
  }

  std::string corner(const Vector &point, const int dim)
  {
    std::string text;
    for (int d = 0; d < dim; ++d)
      text += (d ? ", " : "") + length(point[d]);
    return text;
  }

  void hold(Draft &draft, const std::string &side, const bool fully)
  {
    Block block{"Boundary: " + side, {}};
    const int d0 = side == "left" || side == "right" ? 0 : up(draft);
    for (int d = 0; d < draft.dim; ++d)
      if (fully || d == d0)
        block.entries.push_back(fmt::format("velocity {} = 0", axis(d)));
    draft.blocks.push_back(block);
    draft.keeps_momentum = false;
  }

  void add_floor(Draft &draft, Draw &draw, const double height)
  {
    Vector point{};
    point[up(draft)] = height;
    Block block{"Obstacle: floor",
                {std::string("where = ") + (draft.large      ? "all"
                                            : draft.dim == 2 ? "bottom"
                                                             : "back"),
                 "point = " + corner(point, draft.dim),
                 draft.dim == 2 ? "normal = 0, 1" : "normal = 0, 0, 1"}};
    for (const std::string &entry : draw_touch(draw).entries())
      block.entries.push_back(entry);
    draft.blocks.push_back(block);
    draft.keeps_momentum = false;
  }

  void add_hammer(Draft &draft, Draw &draw, const Vector &place,
                  const double radius)
  {
    Block block{"Obstacle: hammer",
                {"shape = sphere", "point = " + corner(place, draft.dim),
                 "radius = " + length(radius),
                 fmt::format("velocity {} = {}", axis(up(draft)),
                             speed(-draft.speed))}};
    for (const std::string &entry : draw_touch(draw).entries())
      block.entries.push_back(entry);
    draft.blocks.push_back(block);
    draft.keeps_momentum = false;
    draft.end_at_half(draft.speed, up(draft), 0., draft.gap);
  }

  void drive(Draft &draft, Draw &draw, const std::string &side, const int d,
             double sign)
  {
    const double c = draft.slowest.wave_speed(),
                 rise = draft.unit / c * draw.between(1., 10.);
    const bool grows = draw.chance(0.5), at_once = !grows && draw.chance(0.7);
    const std::string shape =
        grows     ? fmt::format(" * min(1, t / ({}))", time(rise))
        : at_once ? ""
                  : fmt::format(" * sin(t / ({}))", time(rise));
    Block block{"Boundary: " + side, {}};
    const double stress =
        draft.kind == Kind::rigid
            ? draft.slowest.density * draft.speed * draft.speed
            : draft.slowest.density * c * draft.speed;
    // what breaks under a dead load beyond its strength has no equilibrium, nor
    // have slopes without friction that are pushed over each other
    const bool breaks_at_rest =
        draft.integrator == "quasi-static" && draft.kind != Kind::elastic;
    if (breaks_at_rest)
      sign = std::abs(sign);
    // rigid bodies between two sides that move cannot follow
    if (draft.kind != Kind::rigid && (draw.chance(0.75) || breaks_at_rest)) {
      block.entries.push_back(fmt::format("velocity {} = {}{}", axis(d),
                                          speed(sign * draft.speed), shape));
      draft.end_at_half(draft.speed, d, grows ? 0.5 * rise : 0., 0.);
      if (draw.chance(0.5))
        block.entries.push_back(
            fmt::format("velocity {} = 0", axis((d + 1) % draft.dim)));
    } else if (draw.chance(0.5))
      block.entries.push_back(fmt::format("traction {} = {}{}", axis(d),
                                          pressure(sign * stress), shape));
    else
      block.entries.push_back(
          fmt::format("pressure = {}{}", pressure(stress), shape));
    draft.blocks.push_back(block);
    draft.keeps_momentum = false;
  }

  void add_pin(Draft &draft, Draw &draw)
  {
    if (draft.integrator == "explicit")
      return; // it has none yet
    for (const Body &body : draft.bodies)
      if (body.rigid) {
        Vector place = body.centre();
        if (draw.chance(0.5)) // else about its centre
          place[0] = body.low[0];
        if (body.angle != 0.)
          place = body.centre();
        draft.blocks.push_back(
            {"Pin: hinge",
             {"material = " + body.name, "at = " + corner(place, draft.dim)}});
        draft.keeps_momentum = false;
        return;
      }
  }
} // namespace wall
