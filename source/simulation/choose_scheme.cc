#include "choose_scheme.h"

#include "silence.h"

#include "records/engineering.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

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
      std::unique_ptr<SceneInput> cheaper; ///< with explicit steps, if they are
      std::string text;
      ChosenScene parts; ///< of the same, without the scene, or none
    };

    std::unique_ptr<SceneInput> copy(const SceneInput &scene)
    {
      return std::make_unique<SceneInput>(scene);
    }

    template <int dim>
    Comparison compare(const SceneInput &input,
                       const AutomaticScheme &automatic,
                       const Communicator &communicator)
    {
      if (!automatic.longest_steps && automatic.given_steps)
        return {copy(*automatic.given_steps),
                fmt::format("all bodies are rigid, and steps are those of the "
                            "scene, {}",
                            engineering(input.time.step, "s")),
                {}};
      if (!automatic.longest_steps)
        return {nullptr, automatic.refused, {}};
      auto scene = copy(*automatic.longest_steps);
      auto model = std::make_unique<Model<dim>>();
      std::vector<std::string> problems;
      std::string warnings;
      {
        const Silence silence; // until it is chosen
        problems = model->build(*scene, communicator);
        warnings = silence.unheard();
      }
      if (!problems.empty())
        return {nullptr, problems.front(), {}};

      const double longest = model->dynamic_step(*scene),
                   step = model->dynamic_step(input);
      // shorter ones are asked for by the scene, and are explicit all the more
      const bool as_given = step <= longest && automatic.given_steps;
      const double explicit_step = as_given ? step : longest;
      const double n_explicit = std::ceil(input.time.end / explicit_step),
                   n_implicit = std::ceil(input.time.end / step),
                   ratio = implicit_over_explicit(dim);
      Comparison found;
      found.text =
          fmt::format("{:.0f} explicit steps of {} or {:.0f} implicit ones of "
                      "{}, each at the cost of some {:g} explicit ones",
                      n_explicit, engineering(explicit_step, "s"), n_implicit,
                      engineering(step, "s"), ratio);
      if (n_explicit > ratio * n_implicit)
        return found;
      if (as_given) {
        found.cheaper = copy(*automatic.given_steps);
        return found;
      }
      found.cheaper = std::move(scene); // its parts refer to it
      std::get<std::unique_ptr<Model<dim>>>(found.parts.built) =
          std::move(model);
      found.parts.warnings = std::move(warnings);
      return found;
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

  ChosenScene choose_scheme(const SceneInput &input, const bool check,
                            const Communicator &communicator)
  {
    ChosenScene chosen;
    if (input.automatic) {
      Comparison found = compare(input, *input.automatic, communicator);
      if (!found.cheaper) {
        chosen.scene = copy(implicit(input, found.text));
        return chosen;
      }
      found.cheaper->scheme_choice = "explicit: " + found.text;
      chosen = std::move(found.parts);
      chosen.scene = std::move(found.cheaper);
      return chosen;
    }
    auto scene = copy(input);
    if (scene->alternative)
      scene->scheme_choice = advice(input, check, communicator);
    chosen.scene = std::move(scene);
    return chosen;
  }
} // namespace nsfd
