#pragma once

#include "joined_bodies.h"

namespace nsfd
{
  /** Of bodies that share nodes. */
  template <int dim>
  class JoinedMotion final : public NodeMotion, public VertexMotion<dim>
  {
  public:
    explicit JoinedMotion(JoinedBodies<dim> &bodies) : bodies_(bodies) {}

    void start(const std::vector<double> &momentum,
               const std::vector<double> &impulse,
               const std::vector<double> &start, double floor = 0.) override;
    bool is_on() const override { return is_on_; }
    double stiffness_over_mass() override;
    bool saves_by_rough_solutions() const override
    {
      return bodies_.tangent_.has_cycles();
    }
    void cancel() override { is_on_ = false; }
    void balance(const std::vector<double> &P, double tolerance) override;
    bool solve(const std::vector<double> &T, bool symmetric,
               const std::vector<double> &c, const Accuracy &accuracy,
               std::vector<double> &dP, std::vector<double> &dU) override;
    const std::vector<double> &factored() const override
    {
      return bodies_.tangent_.factored();
    }
    void move(double length, const std::vector<double> &P,
              std::vector<double> &U) override;
    const std::vector<double> &motion() const override { return w_; }
    void set_motion(const std::vector<double> &w, const std::vector<double> &P,
                    std::vector<double> &U) override;
    double imbalance() const override { return left_ / scale_; }
    bool balances(const double tolerance) const override
    {
      return is_done_ || imbalance() <= tolerance;
    }
    void add_to(std::vector<double> &velocity) const override;
    std::vector<double> left_over() const override;

    const NodeClusters &vertices() override;
    unsigned int unknowns_per_node() const override;
    bool is_tied(const int k) const override
    {
      return !tied_.empty() && tied_[std::size_t(k)];
    }
    void node(int k, std::array<double, dim> &inverse_mass,
              std::array<double, dim> &velocity) const override;
    void sight(std::size_t point, std::vector<int> &nodes,
               std::vector<std::array<double, std::size_t(dim) * dim>> &B)
        const override;

  private:
    using Operator = typename DelassusOperator<dim>::Operator;

    void set_residual(const std::vector<double> &P);
    /** The same, where it is not what is known. Collective. */
    void keep_residual(const std::vector<double> &P, bool same_motion);
    void set_velocity(std::vector<double> &U) const;

    JoinedBodies<dim> &bodies_;
    bool is_on_ = false;
    bool asks_all_ = false;     ///< the last solution left no more than it may
    bool is_done_ = false;      ///< it has been taken in full
    std::vector<double> start_; ///< U_0
    /// own values of the space: p, w, dw and p - M_hat w + H^T P
    std::vector<double> momentum_, w_, dw_, residual_;
    struct {
      double share = -1., value = 0.;
    } stiffness_over_mass_;         ///< of steps with this share of K
    double left_ = 0., scale_ = 1.; ///< sizes of the residual, and of its terms
    double floor_ = 0.;             ///< of the latter
    bool known_ = false;            ///< the residual is that of w and of_
    std::vector<double> of_;        ///< P
    std::vector<char> tied_;        ///< by own node; empty: none
  };
} // namespace nsfd
