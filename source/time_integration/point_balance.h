#pragma once

#include "uniqueness.h"

#include "discretization/discretization.h"
#include "nonsmooth/solver.h"
#include "state/state.h"
#include "time_integrator.h"

#include <algorithm>
#include <array>
#include <vector>

namespace nsfd
{
  struct SceneInput;

  /** Something that a point does takes time. */
  template <int dim>
  bool has_rates(const SceneInput &input, const OneStepProblem<dim> &problem);

  /**
   * The energy balance of the points of a step, one after the other, and what
   * they keep of it: d_m, beta, kind, slip, bound of the penetration.
   */
  template <int dim>
  class PointBalance
  {
  public:
    /** Sums over the points. */
    enum Row {
      stored,
      damage,
      friction,
      positive_friction,
      impact,
      numerical,
      motion,
      broken,
      joint,    ///< work of rows of joints, a part of impact or numerical
      support,  ///< of supports beyond their prescribed velocity, of the work
      impulses, ///< sum R P^2, R the majorants: what the residual relates to
      of_rows,  ///< the same where velocities are prescribed
      viscous   ///< only where a point of the scene has_rates()
    };

    PointBalance(const Discretization<dim> &discretization,
                 const UniquenessBound<dim> &uniqueness,
                 const OneStepProblem<dim> &problem,
                 const LawEvaluation<dim> &evaluation,
                 const std::vector<PointOrigin> &origins, double work_theta,
                 const State &old, State &next);

    /** All of them. */
    void add();

    std::vector<unsigned int> points; ///< with an energy, ascending
    std::size_t n_owned;              ///< of them, the first ones
    unsigned int n_rows;
    std::vector<double> terms;     ///< n_rows of n_owned
    std::vector<double> reactions; ///< the same, dim rows per boundary
    double penetration = 0., excess = 0., drift = 0., viscous_traction = 0.;
    unsigned int active = 0;
    bool beyond_unique = false;

    /** The own point that gave most in a row, or none. */
    std::size_t worst(const Row row) const
    {
      if (n_owned == 0)
        return LineChanges::no_point;
      const auto first = terms.begin() + long(row * n_owned);
      const auto least = std::min_element(first, first + long(n_owned));
      return *least < 0. ? points[std::size_t(least - first)]
                         : LineChanges::no_point;
    }

  private:
    using Vector = std::array<double, dim>;

    void put(const Row row, const double value)
    {
      auto &heat = next_.heat.of_points; // of shared points, too
      if (!heat.empty() && (row == damage || row == friction))
        heat[points[place_]] += value;
      if (place_ < n_owned)
        terms[row * n_owned + place_] += value;
    }
    void add(std::size_t point);
    /** By the rule of the positions. */
    double moved(const std::size_t k) const
    {
      const double theta = problem_.theta;
      return problem_.time_step * (theta * next_.relative_velocity[k] +
                                   (1. - theta) * old_.relative_velocity[k]);
    }
    void add_prescribed(std::size_t i, const Vector &U_theta);
    void add_law(std::size_t i, const Vector &U_theta,
                 const PointEnergies<dim> &energies);
    double add_lift(std::size_t i);
    void keep_history(std::size_t i, const PointEnergies<dim> &energies);
    void heal(std::size_t i);
    void add_penetration(std::size_t i);

    const Discretization<dim> &discretization_;
    const UniquenessBound<dim> &uniqueness_;
    const OneStepProblem<dim> &problem_;
    const LawEvaluation<dim> &evaluation_;
    const std::vector<PointOrigin> &origins_;
    const double work_theta_; ///< of the velocity that impulses work with
    const State &old_;
    State &next_;
    std::size_t place_ = 0; ///< of the present point among `points`
  };
} // namespace nsfd
