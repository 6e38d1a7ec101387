#include "halves_to_join.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /// of the energy of a family, or of a mean one: what may be lost of it
    constexpr double small_part = 1e-3;
    /// cells around joined ones whose nodes may move
    constexpr unsigned int n_rings = 2;

    /** sigma(e) : e. */
    double power(const std::array<double, 3> &e, const double lambda,
                 const double mu)
    {
      const double trace = e[0] + e[1];
      return lambda * trace * trace +
             2. * mu * (e[0] * e[0] + e[1] * e[1] + 2. * e[2] * e[2]);
    }
  } // namespace

  HalvesToJoin::Values HalvesToJoin::Element::forces(const Values &u) const
  {
    const auto e = shape.strain(u.data());
    const double trace = lambda * (e[0] + e[1]);
    const double xx = trace + 2. * mu * e[0], yy = trace + 2. * mu * e[1],
                 xy = 2. * mu * e[2];
    Values result;
    for (unsigned int i = 0; i < 3; ++i) {
      const auto &g = shape.gradients[i];
      result[2 * i] = shape.area * (xx * g[0] + xy * g[1]);
      result[2 * i + 1] = shape.area * (xy * g[0] + yy * g[1]);
    }
    return result;
  }

  double HalvesToJoin::Element::elastic(const Values &u) const
  {
    return shape.area / 2. * power(shape.strain(u.data()), lambda, mu);
  }

  HalvesToJoin::HalvesToJoin(const Bisection &cells,
                             const Discretization<2> &discretization,
                             const JoinedMesh<2> &mesh, const State &state)
      : cells_(cells), old_(discretization.cells()), mesh_(mesh), state_(state),
        mass_(mesh.n_nodes(), 0.), velocity_(2 * mesh.n_nodes()),
        vertex_(mesh.n_nodes()), blocked_(mesh.n_nodes(), 0)
  {
    // corners of a node that is not blocked all say the same
    for (std::size_t i = 0; i < mesh.n_corners(); ++i) {
      const std::size_t n = mesh.node(i);
      mass_[n] += mesh.mass(i);
      vertex_[n] = cells.old_cells()[i / 3][i % 3];
      for (unsigned int c = 0; c < 2; ++c)
        velocity_[2 * n + c] = state.velocity[2 * i + c];
    }
    const auto &origins = discretization.origins();
    for (std::size_t i = 0; i < origins.size(); ++i)
      if (origins[i].kind != PointOrigin::Kind::interface ||
          state.kind[i] != PointKind::bonded)
        blocked_[mesh.node_of_point(i)] = 1;
    std::vector<char> whole(cells.old_cells().size(), 0);
    for (const auto &cell : cells.cells())
      whole[cell.old] = stays(cell);
    for (std::size_t k = 0; k < whole.size(); ++k)
      for (unsigned int i = 0; i < 3 && !whole[k]; ++i)
        blocked_[mesh.node(3 * k + i)] = 1;
  }

  bool HalvesToJoin::stays(const Bisection::Cell &cell) const
  {
    return cell.vertices == cells_.old_cells()[cell.old];
  }

  /** The corners, in the halves, of the ends of the edge that was cut. */
  HalvesToJoin::Pair HalvesToJoin::ends(const Pair &pair) const
  {
    return {{3 * cells_.cells()[pair[0]].old + 2,
             3 * cells_.cells()[pair[1]].old + 1}};
  }

  bool HalvesToJoin::may_join(const Family &family) const
  {
    for (const Pair &pair : family.pairs)
      if (pair[0] != Bisection::none) {
        const Pair to = ends(pair);
        for (const unsigned int corner :
             {3 * cells_.cells()[pair[0]].old, to[0], to[1]})
          if (blocked_[mesh_.node(corner)])
            return false;
      }
    return true;
  }

  HalvesToJoin::Values
  HalvesToJoin::at(const Nodes &nodes,
                   const std::vector<double> &of_nodes) const
  {
    Values result;
    for (unsigned int i = 0; i < 3; ++i)
      std::copy_n(of_nodes.begin() + 2 * long(nodes[i]), 2,
                  result.begin() + 2 * i);
    return result;
  }

  HalvesToJoin::Element HalvesToJoin::element(const Bisection::Cell &cell,
                                              const LinearTriangle &shape,
                                              const Nodes &corners,
                                              const double corner_mass,
                                              const double viscosity) const
  {
    Element result{shape};
    for (unsigned int i = 0; i < 3; ++i) {
      result.nodes[i] = mesh_.node(corners[i]);
      for (unsigned int c = 0; c < 2; ++c) {
        const std::size_t k = 2 * std::size_t(corners[i]) + c;
        result.velocity[2 * i + c] = state_.velocity[k];
        result.displacement[2 * i + c] =
            state_.displacement[k] - state_.last_step / 2. * state_.velocity[k];
      }
    }
    const auto &law = old_.class_shape(cell.old).elasticity[0];
    result.lambda = law.lambda;
    result.mu = law.mu;
    result.corner_mass = corner_mass;
    result.viscosity = viscosity;
    return result;
  }

  HalvesToJoin::Element HalvesToJoin::old_element(const Bisection::Cell &cell,
                                                  const double viscosity) const
  {
    const unsigned int first = 3 * cell.old;
    return element(cell, LinearTriangle(old_, cell.old),
                   {{first, first + 1, first + 2}}, mesh_.mass(first),
                   viscosity);
  }

  HalvesToJoin::Element
  HalvesToJoin::joined_element(const Pair &pair, const double viscosity) const
  {
    const auto cell = cells_.joined(pair[0], pair[1]);
    std::vector<dealii::Point<2>> x;
    for (const unsigned int v : cell.vertices)
      x.push_back(cells_.vertex(v));
    const unsigned int first = 3 * cell.old;
    const Pair to = ends(pair);
    return element(cell, LinearTriangle(old_, cell.old, x),
                   {{first + 1, to[0], to[1]}}, 2. * mesh_.mass(first),
                   viscosity);
  }

  /** By itself: against its energy, or a @p mean one, J/m^2. */
  bool HalvesToJoin::is_smooth(const Family &family, const double mean) const
  {
    double whole = 0., all = 0., strained = 0., loss = 0.;
    for (const Pair &pair : family.pairs) {
      if (pair[0] == Bisection::none)
        continue;
      const Element joined = joined_element(pair, 0.);
      whole += joined.shape.area;
      strained += joined.elastic(joined.displacement);
      const Pair to = ends(pair);
      for (unsigned int k = 0; k < 2; ++k) {
        const Element half = old_element(cells_.cells()[pair[k]], 0.);
        const double elastic = half.elastic(half.displacement);
        strained -= elastic;
        all += elastic;
        for (const double v : half.velocity)
          all += half.corner_mass * v * v / 2.;
        const unsigned int middle = half.nodes[0], end = mesh_.node(to[k]);
        double square = 0.;
        for (unsigned int c = 0; c < 2; ++c)
          square +=
              std::pow(velocity_[2 * middle + c] - velocity_[2 * end + c], 2);
        loss += half.corner_mass * mass_[end] /
                (half.corner_mass + mass_[end]) * square / 2.;
      }
    }
    const double most = small_part * std::max(all, mean * whole);
    return std::abs(strained) <= most && loss <= most;
  }

  /** What was in the middle goes to the ends. */
  void HalvesToJoin::move(const std::vector<Family> &families,
                          Motion &motion) const
  {
    motion.added_mass.assign(mass_.size(), 0.);
    motion.velocity.assign(velocity_.size(), 0.); // first momentum
    for (const Family &family : families)
      for (const Pair &pair : family.pairs) {
        if (pair[0] == Bisection::none)
          continue;
        const Pair to = ends(pair);
        for (unsigned int k = 0; k < 2; ++k) {
          const unsigned int corner = 3 * cells_.cells()[pair[k]].old,
                             middle = mesh_.node(corner),
                             end = mesh_.node(to[k]);
          const double mass = mesh_.mass(corner);
          motion.added_mass[end] += mass;
          for (unsigned int c = 0; c < 2; ++c)
            motion.velocity[2 * end + c] += mass * velocity_[2 * middle + c];
        }
      }
    for (std::size_t n = 0; n < mass_.size(); ++n)
      for (unsigned int c = 0; c < 2; ++c) {
        double &v = motion.velocity[2 * n + c];
        v = motion.added_mass[n] > 0. ? (mass_[n] * velocity_[2 * n + c] + v) /
                                            (mass_[n] + motion.added_mass[n])
                                      : velocity_[2 * n + c];
      }
  }

  /** Nodes of joined cells and of some around them. */
  void HalvesToJoin::let_move(const std::vector<Element> &joined,
                              const std::vector<Element> &others,
                              Motion &motion) const
  {
    auto &may = motion.may_move;
    may.assign(mass_.size(), 0);
    for (const Element &one : joined)
      for (const unsigned int n : one.nodes)
        may[n] = 1;
    for (unsigned int ring = 1; ring <= n_rings; ++ring) {
      const auto before = may;
      for (const Element &one : others)
        if (std::any_of(one.nodes.begin(), one.nodes.end(),
                        [&](const unsigned int n) { return before[n] != 0; }))
          for (const unsigned int n : one.nodes)
            may[n] = 1;
    }
    for (std::size_t n = 0; n < may.size(); ++n)
      may[n] = may[n] != 0 && blocked_[n] == 0;
  }

  /** Conjugate gradients with the diagonal. */
  void HalvesToJoin::project(const std::vector<Element> &halves,
                             const std::vector<Element> &joined,
                             const std::vector<Element> &others,
                             Motion &motion) const
  {
    constexpr unsigned int most = 60;
    constexpr double enough = 1e-4; // of the residual
    const std::size_t n = 2 * mass_.size();
    const auto &may = motion.may_move;
    const auto clear = [&](std::vector<double> &x) {
      for (std::size_t k = 0; k < n; ++k)
        x[k] = may[k / 2] ? x[k] : 0.;
    };
    const auto add_forces = [&](const double sign, const Element &one,
                                const Values &u, std::vector<double> &f) {
      const auto of_one = one.forces(u);
      for (unsigned int i = 0; i < 6; ++i)
        f[2 * one.nodes[i / 2] + i % 2] += sign * of_one[i];
    };
    std::vector<double> r(n, 0.), diagonal(n, 0.), z(n), p(n, 0.), Kp(n);
    for (const Element &half : halves)
      add_forces(1., half, half.displacement, r);
    // what acts in the middle acts on the ends; halves are those of a pair
    std::vector<unsigned int> n_pairs(mass_.size(), 0);
    for (std::size_t k = 0; k < halves.size(); k += 2)
      ++n_pairs[halves[k].nodes[0]];
    for (std::size_t k = 0; k < halves.size(); k += 2) {
      const unsigned int m = halves[k].nodes[0];
      for (const unsigned int end :
           {halves[k].nodes[2], halves[k + 1].nodes[1]})
        for (unsigned int c = 0; c < 2; ++c)
          p[2 * end + c] += r[2 * m + c] / (2. * n_pairs[m]);
    }
    for (std::size_t k = 0; k < n; ++k)
      r[k] += p[k];
    for (const Element &one : joined)
      add_forces(-1., one, one.displacement, r);
    clear(r);
    for (const auto *list : {&joined, &others})
      for (const Element &one : *list) {
        for (unsigned int i = 0; i < 3; ++i) {
          const auto &g = one.shape.gradients[i];
          for (unsigned int c = 0; c < 2; ++c)
            diagonal[2 * one.nodes[i] + c] +=
                one.shape.area *
                (one.mu * g * g + (one.lambda + one.mu) * g[c] * g[c]);
        }
      }
    const auto dot = [n](const std::vector<double> &a,
                         const std::vector<double> &b) {
      double sum = 0.;
      for (std::size_t k = 0; k < n; ++k)
        sum += a[k] * b[k];
      return sum;
    };
    auto &e = motion.shift;
    e.assign(n, 0.);
    std::fill(p.begin(), p.end(), 0.);
    double before = 0., first = 0.;
    for (unsigned int round = 0; round < most; ++round) {
      for (std::size_t k = 0; k < n; ++k)
        z[k] = may[k / 2] ? r[k] / diagonal[k] : 0.;
      const double rz = dot(r, z);
      if (round == 0)
        first = rz;
      if (!(rz > enough * enough * first))
        break;
      for (std::size_t k = 0; k < n; ++k)
        p[k] = z[k] + (round == 0 ? 0. : rz / before) * p[k];
      before = rz;
      std::fill(Kp.begin(), Kp.end(), 0.);
      for (const auto *list : {&joined, &others})
        for (const Element &one : *list)
          add_forces(1., one, at(one.nodes, p), Kp);
      clear(Kp);
      const double alpha = rz / dot(p, Kp);
      for (std::size_t k = 0; k < n; ++k) {
        e[k] += alpha * p[k];
        r[k] -= alpha * Kp[k];
      }
    }
  }

  /** With the displacement in the middle of the step. */
  void HalvesToJoin::add(const double sign, const Element &element,
                         const Values &velocity, const Values &displacement,
                         Plan &plan) const
  {
    const auto rate = element.shape.strain(velocity.data());
    double square = 0.;
    for (const double v : velocity)
      square += v * v;
    const double D = rate[0] + rate[1], h = state_.last_step;
    plan.inertia += sign * element.corner_mass / 2. * square;
    plan.motion -= sign * element.shape.area *
                   (h * h / 8. * power(rate, element.lambda, element.mu) +
                    h / 4. * element.viscosity * D * D);
    plan.elastic += sign * element.elastic(displacement);
  }

  void HalvesToJoin::set_change(const std::vector<double> &front_viscosity,
                                Plan &plan) const
  {
    std::vector<char> goes(cells_.old_cells().size(), 0);
    std::vector<Element> halves, joined, others;
    for (const Family &family : plan.families)
      for (const Pair &pair : family.pairs) {
        if (pair[0] == Bisection::none)
          continue;
        double viscosity = 0.;
        for (const unsigned int half : pair) {
          const auto &cell = cells_.cells()[half];
          goes[cell.old] = 1;
          halves.push_back(old_element(cell, front_viscosity[cell.old]));
          viscosity += front_viscosity[cell.old] / 2.;
        }
        joined.push_back(joined_element(pair, viscosity));
      }
    for (const auto &cell : cells_.cells())
      if (stays(cell) && !goes[cell.old])
        others.push_back(old_element(cell, front_viscosity[cell.old]));
    Motion motion;
    move(plan.families, motion);
    let_move(joined, others, motion);
    others.erase(std::remove_if(others.begin(), others.end(),
                                [&](const Element &one) {
                                  return std::none_of(
                                      one.nodes.begin(), one.nodes.end(),
                                      [&](const unsigned int n) {
                                        return motion.may_move[n] != 0;
                                      });
                                }),
                 others.end());
    project(halves, joined, others, motion);
    plan.inertia = plan.motion = plan.elastic = 0.;
    const auto add_old = [&](const Element &one) {
      add(-1., one, one.velocity, one.displacement, plan);
    };
    const auto add_new = [&](const Element &one) {
      auto velocity = one.velocity, displacement = one.displacement;
      const auto shift = at(one.nodes, motion.shift),
                 of_nodes = at(one.nodes, motion.velocity);
      for (unsigned int i = 0; i < 6; ++i) {
        displacement[i] += shift[i];
        if (motion.added_mass[one.nodes[i / 2]] > 0.)
          velocity[i] = of_nodes[i];
      }
      add(1., one, velocity, displacement, plan);
    };
    std::for_each(halves.begin(), halves.end(), add_old);
    std::for_each(joined.begin(), joined.end(), add_new);
    for (const Element &one : others) {
      add_old(one);
      add_new(one);
    }
    for (std::size_t n = 0; n < mass_.size(); ++n)
      if (motion.may_move[n]) {
        auto &moved = plan.moved[vertex_[n]];
        for (unsigned int c = 0; c < 2; ++c)
          moved[c] = motion.shift[2 * n + c] +
                     state_.last_step / 2. *
                         (motion.velocity[2 * n + c] - velocity_[2 * n + c]);
      }
  }

  HalvesToJoin::Plan
  HalvesToJoin::plan(std::vector<Family> wanted,
                     const std::vector<double> &front_viscosity) const
  {
    double energy = 0., area = 0.;
    for (const auto &cell : cells_.cells())
      if (stays(cell)) {
        const Element one = old_element(cell, 0.);
        energy += one.elastic(one.displacement);
        for (const double v : one.velocity)
          energy += one.corner_mass * v * v / 2.;
        area += one.shape.area;
      }
    const double mean = area > 0. ? energy / area : 0.;
    wanted.erase(std::remove_if(wanted.begin(), wanted.end(),
                                [&](const Family &family) {
                                  return !may_join(family) ||
                                         !is_smooth(family, mean);
                                }),
                 wanted.end());
    Plan result;
    if (wanted.empty())
      return result;
    result.families = std::move(wanted);
    set_change(front_viscosity, result);
    if (!(result.change() <= 0.))
      result = {};
    return result;
  }
} // namespace nsfd
