#pragma once

#include "svg.h"

#include <array>
#include <string>

namespace nsfd
{
  /** The class of a series in the style of the pictures. */
  const char *name_of(LineChart::Colour colour);

  /** The rules of svg_style() with the light colours put in. */
  std::string svg_file_style();

  /** An upper estimate in pixels, for fonts of the usual width. */
  double text_width(const std::string &text, double font_size);

  /** "label (unit)" */
  std::string label_with_unit(const std::string &label,
                              const std::string &unit);

  /** A length to two digits, without zeros at the end. */
  std::string pixel(double x);

  /** Path data: relative, rounded to 0.01 px without accumulating. */
  class PathWriter
  {
  public:
    void move(double x, double y);
    void line(double x, double y);
    void close();

    const std::string &text() const { return text_; }

  private:
    using Pair = std::array<long, 2>;
    static Pair rounded(double x, double y);
    static std::string number(long hundredths);
    static std::string joined(const Pair &pair);
    void append(char command, const std::string &numbers);

    std::string text_;
    Pair at_{}, start_{};
    char command_ = 0;
  };

  std::string text_element(double x, double y, const char *classes,
                           const std::string &text);

  /** Nothing if the path is empty. */
  std::string path_element(const std::string &attributes,
                           const PathWriter &path);

  std::string line_path(const char *classes, double x1, double y1, double x2,
                        double y2);

  /** The whole picture; a file brings its own style. */
  std::string svg_document(SvgUse use, double width, double height,
                           const std::string &label,
                           const std::string &content);
} // namespace nsfd
