#include "uniqueness.h"

#include "discretization/body_frequency.h"
#include "discretization/discretization.h"
#include "nonsmooth/point_law.h"
#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace nsfd
{
  namespace
  {
    /** The largest eigenvalue of sqrt(w_i) W_ij sqrt(w_j) over the slots that
        hold a point. */
    template <int dim>
    double largest_eigenvalue(const Block &W,
                              const std::vector<unsigned int> &slots,
                              const std::vector<unsigned int> &places,
                              const std::vector<double> &weight)
    {
      const unsigned int n = unsigned(slots.size()) * dim;
      Block A(n, n);
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          A(i, j) =
              std::sqrt(weight[places[i / dim]] * weight[places[j / dim]]) *
              W(slots[i / dim] * dim + i % dim, slots[j / dim] * dim + j % dim);
      return nsfd::largest_eigenvalue(A);
    }

    Reach history_of(const State &state, const std::size_t i)
    {
      return {state.opening_max[i],
              state.slip_max.empty() ? 0. : state.slip_max[i]};
    }

    /** Active and at its peak or past it. */
    template <int dim>
    bool softens(const OneStepProblem<dim> &problem, const State &state,
                 const std::size_t i)
    {
      if (state.kind[i] != PointKind::cohesive)
        return false;
      const auto &law = *problem.interactions[problem.interaction[i]].law;
      return law.extrinsic() ||
             past_peak(law, problem.opening_factor[i], history_of(state, i));
    }

    /**
     * Until u + t U has the opening at which the point softens (on): its peak,
     * or the largest so far. Infinite if not before the time @p end.
     */
    template <int dim>
    double time_to_soften(const OneStepProblem<dim> &problem,
                          const State &state, const std::size_t i,
                          const double end)
    {
      const auto &interaction = problem.interactions[problem.interaction[i]];
      const double opening =
          std::max(state.opening_max[i] * (1. - 1e-6),
                   interaction.law->peak_opening() / problem.opening_factor[i]);
      const auto reaches = [&](const double t) {
        double square = 0.;
        for (unsigned int c = 0; c < dim; ++c) {
          const double u = state.jump[i * dim + c] +
                           t * state.relative_velocity[i * dim + c];
          square +=
              c == 0 ? (u > 0. ? u * u : 0.) : interaction.shear_weight * u * u;
        }
        return square >= opening * opening;
      };
      if (!reaches(end))
        return std::numeric_limits<double>::infinity();
      double low = 0., high = end;
      for (unsigned int k = 0; k < 12; ++k) {
        const double middle = 0.5 * (low + high);
        (reaches(middle) ? high : low) = middle;
      }
      return low;
    }
  } // namespace

  template <int dim>
  UniquenessBound<dim>::UniquenessBound(const SceneInput &input,
                                        const std::vector<PointOrigin> &origins,
                                        const DelassusOperator<dim> &delassus)
      : delassus_(delassus), theta_(input.time.theta),
        chi_(input.time.cohesion_rule == CohesionRule::exact ? 0.5 : 1.),
        flexibility_(delassus.points().faces.size(), 0.)
  {
    for (const auto &block : input.interfaces)
      if (block.law) {
        set_flexibility(input, origins);
        return;
      }
  }

  /** Of bodies with a point that has a law; nobody asks for the others. */
  template <int dim>
  void
  UniquenessBound<dim>::set_flexibility(const SceneInput &input,
                                        const std::vector<PointOrigin> &origins)
  {
    const auto &points = delassus_.points();
    const auto &bodies = delassus_.bodies();
    const auto has_law = [&](const unsigned int i) {
      return origins[i].kind == PointOrigin::Kind::interface &&
             input.interfaces[origins[i].block].law;
    };
    std::vector<Block> delassus(bodies.classes.size());
    std::array<std::vector<double>, 2> sides;
    for (auto &side : sides)
      side.assign(points.n_points, 0.);
    // congruent bodies with points at the same slots share the value
    std::map<std::pair<unsigned int, std::vector<unsigned int>>, double> known;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      std::vector<unsigned int> slots, places;
      for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
           ++s)
        if (bodies.slot_point[s] < points.n_points) {
          slots.push_back(unsigned(s - bodies.first_slot[b]));
          places.push_back(bodies.slot_point[s]);
        }
      if (std::none_of(places.begin(), places.end(), has_law))
        continue;
      const unsigned int k = bodies.class_of[b];
      const auto [entry, is_new] = known.emplace(std::pair(k, slots), 0.);
      if (is_new) {
        const auto &body = bodies.classes[k];
        if (delassus[k].rows == 0)
          delassus[k] =
              gram(forward_solve(cholesky(body.mass), body.trace.transposed()));
        entry->second =
            largest_eigenvalue<dim>(delassus[k], slots, places, points.weight);
      }
      for (const unsigned int i : places)
        sides[points.faces[points.face_of[i]].bodies[1] == int(b)][i] =
            entry->second;
    }
    delassus_.exchange({{sides[0].data(), sides[1].data()}}, 1);
    for (std::size_t f = 0; f < points.faces.size(); ++f)
      flexibility_[f] =
          sides[0][points.faces[f].first] + sides[1][points.faces[f].first];
  }

  template <int dim>
  double UniquenessBound<dim>::ratio(const OneStepProblem<dim> &problem,
                                     const std::size_t point,
                                     const double h) const
  {
    const auto &law = *problem.interactions[problem.interaction[point]].law;
    const double slope = law.mixed()
                             ? std::max(law.steepest_softening(),
                                        law.mixed()->steepest_shear_softening())
                             : law.steepest_softening();
    return h * h * theta_ * chi_ * problem.strength_factor[point] *
           problem.opening_factor[point] * slope *
           flexibility_[delassus_.points().face_of[point]];
  }

  /** Of one point; infinite if no step is short enough: the traction jumps. */
  template <int dim>
  double UniquenessBound<dim>::bound(const OneStepProblem<dim> &problem,
                                     const std::size_t point) const
  {
    const double factor = ratio(problem, point, 1.);
    return factor > 0. && std::isfinite(factor)
               ? 1. / std::sqrt(factor)
               : std::numeric_limits<double>::infinity();
  }

  template <int dim>
  double UniquenessBound<dim>::largest_step(const OneStepProblem<dim> &problem,
                                            const State &state) const
  {
    double result = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < problem.n_owned; ++i)
      if (softens(problem, state, i))
        result = std::min(result, bound(problem, i));
    return delassus_.communicator().min(result);
  }

  template <int dim>
  double UniquenessBound<dim>::largest_step(const OneStepProblem<dim> &problem,
                                            const State &old,
                                            const State &next) const
  {
    double result = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < problem.n_owned; ++i) {
      const Reach before = history_of(old, i), after = history_of(next, i);
      if ((after.opening <= before.opening && after.slip <= before.slip) ||
          (old.kind[i] != PointKind::cohesive &&
           old.kind[i] != PointKind::rigid))
        continue;
      const auto &law = *problem.interactions[problem.interaction[i]].law;
      if (past_peak(law, problem.opening_factor[i], after))
        result = std::min(result, bound(problem, i));
    }
    return delassus_.communicator().min(result);
  }

  template <int dim>
  double UniquenessBound<dim>::next_step(const OneStepProblem<dim> &problem,
                                         const State &state, const double h,
                                         const double share) const
  {
    double result = h;
    for (std::size_t i = 0; i < problem.n_owned; ++i) {
      if (state.kind[i] != PointKind::cohesive)
        continue;
      const double allowed = share * bound(problem, i);
      if (allowed >= result)
        continue;
      const double wait = time_to_soften(problem, state, i, 2. * result);
      result = std::min(result, std::max(allowed, 0.5 * wait));
    }
    return delassus_.communicator().min(result);
  }

  template class UniquenessBound<2>;
  template class UniquenessBound<3>;
} // namespace nsfd
