#pragma once

#include "nsfd/materials/material_model.h"
#include "nsfd/parameters/section_reader.h"

#include <string>

/** Entries that several models of materials read, or refuse, in the same way.
 */
namespace nsfd::materials
{
  /** Why constants are the same all over: motion is large; else nothing. */
  std::string why_uniform(const MaterialSetting &setting);

  /**
   * Density, Young's modulus and Poisson's ratio. They may depend on the place
   * unless @p uniform says why not.
   */
  void read_isotropic(SectionReader &reader, const std::string &uniform,
                      MaterialInput &material);

  /** Density of a material whose moduli are others or none. */
  void read_density(SectionReader &reader, const std::string &uniform,
                    MaterialInput &material);

  /** Viscosity of small strain; refused where motion is large. */
  void read_viscosity(SectionReader &reader, const MaterialSetting &setting,
                      MaterialInput &material);

  /** Report a model that needs `motion = small` or `large` and has the other.
   */
  void demand_small_motion(SectionReader &reader,
                           const MaterialSetting &setting,
                           const MaterialInput &material);
  void demand_large_motion(SectionReader &reader,
                           const MaterialSetting &setting,
                           const MaterialInput &material);

  /** Entries of other models, where they stand in the block of this one. */
  void refuse_isotropic(SectionReader &reader, const std::string &reason);
  void refuse_axis(SectionReader &reader); ///< of all anisotropic models
  void refuse_transverse(SectionReader &reader);
  void refuse_cubic(SectionReader &reader);
  void refuse_orthotropic(SectionReader &reader);
  void refuse_orientation(SectionReader &reader);
  void refuse_viscosity(SectionReader &reader, const std::string &reason);
  void refuse_flow(SectionReader &reader);
  void refuse_rigid_bodies(SectionReader &reader, const std::string &reason);
} // namespace nsfd::materials
