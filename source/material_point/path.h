#pragma once

#include <string>
#include <vector>

namespace nsfd
{
  /** Where a point is held: its jump, and the contact that presses it. */
  struct PathMark {
    double opening = 0., slip = 0.; ///< u_N, u_T in m
    double reaction = 0.;           ///< prescribed contact traction in Pa
    double time = 0.;               ///< s, of what heals
  };

  /** A mark, or a place between two of them. */
  struct PathPoint {
    double path = 0.; ///< mark number and fraction, or t of a formula
    PathMark at;
  };

  /**
   * Marks of a path in units of a law: openings of its final opening, slips of
   * its final slip, reactions of a traction.
   */
  struct NamedPath {
    std::string name, text;
    std::vector<PathMark> marks;

    bool presses() const;
  };
  const std::vector<NamedPath> &named_paths();

  /** The marks in m and Pa. */
  std::vector<PathMark> scaled(const std::vector<PathMark> &marks,
                               const PathMark &unit);

  /**
   * Points on the straight lines between marks, every mark one of them, in
   * about @p n_steps steps that share the length of the path, measured in
   * @p unit. With 0 steps, the marks only. A path that does not begin at the
   * jump 0 gets a mark there.
   */
  std::vector<PathPoint> points_between(std::vector<PathMark> marks,
                                        const PathMark &unit,
                                        unsigned int n_steps);

  /**
   * What unilateral contact does not allow, or empty: an opening below 0, a
   * reaction that pulls, an opening under a reaction.
   */
  std::string contradiction(const std::vector<PathPoint> &points);
} // namespace nsfd
