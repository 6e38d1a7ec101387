#include "units_file.h"

#include "nsfd/core/per_extent.h"

#include <nlohmann/json.hpp>

namespace nsfd
{
  namespace
  {
    using Json = nlohmann::ordered_json;

    const char *const energies[] = {"kinetic", "elastic", "cohesive"};
    const char *const losses[] = {"damage", "friction",  "viscous", "plastic",
                                  "impact", "numerical", "absorbed"};
    const char *const pure_columns[] = {"fragments", "active", "newton",
                                        "krylov", "residual"};

    struct Measures {
      explicit Measures(const HistoryFile::Columns &columns)
          : per(per_extent(columns.dimension, columns.axisymmetric)),
            energy("J" + per), force("N" + per), mass("kg" + per),
            area(area_unit("m^2", columns.dimension, columns.axisymmetric))
      {
      }

      std::string per, energy, force, mass, area;
    };

    Json history_units(const HistoryFile::Columns &columns,
                       const Measures &measures)
    {
      const unsigned int dimension = columns.dimension;
      const std::string &energy = measures.energy;
      Json units = {{"step", ""}, {"time", "s"}, {"time_step", "s"}};
      for (const char *name : energies)
        units[name] = energy;
      for (const char *name : losses)
        if (columns.absorbed || name != std::string("absorbed"))
          units[name] = energy;
      units["work"] = energy;
      units["ledger_defect"] = "";
      units["broken_area"] = measures.area;
      for (const char *name : pure_columns)
        units[name] = "";
      for (const std::string &name : columns.driven)
        for (unsigned int c = 0; c < dimension; ++c)
          units["reaction_" + name + '_' + "xyz"[c]] = measures.force;
      if (columns.heat) {
        units["heat"] = units["heat_stored"] = energy;
        units["hottest"] = "K";
      }
      if (columns.heated_sides)
        units["heat_given"] = energy;
      if (columns.load_time)
        units["load_time"] = "s";
      return units;
    }

    Json summary_units(const Measures &measures)
    {
      const std::string &energy = measures.energy;
      Json units = Json::object();
      for (const char *name :
           {"dimension", "steps", "dofs", "cells", "interface_points",
            "ledger_defect_max", "residual_max", "fragments", "counters",
            "errors"})
        units[name] = "";
      for (const char *name : {"final_time", "wall_seconds", "cpu_seconds",
                               "setup_seconds", "loop_cpu_seconds", "timings"})
        units[name] = "s";
      units["peak_memory_mb"] = "MB";
      for (const char *name : energies)
        units["energy"][name] = energy;
      for (const char *name : losses)
        units["dissipated"][name] = energy;
      for (const char *name :
           {"work", "crack_pressure_work", "positive_friction_work"})
        units[name] = energy;
      units["heat"] = {{"made", energy}, {"stored", energy}, {"hottest", "K"}};
      units["viscous_traction_max"] = "Pa";
      for (const char *name :
           {"penetration_max", "penetration_bound", "rigid_drift_max"})
        units[name] = "m";
      Json &sizes = units["fragment_sizes"];
      for (const char *name : {"mean_size", "median_size", "smallest_size",
                               "largest_size", "mean_size_by_mass"})
        sizes[name] = "m";
      for (const char *name : {"total_mass", "mean_mass", "median_mass",
                               "smallest_mass", "largest_mass"})
        sizes[name] = measures.mass;
      sizes["largest_mass_share"] = "";
      sizes["mass_exponent"] = "";
      sizes["surface"] = measures.area;
      return units;
    }
  } // namespace

  std::string units_text(const HistoryFile::Columns &columns,
                         const std::vector<ObservableRecord> &observables)
  {
    const Measures measures(columns);
    Json json = Json::object();
    json["history.csv"] = history_units(columns, measures);
    for (const ObservableRecord &record : observables) {
      Json &table = json["observables/" + record.name + ".csv"];
      table = {{"step", ""}, {"time", "s"}};
      for (const ObservedColumn &column : record.columns)
        table[column.name] = column.unit;
    }
    json["summary.json"] = summary_units(measures);
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
  }
} // namespace nsfd
