#pragma once

#include "study_results.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** Mean of a quantity over cases that differ in what is averaged over. */
  struct StudyMean {
    std::string setting, error;
    std::size_t count = 0;
    double mean = 0., deviation = 0.; ///< of a sample, n - 1
    double half_width = 0.; ///< of the 95 % interval of the mean, Student's t
    std::vector<double> values; ///< sorted
  };

  /** Every point of every series; empty unless the study averages. */
  std::vector<StudyMean> means_of(const StudyResults &study);

  /** "no two means differ by more than their intervals" per quantity. */
  std::string means_text(const StudyResults &study);
} // namespace nsfd
