// Prints the tables of doc/results.md: what the cohesion rules do to the
// energy of an elastic pulse, and what they take out of it in one separation.

#include "../unit/make_scene.h"

#include <deal.II/base/mpi.h>

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

using namespace nsfd;
using nsfd::test::Scene;

namespace
{
  const std::vector<std::string> rules = {"exact", "end point", "end velocity"};

  /** A block of the plate is struck: its velocity jumps at the faces. */
  const std::string struck_plate = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 8, 4
  set cells        = 8, 4
end
subsection Material: struck
  set where              = x < 2 && y < 2
  set model              = linear elastic
  set Young modulus      = 1
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = 1
end
subsection Material: plate
  set model         = linear elastic
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
end
subsection Interface: all
  set law       = michel-suquet
  set stiffness = 21
  set strength  = 1e12
end
subsection Time
  set end   = 1000
  set step  = 0.5 courant
  set theta = 0.5
end
subsection Solver
  set tolerance = 1e-12
end
)";

  /** Two bars of 40 cells pulled apart; the face in the middle breaks. */
  const std::string bars = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 80, 1
  set cells        = 80, 1
end
subsection Material: bar
  set model         = linear elastic
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: middle
  set where     = abs(x - 40) < 0.1
  set law       = LAW
  set strength  = 1
  set toughness = 1
end
subsection Interface: joints
  set law = rigid
end
subsection Boundary: left
  set velocity x = -0.6
end
subsection Boundary: right
  set velocity x = 0.6
end
subsection Time
  set end   = 1000
  set step  = 1 courant
  set theta = 0.5
end
subsection Solver
  set tolerance = 1e-12
end
)";

  std::string row(const std::string &name,
                  const std::vector<std::string> &values)
  {
    std::string line = "| " + name + " |";
    for (const auto &value : values)
      line += " " + value + " |";
    return line + "\n";
  }

  std::string head(const std::string &name,
                   const std::vector<std::string> &columns)
  {
    return row(name, columns) +
           row("---", std::vector<std::string>(columns.size(), "---"));
  }

  struct Decay {
    double energy = 1.; ///< after over before
    double jumps = 1.;  ///< |U| of the last ten steps over that of the first
  };

  Decay decay(const std::string &C, const std::string &rule)
  {
    Scene<2> scene(struck_plate, {"Interface: all/stiffness=" + C,
                                  "Time/cohesion rule=" + rule});
    const auto &weight = scene.discretization->points().weight;
    const auto jumps = [&] {
      double sum = 0.;
      for (std::size_t i = 0; i < weight.size(); ++i)
        for (unsigned int c = 0; c < 2; ++c)
          sum +=
              weight[i] * std::pow(scene.state.relative_velocity[2 * i + c], 2);
      return sum;
    };
    const double energy = scene.energy();
    double first = 0., last = 0.;
    for (unsigned int step = 1; step <= 100; ++step) {
      scene.advance();
      if (step <= 10)
        first += jumps();
      if (step > 90)
        last += jumps();
    }
    return {scene.energy() / energy, std::sqrt(last / first)};
  }

  struct Separation {
    double removed = 0.; ///< over the toughness
    unsigned int steps = 0;
    bool halved = false;
  };

  Separation separate(const std::string &law, const std::string &rule,
                      const std::string &step)
  {
    std::string text = bars;
    text.replace(text.find("LAW"), 3, law);
    Scene<2> scene(
        text, {"Time/cohesion rule=" + rule, "Time/step=" + step + " courant"});
    const auto &origins = scene.discretization->origins();
    const auto &e = scene.state.energy;
    Separation result;
    for (bool whole = true; whole && scene.state.time < 500.;) {
      const double damage = e.damage;
      result.halved |=
          scene.advance_bisecting() < scene.time_step * (1. - 1e-9);
      result.steps += e.damage > damage;
      whole = false;
      for (std::size_t i = 0; i < origins.size(); ++i)
        if (origins[i].kind == PointOrigin::Kind::interface &&
            scene.input->interfaces[origins[i].block].law)
          whole = whole || scene.state.beta[i] > 0.;
    }
    result.removed = scene.state.initial_energy + e.work - e.kinetic -
                     e.elastic - e.cohesive - e.impact;
    return result;
  }
} // namespace

int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const std::vector<std::string> stiffness = {"21", "1e3", "1e5", "1e8"};

  std::string energies = head("C L/E", rules), jumps = energies;
  for (const auto &C : stiffness) {
    std::vector<std::string> lost, kept;
    for (const auto &rule : rules)
      try {
        const Decay result = decay(C, rule);
        lost.push_back(fmt::format("{:.1e}", 1. - result.energy));
        kept.push_back(fmt::format("{:.3f}", result.jumps));
      } catch (const StepRejected &) {
        lost.push_back("not solved");
        kept.push_back("not solved");
      }
    energies += row(C, lost);
    jumps += row(C, kept);
  }
  std::fputs(("Share of the energy lost in 100 steps:\n\n" + energies +
              "\n|U| on the faces, steps 91 to 100 over steps 1 to 10:\n\n" +
              jumps)
                 .c_str(),
             stdout);

  const std::vector<std::string> steps = {"5", "1", "0.25", "0.05"};
  std::vector<std::string> columns;
  for (const auto &step : steps)
    columns.push_back("h = " + step);
  std::string table = head("law, rule", columns);
  for (const std::string law : {"michel-suquet", "tvergaard", "camacho-ortiz"})
    for (const auto &rule : rules) {
      std::vector<std::string> values;
      for (const auto &step : steps)
        try {
          const Separation result = separate(law, rule, step);
          values.push_back((rule == "exact"
                                ? fmt::format("1 {:+.0e}", result.removed - 1.)
                                : fmt::format("{:.3f}", result.removed)) +
                           fmt::format(" ({}{})", result.steps,
                                       result.halved ? ", halved" : ""));
        } catch (const StepRejected &) {
          values.push_back("not solved");
        }
      table += row(law + ", " + rule, values);
    }
  std::fputs(("\nEnergy removed over G in one separation (softening steps):\n"
              "\n" +
              table)
                 .c_str(),
             stdout);
  return 0;
}
