#include "nsfd/adaptivity/indicator.h"
#include "nsfd/parameters/section_reader.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /** Cells whose centre lies in a fixed region have at most a given size. */
    class Region final : public Indicator
    {
    public:
      explicit Region(SectionReader &reader)
          : where_(reader.expression("region", "", units::none,
                                     "condition of x, y, z that holds there")),
            size_(reader.number("cell size", "", units::length,
                                Range::positive(),
                                "largest edge of a cell there"))
      {
        if (where_.depends_on_time())
          reader.error("region", "a region does not depend on t",
                       "write a condition of x, y, z");
      }

      void limit(const MeshView &view, std::vector<double> &size) const override
      {
        const auto &bodies = view.bodies();
        for (std::size_t b = 0; b < bodies.size(); ++b) {
          const auto &x = bodies[b].centre;
          if (where_(x[0], x[1], x[2]) != 0.)
            size[b] = std::min(size[b], size_);
        }
      }

      bool is_fixed() const override { return true; }

    private:
      Expression where_;
      double size_;
    };

    NSFD_REGISTER(IndicatorRegistry, Region, "region",
                  "A given size where a condition of x, y, z holds",
                  "region = x < 1 mm; cell size = 0.1 mm");
  } // namespace
} // namespace nsfd
