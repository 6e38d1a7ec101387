#include "bond_release.h"

#include "nonsmooth/point_law.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nsfd
{
  namespace
  {
    /** Pull and shear as the strength is compared with them, over it. */
    template <int dim>
    double utilisation(const OneStepProblem<dim> &problem, const std::size_t i,
                       const double *traction)
    {
      return effective_traction<dim>(problem, i, traction[0], traction + 1) /
             point_strength<dim>(problem, i);
    }

    /**
     * A law that is set-valued at u = 0 leaves open what a point carries that
     * does not move; joined neighbours leave it open again. So the law starts
     * on its envelope, a little way along it, with the jump that carries the
     * traction of the bond there. Returns the energy that it stores with that,
     * in J.
     */
    template <int dim>
    double start_law(const OneStepProblem<dim> &problem, const std::size_t i,
                     const double utilisation, const double *traction,
                     State &next)
    {
      const auto &interaction = problem.interactions[problem.interaction[i]];
      const double opening = opening_at_release<dim>(problem, i);
      const double r2 = interaction.shear_weight;
      const double compliance =
          opening / (utilisation * point_strength<dim>(problem, i));
      next.kind[i] = PointKind::cohesive;
      next.opening_max[i] = opening;
      for (unsigned int c = 0; c < dim; ++c) {
        double &u = next.jump[i * dim + c];
        if (c == 0)
          u = compliance * std::max(0., traction[0]);
        else
          u = r2 > 0. ? compliance * traction[c] / r2 : 0.;
        next.impulse[i * dim + c] =
            -problem.weight[i] * problem.time_step * traction[c] / utilisation;
      }
      return problem.weight[i] * point_strength<dim>(problem, i) * opening / 2.;
    }
  } // namespace

  template <int dim>
  double opening_at_release(const OneStepProblem<dim> &problem,
                            const std::size_t i)
  {
    constexpr double share = 1e-9; // of the toughness
    const CohesiveLaw &law = *problem.interactions[problem.interaction[i]].law;
    return share * law.toughness() / law.strength() / problem.opening_factor[i];
  }

  std::vector<std::uint8_t> bonded_points(const State &state)
  {
    std::vector<std::uint8_t> bonded(state.kind.size());
    std::transform(
        state.kind.begin(), state.kind.end(), bonded.begin(),
        [](const PointKind kind) { return kind == PointKind::bonded; });
    return bonded;
  }

  template <int dim>
  void set_bond_tractions(const BulkTraction<dim> &bulk, State &state)
  {
    state.bond_traction.resize(state.jump.size());
    bulk.evaluate(state.displacement.data(), state.bond_traction.data());
    if (bulk.delassus().viscous_theta() > 0.) {
      std::vector<double> viscous(state.jump.size());
      bulk.evaluate_viscous(state.velocity.data(), viscous.data());
      for (std::size_t k = 0; k < viscous.size(); ++k)
        state.bond_traction[k] += viscous[k];
    }
    for (std::size_t i = 0; i < state.kind.size(); ++i)
      if (state.kind[i] != PointKind::bonded)
        std::fill_n(&state.bond_traction[i * dim], dim, 0.);
  }

  namespace
  {
    template <int dim>
    BondWay way_of_point(const OneStepProblem<dim> &problem,
                         const std::size_t i, const State &old,
                         const State &next)
    {
      return {utilisation(problem, i, &old.bond_traction[i * dim]),
              utilisation(problem, i, &next.bond_traction[i * dim])};
    }

    /** Of a face that lets go as a whole. */
    template <int dim>
    BondWay way_of_face(const OneStepProblem<dim> &problem,
                        const typename InterfacePoints<dim>::Face &face,
                        const bool mean, const State &old, const State &next)
    {
      if (!mean) {
        BondWay furthest;
        for (unsigned int i = face.first; i < face.first + face.count; ++i) {
          const BondWay way = way_of_point(problem, i, old, next);
          if (way.now > furthest.now)
            furthest = way;
        }
        return furthest;
      }
      const auto of = [&](const State &state) {
        double traction[dim] = {}, weight = 0.;
        for (unsigned int i = face.first; i < face.first + face.count; ++i) {
          weight += problem.weight[i];
          for (unsigned int c = 0; c < dim; ++c)
            traction[c] += problem.weight[i] * state.bond_traction[i * dim + c];
        }
        for (double &t : traction)
          t /= weight;
        return utilisation(problem, face.first, traction);
      };
      return {of(old), of(next)};
    }

  } // namespace

  template <int dim>
  std::vector<std::pair<std::size_t, BondWay>>
  points_at_share(const OneStepProblem<dim> &problem,
                  BondedDelassus<dim> &bonded, const bool mean,
                  const double share, const State &old, const State &next)
  {
    const auto &faces = bonded.points().faces;
    const auto &shares_nodes = bonded.shares_nodes();
    std::vector<std::pair<std::size_t, BondWay>> result;
    std::vector<std::pair<std::size_t, BondWay>> reached; // faces
    auto left = bonded_points(next);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const unsigned int first = faces[f].first;
      if (!problem.interactions[problem.interaction[first]].law)
        continue;
      if (shares_nodes[f]) {
        const BondWay way =
            way_of_face<dim>(problem, faces[f], mean, old, next);
        if (way.now < share)
          continue;
        reached.emplace_back(f, way);
        std::fill_n(left.begin() + first, faces[f].count, 0);
        continue;
      }
      for (unsigned int i = first; i < first + faces[f].count; ++i) {
        if (next.kind[i] != PointKind::bonded)
          continue;
        const BondWay way = way_of_point(problem, i, old, next);
        if (way.now >= share)
          result.emplace_back(i, way);
      }
    }
    if (!bonded.communicator().any(!reached.empty()))
      return result;
    const auto opens = bonded.opens_with(left);
    for (const auto &[f, way] : reached)
      for (unsigned int i = faces[f].first;
           opens[f] && i < faces[f].first + faces[f].count; ++i)
        result.emplace_back(i, way);
    std::sort(result.begin(), result.end(),
              [](const auto &a, const auto &b) { return a.first < b.first; });
    return result;
  }

  template <int dim>
  std::vector<double> bond_shares(const OneStepProblem<dim> &problem,
                                  const BondedDelassus<dim> &bonded,
                                  const bool mean, const State &state)
  {
    std::vector<double> shares(problem.n_points, 0.);
    const auto &faces = bonded.points().faces;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const unsigned int first = faces[f].first, end = first + faces[f].count;
      if (first == end || !problem.interactions[problem.interaction[first]].law)
        continue;
      const bool whole = bonded.shares_nodes()[f];
      for (unsigned int i = first; i < end; ++i)
        if (state.kind[i] == PointKind::bonded)
          shares[i] =
              whole && i > first ? shares[first]
              : whole
                  ? way_of_face<dim>(problem, faces[f], mean, state, state).now
                  : way_of_point<dim>(problem, i, state, state).now;
    }
    return shares;
  }

  template <int dim>
  BondReport release_bonds(const OneStepProblem<dim> &problem,
                           const BulkTraction<dim> &bulk,
                           BondedDelassus<dim> &bonded, const bool mean,
                           const State &old, State &next)
  {
    const auto &communicator = bulk.delassus().communicator();
    set_bond_tractions(bulk, next);
    // what bonds store is the work of the elastic part
    std::vector<double> elastic = next.bond_traction;
    if (bulk.delassus().viscous_theta() > 0.)
      bulk.evaluate(next.displacement.data(), elastic.data());
    BondReport report;
    std::vector<double> in_bonds(problem.n_owned, 0.), in_laws(in_bonds);
    unsigned int released = 0;
    for (const auto &[i, way] :
         points_at_share(problem, bonded, mean, 1., old, next)) {
      // those that could not part before ask for no shorter step
      if (way.before < 1.) {
        report.overshoot = std::max(report.overshoot, way.now - 1.);
        if (way.now > way.before)
          report.share = std::min(report.share,
                                  (1. - way.before) / (way.now - way.before));
      }
      const double *traction = &next.bond_traction[i * dim];
      if (i < problem.n_owned) {
        in_bonds[i] =
            bulk.bond_energy(i, &next.jump[i * dim], &elastic[i * dim]);
        ++released;
      }
      const double stored = start_law(
          problem, i, utilisation(problem, i, traction), traction, next);
      if (i < problem.n_owned)
        in_laws[i] = stored;
    }
    report.released = unsigned(communicator.sum_integer(released));
    if (report.released == 0)
      return report;
    report.overshoot = communicator.max(report.overshoot);
    report.share = communicator.min(report.share);
    const double lost = communicator.sum(in_bonds),
                 gained = communicator.sum(in_laws);
    next.energy.elastic -= lost;
    next.energy.cohesive += gained;
    next.energy.numerical += lost - gained;
    set_bond_tractions(bulk, next);
    return report;
  }

#define INSTANTIATE(dim)                                                       \
  template void set_bond_tractions(const BulkTraction<dim> &, State &);        \
  template double opening_at_release(const OneStepProblem<dim> &,              \
                                     std::size_t);                             \
  template std::vector<std::pair<std::size_t, BondWay>> points_at_share(       \
      const OneStepProblem<dim> &, BondedDelassus<dim> &, bool, double,        \
      const State &, const State &);                                           \
  template std::vector<double> bond_shares(const OneStepProblem<dim> &,        \
                                           const BondedDelassus<dim> &, bool,  \
                                           const State &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
  template BondReport release_bonds(const OneStepProblem<2> &,
                                    const BulkTraction<2> &,
                                    BondedDelassus<2> &, bool, const State &,
                                    State &);
  template BondReport release_bonds(const OneStepProblem<3> &,
                                    const BulkTraction<3> &,
                                    BondedDelassus<3> &, bool, const State &,
                                    State &);
} // namespace nsfd
