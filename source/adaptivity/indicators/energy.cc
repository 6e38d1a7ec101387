#include "nsfd/adaptivity/indicator.h"
#include "nsfd/parameters/section_reader.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /**
     * Kinetic and elastic energy spread evenly: a cell with more than `factor`
     * times the mean per cell is halved, one with less than that over 2^(dim+2)
     * may grow: together with its siblings it stays well below the limit.
     */
    class Energy final : public Indicator
    {
    public:
      explicit Energy(SectionReader &reader)
          : factor_(reader.number("factor", "4", units::none, Range::positive(),
                                  "of the mean energy per cell above which a "
                                  "cell is refined"))
      {
      }

      void limit(const MeshView &view, std::vector<double> &size) const override
      {
        const auto &energy = view.energy();
        const auto &bodies = view.bodies();
        const double mean =
            view.sum(energy) /
            std::max(1., view.sum(std::vector<double>(bodies.size(), 1.)));
        if (!(mean > 0.))
          return;
        for (std::size_t b = 0; b < bodies.size(); ++b)
          if (energy[b] > factor_ * mean)
            size[b] = std::min(size[b], bodies[b].size / 2.);
          else if (energy[b] > factor_ * mean / 32.)
            size[b] = std::min(size[b], bodies[b].size);
      }

    private:
      double factor_;
    };

    NSFD_REGISTER(IndicatorRegistry, Energy, "energy",
                  "Cells with much kinetic and elastic energy are refined",
                  "factor = 4");
  } // namespace
} // namespace nsfd
