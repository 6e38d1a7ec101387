#pragma once

#include "contact_copies.h"

#include <cmath>

// Contact problems of which a solution is known, because they are made from it.

namespace known_contacts
{
  using contact_copies::Dice;
  using nsfd::ContactProblem;

  enum class Status { open, stick, slide };

  struct Options {
    unsigned int dimension = 3;
    int contacts = 20;
    double mu = 0.3;
    int rank = 0; ///< of W; 0: full and well conditioned
    double asymmetry = 0.;
    double w_scale = 1., q_scale = 1.;
    unsigned int seed = 1;
  };

  struct Known {
    ContactProblem problem;
    std::vector<double> r, u; ///< one solution
  };

  /** Impulses and velocities of each contact that obey the law, of all three
   * kinds, and from them q = u - W r. W = H H' of the rank asked for. */
  inline Known manufacture(const Options &o)
  {
    Dice dice(o.seed);
    const int d = int(o.dimension), n = d * o.contacts;
    Known k;
    k.r.assign(n, 0.);
    k.u.assign(n, 0.);
    for (int i = 0; i < o.contacts; ++i) {
      double *r = &k.r[d * i], *u = &k.u[d * i];
      const double angle = dice(0., 6.2831853), size = dice(0.5, 2.),
                   speed = dice(0.2, 1.);
      const double t[2] = {d == 2 ? (angle < 3. ? 1. : -1.) : std::cos(angle),
                           std::sin(angle)};
      const Status status = Status(i % 3);
      if (status == Status::open)
        u[0] = dice(0.2, 1.);
      else
        r[0] = size;
      for (int c = 1; c < d; ++c) {
        if (status == Status::open)
          u[c] = dice(-1., 1.);
        else if (status == Status::stick)
          r[c] = 0.6 * o.mu * size * t[c - 1];
        else {
          r[c] = o.mu * size * t[c - 1];
          u[c] = -speed * t[c - 1];
        }
      }
    }
    const int rank = o.rank > 0 ? o.rank : n;
    std::vector<double> h(std::size_t(n) * rank);
    for (double &x : h)
      x = dice(-1., 1.) / std::sqrt(double(rank));
    ContactProblem &p = k.problem;
    p.dimension = o.dimension;
    p.friction.assign(o.contacts, o.mu);
    p.row_start = {0};
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        double sum = o.rank > 0 || i != j ? 0. : 1.;
        for (int l = 0; l < rank; ++l)
          sum += h[std::size_t(i) * rank + l] * h[std::size_t(j) * rank + l];
        p.column.push_back(j);
        p.value.push_back(o.w_scale * sum * (1. + o.asymmetry * dice(-1., 1.)));
      }
      p.row_start.push_back(int(p.column.size()));
    }
    for (double &x : k.r)
      x *= o.q_scale / o.w_scale;
    for (double &x : k.u)
      x *= o.q_scale;
    p.q.assign(n, 0.);
    std::vector<double> wr;
    relative_velocity(p, k.r, wr);
    for (int j = 0; j < n; ++j)
      p.q[j] = k.u[j] - wr[j];
    return k;
  }
} // namespace known_contacts
