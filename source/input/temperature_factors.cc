#include "temperature_factors.h"

#include "nsfd/scene/scene_input.h"
#include "parameters/input_errors.h"
#include "parameters/parameter_file.h"

#include <fmt/format.h>

namespace nsfd
{
  namespace
  {
    constexpr const char *no_heat = "no material has a heat capacity";

    std::string entry_of(const std::string &what)
    {
      return what + " at temperatures";
    }

    /** `293 K: 1, 600 K: 0.7`; nothing if the file does not give it. */
    TemperatureFactor read_factor(SectionReader &reader,
                                  const std::string &what, const Range range)
    {
      const std::string name = entry_of(what),
                        text = "temperature : factor of the " + what +
                               ", ...; linear in between, constant beyond; "
                               "default: 1",
                        example = "293 K : 1, 600 K : 0.7";
      TemperatureFactor result;
      if (!reader.optional(name, text))
        return result;
      const auto value = reader.raw(name, "", text, example);
      if (!value)
        return result;
      for (const SourceText &pair : value->split(',')) {
        const auto parts = pair.split(':');
        if (parts.size() != 2) {
          reader.errors().error(
              pair.location(),
              fmt::format("{}: `{}` is not a temperature and a factor", name,
                          pair.text()),
              "write for example " + example);
          continue;
        }
        const double T = reader.number_in(parts[0], name, "293 K",
                                          units::temperature,
                                          Range::non_negative()),
                     factor = reader.number_in(parts[1], name, "0.7",
                                               units::none, range);
        if (!result.temperature.empty() && !(T > result.temperature.back()))
          reader.errors().error(
              parts[0].location(),
              fmt::format("{}: {:.6g} K comes after {:.6g} K", name, T,
                          result.temperature.back()),
              "write the temperatures from the lowest to the highest");
        result.temperature.push_back(T);
        result.factor.push_back(factor);
      }
      return result;
    }
  } // namespace

  TemperatureFactor read_friction_factor(SectionReader &reader,
                                         const SceneInput &scene,
                                         const double friction,
                                         const SlidingInput &sliding)
  {
    const std::string name = entry_of("friction");
    if (!scene.has_heat() || friction == 0.) {
      reader.refuse({name},
                    scene.has_heat() ? "there is no `friction`" : no_heat);
      return {};
    }
    const TemperatureFactor factor =
        read_factor(reader, "friction", Range::non_negative());
    if (factor.is_given() && sliding.dilatancy <= friction &&
        sliding.dilatancy > friction * factor.least())
      reader.error(
          name,
          fmt::format("dilatancy = {:g} is above the least friction, {:g}: "
                      "sliding would give energy",
                      sliding.dilatancy, friction * factor.least()),
          "write a smaller dilatancy or larger factors");
    return factor;
  }

  void read_law_factors(SectionReader &reader, const SceneInput &scene,
                        InterfaceInput &input)
  {
    const std::vector<std::string> names = {entry_of("strength"),
                                            entry_of("toughness")};
    if (!scene.has_heat())
      return reader.refuse(names, no_heat);
    if (input.law && !input.law->extrinsic())
      return reader.refuse(
          names, fmt::format("the law {} is intrinsic: its springs hold energy "
                             "before they soften, and would get or lose some "
                             "with the temperature",
                             input.law_name));
    input.heat.strength = read_factor(reader, "strength", Range::positive());
    input.heat.toughness = read_factor(reader, "toughness", Range::positive());
  }
} // namespace nsfd
