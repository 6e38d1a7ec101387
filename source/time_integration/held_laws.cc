#include "held_laws.h"

#include "activation.h"
#include "peak_rule.h"
#include "static_bonds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /** Growth that is no round-off of the rounds. */
    constexpr double least_growth = 1e-9;
    /** Of the opening G/R_max: where a point that opens starts. */
    constexpr double first_opening = 1e-3;
    /** The same of what growth may be hurried by. */
    constexpr double largest_bit = 0.2;
  } // namespace

  template <int dim>
  bool HeldLaws<dim>::may_damage(const std::size_t i) const
  {
    return (iterate_.old->kind[i] == PointKind::cohesive ||
            iterate_.starts_joined(i)) &&
           problem_.interactions[problem_.interaction[i]].law;
  }

  template <int dim>
  Reach HeldLaws<dim>::history(const std::size_t i) const
  {
    // a bond that has let go has next to none
    return {iterate_.activated[i] ? iterate_.at.opening_max[i]
                                  : iterate_.old->opening_max[i],
            iterate_.old->slip_max.empty() ? 0. : iterate_.old->slip_max[i]};
  }

  template <int dim>
  double HeldLaws<dim>::opening_scale(const std::size_t i) const
  {
    const CohesiveLaw &law = *interactions_[interaction_[i]].law;
    return law.toughness() / (law.strength() * problem_.opening_factor[i]);
  }

  template <int dim>
  void HeldLaws<dim>::begin()
  {
    release();
    joint_loads_known_ = false;
  }

  template <int dim>
  void HeldLaws<dim>::hold()
  {
    holds_ = true;
    held_.resize(iterate_.old->kind.size());
    for (std::size_t i = 0; i < held_.size(); ++i)
      held_[i] = history(i);
    interactions_ = problem_.interactions;
    interaction_ = problem_.interaction;
  }

  template <int dim>
  void HeldLaws<dim>::release()
  {
    if (!holds_)
      return;
    holds_ = false;
    problem_.interactions = interactions_;
    problem_.interaction = interaction_;
  }

  /** How much of its strength every joined point carries; collective. */
  template <int dim>
  std::vector<double> HeldLaws<dim>::joint_shares() const
  {
    std::vector<double> shares;
    // rows ask for a system of all of them, common nodes do not
    const auto &kind = iterate_.old->kind;
    const bool by_rows =
        has_extrinsic_ &&
        std::find(kind.begin(), kind.end(), PointKind::rigid) != kind.end();
    if (delassus_.communicator().any(by_rows)) {
      std::vector<double> impulse = iterate_.force;
      for (double &P : impulse)
        P *= iterate_.h;
      shares = strength_shares(delassus_, discretization_.origins(), impulse,
                               problem_)
                   .value_or(shares);
    }
    if (!bonds_)
      return shares;
    const auto of_bonds = bonds_->shares();
    shares.resize(of_bonds.size(), 0.);
    for (std::size_t i = 0; i < shares.size(); ++i)
      if (iterate_.old->kind[i] == PointKind::bonded)
        shares[i] = of_bonds[i];
    return shares;
  }

  template <int dim>
  void HeldLaws<dim>::find_joint_loads()
  {
    if (joint_loads_known_ || !(has_extrinsic_ || bonds_))
      return;
    joint_loads_ = joint_shares();
    joint_loads_known_ = true;
  }

  template <int dim>
  void HeldLaws<dim>::put_springs()
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
      // of bonds that have let go since
      held_[i].opening = std::max(held_[i].opening, iterate_.at.opening_max[i]);
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
  Reach HeldLaws<dim>::held_reach(const std::size_t i) const
  {
    double jump[dim];
    for (unsigned int c = 0; c < dim; ++c)
      jump[c] = problem_.jump_free[i * dim + c] +
                iterate_.h * iterate_.solutions[i].velocity[c];
    return reach_of<dim>(interactions_[interaction_[i]], jump);
  }

  /**
   * Of its strength that a point had carried as a bond, which carries @p now
   * by the forces of its nodes: these are to the bulk traction then as now.
   */
  template <int dim>
  double HeldLaws<dim>::load_at_start(const std::size_t i, const double now,
                                      const std::vector<double> &joints) const
  {
    return joints[i] > 0. ? joint_loads_[i] * now / joints[i] : 0.;
  }

  template <int dim>
  auto HeldLaws<dim>::prediction() -> Prediction
  {
    const auto &communicator = delassus_.communicator();
    auto &problem = problem_;
    std::vector<unsigned int> springs = interaction_;
    springs.swap(problem.interaction); // of the laws
    const auto joints = joint_shares();
    Prediction result;
    bool damages = false;
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      if (!may_damage(i))
        continue;
      double before, after;
      bool certain = true;
      if (iterate_.at.kind[i] == PointKind::bonded)
        continue; // far from its strength
      if (iterate_.old->kind[i] == PointKind::rigid) {
        before = joint_loads_.empty() ? 0. : joint_loads_[i];
        after = joints.empty() ? 0. : joints[i];
        damages = damages || after > 1.;
      } else {
        const PointEnvelope envelope(problem, i);
        const Reach last = history(i), reach = held_reach(i);
        const Interaction &law = interactions_[interaction_[i]];
        const bool closed = bonds_ && bonds_->is_closed(iterate_.at, i);
        after = closed ? bonds_->share_of(iterate_.force, i)
                       : envelope.load(last, reach);
        before =
            iterate_.old->kind[i] == PointKind::bonded
                ? load_at_start(i, after, joints)
            : closed
                ? bonds_->share_of(iterate_.old->point_force, i)
                : envelope.load(
                      last, reach_of<dim>(law, &iterate_.old->jump[i * dim]));
        const double harmless = std::max(
            last.opening, envelope.law.mixed()
                              ? 0.
                              : envelope.law.elastic_limit() / envelope.l);
        damages = damages ||
                  (closed ? after > 1. + least_growth
                          : reach.opening > harmless * (1. + least_growth) ||
                                reach.slip > last.slip * (1. + least_growth));
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

  /** What the last round has held joined above its strength. */
  template <int dim>
  void HeldLaws<dim>::let_joints_go(std::vector<char> &fresh)
  {
    const auto joints = joint_shares();
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (iterate_.at.kind[i] != PointKind::rigid ||
          !(joints[i] > 1. + least_growth))
        continue;
      held_[i] = {first_opening * opening_scale(i), 0.};
      fresh[i] = 1;
      iterate_.activated[i] = LoadStepIterate<dim>::lets_go;
      iterate_.at.kind[i] = PointKind::cohesive;
      iterate_.at.opening_max[i] = 1e-9 * held_[i].opening;
    }
  }

  template <int dim>
  bool HeldLaws<dim>::let_damage_grow(double &largest_growth,
                                      const double stretch)
  {
    const auto &communicator = delassus_.communicator();
    auto &problem = problem_;
    std::vector<char> fresh(problem.n_points, 0);
    std::vector<unsigned int> springs = interaction_;
    springs.swap(problem.interaction); // of the laws
    let_joints_go(fresh);
    largest_growth =
        std::any_of(fresh.begin(), fresh.end(), [](const char f) { return f; })
            ? std::numeric_limits<double>::max()
            : 0.;
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      if (iterate_.at.kind[i] != PointKind::cohesive || fresh[i] ||
          (iterate_.old->kind[i] != PointKind::cohesive &&
           !iterate_.activated[i]))
        continue; // the last round has held it joined
      const CohesiveLaw &law = *interactions_[interaction_[i]].law;
      const double l = problem.opening_factor[i], scale = opening_scale(i);
      Reach &held = held_[i];
      const Reach reach = held_reach(i);
      if (problem.kind[i] == PointKind::prescribed) { // held together so far
        if (bonds_->share_of(iterate_.force, i) > 1. + least_growth) {
          held.opening = first_opening * scale;
          iterate_.activated[i] = LoadStepIterate<dim>::opened;
          largest_growth = std::numeric_limits<double>::max();
        }
        continue;
      }
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
  auto HeldLaws<dim>::passages(const State &next, const bool path) const
      -> Passages
  {
    const auto &problem = problem_;
    Passages passages;
    for (std::size_t i = 0; i < problem.n_owned; ++i) {
      if (!may_damage(i) ||
          (iterate_.starts_joined(i) && next.kind[i] == iterate_.old->kind[i]))
        continue;
      const Interaction &interaction =
          problem.interactions[problem.interaction[i]];
      if (interaction.plateau && !iterate_.starts_joined(i))
        continue; // carries its traction at any opening
      const Reach end = {next.opening_max[i],
                         next.slip_max.empty() ? 0. : next.slip_max[i]};
      const PointEnvelope envelope(problem, i);
      const Reach last = history(i);
      Passage way = passage(
          envelope, last,
          reach_of<dim>(interaction, &iterate_.old->jump[i * dim]), end);
      if (iterate_.starts_joined(i))
        way.start = joint_loads_.empty() ? 0. : joint_loads_[i];
      else if (bonds_ && bonds_->is_closed(*iterate_.old, i))
        way.start = bonds_->share_of(iterate_.old->point_force, i);
      double share = std::min(1., std::max(way.start, way.end));
      if (path && share < 1. &&
          (held_[i].opening > last.opening || held_[i].slip > last.slip)) {
        const double seen = largest_on_the_way(envelope, last, held_[i]),
                     all = largest_on_the_way(envelope, last, end);
        share = std::max(share, std::min(1., seen / all));
      }
      if (grows(last, end))
        passages.largest = std::max(passages.largest, share);
      if (share < passages.least) {
        passages.least = share;
        passages.point = i;
      }
    }
    return passages;
  }

  template class HeldLaws<2>;
  template class HeldLaws<3>;
} // namespace nsfd
