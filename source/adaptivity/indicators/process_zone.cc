#include "nsfd/adaptivity/indicator.h"
#include "nsfd/parameters/section_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

namespace nsfd
{
  namespace
  {
    /** Places with their zones, in boxes that are small against the way that
        is looked around. */
    class Fronts
    {
    public:
      using Front = std::array<double, 4>; ///< place and zone, m

      Fronts(const std::vector<double> &numbers, const double reach)
          : reach_(reach), fronts_(numbers.size() / 4)
      {
        std::array<double, 3> highest{};
        for (std::size_t k = 0; k < fronts_.size(); ++k) {
          std::copy_n(&numbers[4 * k], 4, fronts_[k].begin());
          largest_ = std::max(largest_, fronts_[k][3]);
          for (unsigned int c = 0; c < 3; ++c) {
            const double x = fronts_[k][c];
            lowest_[c] = k == 0 ? x : std::min(lowest_[c], x);
            highest[c] = k == 0 ? x : std::max(highest[c], x);
          }
        }
        width_ = reach * largest_ / 4.;
        std::size_t n = 1;
        const auto set_sizes = [&] {
          n = 1;
          for (unsigned int c = 0; c < 3; ++c) {
            size_[c] = std::size_t((highest[c] - lowest_[c]) / width_) + 1;
            n *= size_[c];
          }
        };
        for (set_sizes(); n > 64 + 8 * fronts_.size(); set_sizes())
          width_ *= 2.;
        first_.assign(n + 1, 0);
        std::sort(fronts_.begin(), fronts_.end(),
                  [&](const Front &a, const Front &b) {
                    return std::pair(box_of(a), a) < std::pair(box_of(b), b);
                  });
        for (const Front &front : fronts_)
          ++first_[box_of(front) + 1];
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
      }

      /** All that may be nearer than their reach and @p own, until @p visit
          says that it has seen enough. */
      template <typename Visit>
      void visit(const std::array<double, 3> &centre, const double own,
                 const Visit &visit) const
      {
        const double near = reach_ * largest_ + own;
        std::array<std::size_t, 3> begin{}, end{};
        for (unsigned int c = 0; c < 3; ++c) {
          const double low = (centre[c] - near - lowest_[c]) / width_,
                       high = (centre[c] + near - lowest_[c]) / width_;
          if (!(high >= 0. && low < double(size_[c])))
            return;
          begin[c] = std::size_t(std::max(0., low));
          end[c] = std::size_t(std::min(double(size_[c]), high + 1.));
        }
        for (std::size_t z = begin[2]; z < end[2]; ++z)
          for (std::size_t y = begin[1]; y < end[1]; ++y) {
            const std::size_t row = (z * size_[1] + y) * size_[0];
            for (std::size_t k = first_[row + begin[0]];
                 k < first_[row + end[0]]; ++k)
              if (visit(fronts_[k]))
                return;
          }
      }

    private:
      std::size_t box_of(const Front &front) const
      {
        std::size_t box = 0;
        for (unsigned int c = 3; c-- > 0;)
          box = box * size_[c] + std::size_t((front[c] - lowest_[c]) / width_);
        return box;
      }

      double reach_;
      std::vector<Front> fronts_;
      std::vector<std::size_t> first_; ///< of a box, x first; size n + 1
      std::array<double, 3> lowest_{};
      std::array<std::size_t, 3> size_{};
      double largest_ = 0., width_ = 1.;
    };

    /**
     * Around the points that soften or are near their strength, cells are at
     * most L_czm / r long, L_czm = 9 pi/32 E' G / R_max^2 the cohesive zone of
     * a crack at rest (Rice 1968, in the form of Palmer & Rice 1973): as far as
     * a cohesive zone reaches, so that the front finds them when it comes.
     * Cells near points that carry half as much stay as they are: waves do not
     * make them come and go.
     */
    class ProcessZone final : public Indicator
    {
    public:
      explicit ProcessZone(SectionReader &reader)
          : cells_(reader.number("cells", "4", units::none, Range::positive(),
                                 "r: cells along the cohesive zone")),
            traction_(reader.number("traction", "0.7", units::none,
                                    {0., 1., true, true},
                                    "of the strength, where the zone begins")),
            reach_(reader.number("reach", "1", units::none,
                                 Range::non_negative(),
                                 "in cohesive zones around such a point"))
      {
      }

      void limit(const MeshView &view, std::vector<double> &size) const override
      {
        const auto &bodies = view.bodies();
        for_near(
            view, traction_,
            [&](const std::size_t b, const double zone) {
              return zone / cells_ < size[b];
            },
            [&](const std::size_t b, const double zone) {
              size[b] = zone / cells_;
            });
        for_near(
            view, traction_ / 2.,
            [&](const std::size_t b, double) {
              return bodies[b].size < size[b];
            },
            [&](const std::size_t b, double) { size[b] = bodies[b].size; });
      }

      bool is_of_points() const override { return true; }

    private:
      /** @p visit (body, zone) near points that carry at least a share, where
          @p asks (body, zone). */
      template <typename Asks, typename Visit>
      void for_near(const MeshView &view, const double share, const Asks &asks,
                    const Visit &visit) const
      {
        // points of a few cells tell the same: the middle of a box of a quarter
        // of a zone stands for them, which does not know the ranks
        std::set<std::array<double, 4>> boxes;
        for (const auto &point : view.points()) {
          if (point.broken || point.utilisation < share)
            continue;
          std::array<double, 4> box{};
          for (unsigned int c = 0; c < 3; ++c)
            box[c] = std::round(4. * point.position[c] / point.zone) *
                     point.zone / 4.;
          box[3] = point.zone;
          boxes.insert(box);
        }
        std::vector<double> here;
        for (const auto &box : boxes)
          here.insert(here.end(), box.begin(), box.end());
        const std::vector<double> all = view.gather(here);
        if (all.empty())
          return;
        const auto &bodies = view.bodies();
        double smallest_zone = all[3];
        for (std::size_t k = 3; k < all.size(); k += 4)
          smallest_zone = std::min(smallest_zone, all[k]);
        // the cell itself may be much larger than the zone
        const double reach = reach_ + 0.25, own = 0.75;
        const Fronts fronts(all, reach);
        for (std::size_t b = 0; b < bodies.size(); ++b) {
          if (!asks(b, smallest_zone)) // nor does a larger one
            continue;
          const double of_body = own * bodies[b].size;
          fronts.visit(bodies[b].centre, of_body,
                       [&](const Fronts::Front &front) {
                         if (!asks(b, front[3]))
                           return false;
                         const double near = reach * front[3] + of_body;
                         double square = 0.;
                         for (unsigned int c = 0; c < 3; ++c) {
                           const double d = bodies[b].centre[c] - front[c];
                           square += d * d;
                         }
                         if (!(square < near * near))
                           return false;
                         visit(b, front[3]);
                         return front[3] == smallest_zone;
                       });
        }
      }

      double cells_, traction_, reach_;
    };

    NSFD_REGISTER(IndicatorRegistry, ProcessZone, "process zone",
                  "Cells resolve the cohesive zone around breaking points",
                  "cells = 4");
  } // namespace
} // namespace nsfd
