#pragma once

#include "bisection.h"
#include "linear_triangle.h"

#include "joined/joined_mesh.h"
#include "state/state.h"

#include <array>
#include <unordered_map>
#include <vector>

namespace nsfd
{
  /**
   * Which halves of bisected triangles may be one cell again, and how. The node
   * in the middle of their edge goes where nothing has happened yet - points
   * that are bonded, no condition, no cell that is refined at the ends - and
   * where the state is smooth: strains and velocities are those of the joined
   * cells but for a small part of their energy.
   *
   * Velocities: mass and momentum of the node go to the two ends, half by half,
   * as in an inelastic impact. Displacements in the middle of the step, which
   * have the elastic energy: the nearest ones of the joined mesh in the norm of
   * that energy (Ritz); nodes some cells around move a little. What both lose
   * is the change of the energy. It is less than before but for what nodes take
   * that must not move: if the sum is more, nothing is joined.
   */
  class HalvesToJoin
  {
  public:
    /** @p cells, settled and refined since, @p discretization and @p mesh of
        the settled ones, and the @p state there. */
    HalvesToJoin(const Bisection &cells,
                 const Discretization<2> &discretization,
                 const JoinedMesh<2> &mesh, const State &state);

    struct Plan {
      std::vector<Bisection::Family> families;
      /// of the state, J; `inertia` is that of the lumped masses, `motion` what
      /// else is kinetic: see Leapfrog and FrontViscosity
      double inertia = 0., motion = 0., elastic = 0.;
      /// displacements on the joined mesh are others at these vertices, m
      std::unordered_map<unsigned int, std::array<double, 2>> moved;
      double change() const { return inertia + motion + elastic; }
    };

    /** What of the @p wanted families can be joined without more energy.
        @p front_viscosity: psi eta of the old cells, Pa s. */
    Plan plan(std::vector<Bisection::Family> wanted,
              const std::vector<double> &front_viscosity) const;

  private:
    using Family = Bisection::Family;
    using Pair = std::array<unsigned int, 2>;
    using Nodes = std::array<unsigned int, 3>;
    using Values = LinearTriangle::Values;

    /** A triangle, old or joined, between corners of the old mesh. */
    struct Element {
      LinearTriangle shape;
      Nodes nodes{};
      Values displacement{}, velocity{}; ///< before; in the middle of the step
      double lambda = 0., mu = 0.;
      double corner_mass = 0., viscosity = 0.;

      /** Forces at the corners, N/m. */
      Values forces(const Values &u) const;
      double elastic(const Values &u) const;
    };
    /// vectors over the nodes of the old mesh
    struct Motion {
      std::vector<double> added_mass, velocity;
      std::vector<std::uint8_t> may_move;
      std::vector<double> shift; ///< of displacements in the middle of the step
    };

    void find_blocked(const Discretization<2> &discretization);
    bool may_join(const Family &family) const;
    bool is_smooth(const Family &family, double mean) const;
    Pair ends(const Pair &pair) const;
    bool stays(const Bisection::Cell &cell) const;
    Element element(const Bisection::Cell &cell, const LinearTriangle &shape,
                    const Nodes &corners, double corner_mass,
                    double viscosity) const;
    Element old_element(const Bisection::Cell &cell, double viscosity) const;
    Element joined_element(const Pair &pair, double viscosity) const;
    Values at(const Nodes &nodes, const std::vector<double> &of_nodes) const;
    void move(const std::vector<Family> &families, Motion &motion) const;
    void let_move(const std::vector<Element> &joined,
                  const std::vector<Element> &others, Motion &motion) const;
    void project(const std::vector<Element> &halves,
                 const std::vector<Element> &joined,
                 const std::vector<Element> &others, Motion &motion) const;
    void add(double sign, const Element &element, const Values &velocity,
             const Values &displacement, Plan &plan) const;
    void set_change(const std::vector<double> &front_viscosity,
                    Plan &plan) const;

    const Bisection &cells_;
    const Cells<2> &old_;
    const JoinedMesh<2> &mesh_;
    const State &state_;
    /// by node: kg/m; two components of the velocity, where it is not blocked
    std::vector<double> mass_, velocity_;
    std::vector<unsigned int> vertex_;  ///< of Bisection
    std::vector<std::uint8_t> blocked_; ///< it must stay as it is
  };
} // namespace nsfd
