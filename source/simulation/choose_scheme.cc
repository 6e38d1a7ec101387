#include "choose_scheme.h"

#include "model.h"
#include "silence.h"

#include "records/engineering.h"

#include <fmt/format.h>

#include <cmath>

namespace nsfd
{
  namespace
  {
    SceneInput implicit(const SceneInput &input, const std::string &why)
    {
      SceneInput scene = input;
      scene.echo = input.automatic->implicit_echo;
      scene.automatic.reset();
      scene.scheme_choice = "moreau-jean: " + why;
      return scene;
    }

    /** The steps of both schemes. */
    struct Comparison {
      const SceneInput *cheaper = nullptr; ///< with explicit steps, if they are
      std::string text;
    };

    template <int dim>
    Comparison compare(const SceneInput &input,
                       const AutomaticScheme &automatic,
                       const Communicator &communicator)
    {
      if (!automatic.longest_steps && automatic.given_steps)
        return {automatic.given_steps.get(),
                fmt::format("all bodies are rigid, and steps are those of the "
                            "scene, {}",
                            engineering(input.time.step, "s"))};
      if (!automatic.longest_steps)
        return {nullptr, automatic.refused};
      Model<dim> model;
      std::vector<std::string> problems;
      {
        const Silence silence; // the same warnings come with the one chosen
        problems = model.build(*automatic.longest_steps, communicator);
      }
      if (!problems.empty())
        return {nullptr, problems.front()};

      const double longest = model.dynamic_step(*automatic.longest_steps),
                   step = model.dynamic_step(input);
      // shorter ones are asked for by the scene, and are explicit all the more
      const bool as_given = step <= longest && automatic.given_steps;
      const double explicit_step = as_given ? step : longest;
      const double n_explicit = std::ceil(input.time.end / explicit_step),
                   n_implicit = std::ceil(input.time.end / step),
                   ratio = implicit_over_explicit(dim);
      const auto &scene =
          as_given ? *automatic.given_steps : *automatic.longest_steps;
      return {
          n_explicit > ratio * n_implicit ? nullptr : &scene,
          fmt::format("{:.0f} explicit steps of {} or {:.0f} implicit ones of "
                      "{}, each at the cost of some {:g} explicit ones",
                      n_explicit, engineering(explicit_step, "s"), n_implicit,
                      engineering(step, "s"), ratio)};
    }

    Comparison compare(const SceneInput &input,
                       const AutomaticScheme &automatic,
                       const Communicator &communicator)
    {
      return input.dimension == 2 ? compare<2>(input, automatic, communicator)
                                  : compare<3>(input, automatic, communicator);
    }

    /** Of a scene that names no scheme, where explicit steps cost less. */
    std::string advice(const SceneInput &input, const bool check,
                       const Communicator &communicator)
    {
      const std::string text =
          "moreau-jean, as `step` is given; scheme = auto "
          "would take explicit steps, which cost less here";
      if (check) {
        const Comparison found =
            compare(input, *input.alternative, communicator);
        return found.cheaper ? text + ": " + found.text : "";
      }
      // the mesh is not built a second time for this
      return input.time.step_kind == StepKind::courant && input.time.step <= 1.
                 ? text
                 : "";
    }
  } // namespace

  SceneInput choose_scheme(const SceneInput &input, const bool check,
                           const Communicator &communicator)
  {
    if (input.automatic) {
      const Comparison found = compare(input, *input.automatic, communicator);
      if (!found.cheaper)
        return implicit(input, found.text);
      SceneInput scene = *found.cheaper;
      scene.scheme_choice = "explicit: " + found.text;
      return scene;
    }
    SceneInput scene = input;
    if (scene.alternative)
      scene.scheme_choice = advice(input, check, communicator);
    return scene;
  }
} // namespace nsfd
