#include "nsfd/output/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

namespace nsfd
{
  namespace
  {
    // ---------------------------------------------------------------- colours

    struct NamedColour {
      const char *name, *light, *dark;
    };

    /// Series after Okabe and Ito: told apart with any colour vision.
    const std::vector<NamedColour> colours = {
        {"blue", "#0072b2", "#4ba6e8"},  {"orange", "#e08e00", "#f5b13d"},
        {"green", "#009e73", "#2fcf9f"}, {"red", "#d1440c", "#ff7d4d"},
        {"pink", "#c2609a", "#e89bc6"},  {"sky", "#4fb0e5", "#86d0f7"},
        {"olive", "#8f8300", "#d8cb4a"}, {"violet", "#6a4fb3", "#ab97ee"},
        {"grey", "#868d96", "#9aa2ad"},  {"ink", "#1c2128", "#e6e9ee"},
        {"muted", "#5b636e", "#a4acb8"}, {"grid", "#e4e7eb", "#323943"},
        {"frame", "#b4bac2", "#5a636f"}, {"paper", "#ffffff", "#1b1f26"}};

    /// @name stands for a colour.
    const char *const rules =
        ".nsfd text{font:12px system-ui,'Segoe UI',Roboto,Helvetica,Arial,"
        "sans-serif;fill:@muted}"
        ".nsfd .title{font-size:14px;font-weight:600;fill:@ink}"
        ".nsfd .name{fill:@ink}"
        ".nsfd .end{text-anchor:end}.nsfd .mid{text-anchor:middle}"
        ".nsfd path,.nsfd line{fill:none}"
        ".nsfd .grid{stroke:@grid}.nsfd .frame{stroke:@frame}"
        ".nsfd .curve{stroke-width:1.6;stroke-linejoin:round;"
        "stroke-linecap:round}"
        ".nsfd .long{stroke-width:1.25}"
        ".nsfd .dash{stroke-dasharray:6 4}"
        ".nsfd .paper{fill:@paper}"
        ".nsfd .rule{stroke:@ink;stroke-width:2}"
        ".nsfd .cells{stroke-width:.7;stroke-linejoin:round}"
        ".nsfd .cells path{fill:currentColor;stroke:currentColor}"
        ".nsfd .face{stroke-linecap:round}"
        ".nsfd .intact{stroke:#fff;stroke-opacity:.16;stroke-width:.5}";

    /// rules of one colour: a curve, or the filled area of a band
    std::string series_rules()
    {
      std::string text;
      for (unsigned int i = 0; i < 10; ++i)
        text += fmt::format(".nsfd .{0}{{stroke:@{0}}}"
                            ".nsfd .fill-{0}{{fill:@{0};stroke:none}}",
                            colours[i].name);
      return text;
    }

