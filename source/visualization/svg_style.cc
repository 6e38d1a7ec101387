#include "svg_elements.h"

#include <fmt/format.h>

#include <cctype>
#include <vector>

namespace nsfd
{
  namespace
  {
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
  } // namespace

  const char *name_of(const LineChart::Colour colour)
  {
    return colours[static_cast<std::size_t>(colour)].name;
  }

  std::string svg_file_style()
  {
    return replace_colours(rules + series_rules(), [](const auto &colour) {
      return std::string(colour.light);
    });
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
} // namespace nsfd
