#include "study_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace nsfd
{
  namespace
  {
    /** What a change in this direction means. */
    constexpr double matters = 0.1;

    /** A sentence per kind of check, over the cases that were checked. */
    void add_checks(const StudyResults &study, std::vector<std::string> &lines)
    {
      std::map<std::string, std::vector<const LimitCheck *>> by_reason;
      for (const LimitCheck &check : study.checks)
        by_reason[check.reason].push_back(&check);
      for (const auto &[reason, checks] : by_reason) {
        double largest = 0.;
        std::size_t n = 0;
        for (const LimitCheck *check : checks)
          if (check->done) {
            ++n;
            if (std::abs(check->change()) > std::abs(largest))
              largest = check->change();
          }
        const bool tolerance = reason == "tolerance/100";
        const char *what = tolerance ? "solver tolerance" : "step";
        if (n == 0) {
          lines.push_back(fmt::format("{}: not known, no check with {} ended "
                                      "well",
                                      what, reason));
          continue;
        }
        const std::string change =
            fmt::format("with {} the error of the best {} cases changes by at "
                        "most {:+.2g} %",
                        reason, n, 100. * largest);
        lines.push_back(fmt::format(
            "{}: {}; {}", what, change,
            std::abs(largest) > matters
                ? (tolerance ? "it limits them" : "time limits them")
                : "not the limit"));
      }
    }

    /** Orders that do not rise with the degree belong to a front. */
    void add_front(const StudyResults &study,
                   const std::vector<StudyOrder> &orders,
                   std::vector<std::string> &lines)
    {
      const std::vector<std::string> errors = shown_errors(study);
      if (errors.empty())
        return;
      std::map<double, double> by_degree;
      const auto series = series_of(study);
      for (const StudySeries &one : series)
        for (const StudyOrder &order : orders)
          if (order.error == errors[0] && order.series == one.name &&
              order.fit.order)
            by_degree[study.cases[one.first[0]].numbers.at("degree")] =
                *order.fit.order;
      if (by_degree.size() < 2)
        return;
      double low = 1e300, high = -1e300;
      for (const auto &[degree, order] : by_degree) {
        low = std::min(low, order);
        high = std::max(high, order);
      }
      if (high < 1.5 && high - low < 0.5)
        lines.push_back(fmt::format(
            "front: orders of {} stay between {:.2f} and {:.2f} for degrees {} "
            "to {}, as where the solution has a front or a kink",
            errors[0], low, high, by_degree.begin()->first,
            by_degree.rbegin()->first));
    }

    void add_levels(const std::vector<StudyOrder> &orders,
                    std::vector<std::string> &lines)
    {
      for (const StudyOrder &order : orders)
        if (order.fit.level)
          lines.push_back(fmt::format(
              "plateau: {}{}{} levels off at {:.2g} after {} points",
              order.error, order.series.empty() ? "" : " with ", order.series,
              *order.fit.level, order.fit.n_fitted));
    }
  } // namespace

  std::vector<std::string> limits_of(const StudyResults &study)
  {
    std::vector<std::string> lines;
    const std::vector<StudyOrder> orders = orders_of(study);
    add_checks(study, lines);
    add_front(study, orders, lines);
    const std::vector<std::string> errors = shown_errors(study);
    // the errors that are drawn or judged
    std::vector<StudyOrder> relevant;
    for (const StudyOrder &order : orders)
      if (order.expected || (!errors.empty() && order.error == errors[0]))
        relevant.push_back(order);
    add_levels(relevant, lines);
    if (errors.empty())
      return lines;
    const auto envelope = lower_envelope(all_points(study, errors[0]));
    if (!envelope.empty()) {
      const StudyPoint &best = envelope.back();
      lines.insert(lines.begin(),
                   fmt::format("smallest {}: {:.2e} in {:.3g} s", errors[0],
                               best.error, best.seconds));
      double tolerance = 0.;
      for (const StudyCase &one : study.cases)
        tolerance = std::max(tolerance, one.tolerance);
      if (best.error < 1e-11)
        lines.push_back("round-off: errors this small are near it");
      else if (best.error < tolerance)
        lines.push_back(fmt::format("the solver's tolerance is {}: errors of "
                                    "its size may be its own",
                                    tolerance));
    }
    if (study.checks.empty())
      lines.emplace_back("tolerance and step were not checked");
    return lines;
  }
} // namespace nsfd
