#include "formula_check.h"

#include "discretization/cells.h"
#include "discretization/discretization.h"
#include "nsfd/scene/scene_input.h"
#include "parameters/bad_values.h"

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  std::vector<std::string> bad_formulas(const Communicator &communicator)
  {
    if (!communicator.any(has_bad_values()))
      return {};
    std::vector<std::string> result;
    // the place on the first rank that has one
    for (const auto &of_rank : dealii::Utilities::MPI::all_gather(
             communicator.mpi(), take_bad_values()))
      for (const std::string &text : of_rank) {
        const std::string formula = text.substr(0, text.find(" is "));
        if (std::none_of(
                result.begin(), result.end(), [&](const std::string &known) {
                  return known.compare(0, formula.size(), formula) == 0;
                }))
          result.push_back(text);
      }
    return result;
  }

  template <int dim>
  std::vector<std::string>
  check_formulas(const SceneInput &input,
                 const Discretization<dim> &discretization,
                 const Communicator &communicator)
  {
    // what is not finite takes note of itself
    for (unsigned int b = 0; b < discretization.bodies().size(); ++b) {
      const auto &material =
          input.materials[discretization.cells().body_class(b).material];
      for (unsigned int c = 0; c < dim; ++c)
        for (const Expression *initial :
             {&material.initial_displacement[c], &material.initial_velocity[c]})
          if (!initial->is_constant())
            initial->at(discretization.cells().centre(b), 0.);
    }
    const auto &points = discretization.points();
    for (const double t : {0., input.time.end}) {
      for (const ObstacleInput &obstacle : input.obstacles)
        for (const auto &velocity : obstacle.velocity)
          if (velocity)
            (*velocity)(0., 0., 0., t);
      for (std::size_t i = 0; i < points.n_points; ++i) {
        const PointOrigin origin = discretization.origins()[i];
        if (origin.kind != PointOrigin::Kind::motion)
          continue;
        const auto &boundary = input.boundaries[origin.block];
        dealii::Point<dim> x;
        for (unsigned int c = 0; c < dim; ++c)
          x[c] = points.position[i * dim + c];
        for (unsigned int c = 0; c < dim; ++c)
          for (const auto *motion :
               {&boundary.velocity[c], &boundary.displacement[c]})
            if (*motion && !(*motion)->is_constant())
              (*motion)->at(x, t);
      }
      std::vector<double> forces(discretization.bodies().n_dofs());
      discretization.add_loads(t, forces);
    }
    return bad_formulas(communicator);
  }

  template std::vector<std::string> check_formulas(const SceneInput &,
                                                   const Discretization<2> &,
                                                   const Communicator &);
  template std::vector<std::string> check_formulas(const SceneInput &,
                                                   const Discretization<3> &,
                                                   const Communicator &);
} // namespace nsfd
