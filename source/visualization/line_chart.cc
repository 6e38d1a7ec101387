#include "chart_axis.h"
#include "svg_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    constexpr double width = 400., plot_height = 165., font_size = 12.;

    /** What the values of one direction are. */
    struct Range {
      double smallest = std::numeric_limits<double>::infinity();
      double largest = -std::numeric_limits<double>::infinity();
      bool integers = true;

      bool empty() const { return largest < smallest; }
      void add(const double value)
      {
        integers = integers && value == std::floor(value);
        smallest = std::min(smallest, value);
        largest = std::max(largest, value);
      }
    };

    void set_axis(AxisMap &map, const LineChart::Axis &axis, const Range &range,
                  const bool to_full_ticks)
    {
      if (axis.logarithmic)
        map.set_logarithmic(range.smallest, range.largest, axis.unit);
      else
        map.set_linear(range.smallest, range.largest, axis.unit, range.integers,
                       to_full_ticks);
    }

    using PixelPoint = std::array<double, 2>;
    using PixelCurve = std::vector<PixelPoint>;

    /** First, smallest, largest and last point of every column of pixels. */
    PixelCurve decimate(const PixelCurve &curve)
    {
      if (curve.size() <= 2000)
        return curve;
      PixelCurve result;
      for (std::size_t begin = 0; begin < curve.size();) {
        const double column = std::floor(curve[begin][0]);
        std::size_t end = begin, low = begin, high = begin;
        for (; end < curve.size() && std::floor(curve[end][0]) == column;
             ++end) {
          if (curve[end][1] < curve[low][1])
            low = end;
          if (curve[end][1] > curve[high][1])
            high = end;
        }
        std::array<std::size_t, 4> kept = {begin, std::min(low, high),
                                           std::max(low, high), end - 1};
        for (std::size_t i = 0; i < kept.size(); ++i)
          if (i == 0 || kept[i] != kept[i - 1])
            result.push_back(curve[kept[i]]);
        begin = end;
      }
      return result;
    }

    /** The parts of a curve between points that cannot be shown. */
    std::vector<PixelCurve> visible_parts(const AxisMap &x_axis,
                                          const AxisMap &y_axis,
                                          const std::vector<double> &x,
                                          const std::vector<double> &y)
    {
      std::vector<PixelCurve> parts(1);
      for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i)
        if (x_axis.shows(x[i]) && y_axis.shows(y[i]))
          parts.back().push_back({x_axis(x[i]), y_axis(y[i])});
        else if (!parts.back().empty())
          parts.emplace_back();
      if (parts.back().empty())
        parts.pop_back();
      return parts;
    }

    void append_dot(PathWriter &path, const PixelPoint &p)
    {
      // an octagon is round enough at this size
      const double r = 2.4;
      for (int i = 0; i < 8; ++i) {
        const double angle = (i + 0.5) * 0.78539816339744831;
        const double x = p[0] + r * std::cos(angle);
        const double y = p[1] + r * std::sin(angle);
        i == 0 ? path.move(x, y) : path.line(x, y);
      }
      path.close();
    }

    /** Lines and labels of the ticks. */
    std::string ticks(const AxisMap &x_axis, const AxisMap &y_axis)
    {
      const double left = x_axis.pixel_lower, right = x_axis.pixel_upper;
      const double top = y_axis.pixel_upper, bottom = y_axis.pixel_lower;
      std::string body;
      PathWriter grid;
      double free_from = -1e9; // labels of the x axis must not touch
      for (const auto &tick : x_axis.ticks) {
        const double x = x_axis(tick.value);
        grid.move(x, top);
        grid.line(x, bottom);
        const double half = text_width(tick.label, font_size) / 2.;
        if (tick.label.empty() || x - half < free_from)
          continue;
        free_from = x + half + 6.;
        body += x + half > width
                    ? text_element(width - 2., bottom + 16., "end", tick.label)
                    : text_element(x, bottom + 16., "mid", tick.label);
      }
      for (const auto &tick : y_axis.ticks) {
        grid.move(left, y_axis(tick.value));
        grid.line(right, y_axis(tick.value));
        if (!tick.label.empty())
          body += text_element(left - 6., y_axis(tick.value) + 4., "end",
                               tick.label);
      }
      return body + path_element("class=\"grid\"", grid);
    }

    std::string fill_class(const LineChart::Colour colour)
    {
      return fmt::format("class=\"fill-{}\"", name_of(colour));
    }

    /** Gaps where one of the two borders is missing. */
    std::string band(const AxisMap &x_axis, const AxisMap &y_axis,
                     const std::vector<double> &x, std::vector<double> lower,
                     std::vector<double> upper, const LineChart::Colour colour)
    {
      upper.resize(std::min(upper.size(), lower.size()));
      lower.resize(upper.size());
      for (std::size_t i = 0; i < upper.size(); ++i)
        if (!y_axis.shows(upper[i]) || !y_axis.shows(lower[i]))
          upper[i] = lower[i] = std::numeric_limits<double>::quiet_NaN();
      const auto uppers = visible_parts(x_axis, y_axis, x, upper);
      const auto lowers = visible_parts(x_axis, y_axis, x, lower);
      PathWriter path;
      for (std::size_t part = 0; part < uppers.size(); ++part) {
        const PixelCurve there = decimate(uppers[part]);
        const PixelCurve back = decimate(lowers[part]);
        path.move(there[0][0], there[0][1]);
        for (std::size_t i = 1; i < there.size(); ++i)
          path.line(there[i][0], there[i][1]);
        for (std::size_t i = back.size(); i-- > 0;)
          path.line(back[i][0], back[i][1]);
        path.close();
      }
      return path_element(fill_class(colour), path);
    }

    /** With dots where there are few points. */
    std::string curve(const AxisMap &x_axis, const AxisMap &y_axis,
                      const std::vector<double> &x,
                      const std::vector<double> &y,
                      const LineChart::Colour colour, const bool dashed)
    {
      PathWriter path, dots;
      for (const auto &part : visible_parts(x_axis, y_axis, x, y)) {
        const PixelCurve kept = decimate(part);
        path.move(kept[0][0], kept[0][1]);
        for (std::size_t i = 1; i < kept.size(); ++i)
          path.line(kept[i][0], kept[i][1]);
        if (part.size() == 1 || x.size() <= 25)
          for (const auto &point : part)
            append_dot(dots, point);
      }
      return path_element(fmt::format("class=\"curve {}{}{}\"", name_of(colour),
                                      dashed ? " dash" : "",
                                      x.size() > 300 ? " long" : ""),
                          path) +
             path_element(fill_class(colour), dots);
    }
  } // namespace

  LineChart::Colour LineChart::palette(const unsigned int index)
  {
    static const std::array<Colour, 8> order = {
        Colour::blue, Colour::red,    Colour::green, Colour::orange,
        Colour::pink, Colour::violet, Colour::sky,   Colour::olive};
    return order[index % order.size()];
  }

  LineChart::LineChart(const std::string &title, const Axis &x, const Axis &y)
      : title_(title), x_(x), y_(y)
  {
  }

  void LineChart::add_line(const std::string &name,
                           const std::vector<double> &x,
                           const std::vector<double> &y, const Colour colour,
                           const bool dashed)
  {
    series_.push_back({name, x, y, {}, colour, dashed});
  }

  void LineChart::add_band(const std::string &name,
                           const std::vector<double> &x,
                           const std::vector<double> &lower,
                           const std::vector<double> &upper,
                           const Colour colour)
  {
    series_.push_back({name, x, upper, lower, colour, false});
  }

  /** The range of all that can be shown; false if that is nothing. */
  bool LineChart::set_axes(AxisMap &x_axis, AxisMap &y_axis) const
  {
    Range x_range, y_range;
    x_axis.logarithmic = x_.logarithmic;
    y_axis.logarithmic = y_.logarithmic;
    for (const auto &series : series_)
      for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size());
           ++i)
        if (x_axis.shows(series.x[i]) && y_axis.shows(series.y[i])) {
          x_range.add(series.x[i]);
          y_range.add(series.y[i]);
          if (i < series.lower.size() && y_axis.shows(series.lower[i]))
            y_range.add(series.lower[i]);
        }
    if (x_range.empty())
      return false;
    set_axis(x_axis, x_, x_range, false);
    set_axis(y_axis, y_, y_range, true);
    return true;
  }

  /** In rows from @p y on, which moves: it cannot cover data. */
  std::string LineChart::legend(double &y) const
  {
    std::string body;
    double x = 8.;
    y += 18.;
    for (const auto &series : series_) {
      if (series.name.empty())
        continue;
      const double length = 22. + text_width(series.name, font_size) + 12.;
      if (x > 8. && x + length > width) {
        x = 8.;
        y += 18.;
      }
      if (series.lower.empty())
        body += line_path(fmt::format("curve {}{}", name_of(series.colour),
                                      series.dashed ? " dash" : "")
                              .c_str(),
                          x, y - 4., x + 17., y - 4.);
      else
        body += fmt::format("<rect {} x=\"{}\" y=\"{}\" "
                            "width=\"14\" height=\"10\"/>\n",
                            fill_class(series.colour), pixel(x + 2.),
                            pixel(y - 9.));
      body += text_element(x + 22., y, "name", series.name);
      x += length;
    }
    return body;
  }

  std::string LineChart::svg(const SvgUse use) const
  {
    AxisMap x_axis, y_axis;
    const bool any = set_axes(x_axis, y_axis);
    std::string body = text_element(8., 18., "title", title_);
    double y = 22.;
    if (series_.size() > 1 && any)
      body += legend(y);
    y += 20.;
    body +=
        text_element(8., y, "", label_with_unit(y_.label, y_axis.scale.unit));

    double label_width = 0.;
    for (const auto &tick : y_axis.ticks)
      label_width = std::max(label_width, text_width(tick.label, font_size));
    x_axis.pixel_lower = std::max(34., 14. + label_width);
    x_axis.pixel_upper = width - 16.;
    y_axis.pixel_upper = y + 11.;
    y_axis.pixel_lower = y_axis.pixel_upper + plot_height;
    const double left = x_axis.pixel_lower, right = x_axis.pixel_upper;
    const double top = y_axis.pixel_upper, bottom = y_axis.pixel_lower;
    const double height = bottom + 40.;
    body += text_element(right, bottom + 34., "end",
                         label_with_unit(x_.label, x_axis.scale.unit));
    if (!any) {
      body += line_path("frame", left, bottom, right, bottom);
      body += text_element((left + right) / 2., (top + bottom) / 2., "mid",
                           "no data");
      return svg_document(use, width, height, title_, body);
    }

    body += ticks(x_axis, y_axis);
    for (const auto &series : series_)
      if (!series.lower.empty())
        body += band(x_axis, y_axis, series.x, series.lower, series.y,
                     series.colour);
    body += line_path("frame", left, bottom, right, bottom);
    if (!y_.logarithmic && y_axis.lower < 0. && y_axis.upper > 0.)
      body += line_path("frame", left, y_axis(0.), right, y_axis(0.));
    for (const auto &series : series_)
      if (series.lower.empty())
        body += curve(x_axis, y_axis, series.x, series.y, series.colour,
                      series.dashed);
    return svg_document(use, width, height, title_, body);
  }
} // namespace nsfd
