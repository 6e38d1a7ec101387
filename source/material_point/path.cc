#include "path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    constexpr double half_diagonal = 0.70710678118654752440;

    /** A diagonal of the plane of opening and slip. */
    PathMark both(const double size)
    {
      return {size * half_diagonal, size * half_diagonal, 0., 0.};
    }
  } // namespace

  bool NamedPath::presses() const
  {
    return std::any_of(marks.begin(), marks.end(),
                       [](const PathMark &m) { return m.reaction > 0.; });
  }

  const std::vector<NamedPath> &named_paths()
  {
    static const std::vector<NamedPath> paths = {
        {"opening",
         "open halfway, close, open beyond separation",
         {{}, {0.5}, {}, {1.}, {1.1}}},
        {"normal cycle",
         "open, press, open further, close halfway, separate, press, open",
         {{},
          {0.5},
          {},
          {0., 0., 1.},
          {},
          {0.5},
          {2. / 3.},
          {1. / 6.},
          {1.05},
          {},
          {0., 0., 1.},
          {},
          {1. / 3.}}},
        {"shear",
         "slip beyond separation under a constant reaction",
         {{0., 0., 1.}, {0., 1., 1.}, {0., 1.2, 1.}}},
        {"shear cycle",
         "slip forth and back with growing amplitude under a constant reaction",
         {{0., 0., 1.},
          {0., 0.5, 1.},
          {0., -0.5, 1.},
          {0., -2. / 3., 1.},
          {0., 2. / 3., 1.},
          {0., 1., 1.},
          {0., 4. / 3., 1.}}},
        {"mixed",
         "opening and slip in proportion: halfway, back, beyond separation",
         {{}, both(0.5), {}, both(1.), both(1.1)}},
    };
    return paths;
  }

  std::vector<PathMark> scaled(const std::vector<PathMark> &marks,
                               const PathMark &unit)
  {
    std::vector<PathMark> result = marks;
    for (PathMark &mark : result) {
      mark.opening *= unit.opening;
      mark.slip *= unit.slip;
      mark.reaction *= unit.reaction;
    }
    return result;
  }

  std::vector<PathPoint> points_between(std::vector<PathMark> marks,
                                        const PathMark &unit,
                                        const unsigned int n_steps)
  {
    const bool starts_at_zero =
        !marks.empty() && marks[0].opening == 0. && marks[0].slip == 0.;
    if (!starts_at_zero)
      marks.insert(marks.begin(), PathMark());

    std::vector<double> lengths;
    double total = 0.;
    for (std::size_t i = 1; i < marks.size(); ++i) {
      const PathMark &a = marks[i - 1], &b = marks[i];
      // pressing changes nothing at a resting point: it is worth few steps
      lengths.push_back(std::abs(b.opening - a.opening) / unit.opening +
                        std::abs(b.slip - a.slip) / unit.slip +
                        0.05 * std::abs(b.reaction - a.reaction) /
                            unit.reaction);
      total += lengths.back();
    }

    // the first mark is number 0, also where it is not the start
    const double first = starts_at_zero ? 0. : -1.;
    std::vector<PathPoint> points = {{first, marks[0]}};
    for (std::size_t i = 1; i < marks.size(); ++i) {
      const PathMark &a = marks[i - 1], &b = marks[i];
      const double share = total > 0. ? lengths[i - 1] / total : 0.;
      const auto n =
          std::max(1u, static_cast<unsigned int>(std::lround(share * n_steps)));
      for (unsigned int k = 1; k < n; ++k) {
        const double x = double(k) / n;
        points.push_back({first + (i - 1) + x,
                          {a.opening + x * (b.opening - a.opening),
                           a.slip + x * (b.slip - a.slip),
                           a.reaction + x * (b.reaction - a.reaction),
                           a.time + x * (b.time - a.time)}});
      }
      points.push_back({first + i, b});
    }
    return points;
  }

  std::string contradiction(const std::vector<PathPoint> &points)
  {
    for (const PathPoint &point : points) {
      const PathMark &at = point.at;
      if (!std::isfinite(at.opening + at.slip + at.reaction))
        return fmt::format("the path is not finite at {:.6g}", point.path);
      if (at.opening < 0.)
        return fmt::format("u_N = {:.6g} m at {:.6g} of the path: contact "
                           "keeps u_N >= 0",
                           at.opening, point.path);
      if (at.reaction < 0.)
        return fmt::format("the reaction is {:.6g} Pa at {:.6g} of the path: "
                           "contact does not pull",
                           at.reaction, point.path);
      if (at.reaction > 0. && at.opening > 0.)
        return fmt::format("u_N = {:.6g} m under a reaction of {:.6g} Pa at "
                           "{:.6g} of the path: an open point is not pressed",
                           at.opening, at.reaction, point.path);
    }
    return "";
  }
} // namespace nsfd
