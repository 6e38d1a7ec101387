#include "certificate_lines.h"

#include "engineering.h"

#include <cmath>

namespace nsfd
{
  namespace
  {
    using Line = CertificateLine;
    using Verdict = Line::Verdict;

    /** "at t = 2.00 ms near (0.1, 0.02) m" */
    std::string at(const Peak &peak)
    {
      return fmt::format("at t = {} near ({:.4g}, {:.4g}, {:.4g}) m",
                         engineering(peak.time, "s"), peak.place[0],
                         peak.place[1], peak.place[2]);
    }

    Line rotation_of(const Peak &peak)
    {
      Line line = line_of("rotation", peak.value, largest_rotation,
                          within(peak.value <= largest_rotation), "{:.2g} rad");
      if (line.verdict == Verdict::bad)
        line.remark = "a cell turns " + at(peak) +
                      ", and motion = small makes it longer as it turns: set "
                      "motion = large";
      return line;
    }

    Line strain_of(const Peak &peak)
    {
      Line line = line_of("strain", peak.value, largest_strain,
                          within(peak.value <= largest_strain));
      print_both(line, "{:.3g} %", "at most ", 100.);
      if (line.verdict == Verdict::bad)
        line.remark = "a cell is strained " + at(peak) +
                      " by more than motion = small is right for: set motion "
                      "= large with a material of finite strain";
      return line;
    }

    Line stride_of(const MotionLimits &limits)
    {
      const Peak &peak = *limits.stride;
      Line line = line_of("way of a step", peak.value, largest_stride,
                          within(peak.value < largest_stride),
                          "{:.2g} thicknesses", "less than ");
      if (line.verdict == Verdict::bad)
        line.remark = fmt::format(
            "at t = {} bodies pass each other by more in a step than the "
            "thinnest of them is thick, {}: one may fly through another "
            "unseen; take steps {:.2g} times shorter",
            engineering(peak.time, "s"), engineering(limits.thickness, "m"),
            2. * peak.value);
      return line;
    }

    Line joints_of(const double speed)
    {
      Line line = line_of("joints", speed, largest_joint_speed,
                          within(speed <= largest_joint_speed));
      print_both(line, "{:.3g} %", "at most ", 100.);
      if (line.verdict == Verdict::bad)
        line.remark =
            "rigidly joined points differ in velocity at t = 0: they meet in "
            "an impact of the first step, which takes energy; give both sides "
            "the same initial velocity, or the faces a law";
      return line;
    }

    Line front_of(const SharpFront &front, const RunFacts &facts)
    {
      const bool has_softened = bool(facts.zone);
      const bool is_sharp = front.share() > largest_front;
      Line line =
          line_of("front", front.share(), largest_front,
                  within(!(is_sharp && has_softened)), "{:.2g} strengths");
      if (line.verdict == Verdict::bad) {
        line.remark = fmt::format(
            "{} brings {} into the bodies within {}, the transit time of a "
            "cell, "
            "at t = {}: the oscillation behind such a front may have broken "
            "faces; ",
            front.name, engineering(front.stress, "Pa"),
            engineering(front.crossing, "s"), engineering(front.time, "s"));
        if (front.can_rise)
          line.remark += fmt::format(
              "let it rise over {} or more, or ",
              engineering(front.crossing * front.share() / largest_front, "s",
                          2));
        line.remark += fmt::format(
            "set bulk viscosity of the material to {} Pa s or more: it spreads "
            "the front over as many cells",
            engineering(front.enough_viscosity(), "", 2));
      } else if (is_sharp)
        line.remark = "no point has softened";
      else if (front.damping() < 1.)
        line.remark =
            fmt::format("damping leaves {:.2g} of it", front.damping());
      return line;
    }
  } // namespace

  void add_motion_limits(const RunFacts &facts, std::vector<Line> &lines)
  {
    const MotionLimits &limits = facts.limits;
    if (limits.rotation)
      lines.push_back(rotation_of(*limits.rotation));
    if (limits.strain)
      lines.push_back(strain_of(*limits.strain));
    if (limits.stride)
      lines.push_back(stride_of(limits));
    if (limits.joints)
      lines.push_back(joints_of(*limits.joints));
    if (limits.front)
      lines.push_back(front_of(*limits.front, facts));
  }
} // namespace nsfd
