#pragma once

#include "body_system.h"
#include "tied_nodes.h"

#include "delassus/velocity_solver.h"
#include "nonsmooth/one_step_problem.h"

#include <vector>

namespace nsfd
{
  /**
   * The motion of bodies apart, by unknown of the bodies: w = v - v_free, with
   * no momentum besides the impulses of the points. Where joints hold all nodes
   * of a face together these are one unknown, and the joint has no row: W of
   * such rows is singular, one condition per loop of cells round a node. What
   * they carry follows from the motion, see complete(). On one rank.
   */
  template <int dim>
  class ApartMotion final : public NodeMotion
  {
  public:
    /** Impulses of points that @p ties holds together count for nothing. */
    ApartMotion(const OneStepProblem<dim> &problem,
                const DelassusOperator<dim> &delassus,
                const TiedNodes<dim> &ties);

    /** The impulses of points that are held together, with which the bodies
        move as they do under the others. */
    void complete(std::vector<double> &P);

    /** @throws std::logic_error with a momentum or an impulse. */
    void start(const std::vector<double> &momentum,
               const std::vector<double> &impulse,
               const std::vector<double> &start, double floor = 0.) override;
    bool is_on() const override { return is_on_; }
    double stiffness_over_mass() override;
    bool saves_by_rough_solutions() const override { return false; }
    void cancel() override { is_on_ = false; }
    void balance(const std::vector<double> &P, double tolerance) override;
    bool solve(const std::vector<double> &T, bool symmetric,
               const std::vector<double> &c, const Accuracy &accuracy,
               std::vector<double> &dP, std::vector<double> &dU) override;
    const std::vector<double> &factored() const override { return none_; }
    void move(double length, const std::vector<double> &P,
              std::vector<double> &U) override;
    const std::vector<double> &motion() const override { return w_; }
    void set_motion(const std::vector<double> &w, const std::vector<double> &P,
                    std::vector<double> &U) override;
    double imbalance() const override { return left_; }
    bool balances(const double tolerance) const override
    {
      return is_done_ || left_ <= tolerance;
    }
    void add_to(std::vector<double> &velocity) const override;
    std::vector<double> left_over() const override;

  private:
    using Vector = std::vector<double>;
    using Operator = typename DelassusOperator<dim>::Operator;

    void impulse(const Vector &P, Vector &result) const;
    void set_residual(const Vector &P);
    void set_velocity(Vector &U) const;

    const OneStepProblem<dim> &problem_;
    const DelassusOperator<dim> &delassus_;
    const TiedNodes<dim> &ties_;
    BodySystem<dim> system_;
    bool is_on_ = false, is_done_ = false;
    const Vector none_{};
    Vector start_;             ///< U_0
    Vector w_, dw_, residual_; ///< the last is H^T P - M_hat w
    double left_ = 0.;         ///< of it, beside its terms
  };
} // namespace nsfd