    template <typename Replacement>
    std::string replace_colours(const std::string &text,
                                const Replacement &replacement)
    {
      std::string result;
      for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '@') {
          result += text[i];
          continue;
        }
        std::size_t end = i + 1;
        while (end < text.size() && std::isalpha(text[end]))
          ++end;
        const std::string name = text.substr(i + 1, end - i - 1);
        for (const auto &colour : colours)
          if (name == colour.name)
            result += replacement(colour);
        i = end - 1;
      }
      return result;
    }

    const char *name_of(const LineChart::Colour colour)
    {
      return colours[static_cast<std::size_t>(colour)].name;
    }

    using Rgb = std::array<double, 3>;

    std::string hex(const Rgb &c)
    {
      const auto byte = [](const double x) {
        return static_cast<int>(std::lround(std::clamp(x, 0., 255.)));
      };
      return fmt::format("#{:02x}{:02x}{:02x}", byte(c[0]), byte(c[1]),
                         byte(c[2]));
    }

    Rgb rgb(const unsigned int code)
    {
      return {double(code >> 16 & 255), double(code >> 8 & 255),
              double(code & 255)};
    }

    Rgb mix(const Rgb &a, const Rgb &b, const double t)
    {
      return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]),
              a[2] + t * (b[2] - a[2])};
    }

    /** Perceptually uniform from dark violet to yellow, x in [0, 1]. */
    Rgb colour_map(const double x)
    {
      static const std::array<unsigned int, 16> anchors = {
          0x440154, 0x481a6c, 0x472f7d, 0x414487, 0x39568c, 0x31688e,
          0x2a788e, 0x23888e, 0x1f988b, 0x22a884, 0x35b779, 0x54c568,
          0x7ad151, 0xa5db36, 0xd2e21b, 0xfde725};
      const double position = 15. * std::clamp(x, 0., 1.);
      const auto i = std::min<std::size_t>(position, 14);
      return mix(rgb(anchors[i]), rgb(anchors[i + 1]), position - i);
    }

    const Rgb no_value = {176., 182., 190.};

    // ------------------------------------------------------------------- text

    /** An upper estimate in pixels, for fonts of the usual width. */
    double text_width(const std::string &text, const double font_size)
    {
      double em = 0.;
      for (const unsigned char c : text) {
        if ((c & 0xC0) == 0x80) // inside a character of several bytes
          continue;
        if (std::string("iljtfr.,:;|'()[] -").find(c) != std::string::npos)
          em += 0.36;
        else
          em += std::isupper(c) || c == 'm' || c == 'w' ? 0.78 : 0.61;
      }
      return em * font_size;
    }

    /** 10⁻¹⁸ */
    std::string power_of_ten(const int exponent)
    {
      static const std::array<const char *, 10> digits = {
          "⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
      std::string text = "10";
      for (const char c : std::to_string(exponent))
        text += c == '-' ? "⁻" : digits[c - '0'];
      return text;
    }

    std::string in_scientific(const double value, const unsigned int digits)
    {
      const std::string text =
          fmt::format("{:.{}e}", value, std::max(digits, 1u) - 1);
      const auto e = text.find('e');
      return text.substr(0, e) + "×" +
             power_of_ten(std::stoi(text.substr(e + 1)));
    }

    /** A minus sign as long as a plus. */
    std::string with_minus(const std::string &text)
    {
      return !text.empty() && text[0] == '-' ? "−" + text.substr(1) : text;
    }

    struct Prefix {
      int exponent;
      const char *symbol;
    };

    const std::vector<Prefix> prefixes = {
        {-15, "f"}, {-12, "p"}, {-9, "n"}, {-6, "µ"}, {-3, "m"},
        {0, ""},    {3, "k"},   {6, "M"},  {9, "G"},  {12, "T"}};

    /** 2 for "m²" or "m^2", 3 for "m³", else 1. */
    int power_of(const std::string &unit)
    {
      const auto starts_with = [&](const char *text) {
        return unit.rfind(text, 0) == 0;
      };
      return starts_with("m²") || starts_with("m^2")   ? 2
             : starts_with("m³") || starts_with("m^3") ? 3
                                                       : 1;
    }

    /** Also where there is no prefix: "10⁻²¹ J/m", "10⁻⁶". */
    UnitScale axis_scale(const double largest, const std::string &unit)
    {
      UnitScale scale = engineering_scale(largest, unit);
      const double value = std::abs(largest) / scale.factor;
      if (value > 0. && std::isfinite(value) &&
          (value < 1e-2 || value >= 1e5)) {
        const int exponent = 3 * int(std::floor(std::log10(value) / 3.));
        scale.factor *= std::pow(10., exponent);
        scale.unit = power_of_ten(exponent) +
                     (scale.unit.empty() ? "" : " " + scale.unit);
      }
      return scale;
    }

    std::string label_with_unit(const std::string &label,
                                const std::string &unit)
    {
      return unit.empty() ? label : label + " (" + unit + ")";
    }

    // -------------------------------------------------------------- SVG pieces

    /** Path data: relative, rounded to 0.01 px without accumulating. */
    class PathWriter
    {
    public:
      void move(const double x, const double y)
      {
        const Pair target = rounded(x, y);
        // the first one counts from the origin, and lines may follow it
        text_ += "m" + joined({target[0] - at_[0], target[1] - at_[1]});
        at_ = start_ = target;
        command_ = 'm';
      }

      void line(const double x, const double y)
      {
        const Pair target = rounded(x, y);
        const Pair step = {target[0] - at_[0], target[1] - at_[1]};
        at_ = target;
        if (step[0] == 0 && step[1] == 0 && command_ != 'm')
          return;
        if (step[1] == 0)
          append('h', number(step[0]));
        else if (step[0] == 0)
          append('v', number(step[1]));
        else
          append('l', joined(step));
      }

      void close()
      {
        text_ += 'z';
        at_ = start_;
        command_ = 'z';
      }

      const std::string &text() const { return text_; }

    private:
      using Pair = std::array<long, 2>;

      static Pair rounded(const double x, const double y)
      {
        const auto hundredths = [](const double value) {
          return std::lround(100. * std::clamp(value, -1e5, 1e5));
        };
        return {hundredths(x), hundredths(y)};
      }

      static std::string number(const long hundredths)
      {
        const long size = std::abs(hundredths);
        std::string text = hundredths < 0 ? "-" : "";
        if (size >= 100 || size == 0)
          text += std::to_string(size / 100);
        if (size % 10 != 0)
          text += fmt::format(".{:02}", size % 100);
        else if (size % 100 != 0)
          text += fmt::format(".{}", size % 100 / 10);
        return text;
      }

      static std::string joined(const Pair &pair)
      {
        return number(pair[0]) + (pair[1] < 0 ? "" : " ") + number(pair[1]);
      }

      void append(const char command, const std::string &numbers)
      {
        // lines that follow a move or a line need no letter of their own
        const bool implied = command == 'l' ? command_ == 'l' || command_ == 'm'
                                            : command == command_;
        if (!implied)
          text_ += command;
        else if (numbers[0] != '-')
          text_ += ' ';
        text_ += numbers;
        command_ = command;
      }

      std::string text_;
      Pair at_{}, start_{};
      char command_ = 0;
    };

    std::string pixel(const double x)
    {
      std::string text = fmt::format("{:.2f}", x);
      text.erase(text.find_last_not_of('0') + 1);
      if (text.back() == '.')
        text.pop_back();
      return text == "-0" ? "0" : text;
    }

    std::string text_element(const double x, const double y,
                             const char *classes, const std::string &text)
    {
      return fmt::format("<text x=\"{}\" y=\"{}\"{}>{}</text>\n", pixel(x),
                         pixel(y),
                         *classes ? fmt::format(" class=\"{}\"", classes) : "",
                         escape_markup(text));
    }

    std::string path_element(const std::string &attributes,
                             const PathWriter &path)
    {
      if (path.text().empty())
        return "";
      return "<path " + attributes + " d=\"" + path.text() + "\"/>\n";
    }

    std::string line_path(const char *classes, const double x1, const double y1,
                          const double x2, const double y2)
    {
      PathWriter path;
      path.move(x1, y1);
      path.line(x2, y2);
      return path_element(fmt::format("class=\"{}\"", classes), path);
    }

    std::string svg_document(const SvgUse use, const double width,
                             const double height, const std::string &label,
                             const std::string &content)
    {
      std::string text;
      if (use == SvgUse::file)
        text = fmt::format(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"nsfd\" "
            "width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n"
            "<title>{2}</title>\n<style>{3}</style>\n"
            "<rect class=\"paper\" width=\"{0}\" height=\"{1}\"/>\n",
            pixel(width), pixel(height), escape_markup(label),
            replace_colours(rules + series_rules(), [](const auto &colour) {
              return std::string(colour.light);
            }));
      else
        text = fmt::format("<svg class=\"nsfd\" viewBox=\"0 0 {} {}\" "
                           "role=\"img\" aria-label=\"{}\">\n",
                           pixel(width), pixel(height), escape_markup(label));
      return text + content + "</svg>\n";
    }

    // ------------------------------------------------------------------- ticks

    /** The smallest of 1, 2, 5, 10 ... that is not below @p x. */
    double nice_above(const double x)
    {
      const double decade = std::pow(10., std::floor(std::log10(x)));
      for (const double digit : {1., 2., 5.})
        if (x <= digit * decade * (1. + 1e-9))
          return digit * decade;
      return 10. * decade;
    }

    double nice_below(const double x)
    {
      const double decade = std::pow(10., std::floor(std::log10(x) + 1e-12));
      for (const double digit : {5., 2.})
        if (x >= digit * decade * (1. - 1e-9))
          return digit * decade;
      return decade;
    }

    struct Tick {
      double value;
      std::string label; ///< may be empty
    };

    /** Data interval, pixels and ticks of one direction of a chart. */
    class AxisMap
    {
    public:
      double lower = 0., upper = 1.; ///< log10 of the values if logarithmic
      double pixel_lower = 0., pixel_upper = 1.;
      bool logarithmic = false;
      UnitScale scale;
      std::vector<Tick> ticks;

      bool shows(const double value) const
      {
        return std::isfinite(value) && (!logarithmic || value > 0.);
      }

      double operator()(const double value) const
      {
        const double x =
            logarithmic ? std::max(std::log10(value), lower) : value;
        return pixel_lower +
               (x - lower) / (upper - lower) * (pixel_upper - pixel_lower);
      }
    };

    void make_linear(AxisMap &axis, double smallest, double largest,
                     const std::string &unit, const bool integers,
                     const bool to_full_ticks)
    {
      if (to_full_ticks && smallest > 0. && smallest < 0.8 * largest)
        smallest = 0.;
      if (to_full_ticks && largest < 0. && largest > 0.8 * smallest)
        largest = 0.;
      const double size = std::max(std::abs(smallest), std::abs(largest));
      // one value: show it against zero
      if (largest - smallest <= 1e-9 * size || size == 0.) {
        smallest = std::min(smallest, 0.);
        largest = size == 0. ? 1. : std::max(largest, 0.);
      }
      axis.scale = axis_scale(size, unit);

      double step = nice_above((largest - smallest) / axis.scale.factor / 5.5);
      if (integers && axis.scale.factor == 1.)
        step = std::max(step, 1.);
      double first = std::floor(smallest / axis.scale.factor / step + 1e-6);
      double last = std::ceil(largest / axis.scale.factor / step - 1e-6);
      if (to_full_ticks) {
        smallest = first * step * axis.scale.factor;
        largest = last * step * axis.scale.factor;
      } else {
        first = std::ceil(smallest / axis.scale.factor / step - 1e-6);
        last = std::floor(largest / axis.scale.factor / step + 1e-6);
      }
      axis.lower = smallest;
      axis.upper = largest;
      const int decimals =
          std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
      for (double i = first; i <= last; ++i)
        axis.ticks.push_back(
            {i * step * axis.scale.factor,
             with_minus(
                 fmt::format("{:.{}f}", i == 0. ? 0. : i * step, decimals))});
    }

    void make_logarithmic(AxisMap &axis, const double smallest,
                          const double largest, const std::string &unit)
    {
      // at most 20 decades: what lies below is drawn at the lower end
      const double top = std::ceil(std::log10(largest) - 1e-9);
      double bottom = std::floor(std::log10(smallest) + 1e-9);
      bottom = std::clamp(bottom, top - 20., top - 1.);
      axis.lower = bottom;
      axis.upper = top;
      axis.scale.unit = unit;
      const int n_decades = static_cast<int>(top - bottom);
      const int stride = (n_decades + 6) / 7;
      for (int i = 0; i <= n_decades; ++i) {
        const int exponent = static_cast<int>(bottom) + i;
        const bool labelled = i % stride == 0;
        const bool plain = n_decades <= 4 && exponent >= 0 && exponent <= 4;
        axis.ticks.push_back(
            {std::pow(10., exponent),
             !labelled ? ""
             : plain   ? fmt::format("{:.0f}", std::pow(10., exponent))
                       : power_of_ten(exponent)});
        if (n_decades > 2 || i == n_decades)
          continue;
        for (const int digit : {2, 5})
          axis.ticks.push_back(
              {digit * std::pow(10., exponent),
               plain ? fmt::format("{:.0f}", digit * std::pow(10., exponent))
                     : fmt::format("{}×{}", digit, power_of_ten(exponent))});
      }
    }

    // ----------------------------------------------------------------- curves

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
  } // namespace

  std::string escape_markup(const std::string &text)
  {
    std::string result;
    result.reserve(text.size());
    for (const char c : text)
      switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        // control characters are not allowed in XML
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t')
          result += c;
      }
    return result;
  }

  UnitScale engineering_scale(const double largest, const std::string &unit)
  {
    const int power = power_of(unit);
    const double size = std::abs(largest);
    if (unit.empty() || size == 0. || !std::isfinite(size))
      return {1., unit};

    UnitScale scale{1., unit};
    for (const auto &prefix : prefixes) {
      const double factor = std::pow(10., power * prefix.exponent);
      if (unit == "s" && prefix.exponent > 0)
        break;
      // rounding must not give 1000 of the smaller unit
      if (size < 0.9995 * factor)
        break;
      scale = {factor, prefix.symbol + unit};
    }
    return scale;
  }

  std::string engineering(const double value, const std::string &unit,
                          const unsigned int digits)
  {
    if (!std::isfinite(value))
      return std::isnan(value) ? "n/a" : value > 0. ? "infinite" : "−infinite";
    const std::string suffix = unit.empty() ? "" : " " + unit;
    if (value == 0.)
      return "0" + suffix;

    const UnitScale scale = engineering_scale(value, unit);
    const double scaled = value / scale.factor;
    const double size = std::abs(scaled);
    const bool seconds = unit == "s";
    const double limit = power_of(unit) == 1 ? 1e4 : 1e10;
    if (size < (unit.empty() ? 1e-3 : 0.9) || (size >= limit && !seconds))
      return with_minus(in_scientific(value, digits)) + suffix;
    const int leading = static_cast<int>(std::floor(std::log10(size))) + 1;
    // 9.999 becomes 10.0, not 10.00
    const int carried = size >= std::pow(10., leading) *
                                    (1. - 0.5 * std::pow(10., -1. * digits))
                            ? leading + 1
                            : leading;
    const int decimals = std::max(0, static_cast<int>(digits) - carried);
    return with_minus(fmt::format("{:.{}f}", scaled, decimals)) +
           (scale.unit.empty() ? "" : " " + scale.unit);
  }

  std::string svg_style()
  {
    std::string text = ":root{";
    for (const auto &colour : colours)
      text += fmt::format("--nsfd-{}:{};", colour.name, colour.light);
    return text + "}" +
           replace_colours(rules + series_rules(), [](const auto &colour) {
             return fmt::format("var(--nsfd-{})", colour.name);
           });
  }

  std::string svg_dark_colours()
  {
    std::string text;
    for (const auto &colour : colours)
      text += fmt::format("--nsfd-{}:{};", colour.name, colour.dark);
    return text;
  }

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

  std::string LineChart::svg(const SvgUse use) const
  {
    const double width = 400., plot_height = 165.;

    // the range of all that can be shown
    struct Range {
      double smallest = std::numeric_limits<double>::infinity();
      double largest = -std::numeric_limits<double>::infinity();
      bool integers = true;
      void add(const double value)
      {
        integers = integers && value == std::floor(value);
        smallest = std::min(smallest, value);
        largest = std::max(largest, value);
      }
    } x_range, y_range;
    AxisMap x_axis, y_axis;
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
    const bool empty = x_range.largest < x_range.smallest;
    if (!empty) {
      if (x_.logarithmic)
        make_logarithmic(x_axis, x_range.smallest, x_range.largest, x_.unit);
      else
        make_linear(x_axis, x_range.smallest, x_range.largest, x_.unit,
                    x_range.integers, false);
      if (y_.logarithmic)
        make_logarithmic(y_axis, y_range.smallest, y_range.largest, y_.unit);
      else
        make_linear(y_axis, y_range.smallest, y_range.largest, y_.unit,
                    y_range.integers, true);
    }

    std::string body = text_element(8., 18., "title", title_);

    // the legend in rows below the title: it cannot cover data
    double y = 22.;
    if (series_.size() > 1 && !empty) {
      double x = 8.;
      y += 18.;
      for (const auto &series : series_) {
        const double length = 22. + text_width(series.name, 12.) + 12.;
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
          body +=
              fmt::format("<rect class=\"fill-{}\" x=\"{}\" y=\"{}\" "
                          "width=\"14\" height=\"10\"/>\n",
                          name_of(series.colour), pixel(x + 2.), pixel(y - 9.));
        body += text_element(x + 22., y, "name", series.name);
        x += length;
      }
    }
    y += 20.;
    body +=
        text_element(8., y, "", label_with_unit(y_.label, y_axis.scale.unit));

    double label_width = 0.;
    for (const auto &tick : y_axis.ticks)
      label_width = std::max(label_width, text_width(tick.label, 12.));
    x_axis.pixel_lower = std::max(34., 14. + label_width);
    x_axis.pixel_upper = width - 16.;
    y_axis.pixel_upper = y + 11.;
    y_axis.pixel_lower = y_axis.pixel_upper + plot_height;
    const double left = x_axis.pixel_lower, right = x_axis.pixel_upper;
    const double top = y_axis.pixel_upper, bottom = y_axis.pixel_lower;
    const double height = bottom + 40.;
    body += text_element(right, bottom + 34., "end",
                         label_with_unit(x_.label, x_axis.scale.unit));

    if (empty) {
      body += line_path("frame", left, bottom, right, bottom);
      body += text_element((left + right) / 2., (top + bottom) / 2., "mid",
                           "no data");
      return svg_document(use, width, height, title_, body);
    }

    PathWriter grid;
    double free_from = -1e9; // labels of the x axis must not touch
    for (const auto &tick : x_axis.ticks) {
      const double x = x_axis(tick.value);
      grid.move(x, top);
      grid.line(x, bottom);
      const double half = text_width(tick.label, 12.) / 2.;
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
        body +=
            text_element(left - 6., y_axis(tick.value) + 4., "end", tick.label);
    }
    body += path_element("class=\"grid\"", grid);

    for (const auto &series : series_) {
      if (series.lower.empty())
        continue;
      PathWriter path;
      // gaps where one of the two borders is missing
      std::vector<double> upper = series.y, lower = series.lower;
      upper.resize(std::min(upper.size(), lower.size()));
      lower.resize(upper.size());
      for (std::size_t i = 0; i < upper.size(); ++i)
        if (!y_axis.shows(upper[i]) || !y_axis.shows(lower[i]))
          upper[i] = lower[i] = std::numeric_limits<double>::quiet_NaN();
      const auto uppers = visible_parts(x_axis, y_axis, series.x, upper);
      const auto lowers = visible_parts(x_axis, y_axis, series.x, lower);
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
      body += path_element(
          fmt::format("class=\"fill-{}\"", name_of(series.colour)), path);
    }
    body += line_path("frame", left, bottom, right, bottom);
    if (!y_.logarithmic && y_axis.lower < 0. && y_axis.upper > 0.)
      body += line_path("frame", left, y_axis(0.), right, y_axis(0.));

    for (const auto &series : series_) {
      if (!series.lower.empty())
        continue;
      PathWriter path, dots;
      for (const auto &part :
           visible_parts(x_axis, y_axis, series.x, series.y)) {
        const PixelCurve curve = decimate(part);
        path.move(curve[0][0], curve[0][1]);
        for (std::size_t i = 1; i < curve.size(); ++i)
          path.line(curve[i][0], curve[i][1]);
        if (part.size() == 1 || series.x.size() <= 25)
          for (const auto &point : part)
            append_dot(dots, point);
      }
      body += path_element(fmt::format("class=\"curve {}{}{}\"",
                                       name_of(series.colour),
                                       series.dashed ? " dash" : "",
                                       series.x.size() > 300 ? " long" : ""),
                           path);
      body += path_element(
          fmt::format("class=\"fill-{}\"", name_of(series.colour)), dots);
    }
    return svg_document(use, width, height, title_, body);
  }

  // ------------------------------------------------------- picture of the body

  namespace
  {
    using Vector = std::array<double, 3>;

    bool finite(const Vector &v)
    {
      return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
    }

    Vector mean_displacement(const Snapshot &snapshot)
    {
      Vector sum{};
      double n = 0.;
      for (const auto &polygon : snapshot.polygons)
        for (const auto &u : polygon.displacement)
          if (finite(u)) {
            for (unsigned int d = 0; d < 3; ++d)
              sum[d] += u[d];
            ++n;
          }
      if (n > 0.)
        for (auto &component : sum)
          component /= n;
      return sum;
    }

    /** From points of the body to the drawing plane (m, second axis up). */
    class Projection
    {
    public:
      Projection(const Snapshot &snapshot, const double magnification)
          : three_dimensional_(snapshot.dimension == 3),
            mean_(mean_displacement(snapshot)), magnification_(magnification)
      {
      }

      Vector deformed(const Vector &reference, const Vector &u) const
      {
        Vector x;
        for (unsigned int d = 0; d < 3; ++d)
          x[d] = reference[d] + mean_[d] + magnification_ * (u[d] - mean_[d]);
        return x;
      }

      /** Third entry: larger is nearer to the eye, at (1, -1, 1). */
      Vector to_plane(const Vector &x) const
      {
        if (!three_dimensional_)
          return {x[0], x[1], 0.};
        return {(x[0] + x[1]) * std::sqrt(0.5),
                (-x[0] + x[1] + 2. * x[2]) * std::sqrt(1. / 6.),
                (x[0] - x[1] + x[2]) * std::sqrt(1. / 3.)};
      }

    private:
      bool three_dimensional_;
      Vector mean_;
      double magnification_;
    };

    /** Corners that can be drawn; empty if something is not a number. */
    std::vector<Vector> deformed_corners(const Snapshot::Polygon &polygon,
                                         const Projection &projection)
    {
      std::vector<Vector> corners;
      for (std::size_t i = 0; i < polygon.reference.size(); ++i) {
        const Vector u = i < polygon.displacement.size()
                             ? polygon.displacement[i]
                             : Vector{};
        corners.push_back(projection.deformed(polygon.reference[i], u));
        if (!finite(corners.back()))
          return {};
      }
      return corners;
    }

    /** Axis-parallel box in space or, with two used entries, in the plane. */
    struct Box {
      Vector lower{HUGE_VAL, HUGE_VAL, HUGE_VAL},
          upper{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
      void add(const Vector &x)
      {
        for (unsigned int d = 0; d < 3; ++d) {
          lower[d] = std::min(lower[d], x[d]);
          upper[d] = std::max(upper[d], x[d]);
        }
      }
      bool empty() const { return !(lower[0] <= upper[0]); }
      double size() const
      {
        return std::max(
            {upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
      }
    };

    double coloured_value(const Snapshot::Polygon &polygon,
                          const PictureOptions::Colouring colouring)
    {
      return colouring == PictureOptions::Colouring::speed ? polygon.speed
                                                           : polygon.value;
    }

    /** The largest fragment light grey, others in turn from a palette. */
    std::map<unsigned int, Rgb> fragment_colours(const Snapshot &snapshot)
    {
      static const std::array<unsigned int, 10> palette = {
          0x4f9bd9, 0xf0a33c, 0x3fae8a, 0xd96c75, 0x9a7fd1,
          0x6cc5dd, 0xc9b84a, 0xd98cc0, 0x7fae4f, 0xb98b6a};
      std::map<unsigned int, std::size_t> n_polygons;
      for (const auto &polygon : snapshot.polygons)
        ++n_polygons[polygon.fragment];
      std::vector<std::pair<std::size_t, unsigned int>> by_size;
      for (const auto &[fragment, n] : n_polygons)
        by_size.emplace_back(n, fragment);
      std::sort(
          by_size.begin(), by_size.end(), [](const auto &a, const auto &b) {
            return a.first != b.first ? a.first > b.first : a.second < b.second;
          });
      std::map<unsigned int, Rgb> result;
      for (std::size_t i = 0; i < by_size.size(); ++i)
        result[by_size[i].second] =
            i == 0 ? rgb(0xc3cbd4) : rgb(palette[(i - 1) % palette.size()]);
      return result;
    }

    Vector difference(const Vector &a, const Vector &b)
    {
      return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    }

    /** 0.7 to 1 by the angle to the light, the same for both sides. */
    double shade(const std::vector<Vector> &corners)
    {
      Vector normal{};
      for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        const Vector a = difference(corners[i], corners[0]);
        const Vector b = difference(corners[i + 1], corners[0]);
        for (unsigned int d = 0; d < 3; ++d)
          normal[d] +=
              a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
      }
      const double length = std::hypot(normal[0], normal[1], normal[2]);
      if (!(length > 0.))
        return 1.;
      const Vector light = {0.32, -0.55, 0.77};
      const double cosine =
          (normal[0] * light[0] + normal[1] * light[1] + normal[2] * light[2]) /
          length;
      return 0.62 + 0.40 * std::abs(cosine);
    }

    /** Finds the cell edges on both sides of a face by its undeformed ends. */
    class EdgeFinder
    {
    public:
      using Edge = std::array<Vector, 2>; ///< deformed ends

      EdgeFinder(const Snapshot &snapshot, const double size,
                 const Projection &projection)
          : cell_(1e-6 * size)
      {
        for (const auto &face : snapshot.faces)
          if (face.beta < 1. || face.contact)
            edges_[key(face.a, face.b)];
        if (edges_.empty())
          return;
        for (const auto &polygon : snapshot.polygons) {
          const auto corners = deformed_corners(polygon, projection);
          for (std::size_t i = 0; i < corners.size(); ++i) {
            const std::size_t j = (i + 1) % corners.size();
            const auto found =
                edges_.find(key(polygon.reference[i], polygon.reference[j]));
            if (found != edges_.end())
              found->second.push_back({corners[i], corners[j]});
          }
        }
      }

      const std::vector<Edge> &find(const Snapshot::FacePiece &face) const
      {
        static const std::vector<Edge> none;
        const auto found = edges_.find(key(face.a, face.b));
        return found == edges_.end() ? none : found->second;
      }

    private:
      using Key = std::array<long long, 4>;
      struct Hash {
        std::size_t operator()(const Key &key) const
        {
          std::size_t hash = 0;
          for (const long long k : key)
            hash = (hash ^ static_cast<std::size_t>(k)) * 0x9E3779B97F4A7C15u;
          return hash ^ hash >> 29;
        }
      };

      Key key(const Vector &a, const Vector &b) const
      {
        // shifted, so that corners of a regular mesh are not on the border
        const auto index = [this](const double x) {
          return std::llround(x / cell_ + 0.1234567);
        };
        std::array<long long, 2> p = {index(a[0]), index(a[1])},
                                 q = {index(b[0]), index(b[1])};
        if (q < p)
          std::swap(p, q);
        return {p[0], p[1], q[0], q[1]};
      }

      double cell_;
      std::unordered_map<Key, std::vector<Edge>, Hash> edges_;
    };

    enum class FaceState { intact, damaged, broken, contact };

    FaceState state_of(const Snapshot::FacePiece &face)
    {
      if (face.contact)
        return FaceState::contact;
      if (face.beta <= 1e-9)
        return FaceState::broken;
      return face.beta < 1. - 1e-9 ? FaceState::damaged : FaceState::intact;
    }

    const char *const broken_colour = "#e3122b";
    const char *const contact_colour = "#2f9dff";

    std::string damage_colour(const double damage)
    {
      return hex(mix(rgb(0xffc14d), rgb(0xff5a1f), damage));
    }
  } // namespace

  PictureOptions picture_options(const std::vector<Snapshot> &snapshots,
                                 const PictureOptions::Colouring colouring)
  {
    PictureOptions options;
    options.colouring = colouring;

    Box reference;
    double largest_displacement = 0.;
    std::vector<double> values;
    for (const auto &snapshot : snapshots) {
      const Vector mean = mean_displacement(snapshot);
      for (const auto &polygon : snapshot.polygons) {
        for (const auto &x : polygon.reference)
          if (finite(x))
            reference.add(x);
        for (const auto &u : polygon.displacement)
          if (finite(u))
            largest_displacement = std::max(
                largest_displacement,
                std::hypot(u[0] - mean[0], u[1] - mean[1], u[2] - mean[2]));
        const double value = coloured_value(polygon, colouring);
        if (std::isfinite(value))
          values.push_back(value);
      }
      for (const auto &face : snapshot.faces) {
        const FaceState state = state_of(face);
        options.explain_damaged |= state == FaceState::damaged;
        options.explain_broken |= state == FaceState::broken;
        options.explain_contact |= state == FaceState::contact;
      }
    }
    if (reference.empty())
      return options;

    const double size = reference.size();
    if (largest_displacement > 1e-12 * size &&
        largest_displacement < 0.02 * size)
      options.magnification = nice_below(0.05 * size / largest_displacement);

    // cells at a singular point must not make all others dark
    if (!values.empty()) {
      const auto nth =
          values.begin() + static_cast<long>(0.998 * (values.size() - 1));
      std::nth_element(values.begin(), nth, values.end());
      options.colour_max = std::max(*nth, 0.);
      if (options.colour_max > 0.) {
        const double unit =
            std::pow(10., std::floor(std::log10(options.colour_max)) - 1.);
        options.colour_max =
            std::ceil(options.colour_max / unit * (1. - 1e-9)) * unit;
      }
    }

    Box drawn, rest;
    for (const auto &snapshot : snapshots) {
      const Projection projection(snapshot, options.magnification);
      for (const auto &polygon : snapshot.polygons) {
        for (const auto &x : deformed_corners(polygon, projection))
          drawn.add(projection.to_plane(x));
        for (const auto &x : polygon.reference)
          if (finite(x))
            rest.add(projection.to_plane(x));
      }
    }
    if (drawn.empty())
      drawn = rest;
    // fragments that fly far off leave the picture
    const double margin = 1.5 * rest.size();
    for (unsigned int d = 0; d < 2; ++d) {
      options.lower[d] = std::max(drawn.lower[d], rest.lower[d] - margin);
      options.upper[d] = std::min(drawn.upper[d], rest.upper[d] + margin);
      if (!(options.lower[d] < options.upper[d])) {
        options.lower[d] = rest.lower[d] - 0.01 * size;
        options.upper[d] = rest.upper[d] + 0.01 * size;
      }
    }
    return options;
  }

  std::string body_picture(const Snapshot &snapshot,
                           const PictureOptions &options, const SvgUse use)
  {
    using Colouring = PictureOptions::Colouring;
    const Projection projection(snapshot, options.magnification);
    const bool three_dimensional = snapshot.dimension == 3;

    const auto fragments = options.colouring == Colouring::fragment
                               ? fragment_colours(snapshot)
                               : std::map<unsigned int, Rgb>();

    std::string caption = "t = " + engineering(snapshot.time, "s");
    if (!fragments.empty())
      caption += fmt::format("  ·  {} fragment{}", fragments.size(),
                             fragments.size() == 1 ? "" : "s");
    caption += options.magnification == 1.
                   ? "  ·  true deformation"
                   : "  ·  deformation × " +
                         (options.magnification < 1e6
                              ? fmt::format("{:.0f}", options.magnification)
                              : in_scientific(options.magnification, 1));
    std::string body = text_element(8., 18., "title", caption);

    const std::array<double, 2> extent = {options.upper[0] - options.lower[0],
                                          options.upper[1] - options.lower[1]};
    if (snapshot.polygons.empty() || !(extent[0] > 0.) || !(extent[1] > 0.)) {
      body += text_element(options.width / 2., 70., "mid", "nothing to draw");
      return svg_document(use, options.width, 120., caption, body);
    }

    // pixels: the body, centred, with a border for strokes
    const double border = 8., top = 28.;
    const double inner = options.width - 2. * border;
    const double scale =
        std::min(inner / extent[0], options.max_height / extent[1]);
    const double body_height = scale * extent[1] + 2. * border;
    const double left = (options.width - scale * extent[0]) / 2.;
    const auto to_pixel = [&](const Vector &deformed) -> Vector {
      const Vector p = projection.to_plane(deformed);
      return {left + scale * (p[0] - options.lower[0]),
              border + scale * (options.upper[1] - p[1]), p[2]};
    };
    const auto add_polygon = [&](PathWriter &path,
                                 const std::vector<Vector> &corners) {
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector p = to_pixel(corners[i]);
        i == 0 ? path.move(p[0], p[1]) : path.line(p[0], p[1]);
      }
      path.close();
    };

    // a nested svg cuts off what leaves the frame
    body += fmt::format("<svg y=\"{}\" width=\"{}\" height=\"{}\">\n",
                        pixel(top), pixel(options.width), pixel(body_height));

    // cells: 64 colours, in 2D one path for each
    const auto colour_of = [&](const Snapshot::Polygon &polygon) -> Rgb {
      if (options.colouring == Colouring::fragment)
        return fragments.at(polygon.fragment);
      const double value = coloured_value(polygon, options.colouring);
      if (!std::isfinite(value))
        return no_value;
      const double share =
          options.colour_max > 0. ? value / options.colour_max : 0.;
      return colour_map(std::round(63. * std::clamp(share, 0., 1.)) / 63.);
    };
    body += "<g class=\"cells\">\n";
    if (!three_dimensional) {
      std::map<Rgb, PathWriter> paths;
      for (const auto &polygon : snapshot.polygons) {
        const auto corners = deformed_corners(polygon, projection);
        if (!corners.empty())
          add_polygon(paths[colour_of(polygon)], corners);
      }
      for (const auto &[colour, path] : paths)
        body += path_element("color=\"" + hex(colour) + "\"", path);
    } else {
      struct Facet {
        double depth;
        std::string colour;
        std::vector<Vector> corners;
      };
      std::vector<Facet> facets;
      for (const auto &polygon : snapshot.polygons) {
        auto corners = deformed_corners(polygon, projection);
        if (corners.empty())
          continue;
        double depth = 0.;
        for (const auto &x : corners)
          depth += projection.to_plane(x)[2] / corners.size();
        const double light = shade(corners);
        Rgb colour = colour_of(polygon);
        for (auto &component : colour)
          component *= light;
        facets.push_back({depth, hex(colour), std::move(corners)});
      }
      std::stable_sort(
          facets.begin(), facets.end(),
          [](const Facet &a, const Facet &b) { return a.depth < b.depth; });
      for (std::size_t begin = 0, end = 0; begin < facets.size(); begin = end) {
        PathWriter path;
        for (;
             end < facets.size() && facets[end].colour == facets[begin].colour;
             ++end)
          add_polygon(path, facets[end].corners);
        body += path_element("color=\"" + facets[begin].colour + "\"", path);
      }
    }
    body += "</g>\n";

    // faces: intact below, broken on the two flanks of the crack
    bool any_damaged = options.explain_damaged,
         any_broken = options.explain_broken,
         any_contact = options.explain_contact;
    if (!three_dimensional) {
      const double size = std::max(extent[0], extent[1]);
      const EdgeFinder edges(snapshot, size, projection);
      const unsigned int n_levels = 8;
      // lines closer than a few pixels would only grey the picture
      const bool show_intact =
          scale * scale * extent[0] * extent[1] >
          49. * static_cast<double>(snapshot.polygons.size());
      PathWriter intact, broken, contact;
      std::vector<PathWriter> damaged(n_levels);
      for (const auto &face : snapshot.faces) {
        const Vector a = projection.deformed(face.a, face.displacement_a);
        const Vector b = projection.deformed(face.b, face.displacement_b);
        if (!finite(a) || !finite(b))
          continue;
        const auto draw = [&](PathWriter &path, const Vector &from,
                              const Vector &to) {
          const Vector p = to_pixel(from), q = to_pixel(to);
          path.move(p[0], p[1]);
          path.line(q[0], q[1]);
        };
        const FaceState state = state_of(face);
        any_damaged = any_damaged || state == FaceState::damaged;
        any_broken = any_broken || state == FaceState::broken;
        any_contact = any_contact || state == FaceState::contact;
        if (state == FaceState::contact)
          draw(contact, a, b);
        else if (state == FaceState::broken) {
          const auto &flanks = edges.find(face);
          for (const auto &edge : flanks)
            draw(broken, edge[0], edge[1]);
          if (flanks.empty())
            draw(broken, a, b);
        } else if (state == FaceState::damaged) {
          const auto level = std::min<std::size_t>(
              n_levels - 1,
              static_cast<std::size_t>((1. - face.beta) * n_levels));
          draw(damaged[level], a, b);
        } else if (face.can_break && show_intact)
          draw(intact, a, b);
      }
      body += path_element("class=\"face intact\"", intact);
      for (unsigned int level = 0; level < n_levels; ++level)
        body += path_element(
            fmt::format("class=\"face\" stroke=\"{}\" stroke-width=\"1.3\"",
                        damage_colour((level + 0.5) / n_levels)),
            damaged[level]);
      body += path_element(
          fmt::format("class=\"face\" stroke=\"{}\" stroke-width=\".9\"",
                      broken_colour),
          broken);
      body += path_element(
          fmt::format("class=\"face\" stroke=\"{}\" stroke-width=\"1.6\"",
                      contact_colour),
          contact);
    }
    body += "</svg>\n";

    // scale bar; lengths along an axis are shorter in the isometric view
    double y = top + body_height + 8.;
    const double axis_scale_3d = three_dimensional ? std::sqrt(2. / 3.) : 1.;
    const double length =
        nice_below(0.26 * options.width / (scale * axis_scale_3d));
    const double length_px = length * scale * axis_scale_3d;
    body += line_path("rule", 10., y + 20., 10. + length_px, y + 20.);
    body += text_element(10., y + 36., "name", engineering(length, "m", 1));
    if (three_dimensional) {
      const double x0 = 10. + length_px + 36., y0 = y + 26.;
      const std::array<std::pair<Vector, const char *>, 3> axes = {
          {{{1., 0., 0.}, "x"}, {{0., 1., 0.}, "y"}, {{0., 0., 1.}, "z"}}};
      for (const auto &[axis, name] : axes) {
        const Vector p = projection.to_plane(axis);
        body += line_path("frame", x0, y0, x0 + 16. * p[0], y0 - 16. * p[1]);
        body +=
            text_element(x0 + 24. * p[0], y0 - 24. * p[1] + 4., "mid", name);
      }
    }

    // colour bar
    if (options.colouring != Colouring::fragment) {
      const bool stress = options.colouring == Colouring::stress;
      const UnitScale unit =
          axis_scale(options.colour_max, stress ? "Pa" : "m/s");
      const double bar = 170., x0 = options.width - bar - 16.;
      const unsigned int n_parts = 50;
      body += text_element(
          x0, y + 8., "",
          label_with_unit(stress ? "von Mises stress" : "speed", unit.unit));
      for (unsigned int i = 0; i < n_parts; ++i)
        // each part reaches below the next: no seams
        body += fmt::format(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"9\" fill=\"{}\"/>\n",
            pixel(x0 + bar * i / n_parts), pixel(y + 14.),
            pixel(bar * (i + 1 < n_parts ? 2. : 1.) / n_parts),
            hex(colour_map((i + 0.5) / n_parts)));
      const double top_value =
          options.colour_max > 0. ? options.colour_max / unit.factor : 1.;
      const double step = nice_above(top_value / 4.5);
      const int decimals =
          std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
      const int n_ticks = options.colour_max > 0.
                              ? static_cast<int>(top_value / step + 1e-9)
                              : 0;
      for (int i = 0; i <= n_ticks; ++i) {
        const double x = x0 + bar * i * step / top_value;
        body += line_path("frame", x, y + 23., x, y + 27.);
        body += text_element(
            x, y + 39., "mid",
            i == 0 ? "0" : fmt::format("{:.{}f}", i * step, decimals));
      }
    }
    y += 48.;

    // what the lines mean
    double x = 10.;
    const auto explain = [&](const bool present, const std::string &colour,
                             const std::string &text) {
      if (!present)
        return;
      body += fmt::format("<path class=\"face\" stroke=\"{}\" "
                          "stroke-width=\"2.5\" d=\"M{} {}h16\"/>\n",
                          colour, pixel(x), pixel(y + 6.));
      body += text_element(x + 22., y + 10., "name", text);
      x += 22. + text_width(text, 12.) + 14.;
    };
    explain(any_damaged, damage_colour(0.5), "damaged");
    explain(any_broken, broken_colour, "broken");
    explain(any_contact, contact_colour, "in contact");
    if (any_damaged || any_broken || any_contact)
      y += 18.;

    return svg_document(use, options.width, y, caption, body);
  }
} // namespace nsfd
