#pragma once

#include "nsfd/core/plug_in.h"
#include "nsfd/records/cost_record.h"
#include "nsfd/records/observable_record.h"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /**
   * The energy lines of a run, in J (J/m of depth in two dimensions). `work`
   * is the work of loads (pressure in cracks and an initial stress are such)
   * and prescribed motion since t = 0; the dissipated lines are sums since t =
   * 0, `absorbed` is what left through absorbing sides. Closed energy balance:
   * kinetic + elastic + cohesive + dissipated lines - initial energy - work
   * = 0.
   */
  struct EnergyLines {
    double kinetic = 0., elastic = 0., cohesive = 0.;
    double damage = 0., friction = 0., viscous = 0., plastic = 0., impact = 0.,
           numerical = 0., absorbed = 0.;
    double work = 0.;
  };

  /** Of a scene with heat: J since t = 0, and K. */
  struct HeatRecord {
    double made = 0.;   ///< by friction, damage and flow
    double stored = 0.; ///< in the bodies
    double hottest = 0.;
    double given = 0.; ///< by sides
  };

  /** One accepted step: a line of history.csv. */
  struct HistoryRow {
    unsigned int step = 0;
    double time = 0., time_step = 0.;
    EnergyLines energy;
    double balance_residual = 0.; ///< relative to the largest energy so far
    double broken_area = 0.;
    unsigned int fragments = 1;
    unsigned int active = 0; ///< points in contact or with evolving damage
    unsigned int newton = 0, krylov = 0;
    double residual = 0.;
    std::vector<double> reactions; ///< per driven boundary, dim components
    std::optional<HeatRecord> heat;
  };

  /** What a run was and what it found: summary.json. */
  struct Summary {
    bool completed = false;
    std::string failure; ///< empty, or where and why the run stopped
    unsigned int dimension = 2;
    bool axisymmetric = false; ///< measures are per radian
    unsigned int steps = 0;
    unsigned long long dofs = 0, cells = 0, interface_points = 0;
    double final_time = 0.;
    double wall_seconds = 0., cpu_seconds = 0., setup_seconds = 0.;
    double peak_memory_mb = 0.;
    EnergyLines energy;
    double balance_residual_max = 0., residual_max = 0., penetration_max = 0.,
           penetration_bound = 0., positive_friction_work = 0.,
           rigid_drift_max = 0.;
    std::optional<double> pressure_work; ///< in cracks, if the scene has one
    std::optional<HeatRecord> heat; ///< at the end, hottest of the whole run
    /// largest viscous traction, if the scene has one: what R_max is shifted by
    std::optional<double> viscous_traction_max;
    unsigned int fragments = 1;
    std::map<std::string, double> counters;
    std::map<std::string, double> errors;
    /// seconds of CPU by part of the step, in the order to print
    std::vector<std::pair<std::string, double>> timings;
    CostRecord cost;
    std::vector<ObservableRecord> observables;
  };

  /** What run.json says. */
  struct RunInfo {
    std::string version, git_hash, command_line, file, date, host, build_type;
    std::string interface; ///< that plug-ins were built against
    std::vector<PlugIn> plug_ins;
    std::map<std::string, std::string> libraries;
    unsigned int ranks = 1;
    std::vector<unsigned int> seeds;
    std::vector<std::pair<std::string, std::string>> parts; ///< kind, name
  };

  /**
   * A picture's worth of data at one time, gathered on rank 0. Coordinates are
   * deformed with the true displacement. 2D: every cell is a polygon. 3D: the
   * visible boundary and broken faces as polygons.
   */
  struct Snapshot {
    double time = 0.;
    unsigned int dimension = 2;
    struct Polygon {
      std::vector<std::array<double, 3>> reference;    ///< undeformed corners
      std::vector<std::array<double, 3>> displacement; ///< at the corners
      double value = 0.;  ///< von Mises stress (Pa)
      double speed = 0.;  ///< |v| (m/s)
      double warmth = 0.; ///< temperature less that at t = 0, mean (K)
      unsigned int fragment = 0, material = 0;
    };
    struct FacePiece {
      std::array<double, 3> a, b; ///< 2D: ends, undeformed
      std::array<double, 3> displacement_a,
          displacement_b; ///< mean of both sides
      double beta = 1.;   ///< 1 intact, 0 broken
      bool contact = false;
      bool can_break = false;
    };
    std::vector<Polygon> polygons;
    std::vector<FacePiece> faces;
  };
} // namespace nsfd
