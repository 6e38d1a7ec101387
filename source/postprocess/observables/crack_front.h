#pragma once

#include "nsfd/postprocess/observable_input.h"

#include <optional>
#include <vector>

namespace nsfd::observables
{
  /**
   * How far a crack has come and how fast it runs: the point of its broken
   * faces that is farthest along a direction.
   *
   * The tip moves from point to point of the mesh. Its speed is the median of
   * the slopes between any two of the moments in the window at which it moved
   * (Theil and Sen): what a daughter crack far ahead or a pause adds to some
   * of the pairs does not count.
   */
  class CrackFront
  {
  public:
    /** @p must_grow: the scene is to have faces that break. */
    CrackFront(SectionReader &reader, const SceneInput &scene,
               bool must_grow = true);

    /** After every step. Collective. */
    void follow(const RunView &view);

    double length() const { return length_; } ///< m; m^2 in space
    const std::optional<Vector> &tip() const { return tip_; }
    double speed() const;
    /** dD/da of the damage of the scene and the length, J/m^2; NaN: none. */
    double spent() const;

    const Vector &direction() const { return direction_; }
    const std::vector<char> &faces() const { return faces_; }
    /** Points that are broken, as of the last follow(). */
    const std::vector<std::size_t> &broken() const { return broken_; }
    std::string text(const SceneInput &scene) const;
    void serialize(Archive &archive);

  private:
    bool is_broken(const RunView &view, std::size_t point) const;
    void measure(const RunView &view);
    double median_slope(unsigned int x, unsigned int y) const;

    /// time, place along the direction, length, damage of the scene
    using Event = std::array<double, 4>;

    std::vector<char> faces_; ///< per Interface block
    Vector direction_;
    std::optional<double> beta_;   ///< threshold; else that of the law
    std::optional<double> window_; ///< s
    double length_ = 0.;
    std::optional<Vector> tip_;
    std::vector<std::size_t> broken_;
    std::vector<Event> events_;
  };
} // namespace nsfd::observables
