#pragma once

#include "model.h"

#include "nsfd/adaptivity/indicator.h"

#include <cstdint>
#include <vector>

namespace nsfd
{
  /**
   * The points of this rank that carry StrengthSites::looked_at of their
   * strength - intact, held or softening - as indicators see them. Of those
   * that carry less some are looked at, and which depends on the ranks.
   */
  class BreakingFronts
  {
  public:
    /** Both outlive it. */
    BreakingFronts(const SceneInput &input, const Model<2> &model)
        : input_(input), model_(model)
    {
    }

    /** After a step of the length @p h. */
    std::vector<MeshView::Point> all(double h) const;
    /** Those that are nearer to their strength than when they were shown. */
    std::vector<MeshView::Point> new_ones(double h);
    /** Points are others now. */
    void mesh_changed();

  private:
    template <typename Look>
    void for_each(double h, const Look &look) const;
    MeshView::Point front(unsigned int point, double share) const;

    const SceneInput &input_;
    const Model<2> &model_;
    /// by point of the present mesh: hundredths of the strength at which
    /// indicators have been asked
    std::vector<std::uint8_t> asked_;
  };
} // namespace nsfd
