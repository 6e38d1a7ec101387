#pragma once

#include <string>
#include <vector>

namespace nsfd
{
  /** What a column of an observable is. */
  struct ObservedColumn {
    std::string name, unit; ///< unit in SI, "" of pure numbers
  };

  /**
   * What an observable has said so far. Values that do not exist, such as the
   * tip of a crack that has not begun, are NaN.
   */
  struct ObservableRecord {
    std::string name, type;
    std::vector<ObservedColumn> columns; ///< without step and time
    /// per column: the last value, and that of the largest size with its time
    std::vector<double> last, peak, peak_time;
    /// time and values, thinned out; only on rank 0
    std::vector<std::vector<double>> rows;
    unsigned long long n_rows = 0; ///< written
    unsigned int stride = 1;       ///< of them in `rows`

    /** Writes a row at @p time; @p keeps it for the chart. */
    void add(double time, const std::vector<double> &values, bool keeps);
  };
} // namespace nsfd
