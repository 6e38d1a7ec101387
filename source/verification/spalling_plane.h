#pragma once

#include "nsfd/verification/case_input.h"

#include <algorithm>
#include <vector>

namespace nsfd::cases
{
  /**
   * A cohesive plane in a bar of impedance Z, hit by a step of tension sigma:
   *
   *   [u]' = 2 (sigma - T([u])) / Z,   [u](0) = 0,
   *
   * until other waves arrive. It breaks only if sigma is above the strength.
   */
  class SpallingPlane
  {
  public:
    SpallingPlane() = default;

    SpallingPlane(const CohesiveLaw &law, const double stress,
                  const double impedance)
    {
      const double last = law.final_opening();
      demand(std::isfinite(last), "the plane needs a law that breaks");
      demand(stress > law.strength(), "the tension must exceed the strength");
      times_ = {0.};
      const double step = last / n_steps;
      for (unsigned int i = 0; i < n_steps; ++i) {
        const double traction = law.traction((i + 0.5) * step);
        tractions_.push_back(traction);
        times_.push_back(times_.back() +
                         impedance * step / (2. * (stress - traction)));
        impulse_ += traction * (times_.back() - times_[i]);
      }
    }

    /** From the arrival of the step until the plane is broken. */
    double duration() const { return times_.back(); }

    /** Of the traction per area, until the plane is broken. */
    double impulse() const { return impulse_; }

    /** At a time since the arrival of the step. */
    double traction(const double t) const
    {
      if (t < 0. || t >= duration())
        return 0.;
      const auto next = std::upper_bound(times_.begin(), times_.end(), t);
      return tractions_[std::size_t(next - times_.begin()) - 1];
    }

  private:
    static constexpr unsigned int n_steps = 2000;
    std::vector<double> times_, tractions_;
    double impulse_ = 0.;
  };

  /** Where neighbouring cells of a bar along an axis are farthest apart. */
  inline double place_of_gap(const std::vector<CellState> &cells,
                             const unsigned int d)
  {
    std::vector<std::array<double, 2>> line; // position, displacement
    for (const CellState &cell : cells)
      line.push_back({cell.centre[d], cell.displacement[d]});
    std::sort(line.begin(), line.end());
    double gap = 0., place = 0.;
    for (std::size_t i = 1; i < line.size(); ++i)
      if (line[i][1] - line[i - 1][1] > gap) {
        gap = line[i][1] - line[i - 1][1];
        place = 0.5 * (line[i][0] + line[i - 1][0]);
      }
    return place;
  }
} // namespace nsfd::cases
