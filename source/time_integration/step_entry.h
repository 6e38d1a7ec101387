#pragma once

#include <string>

namespace nsfd
{
  class SectionReader;
  struct SceneInput;
  struct TimeInput;

  /** A time, a Courant number or `auto`: the step of time. */
  void read_step(SectionReader &reader, const std::string &name,
                 TimeInput &time,
                 const std::string &default_text = "0.5 courant");

  /** Where no wave crosses a cell the step must be a time. */
  void check_step(SectionReader &reader, const SceneInput &scene);

  bool all_rigid(const SceneInput &scene);

  /** `step` of the load, s; reported if it is no time. */
  double read_load_step(SectionReader &reader);
} // namespace nsfd
