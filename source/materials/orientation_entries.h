#pragma once

#include "nsfd/materials/material_model.h"
#include "nsfd/parameters/section_reader.h"

namespace nsfd::materials
{
  /** How the axes of the crystals lie: `orientation` and what belongs to it. */
  OrientationInput read_orientation(SectionReader &reader,
                                    const MaterialSetting &setting);
} // namespace nsfd::materials
