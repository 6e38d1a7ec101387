#include "step_entry.h"

#include "nsfd/parameters/section_reader.h"
#include "nsfd/scene/scene_input.h"
#include "parameters/former_words.h"
#include "parameters/input_errors.h"
#include "parameters/parameter_file.h"
#include "parameters/quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace nsfd
{
  namespace
  {
    /** Splits "0.6 courant" into "0.6" and "courant". */
    std::pair<SourceText, std::string> split_last_word(const SourceText &value)
    {
      const std::size_t begin = begin_of_last_word(value.text());
      return {value.part(0, begin), value.text().substr(begin)};
    }
  } // namespace

  void read_step(SectionReader &reader, const std::string &name,
                 TimeInput &time, const std::string &default_text)
  {
    const auto value = reader.raw(
        name, default_text,
        "a time, a Courant number h c_p / L of the smallest cell, or auto");
    if (!value || value->text() == "auto") {
      time.step_kind = StepKind::automatic;
      return;
    }
    const auto [number, word] = split_last_word(*value);
    const std::string meant = did_you_mean_today(
        word, {"courant"}, FormerWord::Place::unit, "Time", name);
    if (word == "courant") {
      time.step_kind = StepKind::courant;
      time.step = reader.number_in(number, name, "0.5 courant", units::none,
                                   Range::positive());
    } else if (!find_unit(word) && !meant.empty())
      reader.error(
          name,
          fmt::format("{} = {}: `{}` is not a unit", name, value->text(), word),
          meant);
    else if (nearest_name(value->text(), {"auto"}) == "auto")
      reader.error(name,
                   fmt::format("{} = {} is not a step", name, value->text()),
                   "did you mean `auto`?");
    else {
      time.step_kind = StepKind::time;
      time.step = reader.number_in(*value, name, "0.5 courant", units::time,
                                   Range::positive());
    }
  }

  bool all_rigid(const SceneInput &scene)
  {
    return !scene.materials.empty() &&
           std::all_of(scene.materials.begin(), scene.materials.end(),
                       [](const MaterialInput &m) { return m.rigid; });
  }

  void check_step(SectionReader &reader, const SceneInput &scene)
  {
    if (all_rigid(scene) && scene.time.step_kind != StepKind::time)
      reader.error("step",
                   "the step must be a time: all materials are rigid, and no "
                   "wave crosses a cell",
                   "write for example: set step = 1 us");
  }

  double read_load_step(SectionReader &reader)
  {
    const auto step = reader.raw("step", "", "a time: of the load", "1 ms");
    if (!step)
      return 0.;
    const std::string word = split_last_word(*step).second;
    if (word != "auto" && word != "courant")
      return reader.number_in(*step, "step", "1 ms", units::time,
                              Range::positive());
    reader.error("step",
                 fmt::format("step = {}: a quasi-static step is a time of the "
                             "load, no wave counts in it",
                             step->text()),
                 "write for example: set step = 1 ms");
    return 0.;
  }
} // namespace nsfd
