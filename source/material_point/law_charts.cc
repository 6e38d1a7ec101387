#include "law_charts.h"

#include "curve_names.h"

#include "visualization/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace nsfd
{
  namespace
  {
    using Colour = LineChart::Colour;
    using Values = std::vector<double>;

    Values values_of(const Curve &curve,
                     const std::function<double(const CurveRow &)> &value,
                     const double unit = 1.)
    {
      Values values;
      for (const CurveRow &row : curve)
        values.push_back(value(row) / unit);
      return values;
    }

    bool is_nonzero(const std::vector<Curve> &curves,
                    const std::function<double(const CurveRow &)> &value)
    {
      for (const Curve &curve : curves)
        for (const CurveRow &row : curve)
          if (value(row) != 0.)
            return true;
      return false;
    }

    /** Which jumps a path has, and how they are drawn. */
    class Axes
    {
    public:
      Axes(const LawInput &input, const std::vector<Curve> &curves)
          : input_(input),
            opens(is_nonzero(curves, [](auto &row) { return row.opening; })),
            slips(is_nonzero(curves, [](auto &row) { return row.slip; }))
      {
        for (std::size_t i = 0; i < curves.size(); ++i) {
          const Values x = jumps(i, curves[i]);
          forward = forward && std::is_sorted(x.begin(), x.end());
        }
      }

    private:
      const LawInput &input_;

    public:
      const bool opens, slips;
      bool forward = true; ///< the jump never turns back

      const CohesiveLaw &law(const std::size_t i) const
      {
        return *input_.curves[i].interaction.law;
      }

      LineChart::Axis jump_axis() const
      {
        const std::string name = opens && slips ? "jump |u|"
                                 : slips        ? "slip u_T"
                                                : "opening u_N";
        return input_.normalised
                   ? LineChart::Axis{name + " over final jump", ""}
                   : LineChart::Axis{name, "m"};
      }

      Values jumps(const std::size_t i, const Curve &curve) const
      {
        const double unit = !input_.normalised ? 1.
                            : slips && !opens  ? slip_scale(law(i))
                                               : opening_scale(law(i));
        return values_of(
            curve,
            [this](const CurveRow &row) {
              return opens && slips ? std::hypot(row.opening, row.slip)
                     : slips        ? row.slip
                                    : row.opening;
            },
            unit);
      }

      LineChart::Axis traction_axis() const
      {
        return input_.normalised ? LineChart::Axis{"traction over strength", ""}
                                 : LineChart::Axis{"traction", "Pa"};
      }

      double traction_unit(const std::size_t i) const
      {
        return input_.normalised ? law(i).strength() : 1.;
      }

      LineChart::Axis energy_axis() const
      {
        return input_.normalised ? LineChart::Axis{"energy over G", ""}
                                 : LineChart::Axis{"energy", "J/m²"};
      }

      double energy_unit(const std::size_t i) const
      {
        return input_.normalised ? law(i).toughness() : 1.;
      }
    };

    /** "name: what", or the shorter one that is enough. */
    std::string label(const LawInput &input, const std::size_t i,
                      const std::string &what)
    {
      return input.curves.size() == 1 ? what
             : what.empty()           ? input.curves[i].name
                                      : input.curves[i].name + ": " + what;
    }

    /** One law: what cohesion, contact and friction carry. */
    void add_parts(LineChart &chart, const Axes &axes, const Values &x,
                   const Curve &curve)
    {
      const double unit = axes.traction_unit(0);
      const auto values = [&](auto value) {
        return values_of(curve, value, unit);
      };
      const Values cohesive_normal =
                       values([](auto &row) { return row.cohesive_normal; }),
                   normal = values([](auto &row) { return row.normal(); }),
                   cohesive_tangential = values(
                       [](auto &row) { return row.cohesive_tangential; }),
                   tangential =
                       values([](auto &row) { return row.tangential(); });
      if (axes.opens && axes.slips) {
        chart.add_line("normal", x, normal, Colour::blue);
        // in proportional loading the two may coincide
        chart.add_line("tangential", x, tangential, Colour::orange, true);
        return;
      }
      if (!axes.slips) {
        chart.add_line(normal == cohesive_normal ? "cohesion"
                                                 : "cohesion and contact",
                       x, normal, Colour::blue);
        return;
      }
      const bool rubs = tangential != cohesive_tangential;
      if (rubs && axes.forward) {
        chart.add_band("work of cohesion", x, Values(x.size(), 0.),
                       cohesive_tangential, Colour::sky);
        chart.add_band("work of friction", x, cohesive_tangential, tangential,
                       Colour::orange);
      }
      if (rubs && !axes.forward)
        chart.add_line("cohesion", x, cohesive_tangential, Colour::grey, true);
      chart.add_line(rubs ? "cohesion and friction" : "cohesion", x, tangential,
                     Colour::blue);
    }
  } // namespace

  std::string traction_chart(const LawInput &input,
                             const std::vector<Curve> &curves)
  {
    const Axes axes(input, curves);
    LineChart chart(chart_title(input, "traction"), axes.jump_axis(),
                    axes.traction_axis());
    if (curves.size() == 1) {
      add_parts(chart, axes, axes.jumps(0, curves[0]), curves[0]);
      return chart.svg(SvgUse::file);
    }
    for (std::size_t i = 0; i < curves.size(); ++i) {
      const Values x = axes.jumps(i, curves[i]);
      const double unit = axes.traction_unit(i);
      const Values normal = values_of(
          curves[i], [](auto &row) { return row.normal(); }, unit);
      const Values tangential = values_of(
          curves[i], [](auto &row) { return row.tangential(); }, unit);
      const Colour colour = LineChart::palette(i);
      if (axes.opens || !axes.slips)
        chart.add_line(label(input, i, axes.slips ? "normal" : ""), x, normal,
                       colour);
      if (axes.slips)
        chart.add_line(label(input, i, axes.opens ? "tangential" : ""), x,
                       tangential, colour, axes.opens);
    }
    return chart.svg(SvgUse::file);
  }

  std::string energy_chart(const LawInput &input,
                           const std::vector<Curve> &curves)
  {
    const Axes axes(input, curves);
    const bool rubs =
        is_nonzero(curves, [](auto &row) { return row.friction_work; });
    LineChart chart(chart_title(input, "energy"),
                    axes.forward ? axes.jump_axis()
                                 : LineChart::Axis{"mark of the path", ""},
                    axes.energy_axis());
    for (std::size_t i = 0; i < curves.size(); ++i) {
      const Curve &curve = curves[i];
      const Values x =
          axes.forward ? axes.jumps(i, curve)
                       : values_of(curve, [](auto &row) { return row.path; });
      const auto add = [&](const std::string &name, auto value,
                           const Colour colour, const bool dashed) {
        chart.add_line(label(input, i, name), x,
                       values_of(curve, value, axes.energy_unit(i)), colour,
                       dashed);
      };
      const bool single = curves.size() == 1;
      const Colour mine = LineChart::palette(i);
      if (single) {
        add(
            "work", [](auto &row) { return row.work; }, Colour::grey, true);
        add(
            "stored", [](auto &row) { return row.stored; }, Colour::green,
            false);
      }
      add(
          "damage", [](auto &row) { return row.damage; },
          single ? Colour::red : mine, false);
      if (rubs)
        add(
            "friction", [](auto &row) { return row.friction_work; },
            single ? Colour::orange : mine, !single);
    }
    return chart.svg(SvgUse::file);
  }
} // namespace nsfd
