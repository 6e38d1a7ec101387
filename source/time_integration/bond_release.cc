#include "bond_release.h"

#include "nonsmooth/point_law.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace nsfd
{
  namespace
  {
    template <int dim>
    bool has_law(const OneStepProblem<dim> &problem, const std::size_t i)
    {
      return bool(problem.interactions[problem.interaction[i]].law);
    }

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
      // the law has what friction does not carry of the shear
      double shear = 0., share = 1.;
      for (unsigned int c = 1; c < dim; ++c)
        shear = std::hypot(shear, traction[c]);
      if (interaction.friction_exponent == 0. && traction[0] < 0. && shear > 0.)
        share =
            std::max(0., 1. + friction_of(problem, i) * traction[0] / shear);
      next.kind[i] = PointKind::cohesive;
      next.opening_max[i] = opening;
      for (unsigned int c = 0; c < dim; ++c) {
        double &u = next.jump[i * dim + c];
        if (c == 0)
          u = compliance * std::max(0., traction[0]);
        else
          u = r2 > 0. ? compliance * share * traction[c] / r2 : 0.;
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

  namespace
  {
    /** By point: both of its bodies are rigid. Collective. */
    template <int dim>
    std::vector<char> between_rigid(const DelassusOperator<dim> &delassus)
    {
      const auto &points = delassus.points();
      const auto &bodies = delassus.bodies();
      std::array<std::vector<double>, 2> rigid;
      for (auto &side : rigid)
        side.assign(points.n_points + 1, 0.);
      for (const auto &face : points.faces)
        for (unsigned int s = 0; s < 2; ++s)
          for (unsigned int i = face.first;
               face.bodies[s] >= 0 && i < face.first + face.count; ++i)
            rigid[s][i] = bodies.classes[bodies.class_of[face.bodies[s]]].rigid;
      delassus.exchange({{rigid[0].data(), rigid[1].data()}}, 1);
      std::vector<char> result(points.n_points);
      for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = rigid[0][i] != 0. && rigid[1][i] != 0.;
      return result;
    }
  } // namespace

  template <int dim>
  void hold_by_rows(const OneStepProblem<dim> &problem,
                    JoinedDelassus<dim> &joined, State &state)
  {
    const auto &points = joined.points();
    // what would tell when a law between rigid bodies opens are impulses
    const auto rigid = between_rigid(joined);
    for (std::size_t i = 0; i < rigid.size(); ++i)
      if (state.kind[i] == PointKind::bonded && rigid[i] && has_law(problem, i))
        state.kind[i] = PointKind::rigid;
    const auto shares_nodes = joined.sharing(bonded_points(state));
    for (std::size_t i = 0; i < points.n_points; ++i)
      if (state.kind[i] == PointKind::bonded &&
          !shares_nodes[points.face_of[i]])
        state.kind[i] =
            has_law(problem, i) ? PointKind::rigid : PointKind::prescribed;
  }

  template <int dim>
  void set_bond_tractions(const BulkTraction<dim> &bulk, State &state,
                          const typename BulkTraction<dim>::Where where)
  {
    state.bond_traction.resize(state.jump.size());
    bulk.evaluate(state.displacement.data(), where, state.bond_traction.data());
    if (bulk.delassus().terms().viscous_theta > 0.) {
      std::vector<double> viscous(state.jump.size());
      bulk.evaluate_viscous(state.velocity.data(), where, viscous.data());
      for (std::size_t k = 0; k < viscous.size(); ++k)
        state.bond_traction[k] += viscous[k];
    }
    for (std::size_t i = 0; i < state.kind.size(); ++i)
      if (state.kind[i] != PointKind::bonded)
        std::fill_n(&state.bond_traction[i * dim], dim, 0.);
  }

  template <int dim>
  std::vector<char> breakable_faces(const OneStepProblem<dim> &problem,
                                    const InterfacePoints<dim> &points)
  {
    std::vector<char> result(points.faces.size());
    for (std::size_t f = 0; f < result.size(); ++f) {
      const auto &face = points.faces[f];
      result[f] = face.count > 0 && has_law(problem, face.first);
    }
    return result;
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
                  JoinedDelassus<dim> &bonded, const bool mean,
                  const double share, const State &old, const State &next)
  {
    const auto &faces = bonded.points().faces;
    const auto &shares_nodes = bonded.shares_nodes();
    std::vector<std::pair<std::size_t, BondWay>> result;
    std::vector<std::pair<std::size_t, BondWay>> reached; // faces
    auto left = bonded_points(next);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const unsigned int first = faces[f].first;
      if (!shares_nodes[f] || !has_law(problem, first))
        continue;
      const BondWay way = way_of_face<dim>(problem, faces[f], mean, old, next);
      if (way.now < share)
        continue;
      reached.emplace_back(f, way);
      std::fill_n(left.begin() + first, faces[f].count, 0);
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
                                  const JoinedDelassus<dim> &bonded,
                                  const bool mean, const State &state)
  {
    std::vector<double> shares(problem.n_points, 0.);
    const auto &faces = bonded.points().faces;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const unsigned int first = faces[f].first, end = first + faces[f].count;
      if (first == end || !has_law(problem, first))
        continue;
      if (state.kind[first] == PointKind::bonded)
        std::fill(shares.begin() + first, shares.begin() + end,
                  way_of_face<dim>(problem, faces[f], mean, state, state).now);
    }
    return shares;
  }

  template <int dim>
  BondReport release_bonds(const OneStepProblem<dim> &problem,
                           const BulkTraction<dim> &bulk,
                           JoinedDelassus<dim> &bonded, const bool mean,
                           const State &old, State &next)
  {
    const auto &communicator = bulk.delassus().communicator();
    set_bond_tractions(bulk, next, BulkTraction<dim>::Where::marked);
    BondReport report;
    std::vector<double> in_laws(problem.n_owned, 0.);
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
      const double stored = start_law(
          problem, i, utilisation(problem, i, traction), traction, next);
      if (i < problem.n_owned) {
        in_laws[i] = stored;
        ++released;
      }
    }
    report.released = unsigned(communicator.sum_integer(released));
    if (report.released == 0)
      return report;
    report.overshoot = communicator.max(report.overshoot);
    report.share = communicator.min(report.share);
    const double gained = communicator.sum(in_laws);
    next.energy.cohesive += gained;
    next.energy.numerical -= gained;
    hold_by_rows(problem, bonded, next);
    set_bond_tractions(bulk, next, BulkTraction<dim>::Where::marked);
    return report;
  }

#define INSTANTIATE(dim)                                                       \
  template void hold_by_rows(const OneStepProblem<dim> &,                      \
                             JoinedDelassus<dim> &, State &);                  \
  template void set_bond_tractions(const BulkTraction<dim> &, State &,         \
                                   BulkTraction<dim>::Where);                  \
  template std::vector<char> breakable_faces(const OneStepProblem<dim> &,      \
                                             const InterfacePoints<dim> &);    \
  template double opening_at_release(const OneStepProblem<dim> &,              \
                                     std::size_t);                             \
  template std::vector<std::pair<std::size_t, BondWay>> points_at_share(       \
      const OneStepProblem<dim> &, JoinedDelassus<dim> &, bool, double,        \
      const State &, const State &);                                           \
  template std::vector<double> bond_shares(const OneStepProblem<dim> &,        \
                                           const JoinedDelassus<dim> &, bool,  \
                                           const State &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
  template BondReport release_bonds(const OneStepProblem<2> &,
                                    const BulkTraction<2> &,
                                    JoinedDelassus<2> &, bool, const State &,
                                    State &);
  template BondReport release_bonds(const OneStepProblem<3> &,
                                    const BulkTraction<3> &,
                                    JoinedDelassus<3> &, bool, const State &,
                                    State &);
} // namespace nsfd
