#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace end_to_end
{
  namespace test_ductile
  {
    constexpr double V = 0.03, t1 = 120., R = 50.;

    struct Resistance {
      std::vector<double> advance, release; ///< over R_0, over the toughness
      /** Where the crack has first gone so far. */
      double at(const double a) const
      {
        const auto first = std::lower_bound(advance.begin(), advance.end(), a);
        EXPECT_NE(first, advance.end()) << "it does not come so far";
        return first == advance.end() ? 0. : release[first - advance.begin()];
      }
    };

    /** prm/reference/ductile.prm with fewer cells, longer steps and twice the
     * speed, as tests/benchmarks/resistance.awk reads it. */
    Resistance resistance(const Workspace &workspace, const std::string &name,
                          const double yield, const double ratio,
                          const double top)
    {
      const auto number = [](const double x) { return std::to_string(x); };
      const Launch launch{
          prm_folder() / "reference" / "ductile.prm",
          {with_mesh("ductile_coarse.geo"), "Constants/s=0.16",
           "Constants/V=" + number(V), "Constants/t1=" + number(t1),
           "Constants/ratio=" + number(ratio), "Constants/top=" + number(top),
           "Material: near/yield stress=" + number(yield),
           "Material: metal/yield stress=" + number(yield),
           "Material: around/shear viscosity=0.1 * mu",
           "Material: around/bulk viscosity=0.1 * E", "Time/end=180"}};
      const Result result = good_run(workspace, name, launch);
      Resistance found;
      if (!result.completed())
        return found;
      const History &rows = result.history;
      const double toughness = 3. * std::acos(-1.) * 0.91 * 0.003;
      double defect = 0.;
      for (std::size_t k = 0; k < rows.size(); ++k) {
        defect = std::max(defect, std::abs(rows["ledger_defect"][k]));
        const double X = V * (rows["time"][k] - t1),
                     a = rows["damage"][k] / (toughness / 2.);
        if (X < 0.)
          continue;
        found.advance.push_back(a);
        found.release.push_back((1. + (top - 1.) * (1. - std::exp(-X))) *
                                (1. - (a - X) / R));
      }
      expect_below("energy balance of " + name, defect, 1e-9, "certificate");
      EXPECT_EQ(rows["plastic"].back() > 0., yield == 1.);
      return found;
    }
  } // namespace test_ductile

  /**
   * Without flow all that is released breaks the line. What a crack of the
   * speed v needs is larger by v/c_R at most (Freund 1990), c_R > 0.49 c_p for
   * a Poisson ratio of 0.3; the correction for the outer side is of first
   * order in the way over R, and the tip is somewhere in the cohesive zone,
   * which is 9 pi/32 3 pi/ratio^2 long. A stronger line lets more of the
   * metal flow, and costs more.
   */
  TEST(Ductile, ResistanceGrowsWithTheStrength)
  {
    using namespace test_ductile;
    constexpr double way = 1.; // all have left the start behind
    const Workspace workspace;
    const double elastic =
        resistance(workspace, "elastic", 1e3, 2., 1.).at(way);
    const double zone = 9. * std::acos(-1.) / 32. * 3. * std::acos(-1.) / 4.;
    expect_below("elastic, from 1", std::abs(elastic - 1.), V / 0.49 + zone / R,
                 "inertia, tip");
    const double low = resistance(workspace, "2", 1., 2., 1.1).at(way),
                 high = resistance(workspace, "2.25", 1., 2.25, 1.35).at(way);
    EXPECT_GT(low, elastic);
    EXPECT_GT(high, low);
  }
} // namespace end_to_end
