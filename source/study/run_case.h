#pragma once

#include "case_result.h"
#include "study_input.h"

namespace nsfd
{
  /** From now on SIGINT and SIGTERM stop the study and its running cases. */
  void catch_stop_signals();

  /** True after such a signal. */
  bool stop_was_requested();

  /**
   * Run a case, each repeat in a process of its own, in its folder of the
   * study. Results of an earlier study are taken over if @p resume and they
   * are of the same scene, program and number of ranks. Throws
   * std::runtime_error if the folder cannot be written.
   */
  CaseResult run_case(const StudyInput &study, const StudyCase &one,
                      const CaseStamp &program, unsigned int repeats,
                      bool resume);
} // namespace nsfd
