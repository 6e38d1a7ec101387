#include "serialize_state.h"

#include "nsfd/core/archive.h"
#include "state/point_fields.h"

namespace nsfd
{
  namespace
  {
    /** Whole numbers below 2^53. */
    template <typename Number>
    void serialize_numbers(const std::string &name,
                           std::vector<Number> &numbers, Archive &archive)
    {
      std::vector<double> values(numbers.begin(), numbers.end());
      archive.common(name, values);
      numbers.assign(values.begin(), values.end());
    }
    template <typename Number>
    void serialize_points(const std::string &name, std::vector<Number> &values,
                          Archive &archive)
    {
      archive.points(name, values);
    }

    void serialize_points(const std::string &name,
                          std::vector<PointKind> &kinds, Archive &archive)
    {
      std::vector<std::uint8_t> values(kinds.size());
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = std::uint8_t(kinds[i]);
      archive.points(name, values);
      kinds.resize(values.size());
      for (std::size_t i = 0; i < values.size(); ++i)
        kinds[i] = PointKind(values[i]);
    }
  } // namespace

  void serialize(State &s, Archive &archive)
  {
    const Archive::Part part(archive, "state");
    archive.numbers("step", s.step);
    archive.numbers("time", s.time, s.last_step, s.kept_step);
    archive.common("stopped_loads", s.clock.stopped);
    archive.numbers("growth_step", s.growth_step);
    archive.bodies("displacement", s.displacement);
    archive.bodies("velocity", s.velocity);
    for_point_fields(
        [&](const PointField &field, const auto member, const auto &...) {
          serialize_points(field.name, s.*member, archive);
        });
    archive.common("rigid", s.rigid);
    archive.bodies("last_way", s.last_way);
    archive.common("obstacle_shift", s.obstacle_shift);
    archive.histories("material_history", s.material_history);
    archive.cells("temperature", s.heat.temperature);
    archive.points("temperature_at_faces", s.heat.at_faces);
    archive.points("temperature_of_laws", s.heat.of_laws);
    archive.numbers("heat", s.heat.made, s.heat.given, s.heat.stored,
                    s.heat.moved, s.heat.hottest, s.heat.hottest_of_run,
                    s.heat.conducted_until);
    archive.common("surface_impulse", s.surface_impulse);
    archive.common("surface_slip", s.surface_slip);
    archive.common("surface_worn", s.surface_worn);
    archive.common("surface_wear_speed", s.surface_wear_speed);
    archive.common("surface_overlap", s.surface_overlap);
    archive.common("surface_approach", s.surface_approach);
    serialize_numbers("surface_contact", s.surface_contact, archive);
    serialize_numbers("surface_facet", s.surface_facet, archive);
    archive.common("surface_gap", s.surface_gap);
    bool has_viscous = s.viscous_traction.has_value();
    double viscous = s.viscous_traction.value_or(0.);
    archive.numbers("viscous_traction", has_viscous, viscous);
    s.viscous_traction.reset();
    if (has_viscous)
      s.viscous_traction = viscous;
    auto &e = s.energy;
    archive.numbers("energy", e.kinetic, e.elastic, e.cohesive, e.damage,
                    e.friction, e.viscous, e.plastic, e.impact, e.numerical,
                    e.work, e.absorbed);
    archive.numbers("sums", s.initial_energy, s.largest_energy, s.penetration,
                    s.penetration_excess, s.rigid_drift,
                    s.positive_friction_work, s.broken_area, s.pressure_work);
  }
} // namespace nsfd
