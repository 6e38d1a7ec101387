#pragma once

#include "nsfd/core/per_extent.h"
#include "nsfd/parameters/section_reader.h"
#include "nsfd/postprocess/observable.h"
#include "nsfd/postprocess/running_crack.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

/** What several observables read of their blocks. */
namespace nsfd::observables
{
  using Vector = std::array<double, 3>;

  inline double product(const Vector &a, const Vector &b)
  {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  inline Vector minus(const Vector &a, const Vector &b)
  {
    return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}};
  }

  /** "tip_x" ... for ("tip", "m"). */
  inline void add_vector(std::vector<ObservedColumn> &columns,
                         const std::string &name, const std::string &unit,
                         const unsigned int dimension)
  {
    for (unsigned int c = 0; c < dimension; ++c)
      columns.push_back({name + '_' + "xyz"[c], unit});
  }

  inline void add_vector(std::vector<double> &values, const Vector &vector,
                         const unsigned int dimension)
  {
    values.insert(values.end(), vector.begin(), vector.begin() + dimension);
  }

  /** In two dimensions per metre of depth, in axisymmetric scenes per radian.
   */
  inline std::string force_unit(const SceneInput &scene)
  {
    return "N" + per_extent(scene.dimension, scene.axisymmetric);
  }
  inline std::string area_unit(const SceneInput &scene)
  {
    return nsfd::area_unit("m²", scene.dimension, scene.axisymmetric);
  }

  inline Vector in_space(const std::vector<double> &numbers)
  {
    Vector result{};
    std::copy(numbers.begin(), numbers.end(), result.begin());
    return result;
  }

  /** `NAME`, or `Boundary: NAME` where several kinds have the name. */
  NamedSurface read_surface(SectionReader &reader, const SceneInput &scene,
                            const std::string &text);

  /** "Interface: plane". */
  std::string full_name(const NamedSurface &surface);

  /** Of length one. */
  Vector read_direction(SectionReader &reader, const SceneInput &scene);

  /** The elastic material of the scene, if there is only one. */
  std::optional<RunningCrack> only_material(const SceneInput &scene);

  /**
   * Per Interface block 1 where the crack may be: `faces`, by default all that
   * have a law which breaks. There is one if it @p must grow.
   */
  std::vector<char> read_crack_faces(SectionReader &reader,
                                     const SceneInput &scene, bool must_grow);
} // namespace nsfd::observables
