#include "study_means.h"

#include "distribution.h"

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** Setting of a case without what is averaged over. */
    std::string setting_without(const StudyResults &study, const std::size_t k)
    {
      const Combination &combination = study.cases[k].combination;
      std::string text;
      for (std::size_t v = 0; v < study.input.variations.size(); ++v) {
        const Variation &variation = study.input.variations[v];
        if (int(v) == study.input.average || variation.is_constant())
          continue;
        const auto &leader = variation.leader();
        text += (text.empty() ? "" : ", ") + short_name(leader.path) + " = " +
                Variation::value(leader, combination.index[v]);
      }
      return text.empty() ? "all" : text;
    }

    /** The second line of a setting. */
    std::string spread_text(const std::vector<double> &values)
    {
      std::string text =
          fmt::format("  {:<24} {:12.5g} {:12.5g} {:12.5g}", "", values.front(),
                      median(values), values.back());
      if (const auto weibull = weibull_fit(values))
        text += fmt::format("; {:.3g}, {:.5g}", weibull->shape, weibull->scale);
      return text + "\n";
    }

    bool overlap(const StudyMean &a, const StudyMean &b)
    {
      return std::abs(a.mean - b.mean) <= a.half_width + b.half_width;
    }
  } // namespace

  std::vector<StudyMean> means_of(const StudyResults &study)
  {
    std::vector<StudyMean> means;
    if (study.input.average < 0)
      return means;
    for (const std::string &error : shown_quantities(study))
      for (const StudySeries &series : series_of(study))
        for (const auto &members : series.members) {
          std::vector<double> values;
          for (const std::size_t k : members) {
            const auto found = study.results[k].errors.find(error);
            if (is_done(study.results[k]) &&
                found != study.results[k].errors.end() &&
                std::isfinite(found->second))
              values.push_back(found->second);
          }
          if (values.empty())
            continue;
          StudyMean mean;
          mean.setting = setting_without(study, members.front());
          mean.error = error;
          mean.count = values.size();
          const double n = double(values.size());
          for (const double value : values)
            mean.mean += value / n;
          if (values.size() > 1) {
            double square = 0.;
            for (const double value : values)
              square += (value - mean.mean) * (value - mean.mean);
            mean.deviation = std::sqrt(square / (n - 1.));
            const boost::math::students_t t(n - 1.);
            mean.half_width =
                boost::math::quantile(t, 0.975) * mean.deviation / std::sqrt(n);
          }
          std::sort(values.begin(), values.end());
          mean.values = std::move(values);
          means.push_back(mean);
        }
    return means;
  }

  std::string means_text(const StudyResults &study)
  {
    const std::vector<StudyMean> means = means_of(study);
    std::string text;
    for (std::size_t first = 0; first < means.size();) {
      std::size_t end = first;
      while (end < means.size() && means[end].error == means[first].error)
        ++end;
      text +=
          fmt::format("\n{}: mean, 95 % interval of it, standard deviation, "
                      "runs\n",
                      means[first].error);
      text += std::string(23 + 2 + 1, ' ') +
              "smallest, median, largest; Weibull: shape, scale\n";
      bool all_overlap = true;
      for (std::size_t i = first; i < end; ++i) {
        text +=
            fmt::format("  {:<24} {:12.5g} +- {:<10.2g} {:10.2g} {:4}\n",
                        means[i].setting, means[i].mean, means[i].half_width,
                        means[i].deviation, means[i].count);
        text += spread_text(means[i].values);
        for (std::size_t j = first; j < i; ++j)
          all_overlap = all_overlap && overlap(means[i], means[j]);
      }
      if (end > first + 1)
        text += all_overlap ? "  all intervals overlap\n"
                            : "  not all intervals overlap\n";
      first = end;
    }
    return text;
  }
} // namespace nsfd
