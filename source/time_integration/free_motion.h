#pragma once

#include "delassus/delassus_operator.h"
#include "discretization/discretization.h"
#include "nonsmooth/one_step_problem.h"

#include <memory>
#include <vector>

namespace nsfd
{
  struct SceneInput;
  struct State;
  class NodeMotion;
  template <int dim>
  class CrackPressure;

  /**
   * The loads of a step, and the motion of linear bodies under them without any
   * impulse of a point,
   *
   *   v_free = v_k + M_hat^{-1} h (F - K (q_k + h theta v_k) - C v_k);
   *
   * pressure in cracks is a part of F.
   */
  template <int dim>
  class FreeMotion
  {
  public:
    FreeMotion(const SceneInput &input,
               const Discretization<dim> &discretization,
               DelassusOperator<dim> &delassus);
    ~FreeMotion();

    /**
     * Loads at @p time by the @p clock of the state before. Assembled again
     * only if they depend on it: true if they were.
     */
    bool set_loads(double time, const LoadClock &clock);
    /** By unknown, N. */
    const std::vector<double> &loads() const { return loads_; }

    bool has_crack_pressure() const { return crack_pressure_ != nullptr; }
    /** In cracks that are as broken as in @p old, Pa by point; without cracks
        under pressure @p pressure stays as it is. */
    void set_pressure(const State &old, double time,
                      std::vector<double> &pressure) const;
    /** Of this pressure over a step, N s in the frames of the points; empty
        without cracks under pressure. */
    std::vector<double> pressure_impulse(const std::vector<double> &pressure,
                                         double time_step) const;

    /**
     * v_free of the step from @p old, and U_free in @p problem, whose time step
     * it is. Bodies that share nodes know neither: v_free is their motion under
     * the @p impulse of the points, to the digits of a scale. @p elastic is K
     * q_k of the explicit scheme, else null. Collective.
     */
    void move(const State &old, const std::vector<double> &pressure,
              OneStepProblem<dim> &problem, const std::vector<double> &impulse,
              const std::vector<double> *elastic = nullptr);
    /** U_free of bodies that share nodes; false: it is known. Collective. */
    bool find(const State &old, OneStepProblem<dim> &problem);
    /** U_free of bodies that share nodes for those who ask for it after the
        solution, U - W P; the step stays what it is. Collective. */
    void estimate(const std::vector<double> &U, const std::vector<double> &P,
                  OneStepProblem<dim> &problem) const;
    /** v_free by unknown, m/s. */
    const std::vector<double> &velocity() const { return velocity_; }
    /** v of @p next under the @p impulse of the points, after the solution of
        the step from @p old. Collective. */
    void finish(const std::vector<double> &impulse, const State &old,
                State &next) const;
    /** v_free.M v_free, J. Collective. */
    double kinetic_product();

  private:
    void move_nodes(const State &old, const std::vector<double> &pressure,
                    const std::vector<double> &impulse, NodeMotion &motion,
                    OneStepProblem<dim> &problem);

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    DelassusOperator<dim> &delassus_;
    std::unique_ptr<CrackPressure<dim>> crack_pressure_; ///< or null
    std::vector<double> loads_, velocity_, work_;
    bool loads_known_ = false;
    double loads_time_ = 0.;
    LoadClock loads_clock_;
  };
} // namespace nsfd
