#include "rose.h"

#include "svg_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    constexpr double pi = 3.14159265358979323846;
    constexpr double side = 400., radius = 145.;

    /** 1, 2 or 5 times a power of ten, about a third of @p largest. */
    double round_step(const double largest)
    {
      const double third = largest / 3.;
      const double power = std::pow(10., std::floor(std::log10(third)));
      for (const double digit : {1., 2., 5.})
        if (third <= digit * power)
          return digit * power;
      return 10. * power;
    }

    /** From polar coordinates about the centre of the picture to pixels. */
    class PolarMap
    {
    public:
      explicit PolarMap(const double largest)
          : scale_(radius / largest), y_(side / 2. + 20.)
      {
      }
      double x(const double r, const double angle) const
      {
        return side / 2. + scale_ * r * std::cos(angle);
      }
      double y(const double r, const double angle) const
      {
        return y_ - scale_ * r * std::sin(angle);
      }

      /** Once round through all of these. */
      template <typename Radius>
      void closed(PathWriter &path, const std::vector<double> &angles,
                  const Radius &radius_of, const bool backwards = false) const
      {
        const std::size_t n = angles.size();
        for (std::size_t k = 0; k < 2 * n; ++k) {
          const std::size_t j = backwards ? 2 * n - 1 - k : k, i = j % n;
          const double angle = angles[i] * pi / 180. + (j < n ? 0. : pi);
          const double r = radius_of(i);
          k == 0 ? path.move(x(r, angle), y(r, angle))
                 : path.line(x(r, angle), y(r, angle));
        }
        path.close();
      }

    private:
      double scale_, y_;
    };

    std::vector<double> whole_degrees()
    {
      std::vector<double> angles;
      for (int i = 0; i < 60; ++i)
        angles.push_back(3. * i);
      return angles;
    }
  } // namespace

  std::string rose_picture(const Rose &rose, const SvgUse use)
  {
    std::string body = text_element(8., 18., "title", rose.title);
    const double height = side - 4.;
    double largest = 0.;
    for (std::size_t i = 0; i < rose.values.size(); ++i)
      largest = std::max(largest, rose.values[i] + rose.scatter[i] - 1.);
    if (!(largest > 0.)) {
      body += text_element(side / 2., side / 2., "mid",
                           "no way is longer than the straight one");
      return svg_document(use, side, height, rose.title, body);
    }
    const double step = round_step(largest);
    const PolarMap map(step * std::ceil(largest / step));
    PathWriter circles, band, curve, mean;
    for (double r = step; r < (std::ceil(largest / step) + .5) * step;
         r += step) {
      map.closed(circles, whole_degrees(), [&](std::size_t) { return r; });
      body += text_element(map.x(r, pi / 2.) + 4., map.y(r, pi / 2.) - 3., "",
                           fmt::format("{:g}", 1. + r));
    }
    for (int i = 0; i < 6; ++i) {
      const double angle = pi * i / 6.;
      const double r = step * std::ceil(largest / step);
      circles.move(map.x(-r, angle), map.y(-r, angle));
      circles.line(map.x(r, angle), map.y(r, angle));
    }
    map.closed(band, rose.angles, [&](const std::size_t i) {
      return std::max(0., rose.values[i] + rose.scatter[i] - 1.);
    });
    map.closed(
        band, rose.angles,
        [&](const std::size_t i) {
          return std::max(0., rose.values[i] - rose.scatter[i] - 1.);
        },
        true);
    map.closed(curve, rose.angles, [&](const std::size_t i) {
      return std::max(0., rose.values[i] - 1.);
    });
    map.closed(mean, whole_degrees(),
               [&](std::size_t) { return std::max(0., rose.mean - 1.); });
    body += path_element("class=\"fill-sky\" fill-opacity=\"0.35\"", band);
    body += path_element("class=\"grid\"", circles);
    body += path_element("class=\"curve grey dash\"", mean);
    body += path_element("class=\"curve blue\"", curve);
    body += text_element(
        8., 38., "",
        fmt::format("{}; mean {:.4f} (dashed)", rose.what, rose.mean));
    return svg_document(use, side, height, rose.title, body);
  }
} // namespace nsfd
