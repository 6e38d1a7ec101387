#include "anisotropy.h"
#include "orientation_entries.h"

#include "nsfd/materials/material_entries.h"
#include "parameters/input_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    const std::vector<std::string> cubic_names = {"C11", "C12", "C44"},
                                   bar_names = {"Young modulus",
                                                "Poisson ratio",
                                                "shear modulus"};

    /** Those of cubes with these entries. */
    HookeMatrix cubic_matrix(const double C11, const double C12,
                             const double C44)
    {
      HookeMatrix C{};
      for (unsigned int i = 0; i < 3; ++i) {
        for (unsigned int j = 0; j < 3; ++j)
          C[i][j] = i == j ? C11 : C12;
        C[i + 3][i + 3] = C44;
      }
      return C;
    }

    /** C11, C12, C44; C11 = 0 if something is wrong. */
    std::array<double, 3> read_constants(SectionReader &reader)
    {
      const unsigned int n_before = reader.errors().n_errors();
      std::array<double, 3> C{};
      const char *const texts[] = {
          "Pa, of Hooke's matrix in the axes of the cube",
          "Pa, between two axes of the cube", "Pa, of shear along its faces"};
      for (const unsigned int k : {0u, 1u, 2u})
        C[k] =
            reader.number(cubic_names[k], "", units::pressure,
                          k == 1 ? Range::any() : Range::positive(), texts[k]);
      reader.refuse(bar_names, "the block gives C11, C12 and C44; write those "
                               "three, or the three moduli of the cube");
      if (reader.errors().n_errors() > n_before)
        return {};
      if (C[1] < C[0] && C[1] > -C[0] / 2.)
        return C;
      reader.error(cubic_names[1],
                   fmt::format("C12 = {:g} Pa makes a state of strain with "
                               "negative energy: it must lie between -C11/2 "
                               "and C11",
                               C[1]),
                   fmt::format("write a number above {:g} and below {:g} Pa",
                               -C[0] / 2., C[0]));
      return {};
    }

    /** From a bar along an edge of the cube. */
    std::array<double, 3> read_moduli(SectionReader &reader)
    {
      const unsigned int n_before = reader.errors().n_errors();
      const double E = reader.number(bar_names[0], "", units::pressure,
                                     Range::positive(),
                                     "Pa, of a bar along an edge of the cube"),
                   nu = reader.number(bar_names[1], "", units::none,
                                      {-1., 0.5, true, true},
                                      "lateral over axial strain of that bar"),
                   G = reader.number(
                       bar_names[2], "", units::pressure, Range::positive(),
                       "Pa, of shear along the faces of the cube");
      if (reader.errors().n_errors() > n_before)
        return {};
      const double C12 = E * nu / ((1. + nu) * (1. - 2. * nu));
      return {{C12 + E / (1. + nu), C12, G}};
    }

    constexpr const char *pairs[] = {"12", "13", "23"};

    /**
     * Nine constants. nu_ij is the contraction along j over the extension along
     * i, so that nu_ij/E_i = nu_ji/E_j. Nothing is definite before it is
     * checked.
     */
    bool read_orthotropic(SectionReader &reader, HookeMatrix &C)
    {
      const unsigned int n_before = reader.errors().n_errors();
      std::array<double, 3> E, nu, G;
      for (unsigned int k = 0; k < 3; ++k)
        E[k] = reader.number(
            fmt::format("E{}", k + 1), "", units::pressure, Range::positive(),
            fmt::format("Pa, Young's modulus along axis {}", k + 1));
      for (unsigned int k = 0; k < 3; ++k)
        nu[k] = reader.number(
            fmt::format("nu{}", pairs[k]), "", units::none, Range::any(),
            fmt::format("contraction along {} over extension along {}",
                        pairs[k][1], pairs[k][0]));
      for (unsigned int k = 0; k < 3; ++k)
        G[k] = reader.number(fmt::format("G{}", pairs[k]), "", units::pressure,
                             Range::positive(),
                             fmt::format("Pa, of shear between axes {} and {}",
                                         pairs[k][0], pairs[k][1]));
      if (reader.errors().n_errors() > n_before)
        return false;
      const double *const of_first[] = {&E[0], &E[0], &E[1]},
                          *const of_second[] = {&E[1], &E[2], &E[2]};
      for (unsigned int k = 0; k < 3; ++k) {
        const double bound = std::sqrt(*of_first[k] / *of_second[k]);
        if (std::abs(nu[k]) >= bound)
          reader.error(
              fmt::format("nu{}", pairs[k]),
              fmt::format("nu{} = {:g} makes a state of strain with negative "
                          "energy: its square must be below E{}/E{}",
                          pairs[k], nu[k], pairs[k][0], pairs[k][1]),
              fmt::format("write a number between {:.4g} and {:.4g}; it is the "
                          "contraction along {} over the extension along {}",
                          -bound, bound, pairs[k][1], pairs[k][0]));
      }
      // compliances in units of 1/sqrt(E_i E_j): a matrix of ones and
      // coefficients below 1
      const double a = -nu[0] * std::sqrt(E[1] / E[0]),
                   b = -nu[1] * std::sqrt(E[2] / E[0]),
                   c = -nu[2] * std::sqrt(E[2] / E[1]),
                   D = 1. - a * a - b * b - c * c + 2. * a * b * c;
      if (reader.errors().n_errors() == n_before && !(D > 0.))
        reader.error(
            "nu12",
            fmt::format("nu12, nu13 and nu23 together make a state of strain "
                        "with negative energy: 1 - nu12^2 E2/E1 - nu13^2 E3/E1 "
                        "- nu23^2 E3/E2 - 2 nu12 nu13 nu23 E3/E1 = {:.4g} must "
                        "be positive",
                        D),
            "write smaller ones; nu_ij is the contraction along j over the "
            "extension along i");
      if (reader.errors().n_errors() > n_before)
        return false;
      // its inverse, and back to stresses
      const double inverse[3][3] = {{1. - c * c, b * c - a, a * c - b},
                                    {b * c - a, 1. - b * b, a * b - c},
                                    {a * c - b, a * b - c, 1. - a * a}};
      C = {};
      for (unsigned int i = 0; i < 3; ++i) {
        for (unsigned int j = 0; j < 3; ++j)
          C[i][j] = std::sqrt(E[i] * E[j]) * inverse[i][j] / D;
        C[i + 3][i + 3] = G[i]; // 12, 13, 23
      }
      return true;
    }

    /** What is the same for both. */
    void read_others(SectionReader &reader, const MaterialSetting &setting,
                     const bool is_known, const HookeMatrix &C,
                     MaterialInput &material)
    {
      using namespace materials;
      AnisotropicInput input;
      if (is_known)
        input = anisotropic_of(C);
      input.orientation = read_orientation(reader, setting);
      material.anisotropic =
          std::make_shared<const AnisotropicInput>(std::move(input));
      read_density(reader, why_uniform(setting), material);
      material.young = material.poisson =
          std::numeric_limits<double>::quiet_NaN();
      read_viscosity(reader, setting, material);
      refuse_transverse(reader);
      refuse_flow(reader);
      refuse_rigid_bodies(reader, "the material is not rigid");
    }
  } // namespace

  /** Hooke's law of cubic crystals. */
  class Cubic final : public MaterialModel
  {
  public:
    MaterialKind kind() const override { return MaterialKind::small_strain; }
    unsigned int place() const override { return 2; }

    void read(SectionReader &reader, const MaterialSetting &setting,
              MaterialInput &material) override
    {
      materials::demand_small_motion(reader, setting, material);
      materials::refuse_orthotropic(reader);
      const auto given = [&](const std::vector<std::string> &names) {
        return std::any_of(
            names.begin(), names.end(),
            [&](const std::string &name) { return reader.has(name); });
      };
      const auto [C11, C12, C44] = given(bar_names) && !given(cubic_names)
                                       ? read_moduli(reader)
                                       : read_constants(reader);
      read_others(reader, setting, C11 > 0., cubic_matrix(C11, C12, C44),
                  material);
    }
  };

  /** Hooke's law of three planes of symmetry. */
  class Orthotropic final : public MaterialModel
  {
  public:
    MaterialKind kind() const override { return MaterialKind::small_strain; }
    unsigned int place() const override { return 3; }

    void read(SectionReader &reader, const MaterialSetting &setting,
              MaterialInput &material) override
    {
      using namespace materials;
      demand_small_motion(reader, setting, material);
      refuse_cubic(reader);
      refuse_isotropic(reader, "the material is orthotropic and has E1, E2, "
                               "E3, nu12, nu13 and nu23");
      HookeMatrix C{};
      const bool is_known = read_orthotropic(reader, C);
      read_others(reader, setting, is_known, C, material);
    }
  };

  NSFD_REGISTER(MaterialRegistry, Cubic, "cubic",
                "Hooke's law of cubic crystals, turned by grain: metals; "
                "motion = small",
                "C11 = 168.4 GPa; C12 = 121.4 GPa; C44 = 75.4 GPa; density = "
                "8960 kg/m^3",
                "Young modulus = 66.7 GPa; Poisson ratio = 0.419; shear "
                "modulus = 75.4 GPa; density = 8960 kg/m^3; orientation = "
                "random");
  NSFD_REGISTER(MaterialRegistry, Orthotropic, "orthotropic",
                "Hooke's law of three planes of symmetry: wood, rolled sheet, "
                "weaves; motion = small",
                "E1 = 12 GPa; E2 = 0.8 GPa; E3 = 0.5 GPa; nu12 = 0.4; nu13 = "
                "0.4; nu23 = 0.5; G12 = 0.7 GPa; G13 = 0.6 GPa; G23 = 0.05 "
                "GPa; density = 450 kg/m^3");
} // namespace nsfd
