#pragma once

#include "body_system.h"

#include "delassus/velocity_solver.h"

#include <vector>

namespace nsfd
{
  /**
   * The motion of bodies that share no node, by unknown of the bodies: w = v -
   * v_free, with no momentum besides the impulses of the points. Its matrix is
   * that of BodySystem. On one rank.
   */
  template <int dim>
  class ApartMotion final : public NodeMotion
  {
  public:
    ApartMotion(const DelassusOperator<dim> &delassus, double time_step);

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
    using Operator = typename DelassusOperator<dim>::Operator;

    void set_residual(const std::vector<double> &P);
    void set_velocity(std::vector<double> &U) const;

    const DelassusOperator<dim> &delassus_;
    BodySystem<dim> system_;
    bool is_on_ = false, is_done_ = false;
    const std::vector<double> none_{};
    std::vector<double> start_;             ///< U_0
    std::vector<double> w_, dw_, residual_; ///< the last is H^T P - M_hat w
    double left_ = 0.;                      ///< of it, over |H^T P|
  };
} // namespace nsfd
