#pragma once

#include "model.h"

#include "core/communicator.h"
#include "nsfd/scene/scene_input.h"

#include <memory>
#include <string>
#include <tuple>

namespace nsfd
{
  /** A scene and its parts, where it was chosen by these; else null. */
  struct ChosenScene {
    std::unique_ptr<const SceneInput> scene;
    std::tuple<std::unique_ptr<Model<2>>, std::unique_ptr<Model<3>>> built;
    std::string warnings; ///< that building them gave
  };

  /**
   * The scene that `scheme = auto` stands for, with a sentence in
   * SceneInput::scheme_choice; @p input itself if it does not say so, with a
   * sentence there if it names no scheme and explicit steps would cost less.
   *
   * Explicit steps of joined cells are as accurate as implicit ones of the same
   * length and far cheaper, but not longer than a wave needs through a cell.
   * They are taken as long as n of them cost less than the implicit steps of
   * the scene: one of these costs what implicit_over_explicit() explicit ones
   * cost. Builds the mesh and the explicit integrator, once more if this is not
   * what is chosen; without `scheme = auto` only to @p check. @p communicator
   * outlives the result. Collective.
   */
  ChosenScene choose_scheme(const SceneInput &input, bool check,
                            const Communicator &communicator);

  /**
   * Explicit steps at the cost of an implicit one, per cell, of bodies that
   * hold together: as measured on 10^4 to 4 10^4 quadrilaterals of degree 1
   * (46 to 72) and 8 10^3 to 2.7 10^4 hexahedra (90 to 120) at a Courant
   * number of 1.
   */
  constexpr double implicit_over_explicit(const unsigned int dimension)
  {
    return dimension == 2 ? 60. : 100.;
  }
} // namespace nsfd
