#include "study_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace nsfd
{
  namespace
  {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();

    bool varies_with(const Variation &variation, const std::string &path)
    {
      for (const auto &parameter : variation.parameters)
        if (parameter.path == path)
          return true;
      return false;
    }

    /** Formula of what the error is a power of. */
    std::string size_formula(const StudyInput &input)
    {
      if (input.abscissa < 0)
        return "";
      if (input.size != "auto")
        return input.size;
      const Variation &variation =
          input.variations[std::size_t(input.abscissa)];
      if (varies_with(variation, "Mesh/cells"))
        return "1/cells";
      if (varies_with(variation, "Mesh/refinements"))
        return "2^(-refinements)";
      std::string name = short_name(variation.leader().path);
      std::replace(name.begin(), name.end(), ' ', '_');
      return name;
    }

    double size_of(const StudyResults &study, const std::size_t k)
    {
      const std::string formula = size_formula(study.input);
      std::string problem;
      if (formula.empty())
        return nan;
      return evaluate(formula, study.cases[k].numbers, problem).value_or(nan);
    }

    /** "degree = 2" of the variations but those left out. */
    std::string name_without(const StudyResults &study, const std::size_t k,
                             const std::set<int> &without)
    {
      std::string name;
      const auto &variations = study.input.variations;
      for (std::size_t v = 0; v < variations.size(); ++v) {
        if (variations[v].is_constant() || without.count(int(v)) != 0)
          continue;
        const auto &leader = variations[v].leader();
        name += (name.empty() ? "" : ", ") + short_name(leader.path) + " = " +
                Variation::value(leader, study.cases[k].combination.index[v]);
      }
      return name;
    }

    std::vector<std::size_t> key_without(const StudyResults &study,
                                         const std::size_t k,
                                         const std::set<int> &without)
    {
      std::vector<std::size_t> key = study.cases[k].combination.index;
      for (const int v : without)
        if (v >= 0)
          key[std::size_t(v)] = 0;
      return key;
    }

    /** What varies along a series: the abscissa; without one, all but the first
     * of several variations. */
    std::set<int> along_a_series(const StudyInput &input)
    {
      if (input.abscissa >= 0)
        return {input.abscissa, input.average};
      std::set<int> along;
      bool first = true;
      std::size_t several = 0;
      for (const Variation &variation : input.variations)
        several += !variation.is_constant();
      for (std::size_t v = 0; v < input.variations.size(); ++v) {
        if (input.variations[v].is_constant())
          continue;
        if (!first || several == 1)
          along.insert(int(v));
        first = false;
      }
      return along;
    }
  } // namespace

  std::string setting_of(const StudyResults &study, const std::size_t k)
  {
    return name_without(study, k, {});
  }

  std::size_t count(const StudyResults &study, const CaseResult::Status status)
  {
    return std::size_t(
        std::count_if(study.results.begin(), study.results.end(),
                      [status](const auto &r) { return r.status == status; }));
  }

  std::string size_label(const StudyResults &study)
  {
    return size_formula(study.input);
  }

  std::vector<StudySeries> series_of(const StudyResults &study)
  {
    const int average = study.input.average;
    const std::set<int> along = along_a_series(study.input);
    std::map<std::vector<std::size_t>, std::size_t> places;
    std::map<std::vector<std::size_t>, std::size_t> points;
    std::vector<StudySeries> all;
    for (std::size_t k = 0; k < study.cases.size(); ++k) {
      const auto [place, is_new] =
          places.emplace(key_without(study, k, along), all.size());
      if (is_new) {
        all.emplace_back();
        all.back().name = name_without(study, k, along);
      }
      StudySeries &series = all[place->second];
      const auto [point, first] =
          points.emplace(key_without(study, k, {average}), series.first.size());
      if (first) {
        series.first.push_back(k);
        series.members.emplace_back();
      }
      series.members[point->second].push_back(k);
    }
    // from coarse to fine
    for (StudySeries &series : all) {
      std::vector<std::size_t> order(series.first.size());
      for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
      std::stable_sort(order.begin(), order.end(),
                       [&](const std::size_t a, const std::size_t b) {
                         return size_of(study, series.first[a]) >
                                size_of(study, series.first[b]);
                       });
      const StudySeries old = series;
      for (std::size_t i = 0; i < order.size(); ++i) {
        series.first[i] = old.first[order[i]];
        series.members[i] = old.members[order[i]];
      }
    }
    return all;
  }

  std::vector<std::string> shown_errors(const StudyResults &study)
  {
    std::set<std::string> present;
    for (const CaseResult &result : study.results)
      for (const auto &[name, value] : result.errors)
        present.insert(name);
    for (const ObservedQuantity &quantity : study.input.observed)
      present.erase(quantity.name);
    std::vector<std::string> names;
    for (const std::string &name : study.input.errors)
      if (present.count(name) != 0)
        names.push_back(name);
    if (!study.input.errors.empty())
      return names;
    // fields first
    for (const char *name :
         {"displacement_L2", "velocity_L2", "velocity_L1", "stress_L2"})
      if (present.erase(name) != 0)
        names.emplace_back(name);
    names.insert(names.end(), present.begin(), present.end());
    return names;
  }

  std::vector<std::string> shown_quantities(const StudyResults &study)
  {
    std::vector<std::string> names;
    for (const ObservedQuantity &quantity : study.input.observed)
      if (std::any_of(study.results.begin(), study.results.end(),
                      [&](const CaseResult &result) {
                        return result.errors.count(quantity.name) != 0;
                      }))
        names.push_back(quantity.name);
    for (const std::string &name : shown_errors(study))
      names.push_back(name);
    return names;
  }

  std::vector<StudyPoint> points_of(const StudyResults &study,
                                    const StudySeries &series,
                                    const std::string &error)
  {
    std::vector<StudyPoint> points;
    for (const auto &members : series.members) {
      StudyPoint point;
      std::size_t n = 0;
      for (const std::size_t k : members) {
        const CaseResult &result = study.results[k];
        const auto found = result.errors.find(error);
        if (!is_done(result) || found == result.errors.end() ||
            !std::isfinite(found->second))
          continue;
        ++n;
        point.error += found->second;
        point.seconds += solve_median(result);
        point.unknowns += result.dofs;
      }
      if (n < members.size() || n == 0) // an average needs all of them
        continue;
      point.size = size_of(study, members.front());
      point.error /= double(n);
      point.seconds /= double(n);
      point.unknowns /= double(n);
      points.push_back(point);
    }
    return points;
  }

  std::vector<StudyPoint> all_points(const StudyResults &study,
                                     const std::string &error)
  {
    std::vector<StudyPoint> all;
    for (const StudySeries &series : series_of(study))
      for (const StudyPoint &point : points_of(study, series, error))
        all.push_back(point);
    return all;
  }

  std::vector<StudyGroup> groups_of(const StudyResults &study,
                                    const std::string &error)
  {
    const int compare = study.input.compare;
    std::vector<StudyGroup> groups;
    std::map<std::size_t, std::size_t> places;
    for (const StudySeries &series : series_of(study)) {
      const std::size_t k = series.first[0];
      std::string name = series.name;
      std::size_t place = groups.size();
      if (compare >= 0) {
        const std::size_t v = std::size_t(compare);
        const std::size_t i = study.cases[k].combination.index[v];
        const auto &leader = study.input.variations[v].leader();
        name = short_name(leader.path) + " = " + Variation::value(leader, i);
        place = places.emplace(i, place).first->second;
      }
      if (place == groups.size())
        groups.push_back({name, {}, {}});
      groups[place].cases.insert(groups[place].cases.end(),
                                 series.first.begin(), series.first.end());
      for (const StudyPoint &point : points_of(study, series, error))
        groups[place].points.push_back(point);
    }
    return groups;
  }

  std::vector<StudyOrder> orders_of(const StudyResults &study)
  {
    std::vector<StudyOrder> orders;
    if (study.input.abscissa < 0)
      return orders;
    for (const std::string &error : shown_errors(study))
      for (const StudySeries &series : series_of(study)) {
        StudyOrder order;
        order.series = series.name;
        order.error = error;
        order.points = points_of(study, series, error);
        order.fit = fit_order(order.points);
        const auto expected = study.input.expected_orders.find(error);
        std::string problem;
        if (expected != study.input.expected_orders.end())
          order.expected = evaluate(
              expected->second, study.cases[series.first[0]].numbers, problem);
        order.verdict =
            judge(order.fit, order.expected, study.input.order_tolerance);
        orders.push_back(order);
      }
    return orders;
  }

  std::string verdict_text(const StudyResults &study)
  {
    std::map<OrderVerdict, unsigned int> counts;
    unsigned int expected = 0;
    for (const StudyOrder &order : orders_of(study))
      if (order.expected) {
        ++expected;
        ++counts[order.verdict];
      }
    if (expected == 0)
      return "";
    std::string text = fmt::format("{} of {} orders as expected (within {})",
                                   counts[OrderVerdict::reached], expected,
                                   study.input.order_tolerance);
    for (const OrderVerdict other :
         {OrderVerdict::above, OrderVerdict::below, OrderVerdict::too_few})
      if (counts[other] > 0)
        text += fmt::format(", {} {}", counts[other], text_of(other));
    return text;
  }
} // namespace nsfd
