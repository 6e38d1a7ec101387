#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace end_to_end
{
  namespace
  {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();

    double largest(const std::vector<double> &values)
    {
      double result = 0.;
      for (const double value : values)
        result = std::max(result, std::abs(value));
      return result;
    }

    /** max() that does not drop NaN. */
    void raise(double &result, const double value)
    {
      if (!(value <= result))
        result = value;
    }

    double difference(const std::vector<double> &a, const double scale_a,
                      const std::vector<double> &b, const double scale_b,
                      const std::size_t n_rows)
    {
      double result = 0.;
      for (std::size_t i = 0; i < std::min({a.size(), b.size(), n_rows}); ++i)
        raise(result, std::abs(a[i] / scale_a - b[i] / scale_b));
      return result;
    }
  } // namespace

  void expect_below(const std::string &what, const double measured,
                    const double tolerance, const std::string &reason)
  {
    std::printf("  %-44s %9.2e  (allowed %.1e)\n", what.c_str(), measured,
                tolerance);
    // NaN is not below anything
    EXPECT_TRUE(measured <= tolerance)
        << what << " = " << measured << " is above " << tolerance
        << (reason.empty() ? "" : ": ") << reason;
  }

  double energy_difference(const History &a, const History &b,
                           const std::size_t n_rows)
  {
    if (std::min(a.size(), n_rows) != std::min(b.size(), n_rows))
      return nan;
    const double scale_a = a.largest_energy(), scale_b = b.largest_energy();
    double result = difference(a["time"], a["time"].back(), b["time"],
                               b["time"].back(), n_rows) > 1e-12
                        ? nan
                        : 0.;
    for (const std::string &line : History::energy_lines())
      raise(result, difference(a[line], scale_a, b[line], scale_b, n_rows));
    return result;
  }

  double column_difference(const History &a, const std::string &name_a,
                           const History &b, const std::string &name_b,
                           const double sign, const std::size_t n_rows)
  {
    const double scale_a = largest(a[name_a]), scale_b = largest(b[name_b]);
    if (scale_a == 0. && scale_b == 0.)
      return 0.;
    return difference(a[name_a], scale_a, b[name_b], sign * scale_b, n_rows);
  }

  std::size_t rows_without_damage(const History &history)
  {
    const auto &damage = history["damage"];
    return std::find_if(damage.begin(), damage.end(),
                        [](const double d) { return d > 0.; }) -
           damage.begin();
  }

  double field_difference(const Result &a, const Result &b,
                          const std::string &base, const std::string &array,
                          const std::string &scale_base,
                          const std::string &scale)
  {
    const auto first = snapshots(a.directory, base),
               second = snapshots(b.directory, base);
    if (first.empty() || first.size() != second.size())
      return nan;
    double size = 0., result = 0.;
    for (const Snapshot &snapshot : snapshots(a.directory, scale_base))
      if (const auto values = snapshot.find(scale); values != snapshot.end())
        size = std::max(size, largest(values->second));
    for (std::size_t k = 0; k < first.size(); ++k) {
      const auto x = first[k].find(array), y = second[k].find(array);
      if (x == first[k].end() || y == second[k].end() ||
          x->second.size() != y->second.size())
        return nan;
      raise(result, difference(x->second, 1., y->second, 1., std::size_t(-1)));
    }
    return size > 0. ? result / size : result;
  }

  std::string replaced(std::string text, const std::string &from,
                       const std::string &to)
  {
    for (auto at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
    return text;
  }

  std::vector<std::vector<double>> records(const Result &result,
                                           const std::string &base)
  {
    std::vector<std::vector<double>> all;
    double number = 0.;
    for (const Snapshot &snapshot : snapshots(result.directory, base)) {
      const std::size_t n_points = snapshot.at("Points").size() / 3;
      const std::size_t first = all.size();
      for (std::size_t i = 0; i < n_points; ++i)
        all.push_back({number});
      for (const auto &[name, values] : snapshot)
        if (n_points > 0 && values.size() % n_points == 0 &&
            (name == "Points" || name == "displacement" || name == "velocity" ||
             name == "stress")) {
          const std::size_t width = values.size() / n_points;
          for (std::size_t i = 0; i < n_points; ++i)
            all[first + i].insert(all[first + i].end(),
                                  values.begin() + i * width,
                                  values.begin() + (i + 1) * width);
        }
      // fragments have the same numbers everywhere: linear cells
      if (snapshot.count("fragment") != 0 &&
          n_points % snapshot.at("fragment").size() == 0) {
        const auto &fragment = snapshot.at("fragment"),
                   &x = snapshot.at("Points");
        const std::size_t width = x.size() / fragment.size();
        for (std::size_t c = 0; c < fragment.size(); ++c)
          all.push_back({number, x[c * width], x[c * width + 1],
                         x[c * width + 2], fragment[c]});
      }
      ++number;
    }
    std::sort(all.begin(), all.end());
    return all;
  }
} // namespace end_to_end
