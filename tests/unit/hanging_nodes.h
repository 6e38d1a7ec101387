#pragma once

#include "make_scene.h"

#include "discretization/cells.h"
#include "joined/cell_forces.h"
#include "joined/hanging_nodes.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace nsfd::test
{
  inline const std::string refined_plate = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set lower corner = 0, 0
  set upper corner = 4, 3
  set cells        = 4, 3
end
subsection Adaptivity
  set levels = 1
end
subsection Indicator: middle
  set type      = region
  set region    = (x - 1.5)^2 + (y - 1.5)^2 < 1.2
  set cell size = 0.5
end
subsection Material: bulk
  set Young modulus = 200
  set Poisson ratio = 0.3
  set density       = 7
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 1e9
  set toughness = 1e9
end
subsection Time
  set end    = 1
  set step   = auto
  set scheme = explicit
end
)";
  inline const std::vector<std::string> refined_solid = {
      "dimension=3",
      "Mesh/type=brick",
      "Mesh/lower corner=0, 0, 0",
      "Mesh/upper corner=3, 3, 3",
      "Mesh/cells=3, 3, 3",
      "Indicator: middle/region=(x - 1.5)^2 + (y - 1.5)^2 + (z - 1.5)^2 < "
      "1.2"};

  template <int dim>
  std::vector<std::string> of_degree(const unsigned int p,
                                     std::vector<std::string> more = {})
  {
    if (dim == 3)
      more.insert(more.begin(), refined_solid.begin(), refined_solid.end());
    more.push_back("Discretization/degree=" + std::to_string(p));
    return more;
  }

  /** The parts of a mesh that hold it together. */
  template <int dim>
  struct JoinedParts {
    explicit JoinedParts(const std::vector<std::string> &overrides)
        : scene(refined_plate, overrides), mesh(*scene.discretization),
          hanging(*scene.discretization, mesh, nullptr),
          groups(mesh, std::vector<std::uint8_t>(
                           scene.discretization->points().n_points, 1)),
          bare(groups.mass),
          forces(make_cell_forces<dim>(*scene.discretization, mesh, {}))
    {
      EXPECT_TRUE(hanging.any());
      EXPECT_TRUE(hanging.tie(groups));
      const auto &cells = scene.discretization->cells();
      place.resize(groups.size());
      for (std::size_t b = 0; b < cells.bodies.size(); ++b)
        for (unsigned int i = 0; i < cells.class_shape(b).n_nodes; ++i)
          place[groups.of(cells.first_node[b] + i)] =
              cells.place(b, cells.class_shape(b).nodes[i]);
      hangs.resize(groups.size());
      for (const auto &tie : hanging.ties())
        hangs[tie.group] = 1;
    }

    /** Where a group is and the part of a force that turns about 0. */
    double moment(const std::vector<double> &f, const std::size_t g) const
    {
      return place[g][0] * f[g * dim + 1] - place[g][1] * f[g * dim];
    }

    Scene<dim> scene;
    JoinedMesh<dim> mesh;
    HangingNodes<dim> hanging;
    CornerGroups<dim> groups;
    std::vector<double> bare; ///< masses
    std::unique_ptr<CellForces<dim>> forces;
    std::vector<dealii::Point<dim>> place; ///< by group
    std::vector<char> hangs;               ///< the same
  };

} // namespace nsfd::test
