#include "chart_axis.h"
#include "picture_values.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace nsfd
{
  PictureOptions picture_options(const std::vector<Snapshot> &snapshots,
                                 const PictureOptions::Colouring colouring)
  {
    PictureOptions options;
    options.colouring = colouring;

    Box reference;
    double largest_displacement = 0.;
    std::vector<double> values;
    for (const auto &snapshot : snapshots) {
      const Vector3 mean = mean_displacement(snapshot);
      for (const auto &polygon : snapshot.polygons) {
        for (const auto &x : polygon.reference)
          if (is_finite(x))
            reference.add(x);
        for (const auto &u : polygon.displacement)
          if (is_finite(u))
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
          if (is_finite(x))
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
} // namespace nsfd
