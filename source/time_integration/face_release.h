#pragma once

#include "leapfrog_points.h"

#include "joined/cell_forces.h"
#include "joined/hanging_nodes.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace nsfd
{
  class Archive;
  struct InterfaceInput;

  /**
   * Which faces of joined cells are released: where the mean traction of both
   * sides reaches their strength, or would be well beyond it in the next step.
   * To let go is not to open: the points are held as before until the problem
   * of the node opens them.
   */
  template <int dim>
  class FaceRelease
  {
  public:
    /** @p all are the constant data of the points of the mesh; some faces are
        held by @p hanging nodes. */
    FaceRelease(const Discretization<dim> &discretization,
                const OneStepProblem<dim> &all,
                const HangingNodes<dim> &hanging);

    /** From now on @p intact (by point) are. */
    void start(std::vector<std::uint8_t> intact);
    const std::vector<std::uint8_t> &intact() const { return intact_; }

    /** Of the face of a point that may be released, else of the point. */
    typename LeapfrogPoints<dim>::Factors factors(unsigned int point) const;

    /** Strength, toughness and friction at @p temperatures (K) of the points.
     */
    void warm(const std::vector<double> &temperatures);

    /**
     * Points whose faces have reached their strength; intact() is without them
     * then. How far beyond it the worst one is goes into @p excess.
     */
    std::vector<unsigned int> reached(const CellForces<dim> &forces,
                                      double &excess);
    /** Of the faces that are never released, the one that was nearest to its
       strength or furthest beyond it, so far as has been looked at. */
    struct Held {
      double share = 0.; ///< traction over strength, 0: below `looked_at`
      std::array<double, dim> centre{};
      unsigned int block = 0; ///< of Interface
    };
    /** Of all ranks. Collective. */
    Held worst_held(const Communicator &communicator) const;

    /** The tractions of the last step. Collective. */
    void serialize(const Communicator &communicator, Archive &archive);
    /** Of faces that are not released, as far as the last step has looked at
        them: from StrengthSites::looked_at of the strength on. Of lower ones
        some are known, by blocks of cells. @p visit(first point, share). */
    void
    visit_near(const std::function<void(unsigned int, double)> &visit) const;
    /** Mean tractions at intact points in their frames, Pa. */
    void show(const CellForces<dim> &forces,
              std::vector<double> &tractions) const;

  private:
    LawPoint law(std::size_t site) const;
    std::array<double, dim> in_frame(std::size_t point,
                                     const std::array<double, dim> &t) const;
    std::array<double, dim> traction(const CellForces<dim> &forces,
                                     std::size_t site) const;
    double share_of(const std::size_t site) const
    {
      return share_.empty() ? 1. : share_[site];
    }
    const InterfaceInput &block_of(std::size_t site) const;
    double friction_of(std::size_t site) const;
    double temperature(std::size_t site) const;
    bool has_more(const CellForces<dim> &forces, std::size_t site) const;
    void add_more(const CellForces<dim> &forces);
    void let_go(std::size_t site, std::vector<unsigned int> &released);

    const Discretization<dim> &discretization_;
    const OneStepProblem<dim> &all_;
    StrengthSites<dim> sites_;
    /// of sites: traction over the mean that is computed, 2 beside a rigid
    /// cell; empty: 1
    std::vector<double> share_;
    std::vector<typename LeapfrogPoints<dim>::Factors> factors_; ///< of sites
    /// of sites, as they are without a temperature; empty if no law and no
    /// friction depends on it
    struct Cold {
      typename LeapfrogPoints<dim>::Factors factors;
      typename StrengthSites<dim>::Limits limits;
    };
    std::vector<Cold> cold_;
    std::vector<double> temperature_; ///< by point, K; empty likewise
    std::vector<int> first_site_;     ///< by face, -1: it is never released
    /// of this step and the last
    typename StrengthSites<dim>::Near near_, last_near_;
    bool has_looked_ = false;          ///< there was a step
    std::vector<std::uint8_t> intact_; ///< by point
    std::vector<std::uint8_t> held_;   ///< by site; empty: none is
    Held worst_held_;
  };
} // namespace nsfd
