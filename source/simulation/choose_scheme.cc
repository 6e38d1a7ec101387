#include "choose_scheme.h"

#include "model.h"

#include "records/engineering.h"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <sstream>

namespace nsfd
{
  namespace
  {
    /** The same warnings come with the scene that is chosen. */
    class Silence
    {
    public:
      Silence() : before_(std::cerr.rdbuf(unheard_.rdbuf())) {}
      ~Silence() { std::cerr.rdbuf(before_); }
      Silence(const Silence &) = delete;
      Silence &operator=(const Silence &) = delete;

    private:
      std::ostringstream unheard_;
      std::streambuf *before_;
    };

    SceneInput implicit(const SceneInput &input, const std::string &why)
    {
      SceneInput scene = input;
      scene.echo = input.automatic->implicit_echo;
      scene.automatic.reset();
      scene.scheme_choice = "moreau-jean: " + why;
      return scene;
    }

    template <int dim>
    SceneInput choose(const SceneInput &input, const Communicator &communicator)
    {
      const AutomaticScheme &automatic = *input.automatic;
      if (!automatic.longest_steps)
        return implicit(input, automatic.refused);
      Model<dim> model;
      std::vector<std::string> problems;
      {
        const Silence silence;
        problems = model.build(*automatic.longest_steps, communicator);
      }
      if (!problems.empty())
        return implicit(input, problems.front());

      const double longest = model.dynamic_step(*automatic.longest_steps),
                   step = model.dynamic_step(input);
      // shorter ones are asked for by the scene, and are explicit all the more
      const bool as_given = step <= longest && automatic.given_steps;
      const double explicit_step = as_given ? step : longest;
      const double n_explicit = std::ceil(input.time.end / explicit_step),
                   n_implicit = std::ceil(input.time.end / step),
                   ratio = implicit_over_explicit(dim);
      const std::string comparison = fmt::format(
          "{:.3g} explicit steps of {} or {:.3g} implicit ones of {}, each at "
          "the cost of some {:g} explicit ones",
          n_explicit, engineering(explicit_step, "s"), n_implicit,
          engineering(step, "s"), ratio);
      if (n_explicit > ratio * n_implicit)
        return implicit(input, comparison);
      SceneInput scene =
          as_given ? *automatic.given_steps : *automatic.longest_steps;
      scene.scheme_choice = "explicit: " + comparison;
      return scene;
    }
  } // namespace

  SceneInput choose_scheme(const SceneInput &input,
                           const Communicator &communicator)
  {
    if (!input.automatic)
      return input;
    return input.dimension == 2 ? choose<2>(input, communicator)
                                : choose<3>(input, communicator);
  }
} // namespace nsfd
