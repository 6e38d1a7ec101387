#pragma once

#include "face_release.h"
#include "leapfrog_chains.h"

#include "joined/elastic_node.h"

#include <string>

namespace nsfd
{
  /**
   * The points between groups of corners in the equilibrium that explicit steps
   * start from: joints and laws below their history are springs, w t = k u;
   * broken ones carry nothing but what fluid in them does.
   */
  template <int dim>
  class EquilibriumSprings
  {
  public:
    /** @p all are the constant data of the points of the mesh. */
    EquilibriumSprings(const OneStepProblem<dim> &all,
                       const JoinedMesh<dim> &mesh)
        : mesh_(mesh), chains_(all)
    {
    }

    /**
     * The points @p added of the mesh, in ascending order, as @p state has
     * them. False where one has a law without a straight part: bad_point().
     */
    bool add(const std::vector<unsigned int> &added,
             const InterfacePoints<dim> &points, const FaceRelease<dim> &faces,
             const State &state);
    std::size_t bad_point() const { return bad_point_; }

    bool any() const { return !springs_.empty(); }
    /** Of one of them, if there are any. */
    std::size_t a_point() const { return any() ? springs_[0].point : 0; }

    /** As in the steps that follow. */
    const LeapfrogChains<dim> &chains() const { return chains_; }

    /** Adds what they do to the forces of @p groups, N. */
    void add_forces(CornerGroups<dim> &groups) const;
    /** Adds the sizes of these forces, N by component of a group. */
    void add_sizes(const CornerGroups<dim> &groups,
                   std::vector<double> &sizes) const;
    /** Adds what they have on the diagonal of K, N/m. */
    void add_diagonal(const CornerGroups<dim> &groups,
                      std::vector<double> &diagonal) const;

    /** False where one is open beyond its straight part: bad_point(). */
    bool are_straight(const State &state);

  private:
    struct Spring {
      unsigned int point;                      ///< of the mesh
      std::array<double, dim * dim> stiffness; ///< w k, N/m, axes of space
      double largest;                          ///< see ElasticPoint
      const Interaction *interaction;
    };

    std::array<double, dim> force(const Spring &spring,
                                  const CornerGroups<dim> &groups) const;

    const JoinedMesh<dim> &mesh_;
    LeapfrogChains<dim> chains_;
    std::vector<Spring> springs_;
    std::size_t bad_point_ = 0;
  };
} // namespace nsfd
