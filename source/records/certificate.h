#pragma once

#include "motion_limits.h"

#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  /** How well the cohesive zones of a run were resolved, at the worst point. */
  struct ZoneResolution {
    double length = 0., spacing = 0.; ///< cohesive length; of points, m
    std::string interface;            ///< its block

    double points() const { return length / spacing; }
  };

  /** What a line of the energy balance gave that must not give any. */
  struct GivenEnergy {
    std::string line;              ///< "friction"
    double share = 0., bound = 0.; ///< over the largest energy
    std::string advice;            ///< what gives less; may be empty
  };

  /** Faces that cannot be released because a node of smaller cells hangs there.
   */
  struct HeldFaces {
    double share = 0.; ///< the largest traction over the strength
    std::string place; ///< "(1, 2) of Interface: all"
  };

  /** What a run knows of itself when it ends. */
  struct RunFacts {
    bool completed = false;
    std::string failure;
    double time = 0.;
    /// accepted steps in time, without and with the nonsmooth problem, and
    /// those of a load
    unsigned long long smooth_steps = 0, steps = 0, static_steps = 0;
    double residual = 0., tolerance = 0.; ///< worst one, of the steps in time
    double imbalance = 0., static_tolerance = 0.; ///< the same of equilibria
    double balance_residual = 0.;
    /// |stored - made| over the heat that has moved; nothing: there is none
    std::optional<double> heat_residual;
    double cells_crossed_by_heat = 0.;
    std::vector<GivenEnergy> given; ///< by the lines that must not
    double penetration = 0., penetration_bound = 0.; ///< largest ones, m
    double penetration_excess = 0.; ///< of a point above its own bound, m
    double displacement = 0.;       ///< largest, m
    double extent = 0.;             ///< largest coordinate, m
    bool softens = false;           ///< some face has a cohesive law
    bool brittle = false;         ///< the traction of one of them jumps to zero
    bool automatic_steps = false; ///< step = auto
    bool explicit_steps = false;  ///< on joined cells
    bool follows_jumps = false;   ///< at solution jump = dynamic
    bool takes_jumps = false;     ///< at solution jump = relax
    unsigned int maximum_bisections = 10;
    unsigned long long beyond_unique = 0, solution_jumps = 0;
    /// nothing: no point has softened; length 0: between rigid bodies
    std::optional<ZoneResolution> zone;
    std::optional<HeldFaces> held; ///< nothing: there are none
    unsigned long long rejected = 0, overshoots = 0; ///< attempts
    MotionLimits limits;
  };

  /** A number of a run, what it must be, and what to do if it is not. */
  struct CertificateLine {
    enum class Verdict {
      ok,
      bad,
      none, ///< the run has no such thing
      not_measured
    };

    std::string name;         ///< "balance residual"
    std::string value, bound; ///< as text, with units
    Verdict verdict = Verdict::not_measured;
    std::string remark; ///< what is wrong and what to change, or why it is ok
    /// as numbers, SI; nothing where there is none
    std::optional<double> number, limit;
  };

  const char *text_of(CertificateLine::Verdict verdict);

  /** What may be said of a run, line by line. */
  struct Certificate {
    std::vector<CertificateLine> lines;

    /** "ok", "2 lines are not ok", ... */
    std::string verdict() const;
    /** Every line is, or is about what the run does not have. */
    bool is_ok() const;
  };

  /**
   * Every number against its bound: nothing is ok that was not measured.
   *
   *     residual      of the contact problems, and of equilibria: tolerances
   *     penetration   at every point: h times the largest speed at which it
   *                   has closed, and the overlap of its
   *                   released spring; beyond it, the tolerance times the
   *                   displacement and the round-off of positions
   *     energy balance defect 1e-9 of the largest energy
   *     given by ...  by friction, damage, impacts and whatever else must not
   *                   give energy, in any stretch of steps: GivenEnergy
   *     uniqueness    no step in which a softening face may have had several
   *                   solutions
   *     cohesive zone points_per_cohesive_length points
   *     held faces    of joined cells of two sizes: below their strength
   *     attempts      fewer rejected steps than accepted ones
   *     rotation, strain, step length, joints, front
   *                   what the method assumes of a motion, see MotionLimits
   */
  Certificate certify(const RunFacts &facts);

  /** Points on the cohesive length that resolve it, (49) of [AM06]. */
  constexpr double points_per_cohesive_length = 2.5;

  /** The table as lines of at most 80 columns, aligned. */
  std::string certificate_text(const Certificate &certificate);

  /**
   * @p text in lines of at most @p width columns, between words but never
   * between a number and what follows it; every line starts with @p indent
   * blanks.
   */
  std::string wrapped(const std::string &text, std::size_t indent,
                      std::size_t width = 80);
} // namespace nsfd
