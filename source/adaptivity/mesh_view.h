#pragma once

#include "delassus/delassus_operator.h"
#include "discretization/discretization.h"
#include "nonsmooth/one_step_problem.h"
#include "nsfd/adaptivity/indicator.h"
#include "state/state.h"

#include <optional>
#include <vector>

namespace nsfd
{
  struct SceneInput;

  /** A mesh, its last step and the state at its end. */
  template <int dim>
  struct MeshState {
    const Discretization<dim> &discretization;
    const DelassusOperator<dim> &delassus;
    const OneStepProblem<dim> &problem;
    const State &state;
  };

  /** Per body: xx, yy, zz, xy, xz, yz, Pa. */
  template <int dim>
  std::vector<std::array<double, 6>>
  mean_stresses(const Discretization<dim> &discretization,
                const std::vector<double> &displacement);

  /** 9 pi/32 E' G/R_max^2 of a point with a law that damages, m. */
  template <int dim>
  double cohesive_zone(const SceneInput &input,
                       const Discretization<dim> &discretization,
                       const OneStepProblem<dim> &problem, std::size_t point);

  /** What indicators see; nothing is computed before it is asked for. */
  template <int dim>
  class StateView final : public MeshView
  {
  public:
    /** @p levels, per body: refinements since the first mesh. */
    StateView(const SceneInput &input, const MeshState<dim> &mesh,
              const std::vector<unsigned int> &levels);

    const std::vector<Body> &bodies() const override { return bodies_; }
    const std::vector<double> &energy() const override;
    const std::vector<double> &stress_jump() const override;
    const std::vector<Point> &points() const override;
    double sum(const std::vector<double> &terms) const override;
    double max(double value) const override;
    std::vector<double>
    gather(const std::vector<double> &values) const override;

  private:
    double utilisation(std::size_t point) const;

    const SceneInput &input_;
    const MeshState<dim> mesh_;
    std::vector<Body> bodies_;
    mutable std::optional<std::vector<double>> energy_, stress_jump_;
    mutable std::optional<std::vector<Point>> points_;
  };
} // namespace nsfd
