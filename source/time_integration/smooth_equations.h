#pragma once

#include "driven_motion.h"
#include "row_system.h"

#include "delassus/bulk_traction.h"
#include "delassus/joined_delassus.h"
#include "smooth_motion.h"

#include <deal.II/lac/la_parallel_vector.h>

#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * The right-hand side of SmoothMotion and its linear solves. Unknowns y of a
   * rank: displacements, velocities v* of its bodies, and on the first rank the
   * work of loads and motion.
   */
  template <int dim>
  class SmoothEquations
  {
  public:
    using Operator = typename DelassusOperator<dim>::Operator;
    using Vector = dealii::LinearAlgebra::distributed::Vector<double>;
    using Values = std::vector<double>;

    SmoothEquations(const SceneInput &input,
                    const Discretization<dim> &discretization,
                    DelassusOperator<dim> &delassus,
                    JoinedDelassus<dim> *bonded, const State &start);

    /** y' at time @p t. */
    void evaluate(double t, const Vector &y, Vector &rate);

    /** x of (1 - gamma J) x = b. */
    void solve_shifted(double gamma, const Vector &b, Vector &x);

    /** Scales of the start, and the step of the pairs. */
    void serialize(Archive &archive);

    typename SmoothMotion<dim>::Counters counters;

  protected:
    void find_scales(const State &start);
    void set_rows(JoinedDelassus<dim> *bonded);
    double *displacement(Vector &y) const { return y.begin(); }
    const double *displacement(const Vector &y) const { return y.begin(); }
    double *velocity(Vector &y) const { return y.begin() + n_; }
    const double *velocity(const Vector &y) const { return y.begin() + n_; }

    double motion(std::size_t point, unsigned int component, double t) const;
    void set_motion(double t, Values &g) const;
    void set_motion_rate(double t, Values &rate) const;
    const Values &loads(double t);
    void project(double t, const double *v, Values &result);
    void add_springs(const double *q, Values &force) const;
    const Values &acceleration(double t, const double *q);
    void set_reaction_forces(double t, const double *a);

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    DelassusOperator<dim> &delassus_;
    std::unique_ptr<BulkTraction<dim>> bulk_; ///< null without bonds
    const Communicator &communicator_;
    const DrivenMotion<dim> motion_;
    std::unique_ptr<DelassusOperator<dim>> free_; ///< of the mass alone
    OneStepProblem<dim> problem_;
    std::vector<PointKind> kind_;
    const std::size_t n_; ///< unknowns of this rank
    const std::size_t n_rows_;
    bool moves_ = false; ///< a prescribed velocity is not zero
    RowSystem<dim> joined_, shifted_;
    Values D_joined_;
    double gamma_ = -1.;
    struct Scales {
      double velocity = 0., displacement = 0., energy = 0.;
      double inner_step = 0.;
      double share = 1.; ///< of the tolerance of the input
    } scales_;           ///< of the tolerances, and the step of the pairs, s
    struct LoadsAt {
      double time = 0.;
      bool known = false;
      Values force;
    } loads_;
    /// by row (lambda: forces of the rows), and by unknown
    struct Work {
      Values given, mu, lambda, rows, force, rate, v, body;
    } work_;
  };
} // namespace nsfd
