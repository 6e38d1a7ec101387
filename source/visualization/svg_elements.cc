#include "svg_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
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

  std::string label_with_unit(const std::string &label, const std::string &unit)
  {
    return unit.empty() ? label : label + " (" + unit + ")";
  }

  std::string pixel(const double x)
  {
    std::string text = fmt::format("{:.2f}", x);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.')
      text.pop_back();
    return text == "-0" ? "0" : text;
  }

  void PathWriter::move(const double x, const double y)
  {
    const Pair target = rounded(x, y);
    // the first one counts from the origin, and lines may follow it
    text_ += "m" + joined({target[0] - at_[0], target[1] - at_[1]});
    at_ = start_ = target;
    command_ = 'm';
  }

  void PathWriter::line(const double x, const double y)
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

  void PathWriter::close()
  {
    text_ += 'z';
    at_ = start_;
    command_ = 'z';
  }

  PathWriter::Pair PathWriter::rounded(const double x, const double y)
  {
    const auto hundredths = [](const double value) {
      return std::lround(100. * std::clamp(value, -1e5, 1e5));
    };
    return {hundredths(x), hundredths(y)};
  }

  std::string PathWriter::number(const long hundredths)
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

  std::string PathWriter::joined(const Pair &pair)
  {
    return number(pair[0]) + (pair[1] < 0 ? "" : " ") + number(pair[1]);
  }

  void PathWriter::append(const char command, const std::string &numbers)
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

  std::string text_element(const double x, const double y, const char *classes,
                           const std::string &text)
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
          pixel(width), pixel(height), escape_markup(label), svg_file_style());
    else
      text = fmt::format("<svg class=\"nsfd\" viewBox=\"0 0 {} {}\" "
                         "role=\"img\" aria-label=\"{}\">\n",
                         pixel(width), pixel(height), escape_markup(label));
    return text + content + "</svg>\n";
  }
} // namespace nsfd
