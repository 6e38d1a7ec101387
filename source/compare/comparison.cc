#include "comparison.h"

#include "checkpoint/parameter_changes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace nsfd
{
  namespace
  {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

    bool starts_with(const std::string &text, const std::string &begin)
    {
      return text.compare(0, begin.size(), begin) == 0;
    }

    bool is_energy(const std::string &name)
    {
      static const std::set<std::string> columns = {
          "kinetic", "elastic", "cohesive",  "damage", "friction", "viscous",
          "plastic", "impact",  "numerical", "work",   "absorbed"};
      return columns.count(name) > 0 || starts_with(name, "energy/") ||
             starts_with(name, "dissipated/");
    }

    bool is_reaction(const std::string &name)
    {
      return starts_with(name, "reaction_");
    }

    bool is_result(const std::string &name)
    {
      return is_energy(name) || is_reaction(name) || name == "final_time" ||
             name == "broken_area" || name == "fragments";
    }

    double largest_size(const std::vector<double> &values)
    {
      double largest = 0.;
      for (const double value : values)
        if (std::isfinite(value))
          largest = std::max(largest, std::abs(value));
      return largest;
    }

    /** Names of all runs in the order of the first one that has them. */
    template <typename Pairs>
    void collect(const Pairs &pairs, std::vector<std::string> &names)
    {
      std::size_t after = 0;
      for (const auto &entry : pairs) {
        const auto found = std::find(names.begin(), names.end(), entry.first);
        if (found != names.end())
          after = std::size_t(found - names.begin()) + 1;
        else
          names.insert(names.begin() + long(after++), entry.first);
      }
    }

    /** Entries that name the folder of a run are not the run. */
    bool is_place(const std::string &name)
    {
      return name == "Output/directory";
    }

    void compare_parameters(Comparison &comparison)
    {
      const auto &runs = comparison.runs;
      if (!std::all_of(runs.begin(), runs.end(), [](const RunFolder &run) {
            return run.parameters.has_value();
          }))
        return;
      comparison.n_parameters =
          unsigned(parameter_changes("", *runs[0].parameters).size());
      std::vector<std::string> names;
      for (std::size_t k = 1; k < runs.size(); ++k)
        for (const auto &change :
             parameter_changes(*runs[0].parameters, *runs[k].parameters))
          if (!is_place(change.name) &&
              std::find(names.begin(), names.end(), change.name) == names.end())
            names.push_back(change.name);
      for (const std::string &name : names) {
        ComparedParameter entry;
        const std::size_t slash = name.rfind('/');
        entry.section = slash == std::string::npos ? "" : name.substr(0, slash);
        entry.name = name.substr(slash == std::string::npos ? 0 : slash + 1);
        entry.values.assign(runs.size(), "");
        for (std::size_t k = 0; k < runs.size(); ++k)
          for (const auto &value : parameter_changes("", *runs[k].parameters))
            if (value.name == name)
              entry.values[k] = value.now;
        comparison.parameters.push_back(entry);
      }
      std::stable_sort(
          comparison.parameters.begin(), comparison.parameters.end(),
          [](const ComparedParameter &a, const ComparedParameter &b) {
            return a.section < b.section;
          });
    }

    double difference(const double a, const double b, const double scale)
    {
      if (!std::isfinite(a) || !std::isfinite(b))
        return unknown;
      return a == b ? 0. : std::abs(b - a) / scale;
    }

    void compare_numbers(const double energy, Comparison &comparison)
    {
      const auto &runs = comparison.runs;
      std::vector<std::string> names;
      for (const RunFolder &run : runs)
        collect(run.numbers, names);
      for (const std::string &name : names) {
        ComparedNumber entry;
        entry.name = name;
        entry.result = is_result(name);
        bool any_known = false;
        for (const RunFolder &run : runs) {
          const auto value = run.number(name);
          entry.values.push_back(value);
          if (!value || !std::isfinite(*value))
            continue;
          any_known = true;
          entry.scale = std::max(entry.scale, std::abs(*value));
        }
        if (is_energy(name))
          entry.scale = energy;
        for (const auto &value : entry.values)
          entry.differences.push_back(
              any_known || entry.result
                  ? difference(entry.values[0].value_or(unknown),
                               value.value_or(unknown), entry.scale)
                  : 0.); // no run could tell
        comparison.numbers.push_back(entry);
      }
    }

    /** Of both runs within the ends that all of them have. */
    std::vector<double> common_times(const std::vector<double> &a,
                                     const std::vector<double> &b,
                                     const double begin, const double end)
    {
      std::vector<double> times;
      for (const auto *all : {&a, &b})
        for (const double t : *all)
          if (t >= begin && t <= end)
            times.push_back(t);
      std::sort(times.begin(), times.end());
      times.erase(std::unique(times.begin(), times.end()), times.end());
      return times;
    }

    ComparedCurve compare_curve(const std::vector<double> &times,
                                const std::vector<double> &a,
                                const std::vector<double> &b,
                                const double scale)
    {
      ComparedCurve curve;
      curve.scale = scale;
      double area = 0., last = 0.;
      for (std::size_t k = 0; k < times.size(); ++k) {
        const double here = difference(a[k], b[k], scale);
        // also where it is NaN, which stays
        if (!std::isnan(curve.largest) && !(here <= curve.largest)) {
          curve.largest = here;
          curve.time = times[k];
        }
        if (k > 0)
          area += (times[k] - times[k - 1]) * (here + last) / 2.;
        last = here;
      }
      curve.mean = times.size() > 1 ? area / (times.back() - times.front())
                                    : curve.largest;
      return curve;
    }

    void compare_curves(const double energy, Comparison &comparison)
    {
      const auto &runs = comparison.runs;
      comparison.begin = -std::numeric_limits<double>::infinity();
      comparison.end = -comparison.begin;
      for (const RunFolder &run : runs) {
        const auto *time = run.column("time");
        if (!time || time->empty()) {
          comparison.begin = comparison.end = 0.;
          return;
        }
        comparison.begin = std::max(comparison.begin, time->front());
        comparison.end = std::min(comparison.end, time->back());
      }
      std::vector<std::string> names;
      double reaction = 0.;
      for (const RunFolder &run : runs) {
        collect(run.history, names);
        for (const auto &[name, values] : run.history)
          if (is_reaction(name))
            reaction = std::max(reaction, largest_size(values));
      }
      for (const std::string &name : names)
        for (std::size_t k = 1;
             k < runs.size() && name != "step" && name != "time"; ++k) {
          const auto *a = runs[0].column(name), *b = runs[k].column(name);
          ComparedCurve curve;
          if (a && b) {
            const auto &x = *runs[0].column("time"),
                       &y = *runs[k].column("time");
            const double scale =
                is_energy(name) ? energy
                : is_reaction(name)
                    ? reaction
                    : std::max(largest_size(*a), largest_size(*b));
            const auto times =
                common_times(x, y, comparison.begin, comparison.end);
            curve = compare_curve(times, interpolated(x, *a, times),
                                  interpolated(y, *b, times), scale);
          } else
            curve.largest = curve.mean = unknown;
          curve.name = name;
          curve.run = k;
          curve.result = is_result(name);
          comparison.curves.push_back(curve);
        }
    }
  } // namespace

  std::vector<double> interpolated(const std::vector<double> &x,
                                   const std::vector<double> &y,
                                   const std::vector<double> &at)
  {
    std::vector<double> values;
    for (const double t : at) {
      const auto next = std::lower_bound(x.begin(), x.end(), t);
      if (next == x.end() || (next == x.begin() && *next != t)) {
        values.push_back(unknown);
        continue;
      }
      const auto k = std::size_t(next - x.begin());
      if (*next == t) {
        values.push_back(y[k]);
        continue;
      }
      const double share = (t - x[k - 1]) / (x[k] - x[k - 1]);
      values.push_back(y[k - 1] + share * (y[k] - y[k - 1]));
    }
    return values;
  }

  std::string letter(const std::size_t run)
  {
    return run < 26 ? std::string(1, char('A' + run))
                    : "run " + std::to_string(run + 1);
  }

  Comparison::Largest Comparison::largest() const
  {
    Largest result;
    const auto see = [&result](const double difference,
                               const std::string &name) {
      if (std::isnan(result.difference) || difference <= result.difference)
        return;
      result = {difference, name}; // also NaN, which stays
    };
    for (const ComparedNumber &number : numbers)
      if (number.result)
        for (const double difference : number.differences)
          see(difference, number.name);
    for (const ComparedCurve &curve : curves)
      if (curve.result)
        see(curve.largest, curve.name + " over time");
    return result;
  }

  Comparison compare_runs(std::vector<RunFolder> runs)
  {
    Comparison comparison;
    comparison.runs = std::move(runs);
    double energy = 0.;
    for (const RunFolder &run : comparison.runs)
      energy = std::max(energy, run.largest_energy());
    compare_parameters(comparison);
    compare_numbers(energy, comparison);
    compare_curves(energy, comparison);
    return comparison;
  }
} // namespace nsfd
