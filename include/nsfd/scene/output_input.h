#pragma once

#include "field_format.h"

#include <memory>
#include <string>

namespace nsfd
{
  class Observable; // see postprocess/observable.h

  struct OutputInput {
    std::string directory;
    double fields_every = 0.;            ///< s; 0: start and end only
    unsigned int fields_every_steps = 0; ///< 0: not used
    bool fields = true, report = true;
    FieldFormat format = FieldFormat::vtu;
    unsigned int checkpoint_steps = 0; ///< 0: not by steps
    double checkpoint_seconds = 0.;    ///< of wall time; 0: not by time
  };

  /** A block `Observable: name`. */
  struct ObservableInput {
    std::string name, type;
    unsigned int every = 1; ///< accepted steps from row to row
    std::shared_ptr<Observable> observable;
  };
} // namespace nsfd
