#include "activation.h"

#include "linear_algebra/krylov.h"
#include "nonsmooth/point_law.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** Row @p k is a component that the joint holds. */
    template <int dim>
    bool is_joined(const OneStepProblem<dim> &problem, const std::size_t k)
    {
      return problem.mask[k / dim] & (1u << (k % dim)) &&
             problem.kind[k / dim] == PointKind::prescribed;
    }

    /** A point that is joined now and has a strength. */
    template <int dim>
    bool may_let_go(const OneStepProblem<dim> &problem,
                    const std::vector<PointOrigin> &origins,
                    const std::size_t point)
    {
      return origins[point].kind == PointOrigin::Kind::interface &&
             problem.interactions[problem.interaction[point]].law &&
             is_joined(problem, point * dim);
    }

    /**
     * Rigid rows on neighbouring faces make tractions ambiguous (W is
     * singular, one condition per loop around a vertex): what counts is the
     * impulse of least norm on the joined rows with the same effect as @p P,
     * W^+ W P, by conjugate gradients from zero.
     */
    template <int dim>
    std::vector<double> least_impulse(const DelassusOperator<dim> &delassus,
                                      const OneStepProblem<dim> &problem,
                                      const std::vector<double> &P)
    {
      const auto &communicator = delassus.communicator();
      const std::size_t n = problem.n_points * dim,
                        n_owned = problem.n_owned * dim;
      const auto apply = [&](const std::vector<double> &in,
                             std::vector<double> &out) {
        delassus.apply_delassus(in.data(), out.data());
        for (std::size_t k = 0; k < n; ++k)
          if (!is_joined(problem, k))
            out[k] = 0.;
      };
      const auto copy = [](const std::vector<double> &r,
                           std::vector<double> &z) { z = r; };
      const auto dot = [&](const std::vector<double> &a,
                           const std::vector<double> &b) {
        return communicator.dot(a.data(), b.data(), n_owned);
      };
      std::vector<double> x(n, 0.);
      krylov::CgVectors vectors;
      vectors.r.resize(n);
      vectors.q.resize(n);
      apply(P, vectors.r);
      krylov::conjugate_gradients(apply, copy, dot, {1e-10, 1000}, vectors, x);
      return x;
    }
  } // namespace

  template <int dim>
  std::optional<std::vector<double>>
  strength_shares(const DelassusOperator<dim> &delassus,
                  const std::vector<PointOrigin> &origins,
                  const std::vector<double> &impulse,
                  const OneStepProblem<dim> &problem)
  {
    std::vector<std::size_t> candidates;
    for (std::size_t i = 0; i < problem.n_points; ++i)
      if (may_let_go(problem, origins, i))
        candidates.push_back(i);
    if (!delassus.communicator().any(!candidates.empty()))
      return std::nullopt;

    std::vector<double> joined(problem.n_points * dim, 0.);
    for (std::size_t k = 0; k < joined.size(); ++k)
      if (is_joined(problem, k))
        joined[k] = impulse[k];
    const auto least = least_impulse(delassus, problem, joined);
    std::vector<double> shares(problem.n_points, 0.);
    for (const std::size_t i : candidates) {
      const double *P = &least[i * dim];
      shares[i] = effective_traction<dim>(problem, i, -P[0], P + 1) /
                  (problem.weight[i] * problem.time_step *
                   point_strength<dim>(problem, i));
    }
    return shares;
  }

  template <int dim>
  bool activate(const DelassusOperator<dim> &delassus,
                const std::vector<PointOrigin> &origins,
                const std::vector<double> &impulse,
                OneStepProblem<dim> &problem)
  {
    const auto shares = strength_shares(delassus, origins, impulse, problem);
    if (!shares)
      return false;
    bool any = false;
    for (std::size_t i = 0; i < shares->size(); ++i)
      if ((*shares)[i] > 1.) {
        problem.kind[i] = PointKind::rigid;
        problem.mask[i] = 0;
        any = true;
      }
    return delassus.communicator().any(any);
  }

  template std::optional<std::vector<double>>
  strength_shares(const DelassusOperator<2> &, const std::vector<PointOrigin> &,
                  const std::vector<double> &, const OneStepProblem<2> &);
  template std::optional<std::vector<double>>
  strength_shares(const DelassusOperator<3> &, const std::vector<PointOrigin> &,
                  const std::vector<double> &, const OneStepProblem<3> &);
  template bool activate(const DelassusOperator<2> &,
                         const std::vector<PointOrigin> &,
                         const std::vector<double> &, OneStepProblem<2> &);
  template bool activate(const DelassusOperator<3> &,
                         const std::vector<PointOrigin> &,
                         const std::vector<double> &, OneStepProblem<3> &);
} // namespace nsfd
