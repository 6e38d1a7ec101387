#include "drive_point.h"

#include "cohesive_laws/friction_weight.h"
#include "nonsmooth/healing.h"
#include "nonsmooth/point_law.h"
#include "nsfd/scene/time_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    using Vector = std::array<double, 2>;

    double sign(const double x) { return x > 0. ? 1. : x < 0. ? -1. : 0.; }

    /** A problem of one point, w = h = theta = 1: U is the jump increment. */
    class Driver
    {
    public:
      Driver(const Interaction &interaction, const CohesionRule rule)
          : law_(*interaction.law)
      {
        resize(problem_, 1);
        problem_.n_owned = 1;
        problem_.time_step = 1.;
        problem_.theta = 1.;
        problem_.rule = rule;
        problem_.interactions = {interaction};
        problem_.kind = {law_.extrinsic() ? PointKind::rigid
                                          : PointKind::cohesive};
        problem_.weight = {1.};
        problem_.strength_factor = {1.};
        if (!law_.extrinsic())
          problem_.opening_max = {law_.elastic_limit()};
        if (law_.mixed())
          problem_.slip_max = {0.};
      }

      const CurveRow &row() const { return row_; }

      void start(const PathPoint &point)
      {
        time_ = point.at.time;
        row_.path = point.path;
        row_.contact = point.at.reaction;
      }

      /** The tractions with which a motion towards @p next begins. */
      CurveRow before(const PathPoint &next) const
      {
        CurveRow row = row_;
        const Vector U = increment_to(next);
        if (problem_.kind[0] == PointKind::rigid) {
          const double r2 = law_.shear_weight();
          const double d = std::sqrt(U[0] * U[0] + r2 * U[1] * U[1]);
          if (law_.adds_openings()) { // each direction by itself
            row.cohesive_normal = law_.traction(0.);
            row.cohesive_tangential =
                law_.traction(0.) * std::sqrt(r2) * sign(U[1]);
          } else if (d > 0.) {
            row.cohesive_normal = law_.traction(0.) * U[0] / d;
            row.cohesive_tangential = law_.traction(0.) * r2 * U[1] / d;
          }
        }
        if (U[1] != 0.)
          row.friction = sign(U[1]) * bound(row_.beta, row_.contact);
        return row;
      }

      void step(const PathPoint &next)
      {
        const Vector U = increment_to(next);
        const PathMark &at = next.at;
        row_.path = next.path;
        row_.contact = at.reaction;
        const bool rests = U[0] == 0. && U[1] == 0.;
        if (rests && problem_.kind[0] == PointKind::rigid)
          return; // no jump yet, and nothing that tells its traction
        prepare(U, at.reaction);

        // the traction at this end of the step is known, hence the local
        // velocity that leads there, and the solve says whether it does
        PointEnergies<2> energies =
            point_energies<2>(problem_, 0, U, {secant_at(at)});
        const double s = bound(energies.beta, at.reaction);
        const double friction =
            U[1] != 0. ? sign(U[1]) * s : std::clamp(row_.friction, -s, s);
        const Vector P = {at.reaction - energies.cohesive_traction[0],
                          -energies.cohesive_traction[1] - friction};
        const LocalSolution<2> solution = solve(U, P, energies.history);
        const Vector arrived = solution.velocity;
        if (arrived != U)
          energies = point_energies<2>(problem_, 0, arrived, solution.frozen);

        row_.opening += arrived[0];
        row_.slip += arrived[1];
        if (arrived == U) {
          row_.opening = at.opening;
          row_.slip = at.slip;
        }
        row_.beta = energies.beta;
        row_.cohesive_normal = energies.cohesive_traction[0];
        row_.cohesive_tangential = energies.cohesive_traction[1];
        row_.friction =
            U[1] != 0. ? sign(U[1]) * solution.frozen.threshold : friction;
        account(energies, arrived);
        change_kind(energies, solution.damages);
        if (law_.heals())
          heal(energies, at.reaction, at.time - time_);
        time_ = at.time;
      }

    private:
      OneStepProblem<2> problem_;
      const CohesiveLaw &law_;
      CurveRow row_;
      double time_ = 0.;
      double origin_ = 0.; ///< slip at which healed bonds do not pull

      Vector increment_to(const PathPoint &next) const
      {
        return {next.at.opening - row_.opening, next.at.slip - row_.slip};
      }

      double bound(const double beta, const double reaction) const
      {
        const Interaction &interaction = problem_.interactions[0];
        return interaction.friction *
               kappa(beta, interaction.friction_exponent) * reaction;
      }

      /** Of a point that has moved to a mark. */
      Secant secant_at(const PathMark &mark) const
      {
        const double jump[] = {mark.opening, mark.slip - origin_};
        OneStepProblem<2> open = problem_;
        if (open.kind[0] == PointKind::rigid)
          open.kind[0] = PointKind::cohesive;
        return frozen_state<2>(open, 0,
                               reach_of<2>(problem_.interactions[0], jump), 0.)
            .secant;
      }

      void prepare(const Vector &U, const double reaction)
      {
        problem_.jump_old = {row_.opening, row_.slip - origin_};
        problem_.jump_free = problem_.jump_old;
        problem_.contact[0] = reaction > 0.;
        problem_.target[0] = U[0];
      }

      /**
       * The end of a step to which the impulse @p P belongs. Against a soft
       * majorant there is one; at a drop of the traction, two ends may be as
       * close as the majorant is soft.
       */
      LocalSolution<2> solve(const Vector &U, const Vector &P,
                             const Reach &reach) const
      {
        const double size =
            std::max(std::hypot(U[0], U[1]), 1e-6 * opening_scale(law_));
        const double stiffness =
            law_.extrinsic() ? 0. : law_.normal_stiffness();
        const double traction =
            std::hypot(P[0], P[1]) + (law_.strength() + stiffness * size) *
                                         std::max(1., law_.stiffness_ratio());
        double error = 0.;
        for (const double softness : {1e-3, 1e-6, 1e-9}) {
          const double R = softness * size / traction;
          LocalSolution<2> solution = solve_point<2>(
              problem_, 0, {U[0] - R * P[0], U[1] - R * P[1]}, R, R, reach);
          error = std::hypot(solution.velocity[0] - U[0],
                             solution.velocity[1] - U[1]);
          if (error <= 1e-12 * size)
            solution.velocity = U;
          if (error <= (softness > 1e-9 ? 1e-12 : 1e-6) * size)
            return solution;
        }
        throw std::logic_error(fmt::format(
            "a point at u = ({:.6g}, {:.6g}) m leaves its path by {:.2g} m",
            row_.opening, row_.slip, error));
      }

      void account(const PointEnergies<2> &energies, const Vector &U)
      {
        row_.stored = energies.stored;
        row_.damage += energies.damage;
        row_.friction_work += row_.friction * U[1];
        row_.work += row_.normal() * U[0] + row_.tangential() * U[1];
      }

      void heal(const PointEnergies<2> &energies, const double pressure,
                const double time)
      {
        const double jump[] = {row_.opening, row_.slip - origin_};
        const Healing healing =
            healing_of<2>(problem_, 0, energies.beta, energies.history.opening,
                          jump, pressure, time);
        if (!healing.heals)
          return;
        problem_.kind[0] = PointKind::cohesive;
        problem_.opening_max[0] = healing.opening_max;
        origin_ = row_.slip - healing.slip_share * jump[1];
        row_.beta = healing.beta;
        row_.stored -= healing.dissipated;
        row_.damage += healing.dissipated;
      }

      void change_kind(const PointEnergies<2> &energies, const bool damages)
      {
        problem_.opening_max[0] = energies.history.opening;
        if (law_.mixed())
          problem_.slip_max[0] = energies.history.slip;
        if (problem_.kind[0] == PointKind::rigid && damages)
          problem_.kind[0] = PointKind::cohesive;
        if (problem_.kind[0] == PointKind::cohesive && energies.beta <= 0.)
          problem_.kind[0] = PointKind::free;
      }
    };
  } // namespace

  Interaction interaction_of(std::shared_ptr<const CohesiveLaw> law,
                             const double friction,
                             const double friction_exponent)
  {
    Interaction interaction;
    interaction.stiffness_ratio = law->stiffness_ratio();
    interaction.shear_weight = law->shear_weight();
    interaction.law = std::move(law);
    interaction.friction = friction;
    interaction.friction_exponent = friction_exponent;
    return interaction;
  }

  std::vector<CurveRow> drive_point(const Interaction &interaction,
                                    const std::vector<PathPoint> &points,
                                    const CohesionRule rule)
  {
    Driver driver(interaction, rule);
    driver.start(points.front());
    std::vector<CurveRow> rows = {driver.row()};
    for (std::size_t i = 1; i < points.size(); ++i) {
      const CurveRow turned = driver.before(points[i]);
      if (turned.cohesive_normal != rows.back().cohesive_normal ||
          turned.cohesive_tangential != rows.back().cohesive_tangential ||
          sign(turned.friction) != sign(rows.back().friction))
        rows.push_back(turned);
      driver.step(points[i]);
      rows.push_back(driver.row());
    }
    return rows;
  }

  double opening_scale(const CohesiveLaw &law)
  {
    if (std::isfinite(law.final_opening()))
      return law.final_opening();
    double low = 0., high = law.toughness() / law.strength();
    const auto is_gone = [&](const double d) {
      return law.energy(d) >= 0.99 * law.toughness();
    };
    // a law that never takes its toughness breaks its contract, which says so
    for (unsigned int i = 0; i < 60 && !is_gone(high); ++i)
      low = high, high *= 2.;
    while (high - low > 1e-12 * high)
      (is_gone((low + high) / 2.) ? high : low) = (low + high) / 2.;
    return high;
  }

  double slip_scale(const CohesiveLaw &law)
  {
    const double r2 = law.shear_weight();
    return r2 > 0. ? opening_scale(law) / std::sqrt(r2) : opening_scale(law);
  }
} // namespace nsfd
