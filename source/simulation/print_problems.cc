#include "print_problems.h"

#include "parameters/input_errors.h"
#include "parameters/place_of.h"

#include <iostream>

namespace nsfd
{
  void print_problems(const Communicator &communicator, const SceneInput &input,
                      const char *kind,
                      const std::vector<std::string> &problems)
  {
    if (!communicator.is_root())
      return;
    InputErrors errors;
    for (const auto &problem : problems) {
      if (kind == std::string("error"))
        errors.error(place_of(input.file, problem), problem);
      else if (kind == std::string("warning"))
        errors.warning(place_of(input.file, problem), problem);
      else
        std::cerr << input.file << ": " << kind << ": " << problem << "\n";
    }
    std::cerr << errors.report();
  }
} // namespace nsfd
