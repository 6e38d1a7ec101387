#pragma once

#include "leapfrog_points.h"

#include "joined/cell_forces.h"

#include <cstdint>
#include <vector>

namespace nsfd
{
  class Archive;
  struct SceneInput;

  /**
   * Which faces of joined cells let go: where the mean traction of both sides
   * reaches their strength, or would be well beyond it in the next step. To let
   * go is not to open: the points are held as before until the problem of the
   * node opens them.
   */
  template <int dim>
  class FaceRelease
  {
  public:
    /** @p all are the constant data of the points of the mesh. */
    FaceRelease(const Discretization<dim> &discretization,
                const OneStepProblem<dim> &all);

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
    /** The tractions of the last step. */
    void serialize(Archive &archive);
    /** Mean tractions at intact points in their frames, Pa. */
    void show(const CellForces<dim> &forces,
              std::vector<double> &tractions) const;

  private:
    LawPoint law(std::size_t site) const;
    std::array<double, dim> in_frame(std::size_t point,
                                     const std::array<double, dim> &t) const;
    std::array<double, dim> traction(const CellForces<dim> &forces,
                                     std::size_t site) const;
    void let_go(std::size_t site, std::vector<unsigned int> &released);

    const Discretization<dim> &discretization_;
    StrengthSites sites_;
    std::vector<double> share_; ///< of sites: traction over the mean that is
                                ///< computed, 2 beside a rigid cell
    std::vector<typename LeapfrogPoints<dim>::Factors> factors_; ///< of sites
    std::vector<int> site_of_; ///< by point, -1: it never lets go
    std::vector<double> squares_, old_squares_; ///< of this step and the last
    std::vector<std::uint8_t> intact_;          ///< by point
  };
} // namespace nsfd
