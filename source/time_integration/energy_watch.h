#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace nsfd
{
  class Archive;
  struct EnergyLines;
  struct SceneInput;
  struct State;

  /** Lines of the energy balance that must not give energy. */
  enum class WatchedLine : unsigned int {
    friction,
    damage,
    impact,
    viscous,
    plastic,
    joints,   ///< rows of joints: no work, either way
    supports, ///< rows of supports beyond their prescribed motion: none
    scheme,   ///< what the rules of the time step make: `numerical`
    /// work of the loads between two equilibria above that of their mean
    load_steps,
    /// explicit steps of large motions: forces that are not linear, frames
    /// that turn; a part of `numerical` that is not in `scheme`
    large_motion
  };
  constexpr std::size_t n_watched_lines = 10;

  /** "friction", ...: as the certificate names it. */
  const char *name_of(WatchedLine line);

  /**
   * The rules that the scene has chosen cannot give energy by this line: a step
   * that does is not accepted. Pure rules (`sliding = velocity`, theta above
   * 1 / (1 + e), cohesion at the end point, explicit steps, laws of released
   * faces) and the frames of large motions can; then the certificate says how
   * much. No step may give more by those of large motions than a run.
   */
  bool never_gives(WatchedLine line, const SceneInput &scene);

  /**
   * What each line took in one step, in J: negative where it gave. `worst` is
   * the point of this rank that gave most, or no_point.
   */
  struct LineChanges {
    static constexpr std::size_t no_point = std::size_t(-1);

    std::array<double, n_watched_lines> taken{};
    std::array<std::size_t, n_watched_lines> worst{};
    double defect = 0.;   ///< by which the sum of all lines went astray, J
    double impulses = 0.; ///< sum R P^2 over the points, see LawEvaluation, J
    /// where velocities are prescribed and U = U_free + W P, else 0
    double impulses_of_rows = 0.;
    /// round-off of rows with a prescribed velocity, see RowWork, J
    double of_rows = 0.;
    double scale = 0.; ///< the largest energy so far, or what the loads would
                       ///< give in this step without impulses, J
    double terms = 0.; ///< see work_of_impulses(), J
  };

  /** Of a step from energies @p before to @p after that no point splits. */
  LineChanges changes_of_energy(const EnergyLines &before, const State &after);

  /**
   * The lines over a whole run, in J. `given` is the most that a line gave
   * back in any stretch of steps: the largest fall of its sum from where it
   * was highest; of joints and supports, the largest size of their sum.
   */
  struct EnergyWatch {
    std::array<double, n_watched_lines> fallen{}, given{};
    double of_rows = 0.;   ///< sum over the steps
    double round_off = 0.; ///< the same of round_off_of_step(terms)

    void add(const LineChanges &step);
    void serialize(Archive &archive);
  };

  /** Share of the largest energy that counts as none. */
  constexpr double energy_round_off = 1e-9;
  /** What `large motion` may give in a run, and so in a step. */
  constexpr double most_of_large_motion = 1e-3;

  /**
   * The last bits of the energies of a step, J: there is no energy at rest, but
   * impulses move @p scale there and take it away again.
   */
  inline double round_off_of_step(const double scale)
  {
    constexpr double terms = 8.; // of a line: impulses and both velocities
    return terms * std::numeric_limits<double>::epsilon() * scale;
  }

  /** |P|_R |U|_(1/R), as large as the terms of these lines: @p energy_scale as
      for LawEvaluation, @p impulses as in LineChanges. */
  inline double work_of_impulses(const double energy_scale,
                                 const double impulses)
  {
    return std::max(energy_scale, std::sqrt(energy_scale * impulses));
  }
} // namespace nsfd
