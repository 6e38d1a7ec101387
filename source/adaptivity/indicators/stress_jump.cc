#include "nsfd/adaptivity/indicator.h"
#include "nsfd/parameters/section_reader.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /**
     * The jump of the mean stress over a face is the error of linear cells:
     * above a share of the largest one a cell is refined, so that the rest is
     * below it on every mesh; or above a stress, if one is given.
     */
    class StressJump final : public Indicator
    {
    public:
      explicit StressJump(SectionReader &reader)
          : share_(reader.number("share", "0.3", units::none,
                                 {0., 1., true, true},
                                 "of the largest jump, above which a cell is "
                                 "refined"))
      {
        if (reader.optional("jump", "of the stress above which a cell is "
                                    "refined, in place of a share"))
          jump_ = reader.number("jump", "", units::pressure, Range::positive(),
                                "of the stress above which a cell is refined");
      }

      void limit(const MeshView &view, std::vector<double> &size) const override
      {
        const auto &jump = view.stress_jump();
        const auto &bodies = view.bodies();
        double limit = jump_;
        if (limit == 0.) {
          for (const double value : jump)
            limit = std::max(limit, value);
          limit = share_ * view.max(limit);
        }
        if (!(limit > 0.))
          return;
        for (std::size_t b = 0; b < bodies.size(); ++b)
          if (jump[b] > limit)
            size[b] = std::min(size[b], bodies[b].size / 2.);
          else if (jump[b] > limit / 4.) // coarser cells jump twice as far
            size[b] = std::min(size[b], bodies[b].size);
      }

    private:
      double share_, jump_ = 0.;
    };

    NSFD_REGISTER(IndicatorRegistry, StressJump, "stress jump",
                  "Cells are refined where the stress jumps across faces",
                  "share = 0.3");
  } // namespace
} // namespace nsfd
