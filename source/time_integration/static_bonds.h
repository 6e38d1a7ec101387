#pragma once

#include "load_step_iterate.h"
#include "node_supports.h"

#include "delassus/bulk_traction.h"
#include "delassus/joined_delassus.h"
#include "delassus/velocity_solver.h"
#include "discretization/discretization.h"
#include "discretization/loads.h"

#include <utility>
#include <vector>

namespace nsfd
{
  /**
   * Faces of a load step whose bodies share nodes: they have no rows. A face
   * that carries a third of its strength gets its law where its sides can part,
   * as one that has taken a thousand millionth of the toughness: then the
   * forces of its nodes decide when it opens, and not the stress of the cells
   * beside it, which falls short of them at a notch.
   */
  template <int dim>
  class StaticBonds
  {
  public:
    /**
     * All are those of the rounds and outlive this; @p mean as for
     * release_bonds().
     */
    StaticBonds(const Discretization<dim> &discretization,
                JoinedDelassus<dim> &bonded, bool mean,
                OneStepProblem<dim> &problem, LoadStepIterate<dim> &iterate)
        : discretization_(discretization), bonded_(bonded),
          bulk_(bonded, discretization.loads().initial_stress()), mean_(mean),
          problem_(problem), iterate_(iterate),
          nodes_(dynamic_cast<VelocitySolver &>(bonded))
    {
    }

    /** The bonds of the iterate, before the data of a round. Collective. */
    void set();
    /** Cells of the smallest body that they make. Collective. */
    double cells_of_smallest_body();
    /** Supports once per node, after the data of a round. Collective. */
    void constrain();

    /** A round of h from rest at @p displacement, see NodeMotion; @p impulse is
        that of the pressure in cracks, or empty, @p forces the largest ones so
        far. Collective. */
    void start_from_rest(double h, const std::vector<double> &loads,
                         const std::vector<double> &impulse,
                         const std::vector<double> &displacement,
                         double forces);
    /** v, and the forces that are left over: F + H^T r - K q of its end.
        Collective. */
    void finish_from_rest(double h, std::vector<double> &velocity,
                          std::vector<double> &left);

    /** Mean bulk tractions of bonded points. Collective. */
    void set_tractions(State &state) const;
    /**
     * Of the strength that points carry in the iterate by the bulk traction
     * which were bonded at the start of the step. Collective.
     */
    std::vector<double> shares() const;

    /**
     * The point has its law in @p state and has not been opened yet: its law is
     * set-valued there, any traction up to the strength at no opening.
     */
    bool is_closed(const State &state, std::size_t point) const;
    /** Of the strength that forces @p force of the points in N carry at one. */
    double share_of(const std::vector<double> &force, std::size_t point) const;

    /** Faces of the iterate that carry enough get their law from the next round
        on: false if there are none. Collective. */
    bool let_go();

    /**
     * What bonds of the start of the step that are no more give the bodies on
     * the way to @p next, in J: the work f . dq / 2 of their forces, which fall
     * to zero, f = K q - F - H^T r at the start. (Common nodes that are left
     * give nothing with such an f.) @p forces are the loads F. Collective.
     */
    double work_of_released(const std::vector<double> &forces,
                            const State &next) const;

  private:
    bool has_let_go(const std::size_t point) const
    {
      return iterate_.activated[point] &&
             iterate_.old->kind[point] == PointKind::bonded;
    }

    const Discretization<dim> &discretization_;
    JoinedDelassus<dim> &bonded_;
    const BulkTraction<dim> bulk_;
    const bool mean_;
    OneStepProblem<dim> &problem_;
    LoadStepIterate<dim> &iterate_;
    VelocitySolver &nodes_; ///< bonded_
    NodeSupports<dim> supports_;
    bool changed_ = true;  ///< bonds, since the last constrain()
    double smallest_ = 0.; ///< cells_of_smallest_body(), 0 if not known
  };
} // namespace nsfd
