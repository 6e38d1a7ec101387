#pragma once

#include "input/read_scene.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace nsfd::small_scene_text
{
  const std::string small_scene = R"(# small - the least that runs
set dimension = 2
subsection Mesh
  set upper corner = 10 um, 20 um
  set cells = 2, 4
end
subsection Material: bulk
  set Young modulus = 135 GPa
  set Poisson ratio = 0.32
  set density = 7800 kg/m^3
end
subsection Interface: all
  set law = rigid
end
subsection Time
  set end = 10 ns
end
)";

  inline std::unique_ptr<SceneInput>
  read_good(const std::string &text,
            const std::vector<std::string> &overrides = {})
  {
    InputErrors errors;
    auto scene = read_scene_text(text, "prm/small.prm", overrides, errors);
    EXPECT_EQ(errors.report(), "");
    return scene;
  }

  inline std::string report_of(const std::string &text,
                               const std::vector<std::string> &overrides = {})
  {
    InputErrors errors;
    read_scene_text(text, "small.prm", overrides, errors);
    return errors.report();
  }

  inline std::string replaced(std::string text, const std::string &from,
                              const std::string &to)
  {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
} // namespace nsfd::small_scene_text
