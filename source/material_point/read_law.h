#pragma once

#include "bar.h"
#include "nonsmooth/one_step_problem.h"
#include "nsfd/scene/time_input.h"
#include "parameters/input_errors.h"
#include "path.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  /** A law to be driven, and its way. */
  struct LawCurveInput {
    std::string name, law_name;
    Interaction interaction;
    std::vector<PathPoint> points;
  };

  /** What `nsfd law` is asked to do. */
  struct LawInput {
    std::string title;
    std::vector<LawCurveInput> curves;
    std::string path_name; ///< named path, points, formula or file
    CohesionRule cohesion_rule = CohesionRule::end_point;
    bool normalised = false; ///< pictures over final opening and strength
    std::optional<Bar> bar;  ///< pulls the points; then there is no path
    std::string directory;
    std::string echo; ///< complete file: driving it again gives the same
    /// of a law by its name: "strength = 3 MPa (example); friction = 0.3"
    std::string entries;
  };

  /**
   * Read what `nsfd law WHAT` names: a registered law, with entries of its
   * first example where @p overrides give none, or a file with Interface
   * blocks and a section `Path` or `Bar`. In @p overrides, entries without a
   * section belong to the (only) Interface block. Errors as read_scene().
   */
  std::unique_ptr<LawInput> read_law(const std::string &what,
                                     const std::vector<std::string> &overrides,
                                     InputErrors &errors);

  /** As read_law(); a registered law without @p overrides once with each of its
   * examples. */
  std::vector<std::unique_ptr<LawInput>>
  read_examples(const std::string &what,
                const std::vector<std::string> &overrides, InputErrors &errors);

  /** As read_law(), for the text of a file that messages call @p name. */
  std::unique_ptr<LawInput>
  read_law_text(const std::string &text, const std::string &name,
                const std::vector<std::string> &overrides, InputErrors &errors);
} // namespace nsfd
