#include "nsfd/records/observable_record.h"

#include <cmath>
#include <limits>

namespace nsfd
{
  void ObservableRecord::add(const double time,
                             const std::vector<double> &values,
                             const bool keeps)
  {
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    last = values;
    peak.resize(values.size(), nothing);
    peak_time.resize(values.size(), nothing);
    for (std::size_t k = 0; k < values.size(); ++k)
      if (!std::isnan(values[k]) &&
          !(std::abs(values[k]) <= std::abs(peak[k]))) {
        peak[k] = values[k];
        peak_time[k] = time;
      }
    if (keeps && n_rows % stride == 0) {
      auto &row = rows.emplace_back(1, time);
      row.insert(row.end(), values.begin(), values.end());
    }
    ++n_rows;
    if (rows.size() > 20000) {
      stride *= 2;
      for (std::size_t k = 1; 2 * k < rows.size(); ++k)
        rows[k].swap(rows[2 * k]);
      rows.resize((rows.size() + 1) / 2);
    }
  }
} // namespace nsfd
