#pragma once

#include "visualization/energy_lines.h"

#include "records/fragment_sizes.h"

#include <functional>
#include <string>
#include <vector>

namespace nsfd
{
  struct NamedChart {
    std::string name; ///< of the file
    LineChart chart;
  };

  /** The curves of a report. */
  class Charts
  {
  public:
    Charts(const std::vector<HistoryRow> &rows, const Units &units,
           const std::vector<std::string> &reaction_names,
           unsigned int dimension);

    double initial_energy() const { return initial_energy_; }

    /** All lines stacked; their top is the initial energy plus the work. */
    NamedChart energy_stack() const;
    NamedChart energy_lines() const;
    NamedChart dissipated() const;
    NamedChart broken_area() const;
    NamedChart fragments() const;
    NamedChart active() const;
    NamedChart reactions() const;
    NamedChart step_size() const;
    NamedChart newton() const;
    NamedChart krylov() const;
    NamedChart accuracy() const;

  private:
    using Picker = std::function<double(const HistoryRow &)>;

    std::vector<double> column(const Picker &pick) const;
    std::vector<double> energy_column(const EnergyLine &line) const;
    /** Zero but for rounding, compared with the largest energy. */
    bool negligible(const std::vector<double> &values) const;
    NamedChart single(const std::string &name, const std::string &title,
                      const LineChart::Axis &x_axis,
                      const std::vector<double> &x,
                      const LineChart::Axis &y_axis, LineChart::Colour colour,
                      const Picker &pick) const;

    const std::vector<HistoryRow> &rows_;
    const Units &units_;
    const std::vector<std::string> &reaction_names_;
    unsigned int dimension_;
    std::vector<double> time_, step_;
    double largest_energy_ = 0., initial_energy_ = 0.;
  };

  /** How many fragments have a size or a larger one. */
  NamedChart fragments_by_size(const FragmentSizes &sizes);
} // namespace nsfd
