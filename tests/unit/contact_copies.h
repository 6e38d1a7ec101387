#pragma once

#include "core/dice.h"
#include "nonsmooth/frictional_contact/contact_problem.h"

#include <algorithm>
#include <utility>

// Copies of a stored contact problem that are the same problem, or a
// neighbour of it: by these the luck of an order or of a digit shows.

namespace contact_copies
{
  using nsfd::ContactProblem;
  using nsfd::Dice;

  /** A vector of the contacts in another order: contact i of the result is
   * contact @p order [i] of @p x. */
  inline std::vector<double> relabelled(const std::vector<double> &x,
                                        const std::vector<int> &order)
  {
    const std::size_t d = x.size() / std::max<std::size_t>(order.size(), 1);
    std::vector<double> result;
    for (const int i : order)
      result.insert(result.end(), x.begin() + d * i, x.begin() + d * (i + 1));
    return result;
  }

  inline ContactProblem relabelled(const ContactProblem &problem,
                                   const std::vector<int> &order)
  {
    const int d = int(problem.dimension);
    std::vector<int> place(order.size());
    for (std::size_t i = 0; i < order.size(); ++i)
      place[order[i]] = int(i);
    ContactProblem result = problem;
    result.friction = relabelled(problem.friction, order);
    result.q = relabelled(problem.q, order);
    result.guess = relabelled(problem.guess, order);
    result.solution = relabelled(problem.solution, order);
    result.row_start.assign(1, 0);
    result.column.clear();
    result.value.clear();
    for (const int i : order)
      for (int c = 0; c < d; ++c) {
        std::vector<std::pair<int, double>> row;
        for (int k = problem.row_start[d * i + c];
             k < problem.row_start[d * i + c + 1]; ++k)
          row.emplace_back(d * place[problem.column[k] / d] +
                               problem.column[k] % d,
                           problem.value[k]);
        std::sort(row.begin(), row.end());
        for (const auto &[column, value] : row) {
          result.column.push_back(column);
          result.value.push_back(value);
        }
        result.row_start.push_back(int(result.column.size()));
      }
    return result;
  }

  /** Every entry of q changed by a share of itself, at most @p share. */
  inline ContactProblem with_other_q(ContactProblem problem, const double share,
                                     Dice &dice)
  {
    for (double &value : problem.q)
      value *= 1. + dice(-share, share);
    return problem;
  }

  inline ContactProblem with_friction(ContactProblem problem,
                                      const double factor)
  {
    for (double &mu : problem.friction)
      mu *= factor;
    return problem;
  }

  /** In other units: W times @p w, q times @p s, impulses times s / w. */
  inline ContactProblem scaled(ContactProblem problem, const double w,
                               const double s)
  {
    for (double &value : problem.value)
      value *= w;
    for (double &value : problem.q)
      value *= s;
    for (std::vector<double> *r : {&problem.guess, &problem.solution})
      for (double &value : *r)
        value *= s / w;
    return problem;
  }
} // namespace contact_copies
