#include "report_charts.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using Colour = LineChart::Colour;

  namespace
  {
    const LineChart::Axis time_axis = {"time", "s"};
    const LineChart::Axis step_axis = {"step", ""};

    double largest_size(const std::vector<double> &values)
    {
      double largest = 0.;
      for (const double value : values)
        if (std::isfinite(value))
          largest = std::max(largest, std::abs(value));
      return largest;
    }
  } // namespace

  Charts::Charts(const std::vector<HistoryRow> &rows, const Units &units,
                 const std::vector<std::string> &reaction_names,
                 const unsigned int dimension)
      : rows_(rows), units_(units), reaction_names_(reaction_names),
        dimension_(dimension),
        time_(column([](const auto &row) { return row.time; })),
        // nothing was solved for the initial state
        step_(column([](const auto &row) {
          return row.step > 0 ? row.step : std::nan("");
        }))
  {
    for (const auto &line : all_lines())
      largest_energy_ =
          std::max(largest_energy_, largest_size(energy_column(line)));
    initial_energy_ = rows.empty() ? 0.
                                   : sum_of(rows[0].energy, all_lines()) -
                                         rows[0].energy.work;
  }

  std::vector<double> Charts::column(const Picker &pick) const
  {
    std::vector<double> values;
    values.reserve(rows_.size());
    for (const auto &row : rows_)
      values.push_back(pick(row));
    return values;
  }

  std::vector<double> Charts::energy_column(const EnergyLine &line) const
  {
    return column([&](const auto &row) { return row.energy.*line.member; });
  }

  bool Charts::negligible(const std::vector<double> &values) const
  {
    return largest_size(values) <= 1e-11 * largest_energy_;
  }

  NamedChart Charts::single(const std::string &name, const std::string &title,
                            const LineChart::Axis &x_axis,
                            const std::vector<double> &x,
                            const LineChart::Axis &y_axis, const Colour colour,
                            const Picker &pick) const
  {
    LineChart chart(title, x_axis, y_axis);
    chart.add_line(y_axis.label, x, column(pick), colour);
    return {name, chart};
  }

  NamedChart Charts::energy_stack() const
  {
    LineChart chart("Where the energy is", time_axis,
                    {"energy", units_.energy});
    std::vector<double> top(rows_.size(), 0.), bottom(rows_.size(), 0.);
    for (const auto &line : all_lines()) {
      const auto values = energy_column(line);
      if (negligible(values))
        continue;
      // what is negative is stacked below zero
      std::vector<double> lower(values.size()), upper(values.size());
      for (std::size_t i = 0; i < values.size(); ++i) {
        double &level = values[i] < 0. ? bottom[i] : top[i];
        lower[i] = level;
        level += std::isfinite(values[i]) ? values[i] : 0.;
        upper[i] = std::isfinite(values[i]) ? level : values[i];
      }
      chart.add_band(line.name, time_, lower, upper, line.colour);
    }
    chart.add_line("initial + work", time_, column([this](const auto &row) {
                     return initial_energy_ + row.energy.work;
                   }),
                   Colour::ink, true);
    return {"energies", chart};
  }

  NamedChart Charts::energy_lines() const
  {
    LineChart chart("Energy lines", time_axis, {"energy", units_.energy});
    for (const auto &line : stored_lines())
      if (const auto values = energy_column(line); !negligible(values))
        chart.add_line(line.name, time_, values, line.colour);
    chart.add_line("dissipated", time_, column([](const auto &row) {
                     return sum_of(row.energy, dissipated_lines());
                   }),
                   Colour::red);
    chart.add_line("work", time_,
                   column([](const auto &row) { return row.energy.work; }),
                   Colour::ink, true);
    return {"energy_lines", chart};
  }

  NamedChart Charts::dissipated() const
  {
    LineChart chart("Dissipated energy", time_axis, {"energy", units_.energy});
    bool any = false;
    for (const auto &line : dissipated_lines())
      if (const auto values = energy_column(line); !negligible(values)) {
        chart.add_line(line.name, time_, values, line.colour);
        any = true;
      }
    if (!any)
      chart.add_line("nothing", time_, std::vector<double>(rows_.size(), 0.),
                     Colour::grey);
    return {"dissipated", chart};
  }

  NamedChart Charts::broken_area() const
  {
    return single("broken_area",
                  units_.broken == "broken area" ? "Broken area"
                                                 : "Broken length",
                  time_axis, time_, {units_.broken, units_.area}, Colour::red,
                  [](const auto &row) { return row.broken_area; });
  }

  NamedChart Charts::fragments() const
  {
    return single("fragments", "Fragments", time_axis, time_, {"number", ""},
                  Colour::green, [](const auto &row) { return row.fragments; });
  }

  NamedChart Charts::active() const
  {
    return single("active_points", "Points in contact or softening", time_axis,
                  time_, {"points", ""}, Colour::green,
                  [](const auto &row) { return row.active; });
  }

  NamedChart Charts::reactions() const
  {
    LineChart chart("Reactions of driven boundaries", time_axis,
                    {"force", units_.force});
    std::vector<std::pair<std::string, std::vector<double>>> columns;
    double largest = 0.;
    for (std::size_t i = 0; i < reaction_names_.size(); ++i)
      for (unsigned int d = 0; d < dimension_; ++d) {
        const std::size_t entry = i * dimension_ + d;
        columns.emplace_back(reaction_names_[i] + ' ' + "xyz"[d],
                             column([entry](const auto &row) {
                               return entry < row.reactions.size()
                                          ? row.reactions[entry]
                                          : std::nan("");
                             }));
        largest = std::max(largest, largest_size(columns.back().second));
      }
    // components that are only rounding are left out
    unsigned int n = 0;
    for (const auto &[name, values] : columns)
      if (largest == 0. || largest_size(values) > 1e-10 * largest) {
        chart.add_line(name, time_, values, LineChart::palette(n), n >= 8);
        ++n;
      }
    return {"reactions", chart};
  }

  NamedChart Charts::step_size() const
  {
    return single("step_size", "Step size", step_axis, step_, {"step", "s"},
                  Colour::blue, [](const auto &row) { return row.time_step; });
  }

  NamedChart Charts::newton() const
  {
    return single("newton", "Newton iterations per step", step_axis, step_,
                  {"iterations", ""}, Colour::blue,
                  [](const auto &row) { return row.newton; });
  }

  NamedChart Charts::krylov() const
  {
    return single("krylov", "Krylov iterations per step", step_axis, step_,
                  {"iterations", ""}, Colour::violet,
                  [](const auto &row) { return row.krylov; });
  }

  NamedChart Charts::accuracy() const
  {
    LineChart chart("Residual and energy balance", step_axis,
                    {"relative", "", true});
    chart.add_line("residual of the contact problem", step_,
                   column([](const auto &row) { return row.residual; }),
                   Colour::blue);
    chart.add_line("balance residual", step_, column([](const auto &row) {
                     return std::abs(row.balance_residual);
                   }),
                   Colour::orange);
    return {"accuracy", chart};
  }

  NamedChart fragments_by_size(const FragmentSizes &sizes)
  {
    LineChart chart("Fragments by size",
                    {"diameter of the same volume", "m", true},
                    {"fragments of this size or larger", "", true});
    // stairs: N jumps at each size
    std::vector<double> x, y;
    for (std::size_t k = 0; k < sizes.sizes.size(); ++k) {
      x.insert(x.end(), {sizes.sizes[k], sizes.sizes[k]});
      y.insert(y.end(), {std::max(1., double(k)), double(k + 1)});
    }
    chart.add_line("number", x, y, Colour::blue);
    return {"fragments_by_size", chart};
  }
} // namespace nsfd
