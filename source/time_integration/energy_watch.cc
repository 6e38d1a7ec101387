#include "energy_watch.h"

#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace nsfd
{
  const char *name_of(const WatchedLine line)
  {
    switch (line) {
    case WatchedLine::friction:
      return "friction";
    case WatchedLine::damage:
      return "damage";
    case WatchedLine::impact:
      return "impact";
    case WatchedLine::viscous:
      return "viscous";
    case WatchedLine::plastic:
      return "plastic";
    case WatchedLine::joints:
      return "joints";
    case WatchedLine::supports:
      return "supports";
    case WatchedLine::scheme:
      return "numerical";
    case WatchedLine::load_steps:
      return "load steps";
    case WatchedLine::large_motion:
      return "large motion";
    }
    return "";
  }

  namespace
  {
    /** Largest e of a scene. */
    double largest_restitution(const SceneInput &scene)
    {
      double e = 0.;
      const auto raise = [&e](const auto &blocks) {
        for (const auto &block : blocks)
          e = std::max(e, block.restitution);
      };
      raise(scene.interfaces);
      raise(scene.obstacles);
      raise(scene.contacts);
      return e;
    }
  } // namespace

  bool never_gives(const WatchedLine line, const SceneInput &scene)
  {
    const TimeInput &time = scene.time;
    switch (line) {
    case WatchedLine::friction:
      return time.sliding != Sliding::velocity;
    case WatchedLine::impact:
      return time.contact_target == ContactTarget::energy_safe &&
             time.theta * (1. + largest_restitution(scene)) <= 1. + 1e-12;
    case WatchedLine::scheme:
      // springs of two stiffnesses turn with their frames in large motions, and
      // flow at finite strain has no exact balance of a step
      return time.scheme.theta_scheme && !scene.large_motion &&
             time.cohesion_rule == CohesionRule::exact &&
             !scene.has_bonded_faces();
    case WatchedLine::large_motion:
      return false;
    default:
      return true;
    }
  }

  LineChanges changes_of_energy(const EnergyLines &before, const State &after)
  {
    LineChanges changes;
    changes.scale = after.largest_energy;
    const auto take = [&](const WatchedLine line,
                          double EnergyLines::*const member) {
      changes.taken[std::size_t(line)] = after.energy.*member - before.*member;
    };
    take(WatchedLine::friction, &EnergyLines::friction);
    take(WatchedLine::damage, &EnergyLines::damage);
    take(WatchedLine::impact, &EnergyLines::impact);
    take(WatchedLine::viscous, &EnergyLines::viscous);
    take(WatchedLine::plastic, &EnergyLines::plastic);
    take(WatchedLine::scheme, &EnergyLines::numerical);
    return changes;
  }

  void EnergyWatch::add(const LineChanges &step)
  {
    of_rows += step.of_rows;
    round_off += round_off_of_step(step.terms);
    for (std::size_t k = 0; k < n_watched_lines; ++k) {
      const auto line = WatchedLine(k);
      if (line == WatchedLine::joints || line == WatchedLine::supports) {
        fallen[k] -= step.taken[k];
        given[k] = std::max(given[k], std::abs(fallen[k]));
      } else {
        fallen[k] = std::max(0., fallen[k] - step.taken[k]);
        given[k] = std::max(given[k], fallen[k]);
      }
    }
  }

  void EnergyWatch::serialize(Archive &archive)
  {
    std::vector<double> sums(fallen.begin(), fallen.end());
    sums.insert(sums.end(), given.begin(), given.end());
    sums.insert(sums.end(), {of_rows, round_off});
    archive.common("energy_watch", sums);
    if (sums.size() != 2 * n_watched_lines + 2)
      throw BadCheckpoint("energy_watch has another number of values");
    std::copy_n(sums.begin(), n_watched_lines, fallen.begin());
    std::copy_n(sums.begin() + n_watched_lines, n_watched_lines, given.begin());
    of_rows = sums[2 * n_watched_lines];
    round_off = sums.back();
  }
} // namespace nsfd
