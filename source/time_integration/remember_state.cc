#include "remember_state.h"

#include "core/archive.h"
#include "state/state.h"

namespace nsfd
{
  namespace
  {
    /** Whole numbers below 2^53. */
    template <typename Number>
    void remember_numbers(const std::string &name, std::vector<Number> &numbers,
                          Archive &archive)
    {
      std::vector<double> values(numbers.begin(), numbers.end());
      archive.common(name, values);
      numbers.assign(values.begin(), values.end());
    }
  } // namespace

  void remember(State &s, Archive &archive)
  {
    const Archive::Part part(archive, "state");
    archive.numbers("step", s.step);
    archive.numbers("time", s.time, s.last_step);
    archive.bodies("displacement", s.displacement);
    archive.bodies("velocity", s.velocity);
    archive.points("jump", s.jump);
    archive.points("relative_velocity", s.relative_velocity);
    archive.points("impulse", s.impulse);
    archive.points("opening_max", s.opening_max);
    archive.points("slip_max", s.slip_max);
    archive.points("beta", s.beta);
    archive.points("slip", s.slip);
    archive.points("dilated", s.dilated);
    archive.points("worn", s.worn);
    archive.points("dilation_speed", s.dilation_speed);
    archive.points("wear_speed", s.wear_speed);
    archive.points("released_overlap", s.released_overlap);
    archive.points("approach", s.approach);
    std::vector<std::uint8_t> kind(s.kind.size());
    for (std::size_t i = 0; i < kind.size(); ++i)
      kind[i] = std::uint8_t(s.kind[i]);
    archive.points("kind", kind);
    s.kind.resize(kind.size());
    for (std::size_t i = 0; i < kind.size(); ++i)
      s.kind[i] = PointKind(kind[i]);
    archive.points("two_sided", s.two_sided);
    archive.points("contact", s.contact);
    archive.points("bond_traction", s.bond_traction);
    archive.points("pressure", s.pressure);
    archive.points("point_force", s.point_force);
    archive.common("rigid", s.rigid);
    archive.common("obstacle_shift", s.obstacle_shift);
    archive.histories("material_history", s.material_history);
    archive.common("surface_impulse", s.surface_impulse);
    archive.common("surface_slip", s.surface_slip);
    archive.common("surface_worn", s.surface_worn);
    archive.common("surface_wear_speed", s.surface_wear_speed);
    archive.common("surface_overlap", s.surface_overlap);
    archive.common("surface_approach", s.surface_approach);
    remember_numbers("surface_contact", s.surface_contact, archive);
    remember_numbers("surface_facet", s.surface_facet, archive);
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
                    e.work);
    archive.numbers("sums", s.initial_energy, s.largest_energy, s.penetration,
                    s.penetration_excess, s.rigid_drift,
                    s.positive_friction_work, s.broken_area, s.pressure_work);
  }
} // namespace nsfd
