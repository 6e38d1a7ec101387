#include "contact_path.h"
#include "lemke.h"

#include "nonsmooth/springs.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  bool ContactPath<dim>::newton(const unsigned int patience)
  {
    nsfd::newton_refinement<dim>(problem_, system_, delassus_,
                                 control_.tolerance, patience, softening_,
                                 impulse_, evaluation_, report_);
    return judge();
  }

  template <int dim>
  bool ContactPath<dim>::refine()
  {
    restore();
    if (newton(best_.error < 1e-4 ? 6 : 2))
      return true;
    for (unsigned int k = 0; k < 3 && best_.error < 1e-5; ++k) {
      const double before = best_.error;
      bool moved;
      if (solve_cluster(moved) || (moved && newton(3)))
        return true;
      if (!(best_.error < 0.7 * before))
        break;
    }
    return false;
  }

  /**
   * The points that hold the error up, worst first, and the contacts of the
   * bodies they are on: rows of W that depend on each other, as around a
   * vertex, have all their points on neighbouring bodies. Empty if the error is
   * spread over too many of them.
   */
  template <int dim>
  std::vector<std::size_t> ContactPath<dim>::find_cluster() const
  {
    constexpr std::size_t most_bad = 60, most = 160;
    const std::size_t n = problem_.n_points;
    const auto &points = delassus_.points();
    std::vector<std::pair<double, std::size_t>> share(n);
    double sum = 0.;
    for (std::size_t i = 0; i < n; ++i) {
      double e = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        e += evaluation_.majorant(i, c) *
             springs::square(evaluation_.defect[i * dim + c]);
      share[i] = {e, i};
      sum += e;
    }
    std::sort(share.rbegin(), share.rend());
    const double rest =
        sum * springs::square(0.3 * control_.tolerance / evaluation_.error);
    std::vector<std::vector<unsigned int>> faces_of(delassus_.bodies().size());
    for (unsigned int f = 0; f < points.faces.size(); ++f)
      for (const int body : points.faces[f].bodies)
        if (body >= 0)
          faces_of[body].push_back(f);

    std::vector<char> taken(n, 0);
    std::vector<std::size_t> cluster;
    for (std::size_t k = 0; k < n && sum > rest; sum -= share[k++].first) {
      if (k == most_bad)
        return {};
      for (const int body :
           points.faces[points.face_of[share[k].second]].bodies)
        if (body >= 0)
          for (const unsigned int f : faces_of[body])
            for (std::size_t i = points.faces[f].first;
                 i < points.faces[f].first + points.faces[f].count; ++i) {
              double pull[dim], slope[dim];
              if (taken[i] || !is_candidate_[i])
                continue;
              spring(i, pull, slope);
              if (std::any_of(slope, slope + dim,
                              [](const double x) { return x != 0.; }))
                continue;
              taken[i] = 1;
              cluster.push_back(i);
            }
      if (cluster.size() > most)
        break;
    }
    return cluster;
  }

  template <int dim>
  bool ContactPath<dim>::solve_cluster(bool &moved)
  {
    moved = false;
    if (dim != 2 || !problem_.dilatancy.empty())
      return false;
    restore();
    const auto path = frozen_; // which goes on after this
    for (std::size_t i = 0; i < problem_.n_points; ++i)
      frozen_[i] = evaluation_.solutions[i].frozen;
    const auto cluster = find_cluster();
    frozen_ = path;
    if (cluster.empty())
      return false;
    const std::size_t n = problem_.n_points, m = cluster.size();

    laws_.softening = std::max(1e-4, softening_);
    laws_.update(problem_, evaluation_, impulse_);
    laws_.softening = 1e-7;
    for (const std::size_t i : cluster) {
      std::fill_n(&laws_.stiffness[i * dim * dim], dim * dim, 0.);
      std::fill_n(&laws_.change[i * dim], dim, 0.);
    }
    if (!system_.factorise(laws_.stiffness))
      return false;
    ++report_.newton;
    // what the others do by themselves, and against an impulse in the cluster
    equilibrate(laws_.change, true);
    std::vector<double> q(m * dim), W(m * dim * m * dim), mu(m), P(m * dim);
    for (std::size_t a = 0; a < m; ++a) {
      mu[a] = frozen_state<dim>(problem_, cluster[a],
                                evaluation_.solutions[cluster[a]].reach, 1.)
                  .threshold;
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t j = cluster[a] * dim + c;
        q[a * dim + c] = evaluation_.velocity[j] + direction_.U[j] -
                         (c == 0 ? problem_.target[cluster[a]]
                                 : -problem_.sliding_offset[j]);
        P[a * dim + c] = impulse_[j];
      }
    }
    Vector unit(n * dim, 0.);
    for (std::size_t b = 0; b < m * dim; ++b) {
      unit[cluster[b / dim] * dim + b % dim] = 1.;
      equilibrate(unit, true);
      unit[cluster[b / dim] * dim + b % dim] = 0.;
      for (std::size_t a = 0; a < m * dim; ++a) {
        W[a * m * dim + b] = direction_.U[cluster[a / dim] * dim + a % dim];
        q[a] -= W[a * m * dim + b] * P[b];
      }
    }
    std::vector<double> solution;
    bool found = false;
    for (unsigned int seed = 1; seed <= 4 && !found; ++seed)
      found = solve_by_lemke(W, q, mu, seed, solution);
    if (!found)
      return false;

    // all others follow
    Vector change(laws_.change);
    for (std::size_t b = 0; b < m * dim; ++b)
      change[cluster[b / dim] * dim + b % dim] = solution[b] - P[b];
    equilibrate(change, true);
    for (std::size_t j = 0; j < n * dim; ++j) {
      impulse_[j] += change[j];
      for (unsigned int d = 0; d < dim; ++d)
        impulse_[j] -=
            laws_.stiffness[j * dim + d] * direction_.U[j / dim * dim + d];
    }
    evaluation_.update(impulse_);
    moved = true;
    return judge();
  }

  template bool ContactPath<2>::refine();
  template bool ContactPath<3>::refine();
  template std::vector<std::size_t> ContactPath<2>::find_cluster() const;
  template std::vector<std::size_t> ContactPath<3>::find_cluster() const;
  template bool ContactPath<2>::solve_cluster(bool &);
  template bool ContactPath<3>::solve_cluster(bool &);
} // namespace nsfd
