#include "nsfd/materials/material_entries.h"

#include <fmt/format.h>

#include <cmath>

namespace nsfd
{
  namespace
  {
    void read_finite_strain(SectionReader &reader,
                            const MaterialSetting &setting,
                            MaterialInput &material)
    {
      using namespace materials;
      refuse_axis(reader);
      read_isotropic(reader, why_uniform(setting), material);
      read_viscosity(reader, setting, material);
      refuse_flow(reader);
      refuse_rigid_bodies(reader, "the material is not rigid");
    }
  } // namespace

  /** Hooke's law between the Green strain and the stress that goes with it. */
  class SaintVenantKirchhoffModel final : public MaterialModel
  {
  public:
    MaterialKind kind() const override { return MaterialKind::finite_strain; }
    unsigned int place() const override { return 3; }

    void read(SectionReader &reader, const MaterialSetting &setting,
              MaterialInput &material) override
    {
      materials::demand_large_motion(reader, setting, material);
      read_finite_strain(reader, setting, material);
    }

    double stress_across(const double lambda, const Voigt<2> &C) const override
    {
      return lambda * (C[0] + C[1] - 2.) / 2.;
    }

  private:
    void
    make_energy(const MaterialInput &material, const bool plane_stress,
                std::unique_ptr<const Hyperelastic<2>> &result) const override
    {
      result = make_saint_venant_kirchhoff<2>(material.young, material.poisson,
                                              plane_stress);
    }
    void
    make_energy(const MaterialInput &material, const bool plane_stress,
                std::unique_ptr<const Hyperelastic<3>> &result) const override
    {
      result = make_saint_venant_kirchhoff<3>(material.young, material.poisson,
                                              plane_stress);
    }
  };

  /** Compressible, and resists being crushed. */
  class NeoHookean final : public MaterialModel
  {
  public:
    MaterialKind kind() const override { return MaterialKind::finite_strain; }
    unsigned int place() const override { return 4; }

    void read(SectionReader &reader, const MaterialSetting &setting,
              MaterialInput &material) override
    {
      materials::demand_large_motion(reader, setting, material);
      if (setting.plane_stress)
        reader.error(
            "model",
            fmt::format("model = {} is not available for plane = stress",
                        material.model_name),
            "write plane = strain, or model = saint-venant "
            "kirchhoff");
      read_finite_strain(reader, setting, material);
    }

    double stress_across(const double lambda, const Voigt<2> &C) const override
    {
      return lambda / 2. * std::log(determinant(C));
    }

  private:
    void
    make_energy(const MaterialInput &material, bool,
                std::unique_ptr<const Hyperelastic<2>> &result) const override
    {
      result = make_neo_hooke<2>(material.young, material.poisson);
    }
    void
    make_energy(const MaterialInput &material, bool,
                std::unique_ptr<const Hyperelastic<3>> &result) const override
    {
      result = make_neo_hooke<3>(material.young, material.poisson);
    }
  };

  NSFD_REGISTER(
      MaterialRegistry, SaintVenantKirchhoffModel, "saint-venant kirchhoff",
      "Hooke's law between the Green strain and its stress; large "
      "rotations, moderate strains; motion = large",
      "Young modulus = 2 GPa; Poisson ratio = 0.3; density = 1000 kg/m^3");
  NSFD_REGISTER(
      MaterialRegistry, NeoHookean, "neo-hookean",
      "compressible, resists being crushed; motion = large",
      "Young modulus = 2 GPa; Poisson ratio = 0.3; density = 1000 kg/m^3");
} // namespace nsfd
