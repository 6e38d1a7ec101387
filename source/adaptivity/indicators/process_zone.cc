#include "nsfd/adaptivity/indicator.h"
#include "nsfd/parameters/section_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace nsfd
{
  namespace
  {
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
        for_near(view, traction_, [&](const std::size_t b, const double zone) {
          size[b] = std::min(size[b], zone / cells_);
        });
        for_near(view, traction_ / 2., [&](const std::size_t b, double) {
          size[b] = std::min(size[b], bodies[b].size);
        });
      }

      bool is_of_points() const override { return true; }

    private:
      /** @p visit (body, zone) near points that carry at least a share. */
      template <typename Visit>
      void for_near(const MeshView &view, const double share,
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
        std::vector<std::array<double, 4>> fronts(all.size() / 4);
        double largest = 0.;
        for (std::size_t k = 0; k < fronts.size(); ++k) {
          std::copy_n(&all[4 * k], 4, fronts[k].begin());
          largest = std::max(largest, fronts[k][3]);
        }
        std::sort(fronts.begin(), fronts.end());

        const auto &bodies = view.bodies();
        for (std::size_t b = 0; b < bodies.size() && !fronts.empty(); ++b) {
          const auto &centre = bodies[b].centre;
          // the cell itself may be much larger than the zone
          const auto reach_of = [&](const double zone) {
            return (reach_ + 0.25) * zone + 0.75 * bodies[b].size;
          };
          const double furthest = reach_of(largest);
          const auto left_of = [](const auto &front, const double x) {
            return front[0] < x;
          };
          for (auto front = std::lower_bound(fronts.begin(), fronts.end(),
                                             centre[0] - furthest, left_of);
               front != fronts.end() && (*front)[0] <= centre[0] + furthest;
               ++front) {
            const double near = reach_of((*front)[3]);
            double square = 0.;
            for (unsigned int c = 0; c < 3; ++c) {
              const double d = centre[c] - (*front)[c];
              square += d * d;
            }
            if (square < near * near)
              visit(b, (*front)[3]);
          }
        }
      }

      double cells_, traction_, reach_;
    };

    NSFD_REGISTER(IndicatorRegistry, ProcessZone, "process zone",
                  "Cells resolve the cohesive zone around breaking points",
                  "cells = 4");
  } // namespace
} // namespace nsfd
