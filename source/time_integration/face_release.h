#pragma once

#include "leapfrog_points.h"

#include "joined/cell_forces.h"

#include <cstdint>
#include <vector>

namespace nsfd
{
  struct SceneInput;

  /**
   * Which faces of joined cells let go. A face does where the mean traction of
   * both sides reaches its strength. At the end of a crack that is not enough:
   * the node there is held by faces whose own cells are not the ones that pull.
   * So at nodes with a face that has let go, another one does as well if it
   * would cut the node, and what holds the corners S on one side of the cut,
   *
   *   H = m_S a - f_S,   a = f / m of the whole group,
   *
   * shared among the faces of the cut by their weights, is beyond the strength
   * of one of them. To let go is not to open: the points are held as before
   * until the problem of the node opens them.
   */
  template <int dim>
  class FaceRelease
  {
  public:
    /** @p all are the constant data of the points of the mesh. */
    FaceRelease(const Discretization<dim> &discretization,
                const JoinedMesh<dim> &mesh, const OneStepProblem<dim> &all);

    /** From now on @p intact (by point) are. */
    void start(std::vector<std::uint8_t> intact);
    const std::vector<std::uint8_t> &intact() const { return intact_; }

    /** Of the face of a point, where there is one that lets go. */
    typename LeapfrogPoints<dim>::Factors factors(unsigned int point) const;

    /**
     * Points whose faces have reached their strength; intact() is without them
     * then. How far beyond it the worst one is goes into @p excess.
     */
    std::vector<unsigned int> reached(const CellForces<dim> &forces,
                                      double &excess);
    /**
     * The same at the nodes of crack ends, once the groups are those of
     * intact(). @p loads are forces on the groups, empty if there are none;
     * @p prescribed is a mask of components by group.
     */
    std::vector<unsigned int> reached_at_ends(
        const CellForces<dim> &forces, const CornerGroups<dim> &groups,
        const LeapfrogPoints<dim> &points,
        const std::vector<double> &corner_loads,
        const std::vector<std::uint8_t> &prescribed, double &excess);

    /** Mean tractions at intact points in their frames, Pa. */
    void show(const CellForces<dim> &forces,
              std::vector<double> &tractions) const;

  private:
    LawPoint law(std::size_t site) const;
    std::array<double, dim> in_frame(std::size_t point,
                                     const std::array<double, dim> &t) const;
    void let_go(std::size_t site, std::vector<unsigned int> &released);
    /** A node where a face has let go, and its links that have not. */
    struct End {
      unsigned int node;
      struct Link {
        unsigned int point;
        std::array<unsigned short, 2> corners; ///< among those of the node
      };
      std::vector<Link> links; ///< of all its faces
    };
    void add_end(std::size_t node);
    bool is_finished(const End &end) const;
    void set_pulls(const End &end, const CellForces<dim> &forces,
                   const CornerGroups<dim> &groups,
                   const LeapfrogPoints<dim> &points,
                   const std::vector<double> &corner_loads,
                   const std::vector<std::uint8_t> &prescribed);
    bool may_let_go(const End &end) const;
    bool cuts(const End &end, std::size_t link,
              const CornerGroups<dim> &groups);
    double share_of_strength(const End &end, const typename End::Link &link,
                             const CornerGroups<dim> &groups) const;

    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    StrengthSites sites_;
    std::vector<double> strength_factor_, opening_factor_; ///< of the sites
    std::vector<int> site_of_; ///< by point, -1: it never lets go
    std::vector<double> squares_;
    std::vector<std::uint8_t> intact_; ///< by point
    std::vector<End> ends_;
    std::vector<char> is_end_;    ///< by node
    std::vector<double> weakest_; ///< traction of any direction, by site, Pa
    // of one node
    std::vector<std::array<double, dim>> pulls_; ///< f - m a by corner, N
    std::vector<char> side_;                     ///< 1: with the first corner
  };
} // namespace nsfd
