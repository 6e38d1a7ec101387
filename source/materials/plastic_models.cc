#include "nsfd/materials/material_entries.h"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace nsfd
{
  namespace
  {
    const std::vector<std::string> overstress_names = {
        "viscosity", "rate exponent", "reference rate"};

    /** R(p) = isotropic p + Q (1 - exp(-b p)) or a power law; X = 2/3 kinematic
        eps_p. */
    void read_hardening(SectionReader &reader, PlasticInput &plastic)
    {
      plastic.yield_stress =
          reader.number("yield stress", "", units::pressure, Range::positive(),
                        "Pa, in uniaxial stress, before any flow");
      const std::string
          power = "hardening exponent",
          power_text = "N of the power law strain = yield/E "
                       "(stress/yield)^(1/N) beyond yield, in place of the "
                       "other isotropic hardening";
      const std::string by_power =
          "the yield stress grows by the power law of `" + power + "`";
      const bool has_power = reader.optional(power, power_text);
      if (has_power) {
        plastic.hardening_exponent = reader.number(
            power, "", units::none, {1e-6, 1., false, true}, power_text);
        reader.refuse({"isotropic hardening modulus"}, by_power);
      } else
        plastic.isotropic =
            reader.number("isotropic hardening modulus", "0", units::pressure,
                          Range::non_negative(),
                          "Pa, growth of the yield stress with the flow");
      plastic.kinematic = reader.number(
          "kinematic hardening modulus", "0", units::pressure,
          Range::non_negative(),
          "Pa, of the back stress in uniaxial stress; the middle of the "
          "surface follows the flow");
      const std::string exponent = "saturation exponent";
      if (has_power) {
        reader.refuse({"saturation stress", exponent}, by_power);
        return;
      }
      plastic.saturation_stress = reader.number(
          "saturation stress", "0", units::pressure, Range::non_negative(),
          "Pa, Q of Q (1 - exp(-b p)), which the yield stress "
          "grows by in the end");
      if (plastic.saturation_stress == 0.)
        reader.refuse({exponent}, "there is no `saturation stress`");
      else
        plastic.saturation_exponent =
            reader.number(exponent, "", units::none, Range::positive(), "b");
    }

    void read_overstress(SectionReader &reader, PlasticInput &plastic)
    {
      constexpr Unit per_time{0, 0, -1};
      plastic.viscosity = reader.number(
          "viscosity", "", units::viscosity, Range::positive(),
          "Pa s, overstress over rate of flow (at the reference rate)");
      plastic.rate_exponent = reader.number(
          "rate exponent", "1", units::none, {1., 1e3, false, false},
          "n: the rate grows like the overstress to the n");
      const std::string rate = "reference rate";
      if (plastic.rate_exponent == 1.)
        reader.refuse({rate}, "it is of no effect where `rate exponent` is 1");
      else
        plastic.reference_rate = reader.number(
            rate, "", per_time, Range::positive(),
            "1/s, r of overstress = viscosity r (rate / r)^(1/n)");
    }

    /** All but the overstress. */
    void read_plastic(SectionReader &reader, const MaterialSetting &setting,
                      MaterialInput &material)
    {
      using namespace materials;
      if (setting.plane_stress && setting.large_motion)
        reader.error(
            "model",
            fmt::format("model = {} is not available for plane = stress "
                        "with motion = large",
                        material.model_name),
            "write plane = strain, or motion = small");
      refuse_axis(reader);
      const std::string uniform = why_uniform(setting);
      read_isotropic(reader, uniform.empty() ? "the material flows" : uniform,
                     material);
      refuse_viscosity(reader, "it belongs to elastic materials");
      read_hardening(reader, material.plastic.emplace());
    }
  } // namespace

  /** Flow on the surface of von Mises, which grows and moves. */
  class J2Plastic : public MaterialModel
  {
  public:
    MaterialKind kind() const override
    {
      return MaterialKind::history_dependent;
    }
    unsigned int place() const override { return 5; }

    void read(SectionReader &reader, const MaterialSetting &setting,
              MaterialInput &material) override
    {
      read_plastic(reader, setting, material);
      reader.refuse(overstress_names, "it belongs to model = viscoplastic");
      materials::refuse_rigid_bodies(reader, "the material is not rigid");
    }

  private:
    void make_history(
        const MaterialInput &material, const bool finite_strain,
        const bool plane_stress,
        std::unique_ptr<const HistoryMaterial<2>> &result) const override
    {
      result = make_history_material<2>(material.young, material.poisson,
                                        *material.plastic, finite_strain,
                                        plane_stress);
    }
    void make_history(
        const MaterialInput &material, const bool finite_strain,
        const bool plane_stress,
        std::unique_ptr<const HistoryMaterial<3>> &result) const override
    {
      result = make_history_material<3>(material.young, material.poisson,
                                        *material.plastic, finite_strain,
                                        plane_stress);
    }
  };

  /** The same, and beyond the surface by an overstress. */
  class Viscoplastic final : public J2Plastic
  {
  public:
    unsigned int place() const override { return 6; }

    void read(SectionReader &reader, const MaterialSetting &setting,
              MaterialInput &material) override
    {
      read_plastic(reader, setting, material);
      read_overstress(reader, *material.plastic);
      materials::refuse_rigid_bodies(reader, "the material is not rigid");
    }
  };

  NSFD_REGISTER(MaterialRegistry, J2Plastic, "j2 plastic",
                "flow on the surface of von Mises, which grows and moves; "
                "small or large motion",
                "Young modulus = 2 GPa; Poisson ratio = 0.3; density = 1000 "
                "kg/m^3; yield stress = 20 MPa");
  NSFD_REGISTER(MaterialRegistry, Viscoplastic, "viscoplastic",
                "the same, and beyond the surface by an overstress that grows "
                "with the rate; small or large motion",
                "Young modulus = 2 GPa; Poisson ratio = 0.3; density = 1000 "
                "kg/m^3; yield stress = 20 MPa; viscosity = 1e6 Pa*s");
} // namespace nsfd
