#pragma once

#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/scatter.h"
#include "nsfd/parameters/expression.h"
#include "nsfd/scene/heat_input.h"
#include "nsfd/scene/sliding_input.h"
#include "nsfd/scene/stress_input.h"
#include "nsfd/scene/where_input.h"

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>

namespace nsfd
{
  enum class IntactFaces {
    spring,
    unilateral,
    rigid,
    bonded ///< by common nodes, see delassus/joined_delassus.h
  };

  struct InterfaceInput {
    std::string name;
    /// the other side of its faces, which are boundary faces; -1: a cell
    int obstacle = -1;
    Where where;
    /// "rigid", "bonded", "elastic", "contact" or the name of a cohesive law
    std::string law_name;
    /// for cohesive laws
    std::shared_ptr<const CohesiveLaw> law;
    /// for `elastic`: C_N, C_T in Pa/m
    double normal_stiffness = 0., tangential_stiffness = 0.;
    /// for cohesive laws: strength and toughness over those of the law
    Expression strength_factor{1.}, toughness_factor{1.}; ///< of x, y, z
    Scatter strength_scatter, toughness_scatter;
    unsigned int seed = 1;
    double friction = 0.;
    /// kappa = (1-beta)^exponent; 0 means kappa = 1
    double friction_exponent = 1.;
    double restitution = 0.;
    bool has_broken = false;
    Expression broken; ///< points where it is not zero start at beta = 0
    IntactFaces intact = IntactFaces::spring;
    bool plateau = false; ///< extrinsic: T(d_m) also while closing, (5)
    double opening_viscosity = 0.; ///< eta in Pa s/m, while beta > 0
    double viscous_limit = std::numeric_limits<double>::infinity(); ///< Pa
    SlidingInput sliding;
    /// Pa, of x, y, z, t: on the crack faces of points with beta <= threshold
    std::optional<Expression> crack_pressure;
    double pressure_threshold = 0.;
    HeatOfFaces heat;
    /// whose traction the faces carry at t = 0; components that are not given
    /// are those of the cells
    StressInput initial_stress;
    /** "Interface: NAME", or of the obstacle. */
    std::string section() const
    {
      return (obstacle < 0 ? "Interface: " : "Obstacle: ") + name;
    }
    /** Its two sides may part. */
    bool may_open() const { return law || law_name == "contact"; }
    /// beta up to which a point is broken: above 0 for laws with a tail
    double broken_beta() const
    {
      return law && std::isinf(law->final_opening()) ? 1e-3 : 0.;
    }
  };
} // namespace nsfd
