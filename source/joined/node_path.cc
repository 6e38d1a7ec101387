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

  /** s = 1: as Gauss-Seidel steps, which lead there where Newton's do not. */
  template <int dim>
  bool NodePath<dim>::begin(const Slack slack)
  {
    for (unsigned int k = 0; k < 5; ++k) {
      system_.keep(good);
      system_.soften(1., slack == Slack::here_first);
      if (newton(1., 1e-6, 25)) {
        system_.keep(good);
        return true;
      }
      system_.restore(good);
      const unsigned int n = 20u << k;
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
  bool NodePath<dim>::follow(const Slack slack)
  {
    bool solved = false;
    if (begin(slack)) {
      double share = 1., factor = 0.1;
      while (!solved && factor < 0.97 && share > 1e-13) {
        const double next = share * factor;
        system_.soften(next, slack == Slack::here_first);
        const double tolerance =
            std::max(NodeSolver<dim>::aim, 1e-3 * std::min(next, 1e-3));
        if (newton(next, tolerance, 25)) {
          share = next;
          factor = std::max(0.1, 0.5 * factor);
          system_.keep(good);
          solved = share < 1e-4 && finish();
        } else
          factor = std::sqrt(factor);
        if (!solved)
          system_.restore(good);
      }
    }
    system_.soften(0., false);
    return solved;
  }

  template class NodePath<2>;
  template class NodePath<3>;
} // namespace nsfd
