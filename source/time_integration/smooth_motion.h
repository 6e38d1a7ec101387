#pragma once

#include "time_integrator.h"

#include "discretization/discretization.h"

#include <memory>
#include <vector>

namespace nsfd
{
  template <int dim>
  class JoinedDelassus;

  /**
   * Motion without events, `scheme = arkode`: bodies, springs, bonds, joints
   * and prescribed motion as ordinary differential equations, integrated by
   * the adaptive Runge-Kutta pairs of ARKODE (SUNDIALS), explicit or
   * diagonally implicit,
   *
   *     q' = v = v* + M^{-1} H_r^T mu,    W_r mu = g(t) - H_r v*,
   *     v*' = M^{-1} (F(t) - K q - H^T w C H q),
   *
   * with rows r of joints and prescribed motion, whose impulses mu since the
   * start of a recorded step keep H_r v = g exactly, without a derivative of
   * g. The work of the loads is integrated along: the energy balance shows the
   * error of the integration.
   */
  template <int dim>
  class SmoothMotion final : public TimeIntegrator<dim>
  {
  public:
    /** @p delassus holds the stiffness of the bodies; @p bonded is the same if
        the scene has bonded faces, else null. */
    SmoothMotion(const SceneInput &input,
                 const Discretization<dim> &discretization,
                 DelassusOperator<dim> &delassus,
                 JoinedDelassus<dim> *bonded = nullptr);
    ~SmoothMotion() override;

    /**
     * The scales of the tolerances come from @p given and from the loads and
     * motions until the end. Collective.
     */
    State start_from(State given) override;
    void resume_from(const State &state) override;

    /**
     * From @p old over @p time_step, in as many steps of the pairs as the
     * tolerance asks for, and with a smaller one where the energy balance is
     * off by more than the tolerance. Rejected is what ARKODE gives up.
     * Collective.
     */
    StepReport advance(const State &old, double time_step, State &next,
                       unsigned int idle_rounds) override;

    /** At the end of the step. */
    const std::vector<double> &reactions() const override;
    ResidualKind residual_kind() const override { return ResidualKind::none; }
    void fill_counters(std::map<std::string, double> &counters) const override;
    std::vector<std::pair<std::string, double>> stage_seconds() const override;

    void serialize(Archive &archive) override;

    struct Counters {
      unsigned long long steps = 0, evaluations = 0, iterations = 0,
                         linear_solves = 0;
      double seconds = 0.; ///< CPU time of advance()
    };
    Counters counters() const;

  private:
    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    DelassusOperator<dim> &delassus_;
    JoinedDelassus<dim> *const bonded_; ///< or null
    class Equations;
    std::unique_ptr<Equations> equations_; ///< since the start
  };
} // namespace nsfd
