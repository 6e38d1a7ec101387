#pragma once

#include "delassus_operator.h"
#include "linear_algebra/simd_kernels.h"

#include <array>
#include <vector>

namespace nsfd
{
  /**
   * Where bodies and faces are in batches of simd::width: bodies of a large
   * class by themselves, others with those whose traces have the same pattern;
   * faces with those of as many points. Components are scaled to a diagonal of
   * W of one, so nothing leaves the range of floats.
   */
  template <int dim>
  class SimdLayout
  {
  public:
    SimdLayout(const Bodies &bodies, const InterfacePoints<dim> &points);

    /** After M_hat has changed. Collective. */
    void set_values(const DelassusOperator<dim> &delassus);

    /** Calls function(component of the points, where it is in the group). */
    template <typename Function>
    void for_components(const simd::FaceGroup &group,
                        const Function &function) const
    {
      const unsigned int n = group.n();
      for (std::size_t l = 0; l < group.faces.size(); ++l)
        if (group.faces[l] != none) {
          const std::size_t first =
              std::size_t(points_.faces[group.faces[l]].first) * dim;
          const std::size_t at =
              l / simd::width * n * simd::width + l % simd::width;
          for (unsigned int k = 0; k < n; ++k)
            function(first + k, at + k * simd::width);
        }
    }

    std::vector<simd::BodyGroup> body_groups;
    std::vector<simd::FaceGroup> face_groups;
    std::vector<std::vector<double>> face_blocks; ///< scaled, packed, by lane
    std::vector<double> scale; ///< per component, square root of its W
    double unit = 1.;          ///< of the bodies' blocks: the largest of W_kk
    std::size_t size = 0;      ///< of a vector over faces
    std::size_t n_places = 0;  ///< of a vector over slots and what is behind
    std::array<std::vector<int>, 2> place; ///< per point, of its sides
    struct Extra {
      int slot, place;
    };
    std::vector<Extra> extras; ///< further points of a slot

  private:
    static constexpr unsigned int none = static_cast<unsigned int>(-1);

    void group_bodies();
    void group_faces();
    void place_points();
    void set_bodies(const DelassusOperator<dim> &delassus,
                    simd::BodyGroup &group,
                    const std::vector<unsigned int> &members);
    void set_faces(const DelassusOperator<dim> &delassus,
                   simd::FaceGroup &group);

    const Bodies &bodies_;
    const InterfacePoints<dim> &points_;
    std::vector<std::vector<unsigned int>> members_; ///< bodies, per group
    std::size_t n_slots_ = 0; ///< floats of the bodies' slots
  };
} // namespace nsfd
