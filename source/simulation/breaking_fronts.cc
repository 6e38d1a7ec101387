#include "breaking_fronts.h"

#include "adaptivity/mesh_view.h"
#include "nonsmooth/point_law.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** Of a point that has been released: what it carried in the step of the
        length @p h over the strength that it had. What is left of broken places
        that rest is little. */
    double share_of_strength(const LeapfrogChains<2> &chains, const double h,
                             const std::size_t a)
    {
      const auto &problem = chains.problem;
      const auto *law = problem.interactions[problem.interaction[a]].law.get();
      if (!law || (chains.beta[a] <= 0. && chains.other.beta[a] <= 0.))
        return 0.;
      const double pull = std::max(0., -chains.impulse[2 * a]),
                   slide = chains.impulse[2 * a + 1];
      // impulses are those from the middle of the step before to the next one
      return std::hypot(pull, slide) /
             (problem.weight[a] * 2. * h * law->strength() *
              problem.strength_factor[a]);
    }
  } // namespace

  /** @p look(point, share of its strength). */
  template <typename Look>
  void BreakingFronts::for_each(const double h, const Look &look) const
  {
    const auto parts = model_.leapfrog->parts();
    const auto &problem = parts.stepped;
    const auto with_law = [&](const unsigned int i, const double share) {
      const bool is_own =
          parts.own_points.empty() || parts.own_points[i] != unsigned(-1);
      if (is_own && problem.interactions[problem.interaction[i]].law)
        look(i, share);
    };
    parts.faces.visit_near(with_law);
    const auto &chains = parts.points.chains();
    for (std::size_t a = 0; a < chains.size(); ++a) {
      const double share = share_of_strength(chains, h, a);
      if (share >= StrengthSites<2>::looked_at)
        with_law(chains.point[a], std::min(1., share));
    }
  }

  MeshView::Point BreakingFronts::front(const unsigned int point,
                                        const double share) const
  {
    const auto parts = model_.leapfrog->parts();
    const auto &discretization = parts.discretization;
    MeshView::Point result;
    for (unsigned int c = 0; c < 2; ++c)
      result.position[c] = discretization.points().position[2 * point + c];
    result.utilisation = share;
    result.zone =
        cohesive_zone<2>(input_, discretization, parts.stepped, point);
    return result;
  }

  std::vector<MeshView::Point> BreakingFronts::all(const double h) const
  {
    std::vector<MeshView::Point> result;
    for_each(h, [&](const unsigned int i, const double share) {
      result.push_back(front(i, share));
    });
    return result;
  }

  std::vector<MeshView::Point> BreakingFronts::new_ones(const double h)
  {
    std::vector<MeshView::Point> result;
    for_each(h, [&](const unsigned int i, const double share) {
      const auto level = std::uint8_t(std::min(100., 100. * share));
      if (level <= asked_[i])
        return;
      asked_[i] = level;
      result.push_back(front(i, share));
    });
    return result;
  }

  void BreakingFronts::mesh_changed()
  {
    asked_.assign(model_.leapfrog->parts().discretization.points().n_points, 0);
  }
} // namespace nsfd
