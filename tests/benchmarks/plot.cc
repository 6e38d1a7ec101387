// Draws columns of a table of tables.sh as curves over logarithmic axes:
//   nsfd_plot TABLE.csv X Y "title" "label of x" "label of y" > PICTURE.svg
// The first column names the curve of a row. Curves whose names agree up to
// their first semicolon share a colour; the first is solid, others are dashed.

#include "visualization/svg.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

using nsfd::LineChart;

namespace
{
  struct Curve {
    std::string name;
    std::vector<std::pair<double, double>> points;
  };

  [[noreturn]] void fail(const std::string &message)
  {
    std::cerr << "nsfd_plot: " << message << "\n";
    std::exit(2);
  }

  std::vector<std::string> cells_of(const std::string &line)
  {
    std::vector<std::string> cells;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');)
      cells.push_back(cell);
    return cells;
  }

  std::size_t column(const std::vector<std::string> &head,
                     const std::string &name)
  {
    const auto found = std::find(head.begin(), head.end(), name);
    if (found == head.end())
      fail("no column `" + name + "`");
    return found - head.begin();
  }

  double number(const std::string &text)
  {
    char *end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0')
      fail("`" + text + "` is not a number");
    return value;
  }

  std::vector<Curve> read(const std::string &file, const std::string &x,
                          const std::string &y)
  {
    std::ifstream stream(file);
    std::string line;
    if (!std::getline(stream, line))
      fail("cannot read " + file);
    const auto head = cells_of(line);
    const std::size_t i = column(head, x), j = column(head, y);
    std::vector<Curve> curves;
    while (std::getline(stream, line)) {
      const auto cells = cells_of(line);
      if (cells.size() != head.size())
        fail("a row has not as many cells as the head: " + line);
      auto at = std::find_if(curves.begin(), curves.end(),
                             [&](const auto &c) { return c.name == cells[0]; });
      if (at == curves.end())
        at = curves.insert(curves.end(), {cells[0], {}});
      at->points.emplace_back(number(cells[i]), number(cells[j]));
    }
    for (auto &curve : curves)
      std::sort(curve.points.begin(), curve.points.end());
    return curves;
  }

  std::string stem(const std::string &name)
  {
    return name.substr(0, name.find(';'));
  }
} // namespace

int main(int argc, char **argv)
{
  if (argc != 7)
    fail("six arguments: TABLE.csv X Y \"title\" \"label of x\" "
         "\"label of y\"");
  LineChart chart(argv[4], {argv[5], "", true}, {argv[6], "", true});
  std::vector<std::string> stems;
  for (const auto &curve : read(argv[1], argv[2], argv[3])) {
    std::vector<double> x, y;
    for (const auto &point : curve.points) {
      x.push_back(point.first);
      y.push_back(point.second);
    }
    auto at = std::find(stems.begin(), stems.end(), stem(curve.name));
    const bool dashed = at != stems.end();
    const auto colour = static_cast<unsigned int>(at - stems.begin());
    if (!dashed)
      stems.push_back(stem(curve.name));
    std::string name = curve.name;
    std::replace(name.begin(), name.end(), ';', ',');
    chart.add_line(name, x, y, LineChart::palette(colour), dashed);
  }
  std::cout << chart.svg(nsfd::SvgUse::file);
}
