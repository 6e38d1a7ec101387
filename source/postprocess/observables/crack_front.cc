#include "crack_front.h"

#include "nsfd/core/archive.h"

#include <fmt/format.h>

#include <array>
#include <limits>

namespace nsfd::observables
{
  CrackFront::CrackFront(SectionReader &reader, const SceneInput &scene,
                         const bool must_grow)
      : faces_(read_crack_faces(reader, scene, must_grow)),
        direction_(read_direction(reader, scene))
  {
    if (reader.optional("threshold", "beta up to which a point counts; by "
                                     "default where the law has ended"))
      beta_ = reader.number("threshold", "", units::none, Range::closed(0., 1.),
                            "");
    if (reader.optional("window", "s, for the speed; by default the way of a "
                                  "wave through twenty cells"))
      window_ = reader.number("window", "", units::time, Range::positive(), "");
  }

  bool CrackFront::is_broken(const RunView &view, const std::size_t i) const
  {
    const PointOrigin origin = view.points()[i].origin;
    return origin.kind == PointOrigin::Kind::interface &&
           faces_[origin.block] &&
           view.beta(i) <= beta_.value_or(view.broken_beta(i));
  }

  void CrackFront::measure(const RunView &view)
  {
    const auto &points = view.points();
    const double none = -std::numeric_limits<double>::max();
    std::vector<double> areas;
    double farthest = none;
    std::vector<Vector> first;
    broken_.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!is_broken(view, i))
        continue;
      broken_.push_back(i);
      areas.push_back(points[i].area);
      for (const Vector &end : points[i].ends) {
        const double along = product(end, direction_);
        if (along > farthest)
          first.clear();
        if (along >= farthest)
          first.push_back(end);
        farthest = std::max(farthest, along);
      }
    }
    length_ = view.sums(areas, 1)[0];
    const double along = view.max(farthest);
    tip_.reset();
    if (along == none)
      return;
    // of several the first by its coordinates, on any number of ranks
    const double last = std::numeric_limits<double>::max();
    if (farthest < along)
      first.clear();
    Vector tip{};
    for (unsigned int c = 0; c < 3; ++c) {
      double smallest = last;
      for (const Vector &end : first)
        smallest = std::min(smallest, end[c]);
      tip[c] = view.min(smallest);
      first.erase(
          std::remove_if(first.begin(), first.end(),
                         [&](const Vector &end) { return end[c] > tip[c]; }),
          first.end());
    }
    tip_ = tip;
  }

  void CrackFront::follow(const RunView &view)
  {
    measure(view);
    const double window = window_.value_or(20. * view.crossing_time());
    events_.erase(events_.begin(), std::find_if(events_.begin(), events_.end(),
                                                [&](const Event &event) {
                                                  return event[0] >=
                                                         view.time() - window;
                                                }));
    if (!tip_)
      return;
    const double along = product(*tip_, direction_);
    if (events_.empty() || along > events_.back()[1])
      events_.push_back(
          {{view.time(), along, length_, view.row().energy.damage}});
  }

  double CrackFront::median_slope(const unsigned int x,
                                  const unsigned int y) const
  {
    constexpr std::size_t most = 64;
    const std::size_t n = std::min(events_.size(), most);
    const auto event = [&](const std::size_t k) {
      return events_[n < 2 ? k : k * (events_.size() - 1) / (n - 1)];
    };
    std::vector<double> slopes;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (event(a)[x] > event(b)[x])
          slopes.push_back((event(a)[y] - event(b)[y]) /
                           (event(a)[x] - event(b)[x]));
    if (slopes.empty())
      return std::numeric_limits<double>::quiet_NaN();
    const auto middle = slopes.begin() + long(slopes.size() / 2);
    std::nth_element(slopes.begin(), middle, slopes.end());
    if (slopes.size() % 2 == 1)
      return *middle;
    return 0.5 * (*middle + *std::max_element(slopes.begin(), middle));
  }

  double CrackFront::speed() const
  {
    const double slope = median_slope(0, 1);
    return std::isnan(slope) ? 0. : slope;
  }

  double CrackFront::spent() const { return median_slope(2, 3); }

  std::string CrackFront::text(const SceneInput &scene) const
  {
    std::string names;
    for (std::size_t b = 0; b < faces_.size(); ++b)
      if (faces_[b])
        names += (names.empty() ? "" : ", ") + scene.interfaces[b].name;
    return fmt::format(
        "broken faces of {}, along ({:.4g}, {:.4g}{})", names, direction_[0],
        direction_[1],
        scene.dimension == 3 ? fmt::format(", {:.4g}", direction_[2]) : "");
  }

  void CrackFront::serialize(Archive &archive)
  {
    std::vector<double> numbers;
    for (const Event &event : events_)
      numbers.insert(numbers.end(), event.begin(), event.end());
    archive.common("events", numbers);
    events_.clear();
    for (std::size_t k = 0; k + 3 < numbers.size(); k += 4)
      events_.push_back(
          {{numbers[k], numbers[k + 1], numbers[k + 2], numbers[k + 3]}});
  }
} // namespace nsfd::observables
