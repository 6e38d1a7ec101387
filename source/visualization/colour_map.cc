#include "colour_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
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
} // namespace nsfd
