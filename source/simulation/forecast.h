#pragma once

#include "core/communicator.h"

#include <string>
#include <vector>

namespace nsfd
{
  struct SceneInput;

  /** How far the first steps of a run had come. */
  struct StepSample {
    unsigned int steps = 0; ///< accepted
    double time = 0.;       ///< s, simulated
    double cpu = 0.;        ///< s of this process
  };

  /** The first steps of a run, as far as they were tried. */
  struct FirstSteps {
    std::vector<StepSample> samples; ///< the first one before all steps
    double set_up = 0.;              ///< s of CPU before them
    double cpu = 0., wall = 0.;      ///< s, of the trial
    std::string failure;             ///< why one of them failed; empty: none
  };

  /**
   * Decides how many steps are tried, and keeps what they took: about a second
   * of CPU and at least two steps, but at most a second of CPU more than set-up
   * took. A step is left between two iterations of its solver; factors are
   * finished.
   */
  class StepTrial
  {
  public:
    /** @p set_up in s of CPU. */
    StepTrial(const Communicator &communicator, double set_up);
    ~StepTrial();
    StepTrial(const StepTrial &) = delete;
    StepTrial &operator=(const StepTrial &) = delete;

    /** What is there when steps begin; @p cpu of set-up, s. */
    void begin(double set_up_cpu, double time);
    /** After an accepted step. */
    void add(double time);
    /** Another step is wanted. Collective. */
    bool goes_on() const;
    void fail(const std::string &why) { result_.failure = why; }
    FirstSteps finish();

  private:
    const Communicator &communicator_;
    double start_; ///< s of wall time
    double last_;  ///< s of CPU: where a step is left
    unsigned int steps_ = 0;
    double time_ = 0.;
    FirstSteps result_;
  };

  /** Numbers of a scene that its files and pictures depend on. */
  struct OutputCounts {
    double cells = 0., points = 0.;
  };

  /** What a run will take. */
  struct Forecast {
    bool known = false;    ///< else all that follows says nothing
    double steps = 0.;     ///< of the whole run
    double step = 0.;      ///< s of CPU, of a later one
    double seconds = 0.;   ///< s of CPU, of the whole run
    double longest = 0.;   ///< the same where many faces break or touch
    double set_up = 0.;    ///< s of CPU
    double pictures = 0.;  ///< how many
    double picturing = 0.; ///< s of CPU, of all of them
    double megabytes = 0.; ///< at most, with the pictures
    double busy = 1.;      ///< wall time over CPU time in the trial
  };

  /**
   * Extrapolates: the simulated time that is left, at the rate of the second
   * half of the trial; where that half is a few dear steps, of all but the
   * dearest. @p megabytes at the end of the trial.
   */
  Forecast forecast(const SceneInput &input, const FirstSteps &trial,
                    const OutputCounts &counts, double megabytes);

  /** Lines on time and memory for a reader, with what they rest on. */
  std::string forecast_text(const SceneInput &input, const FirstSteps &trial,
                            const Forecast &forecast);
} // namespace nsfd
