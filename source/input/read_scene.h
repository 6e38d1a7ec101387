#pragma once

#include "nsfd/scene/scene_input.h"
#include "parameters/input_errors.h"

#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * Read and check a parameter file. @p overrides are `Section/name=value` as
   * given to --set. Everything that is wrong goes into @p errors, with its
   * line; the result is null if there is any error. Warnings are collected
   * there as well and do not matter for the result. Does not throw for bad
   * input. VerificationCase::initialise() is left to the caller.
   */
  std::unique_ptr<SceneInput>
  read_scene(const std::string &file, const std::vector<std::string> &overrides,
             InputErrors &errors);

  /** `Section/name=value`, and the file that gives the value: paths in it start
      there, without one where the program runs. */
  struct Assignment {
    std::string text, file = {};
  };

  /** As read_scene(), for a case of a study. */
  std::unique_ptr<SceneInput>
  read_case_scene(const std::string &file,
                  const std::vector<Assignment> &assignments,
                  InputErrors &errors);

  /** As read_scene(), for text that messages call @p name. */
  std::unique_ptr<SceneInput>
  read_scene_text(const std::string &text, const std::string &name,
                  const std::vector<std::string> &overrides,
                  InputErrors &errors);

  /** A name that a parameter file may write, for `--list`. */
  struct NamedPart {
    std::string kind, name, text;
    std::string example = {}; ///< entries it needs: "strength = 3 MPa; ..."
    std::string plug_in = {}; ///< that brings it
  };

  /** Material models, interface laws, verification cases, meshes, solvers: in
   * this order. */
  std::vector<NamedPart> named_parts();
} // namespace nsfd
