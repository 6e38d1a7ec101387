#pragma once

#include "joined_bodies.h"

namespace nsfd
{
  /** Of bodies that share nodes. */
  template <int dim>
  class JoinedFromRest final : public StepFromRest
  {
  public:
    explicit JoinedFromRest(JoinedBodies<dim> &bodies) : bodies_(bodies) {}

    void start(double h, const std::vector<double> &momentum,
               const std::vector<double> &impulse,
               const std::vector<double> &displacement) override;
    bool is_on() const override { return is_on_; }
    void cancel() override { is_on_ = false; }
    bool solve(const std::vector<double> &T, bool symmetric,
               const std::vector<double> &P, const std::vector<double> &c,
               double tolerance, std::vector<double> &dP,
               std::vector<double> &dU) override;
    void move(double length, std::vector<double> &U) override;
    const std::vector<double> &motion() const override { return v_; }
    void set_motion(const std::vector<double> &v) override { v_ = v; }
    void finish(const std::vector<double> &P, std::vector<double> &velocity,
                std::vector<double> &left) override;

  private:
    using Operator = typename DelassusOperator<dim>::Operator;

    void set_right_side(const std::vector<double> &P);

    JoinedBodies<dim> &bodies_;
    bool is_on_ = false;
    /// own values of the space: h (F - K q) and what acts besides, v and dv
    std::vector<double> momentum_, v_, dv_;
  };
} // namespace nsfd
