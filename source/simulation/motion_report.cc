#include "motion_report.h"

#include "nsfd/obstacles/obstacle_shape.h"

#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

namespace nsfd
{
  namespace
  {
    std::string describe_bodies(const RigidInput &rigid,
                                const unsigned int dimension)
    {
      std::string text =
          rigid.connected ? "cells that touch are one" : "each cell is one";
      if (rigid.ball)
        text +=
            dimension == 2 ? ", its surface a disc" : ", its surface a ball";
      if (rigid.mass)
        text += fmt::format(", mass {:.6g}", *rigid.mass);
      if (rigid.inertia)
        text += dimension == 2
                    ? fmt::format(", inertia {:.6g}", (*rigid.inertia)[2])
                    : fmt::format(", inertia {:.6g}",
                                  fmt::join(*rigid.inertia, ", "));
      return text;
    }

    std::string describe_contact(const ContactInput &contact)
    {
      std::string text = fmt::format(
          "{}: {}, friction {:g}, restitution {:g}",
          contact.is_default ? "no Contact block" : contact.name,
          contact.materials[0].empty()
              ? "all surfaces"
              : contact.materials[0] + " and " + contact.materials[1],
          contact.friction, contact.restitution);
      if (contact.sliding.wear > 0.)
        text += fmt::format(", wear coefficient {:g}", contact.sliding.wear);
      return text;
    }
  } // namespace

  std::string describe_obstacle(const ObstacleInput &obstacle,
                                const unsigned int dimension)
  {
    std::string text = obstacle.moves() ? "moving " : "";
    if (obstacle.hollow)
      text += "hollow ";
    return text + obstacle.shape->text(dimension);
  }

  std::vector<ReportLine> motion_report(const SceneInput &input)
  {
    std::vector<ReportLine> lines;
    if (!input.large_motion)
      return lines;
    for (const MaterialInput &material : input.materials)
      if (material.kind == MaterialKind::finite_strain)
        lines.push_back(
            {"finite strain", material.name + ": " + material.model_name});
      else if (material.rigid)
        lines.push_back(
            {"rigid bodies",
             material.name + ": " +
                 describe_bodies(material.rigid_bodies, input.dimension)});
    for (const ContactInput &contact : input.contacts)
      lines.push_back({"contact search", describe_contact(contact)});
    if (input.contacts.empty())
      lines.push_back({"contact search",
                       "no Contact block: surfaces pass through each other"});
    for (const PinInput &pin : input.pins)
      lines.push_back({"pin", pin.name + ": of " + pin.material});
    return lines;
  }
} // namespace nsfd
