#include "activation.h"
#include "peak_rule.h"
#include "relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /** Growth that is no round-off of the rounds. */
    constexpr double least_growth = 1e-9;
    /** Of the opening G/R_max: where a point that lets go starts. */
    constexpr double first_opening = 1e-3;
    /** The same of what growth may be hurried by. */
    constexpr double largest_bit = 0.2;
  } // namespace

  template <int dim>
  bool Relaxation<dim>::may_damage(const std::size_t i) const
  {
    const PointKind kind = old_->kind[i];
    return (kind == PointKind::cohesive || kind == PointKind::rigid) &&
           problem_.interactions[problem_.interaction[i]].law;
  }

  template <int dim>
  bool Relaxation<dim>::has_laws() const
  {
    bool any = false;
    for (const auto &block : input_.interfaces)
      any = any || block.law;
    return any;
  }

  template <int dim>
  Reach Relaxation<dim>::history(const std::size_t i) const
  {
    return {old_->opening_max[i],
            old_->slip_max.empty() ? 0. : old_->slip_max[i]};
  }

  template <int dim>
  void Relaxation<dim>::hold_laws()
  {
    holds_ = true;
    held_.resize(old_->kind.size());
    for (std::size_t i = 0; i < held_.size(); ++i)
      held_[i] = history(i);
    interactions_ = problem_.interactions;
    interaction_ = problem_.interaction;
  }

  template <int dim>
  void Relaxation<dim>::free_laws()
  {
    if (!holds_)
      return;
    holds_ = false;
    problem_.interactions = interactions_;
    problem_.interaction = interaction_;
  }

  /** Springs in place of the laws of a round; joints stay as they are. */
  template <int dim>
  void Relaxation<dim>::hold()
  {
    auto &problem = problem_;
    problem.interactions = interactions_;
    problem.interaction = interaction_;
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      if (problem.kind[i] != PointKind::cohesive)
        continue;
      const Interaction &law = interactions_[interaction_[i]];
      if (law.plateau)
        continue; // no spring: it carries a traction at no opening
      const FrozenPoint frozen = frozen_state<dim>(problem, i, held_[i], 1.);
      Interaction spring = law;
      spring.law = nullptr;
      spring.normal_stiffness = frozen.secant.normal;
      if (frozen.secant.tangential > 0.)
        spring.normal_stiffness =
            std::max(spring.normal_stiffness, 1e-12 * frozen.secant.tangential);
      spring.friction = frozen.threshold; // at a contact force of 1
      spring.friction_exponent = 0.;
      problem.kind[i] = PointKind::free;
      if (spring.normal_stiffness > 0.) {
        problem.kind[i] = PointKind::elastic;
        spring.stiffness_ratio =
            frozen.secant.tangential / spring.normal_stiffness;
        spring.shear_weight = spring.stiffness_ratio;
      }
      problem.interaction[i] = unsigned(problem.interactions.size());
      problem.interactions.push_back(std::move(spring));
    }
  }

  /** At the end of the last round, from where the law counts. */
  template <int dim>
  Reach Relaxation<dim>::held_reach(const std::size_t i) const
  {
    double jump[dim];
    for (unsigned int c = 0; c < dim; ++c)
      jump[c] =
          problem_.jump_free[i * dim + c] + h_ * solutions_[i].velocity[c];
    return reach_of<dim>(interactions_[interaction_[i]], jump);
  }

  template <int dim>
  auto Relaxation<dim>::prediction() -> Prediction
  {
    const auto &communicator = dynamics_.communicator();
    auto &problem = problem_;
    std::vector<double> impulse = force_;
    for (double &P : impulse)
      P *= h_;
    const auto joints =
        step_problem_.has_extrinsic()
            ? strength_shares(dynamics_, discretization_.origins(), impulse,
                              problem)
            : std::vector<double>();
    std::vector<unsigned int> springs = interaction_;
    springs.swap(problem.interaction); // of the laws
    Prediction result;
    bool damages = false;
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      if (!may_damage(i))
        continue;
      double before, after;
      bool certain = true;
      if (old_->kind[i] == PointKind::rigid) {
        before = joint_loads_.empty() ? 0. : joint_loads_[i];
        after = joints.empty() ? 0. : joints[i];
        damages = damages || after > 1.;
      } else {
        const PointEnvelope envelope(problem, i);
        const Reach last = history(i), reach = held_reach(i);
        const Interaction &law = interactions_[interaction_[i]];
        before = envelope.load(last, reach_of<dim>(law, &old_->jump[i * dim]));
        after = envelope.load(last, reach);
        const double harmless = std::max(
            last.opening, envelope.law.mixed()
                              ? 0.
                              : envelope.law.elastic_limit() / envelope.l);
        damages = damages || reach.opening > harmless * (1. + least_growth) ||
                  reach.slip > last.slip * (1. + least_growth);
        certain = envelope.is_elastic_to_the_peak(last);
      }
      if (before >= Passage::least_share || !(after > 1. + least_growth))
        continue;
      const double share = (1. - before) / (after - before);
      if (share < result.share) {
        result.share = share;
        result.point = i;
        result.certain = certain && after > 1. + (1. - Passage::least_share);
      }
    }
    problem.interaction.swap(springs);
    const double least = -communicator.max(-result.share);
    result.certain = communicator.any(result.certain && result.share == least);
    result.share = least;
    result.damages = communicator.any(damages);
    return result;
  }

  template <int dim>
  bool Relaxation<dim>::let_damage_grow(double &largest_growth,
                                        const double stretch)
  {
    const auto &communicator = dynamics_.communicator();
    auto &problem = problem_;
    largest_growth = 0.;
    if (step_problem_.has_extrinsic()) {
      std::vector<double> impulse = force_;
      for (double &P : impulse)
        P *= h_;
      const auto joints = strength_shares(dynamics_, discretization_.origins(),
                                          impulse, problem);
      for (std::size_t i = 0; i < joints.size(); ++i)
        if (joints[i] > 1. + least_growth) {
          const CohesiveLaw &law = *interactions_[interaction_[i]].law;
          held_[i] = {first_opening * law.toughness() /
                          (law.strength() * problem.opening_factor[i]),
                      0.};
          let_go_[i] = 1;
          at_.kind[i] = PointKind::cohesive;
          at_.opening_max[i] = 1e-9 * held_[i].opening;
          largest_growth = std::numeric_limits<double>::max();
        }
    }
    std::vector<unsigned int> springs = interaction_;
    springs.swap(problem.interaction);
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      if (at_.kind[i] != PointKind::cohesive ||
          (old_->kind[i] != PointKind::cohesive && !let_go_[i]) ||
          (let_go_[i] && problem.kind[i] == PointKind::prescribed))
        continue; // the last round has held it rigid
      const CohesiveLaw &law = *interactions_[interaction_[i]].law;
      const double l = problem.opening_factor[i];
      const double scale = law.toughness() / (law.strength() * l);
      Reach &held = held_[i];
      const Reach reach = held_reach(i);
      const double elastic = law.mixed() ? 0. : law.elastic_limit() / l;
      const auto grow = [&](double &x, const double to, const double least) {
        const double from = std::max(x, least);
        if (!(to > from * (1. + least_growth)))
          return;
        largest_growth = std::max(largest_growth, (to - from) / scale);
        x = from + std::min(stretch * (to - from),
                            std::max(to - from, largest_bit * scale));
      };
      grow(held.opening, reach.opening, elastic);
      if (law.mixed())
        grow(held.slip, reach.slip, 0.);
    }
    problem.interaction.swap(springs);
    largest_growth = communicator.max(largest_growth);
    return largest_growth > 0.;
  }

  template <int dim>
  std::pair<double, std::size_t>
  Relaxation<dim>::least_passage(const State &next, const bool path) const
  {
    const auto &problem = problem_;
    std::pair<double, std::size_t> least(1., 0);
    for (std::size_t i = 0; i < problem.n_owned; ++i) {
      if (!may_damage(i) ||
          (old_->kind[i] == PointKind::rigid && next.kind[i] == old_->kind[i]))
        continue;
      const Interaction &interaction =
          problem.interactions[problem.interaction[i]];
      if (interaction.plateau && old_->kind[i] != PointKind::rigid)
        continue; // carries its traction at any opening
      const Reach end = {next.opening_max[i],
                         next.slip_max.empty() ? 0. : next.slip_max[i]};
      const PointEnvelope envelope(problem, i);
      const Reach last = history(i);
      Passage way =
          passage(envelope, last,
                  reach_of<dim>(interaction, &old_->jump[i * dim]), end);
      if (old_->kind[i] == PointKind::rigid)
        way.start = joint_loads_.empty() ? 0. : joint_loads_[i];
      double share = std::min(1., std::max(way.start, way.end));
      if (path && share < 1. &&
          (held_[i].opening > last.opening || held_[i].slip > last.slip)) {
        const double seen = largest_on_the_way(envelope, last, held_[i]),
                     all = largest_on_the_way(envelope, last, end);
        share = std::max(share, std::min(1., seen / all));
      }
      if (share < least.first)
        least = {share, i};
    }
    return least;
  }

#define INSTANTIATE(dim)                                                       \
  template bool Relaxation<dim>::has_laws() const;                             \
  template void Relaxation<dim>::hold_laws();                                  \
  template void Relaxation<dim>::free_laws();                                  \
  template void Relaxation<dim>::hold();                                       \
  template Relaxation<dim>::Prediction Relaxation<dim>::prediction();          \
  template bool Relaxation<dim>::let_damage_grow(double &, double);            \
  template std::pair<double, std::size_t> Relaxation<dim>::least_passage(      \
      const State &, bool) const

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
