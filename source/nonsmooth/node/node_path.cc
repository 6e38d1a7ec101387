#include "node_path.h"

#include "node_solver.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    constexpr unsigned int good = 2;     ///< slot of the last s that was solved
    constexpr double last_digit = 1e-12; ///< of W, see NodeSystem
  }                                      // namespace

  /** At the share s that @p system has; without springs for s = 0. */
  template <int dim>
  bool NodePath<dim>::newton(const double share, const double tolerance,
                             const unsigned int most)
  {
    for (unsigned int k = 0;; ++k) {
      ++report_.evaluations;
      const double error = system_.evaluate();
      if (error <= tolerance * system_.scale())
        return true;
      if (k == most || !std::isfinite(error))
        return false;
      system_.linearise();
      system_.keep(0);
      ++report_.newton;
      if (!system_.find_direction(std::max(share, last_digit), share == 0.))
        return false;
      system_.move(1.);
    }
  }

  /**
   * s = 1: a step of Gauss-Seidel contracts, against all of R, and leads where
   * Newton's steps do not.
   */
  template <int dim>
  bool NodePath<dim>::begin(const double part, const Slack slack)
  {
    const unsigned int most = part < 1. ? 1 : 5;
    for (unsigned int k = 0; k < most; ++k) {
      system_.keep(good);
      system_.soften(1., slack == Slack::here_first);
      if (newton(1., 1e-6, 25)) {
        system_.keep(good);
        return true;
      }
      system_.restore(good);
      const unsigned int n = part < 1. ? 0 : 20u << k;
      report_.sweeps += n;
      for (unsigned int s = 0; s < n; ++s)
        system_.sweep();
      system_.refresh_velocity();
    }
    return false;
  }

  template <int dim>
  bool NodePath<dim>::finish()
  {
    system_.soften(0., false);
    if (!newton(0., NodeSolver<dim>::aim, 12))
      return false;
    system_.refresh_velocity();
    ++report_.evaluations;
    return system_.evaluate() <= NodeSolver<dim>::control * system_.scale();
  }

  template <int dim>
  bool NodePath<dim>::descend(const Slack slack)
  {
    double share = 1., factor = 0.1;
    while (factor < 0.97 && share > 1e-13) {
      const double next = share * factor;
      system_.soften(next, slack == Slack::here_first);
      const double tolerance =
          std::max(NodeSolver<dim>::aim, 1e-3 * std::min(next, 1e-3));
      if (newton(next, tolerance, 25)) {
        share = next;
        factor = std::max(0.1, 0.5 * factor);
        system_.keep(good);
        if (share < 1e-4 && finish())
          return true;
      } else
        factor = std::sqrt(factor);
      system_.restore(good);
    }
    return false;
  }

  template <int dim>
  bool NodePath<dim>::follow(const double part, const Slack slack)
  {
    system_.scale_majorant(part);
    const bool solved = begin(part, slack) && descend(slack);
    system_.soften(0., false);
    if (!solved)
      system_.scale_majorant(1. / part);
    return solved;
  }

  template class NodePath<2>;
  template class NodePath<3>;
} // namespace nsfd
