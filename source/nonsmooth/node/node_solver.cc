#include "node_solver.h"

#include "node_path.h"
#include "nonsmooth/natural_map.h"

#include <algorithm>
#include <iterator>

namespace nsfd
{
  namespace
  {
    /// of W beside points that hold: above the round-off of all that is refined
    constexpr double least_softening = 1e-12;
    /// where a step goes too far, less is of no use
    constexpr double least_help = 1e-2;
    /// more are points of several nodes that contacts join
    constexpr std::size_t of_a_node = 24;

    /** Of a cluster each start takes the more time the larger it is, and what
        helps one has done so after few: 12 of 118 points that shatter. */
    unsigned int most_starts(const std::size_t n_points)
    {
      constexpr std::size_t most = 60, least = 8;
      return unsigned(std::clamp(most * of_a_node / n_points, least, most));
    }

    /** Around a node they lead to the point that is to be released; in a
        cluster most of them lead nowhere, and a way by softer laws is at hand.
     */
    unsigned int most_flat_moves(const std::size_t n_points)
    {
      return n_points > of_a_node ? 15 : 100;
    }
  } // namespace

  template <int dim>
  double NodeSolver<dim>::evaluate()
  {
    ++report_.evaluations;
    return system_.evaluate();
  }

  /** Also of velocities without the round-off of what led here. */
  template <int dim>
  bool NodeSolver<dim>::is_solved()
  {
    if (error_ > aim * system_.scale())
      return false;
    if (report_.newton > 2) {
      system_.refresh_velocity();
      error_ = evaluate();
    }
    return error_ <= control * system_.scale();
  }

  /** Along the direction; a flat move keeps the error. */
  template <int dim>
  bool NodeSolver<dim>::accepts(const double length, const bool first)
  {
    system_.move(length);
    const double next = evaluate();
    const bool falls =
        next <= aim * system_.scale() || next < (1. - 0.2 * length) * error_;
    const bool flat = (!first || flat_moves_ > 0) && next <= 1.01 * error_ &&
                      flat_moves_ < most_flat_moves(system_.n_points());
    if (!falls && !flat)
      return false;
    flat_moves_ += !falls;
    error_ = next;
    return true;
  }

  /** One Newton step, softened until it does not make things worse. */
  template <int dim>
  bool NodeSolver<dim>::improve()
  {
    system_.linearise();
    system_.keep(0);
    const bool nearly = error_ <= control * system_.scale();
    for (bool first = true; soft_ <= 2.; first = false) {
      ++report_.newton;
      if (system_.find_direction(soft_, soft_ <= least_softening)) {
        double length = 1.;
        const unsigned int n = !first ? 2 : report_.starts > 0 ? 6 : 3;
        for (unsigned int k = 0; k < n; ++k, length *= 0.5)
          if (accepts(length, first)) {
            const double less = flat_moves_ == 0 || first ? 0.1 : 0.3;
            soft_ = std::max(least_softening, less * soft_);
            return true;
          }
      }
      system_.restore(0);
      if (nearly && !first)
        break;
      soft_ = std::max(least_help, (flat_moves_ == 0 ? 100. : 10.) * soft_);
    }
    return false;
  }

  /**
   * Between attempts: along ways by softer laws, each from what the last
   * attempt has led to. Where a point alone has several answers, softening or
   * with friction that grows with its damage, S jumps from one to another;
   * against a smaller R it has one.
   */
  template <int dim>
  bool NodeSolver<dim>::follow()
  {
    using Slack = typename NodePath<dim>::Slack;
    constexpr struct {
      double share; ///< of R
      Slack slack;
    } ways[] = {{1., Slack::here_first},   {0.3, Slack::here_first},
                {0.3, Slack::nothing},     {1., Slack::nothing},
                {0.2, Slack::here_first},  {0.5, Slack::here_first},
                {0.05, Slack::here_first}, {0.1, Slack::here_first}};
    const std::size_t k = report_.starts % std::size(ways);
    const bool solved =
        NodePath<dim>(system_, report_).follow(ways[k].share, ways[k].slack);
    error_ = evaluate();
    return solved;
  }

  template <int dim>
  void NodeSolver<dim>::start_again()
  {
    if (report_.starts == 0 || error_ < best_) {
      best_ = error_;
      system_.keep(1);
    }
    const unsigned int k = ++report_.starts;
    if (k > 3) {
      system_.scatter(k, k % 3 == 0 ? 0. : k % 3 == 1 ? 1. : 4.);
      flat_moves_ = 0;
    }
    soft_ = k % 2 == 0 ? 1e-4 : least_softening;
    const unsigned int n = k % 4 == 0 ? 300 : k % 2 == 0 ? 2 : 20;
    for (unsigned int s = 0; s < n; ++s) {
      ++report_.sweeps;
      if (system_.sweep() <= 0.1 * aim * system_.scale())
        break;
    }
    system_.refresh_velocity();
    error_ = evaluate();
  }

  template <int dim>
  bool NodeSolver<dim>::run()
  {
    error_ = evaluate();
    soft_ = least_softening;
    flat_moves_ = 0;
    for (unsigned int k = 0; k < 1000; ++k) {
      if (is_solved())
        return true;
      if (improve())
        continue;
      if (error_ <= control * system_.scale()) {
        system_.refresh_velocity();
        error_ = evaluate();
        if (error_ <= control * system_.scale())
          return true;
      }
      // nearly there is worth one more attempt, not several
      const double enough = (report_.starts == 0 ? 0.1 : 1.) * enough_;
      if (report_.starts >= most_starts(system_.n_points()) ||
          error_ <= enough * system_.scale())
        break;
      // S may jump where it is asked once more
      if (follow() && error_ <= control * system_.scale())
        return true;
      start_again();
    }
    if (report_.starts > 0 && !(error_ <= best_)) {
      system_.restore(1);
      error_ = best_;
    }
    return error_ <= control * system_.scale();
  }

  template <int dim>
  NodeReport NodeSolver<dim>::solve(const OneStepProblem<dim> &problem,
                                    const std::vector<double> &frames,
                                    NodeProblem<dim> &node,
                                    std::vector<double> &impulses,
                                    std::vector<LocalSolution<dim>> &solutions,
                                    const double enough)
  {
    report_ = {};
    enough_ = enough;
    system_.reinit(problem, frames, node, impulses, solutions);
    if (system_.n_points() == 0)
      return report_;
    if (system_.is_single()) {
      ++report_.evaluations;
      system_.solve_single();
    } else {
      report_.converged = run();
      report_.residual = relative_natural_map(error_, system_.scale());
    }
    system_.store(report_.residual <= 1e-14, node, impulses, solutions);
    return report_;
  }

  template class NodeSolver<2>;
  template class NodeSolver<3>;
} // namespace nsfd
