#include "forecast.h"

#include "core/stop_request.h"
#include "core/stopwatch.h"
#include "nsfd/scene/scene_input.h"
#include "postprocess/progress.h"
#include "records/certificate.h"
#include "records/engineering.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    constexpr double budget = 1.;      ///< s of CPU for the trial
    constexpr double patience = 5.;    ///< s of wall time, on a busy machine
    constexpr double interval = 0.002; ///< s of CPU between two samples
    constexpr unsigned int fewest = 2; ///< steps: the first one makes factors
    constexpr unsigned int few = 4;    ///< steps that say little

    // measured, see doc/performance.md
    /// of a picture and its files, per cell and per point of a face
    constexpr double seconds_per_item = 1.5e-6;
    constexpr double bytes_per_polygon = 900.;
    /// steps in which faces break over those before
    constexpr double most_growth = 2.;

    double end_of(const SceneInput &input)
    {
      return input.may_move() ? input.time.end : input.statics->until;
    }

    bool is_static(const SceneInput &input)
    {
      return input.statics && input.statics->steps;
    }

    /** The first sample of the second half, by CPU; never the last one. */
    const StepSample &middle(const std::vector<StepSample> &samples)
    {
      const double half = (samples.front().cpu + samples.back().cpu) / 2.;
      const auto found = std::find_if(
          samples.begin(), samples.end() - 1,
          [half](const StepSample &one) { return one.cpu >= half; });
      return found == samples.end() - 1 ? *(samples.end() - 2) : *found;
    }

    StepSample operator-(const StepSample &a, const StepSample &b)
    {
      return {a.steps - b.steps, a.time - b.time, a.cpu - b.cpu};
    }

    /**
     * The steps that later ones will be like: those of the second half. Where
     * these are a few dear ones of a motion, an impact has begun, and that
     * passes: then all but the first one, which makes factors, and the dearest.
     */
    StepSample like_later(const SceneInput &input,
                          const std::vector<StepSample> &samples)
    {
      const StepSample half = samples.back() - middle(samples);
      if (half.steps > few || is_static(input) || samples.size() < 4)
        return half;
      StepSample dearest;
      for (std::size_t k = 2; k < samples.size(); ++k) {
        const StepSample one = samples[k] - samples[k - 1];
        if (one.cpu > dearest.cpu)
          dearest = one;
      }
      return samples.back() - samples[1] - dearest;
    }
  } // namespace

  StepTrial::StepTrial(const Communicator &communicator, const double set_up)
      : communicator_(communicator), start_(wall_seconds()),
        last_(cpu_seconds() + budget + set_up)
  {
    stop_request::leave_steps_at(last_);
  }

  StepTrial::~StepTrial() { stop_request::leave_steps_at(0.); }

  void StepTrial::begin(const double set_up_cpu, const double time)
  {
    result_.set_up = set_up_cpu;
    result_.samples.push_back({0, time, cpu_seconds()});
    time_ = time;
  }

  void StepTrial::add(const double time)
  {
    ++steps_;
    time_ = time;
    const double cpu = cpu_seconds();
    if (steps_ <= fewest || cpu > result_.samples.back().cpu + interval)
      result_.samples.push_back({steps_, time, cpu});
  }

  bool StepTrial::goes_on() const
  {
    const double cpu = cpu_seconds();
    const bool enough = steps_ < fewest
                            ? cpu > last_
                            : cpu > result_.samples.front().cpu + budget ||
                                  wall_seconds() > start_ + patience;
    return !communicator_.any(communicator_.is_root() && enough);
  }

  FirstSteps StepTrial::finish()
  {
    auto &samples = result_.samples;
    if (samples.empty())
      samples.push_back({0, time_, cpu_seconds()});
    if (samples.back().steps < steps_)
      samples.push_back({steps_, time_, cpu_seconds()});
    result_.cpu = cpu_seconds() - samples.front().cpu;
    result_.wall = wall_seconds() - start_;
    return result_;
  }

  namespace
  {
    /** Times at which fields and pictures are due, with start and end. */
    double n_pictures(const SceneInput &input, const double steps)
    {
      const OutputInput &output = input.output;
      if (!output.fields && !output.report)
        return 0.;
      double n = 2.;
      if (output.fields_every > 0.)
        n += std::max(0., std::ceil(end_of(input) / output.fields_every) - 1.);
      if (output.fields_every_steps > 0)
        n += std::floor(steps / output.fields_every_steps);
      return std::min(n, steps + 1.);
    }

    /** MB that the pictures of the report keep: those that are not dropped. */
    double kept_pictures(const double n_pictures, const OutputCounts &counts)
    {
      constexpr double most = 24., most_polygons = 600000.;
      const double n = std::max(1., counts.cells);
      return bytes_per_polygon * n *
             std::min(n_pictures, std::clamp(most_polygons / n, 2., most)) /
             1048576.;
    }

    /** Faces may break, surfaces may meet: dearer steps may come. */
    bool may_change(const SceneInput &input)
    {
      return !input.contacts.empty() || !input.obstacles.empty() ||
             std::any_of(input.interfaces.begin(), input.interfaces.end(),
                         [](const auto &block) { return bool(block.law); });
    }
  } // namespace

  Forecast forecast(const SceneInput &input, const FirstSteps &trial,
                    const OutputCounts &counts, const double megabytes)
  {
    Forecast result;
    const auto &samples = trial.samples;
    const StepSample &first = samples.front(), &last = samples.back();
    result.set_up = trial.set_up;
    result.busy = trial.cpu > 0. ? std::max(1., trial.wall / trial.cpu) : 1.;
    result.megabytes = megabytes;
    if (samples.size() < 2 || !(last.time > first.time))
      return result;
    const StepSample like = like_later(input, samples);
    const double left = std::max(0., end_of(input) - last.time) / like.time;
    result.known = true;
    result.steps = last.steps + left * like.steps;
    result.step = like.cpu / like.steps;
    result.pictures = n_pictures(input, result.steps);
    result.picturing =
        result.pictures * (counts.cells + counts.points) * seconds_per_item;
    const double later = left * like.cpu;
    result.seconds = trial.set_up + trial.cpu + later + result.picturing;
    result.longest = result.seconds;
    if (may_change(input))
      result.longest += (most_growth - 1.) * later;
    if (input.output.report)
      result.megabytes += kept_pictures(result.pictures, counts);
    return result;
  }

  namespace
  {
    /** Why nothing can be said, or how much at least. */
    std::string unknown_text(const FirstSteps &trial)
    {
      if (!trial.failure.empty())
        return "not known, the first step fails: " + trial.failure;
      return fmt::format("not known, the first step takes more than {}",
                         Progress::duration(trial.cpu));
    }

    /** What is still to come that the first steps know nothing of. */
    std::string time_text(const SceneInput &input, const Forecast &forecast)
    {
      const std::string time = Progress::duration(forecast.seconds);
      if (!(forecast.longest > forecast.seconds))
        return "about " + time;
      if (input.mesh_changes())
        return "at least about " + time +
               ", more where the mesh is refined on the way";
      if (is_static(input))
        return "at least about " + time +
               ", several times that where steps of the load must be bisected "
               "because faces break";
      return fmt::format("about {}, up to {} where many faces break or touch",
                         time, Progress::duration(forecast.longest));
    }

    std::string parts_text(const Forecast &forecast)
    {
      std::string text = fmt::format(
          "set-up {}, {:.0f} steps of {}", Progress::duration(forecast.set_up),
          forecast.steps, engineering(forecast.step, "s"));
      if (forecast.pictures > 0.)
        text += fmt::format(", {:.0f} pictures in {}", forecast.pictures,
                            Progress::duration(forecast.picturing));
      return text;
    }
  } // namespace

  std::string forecast_text(const SceneInput &input, const FirstSteps &trial,
                            const Forecast &forecast)
  {
    constexpr std::size_t indent = 13;
    std::string text;
    const auto line = [&text](const char *name, const std::string &sentence) {
      text += fmt::format("  {:<10} ", name) +
              wrapped(sentence, indent).substr(indent);
    };
    const StepSample &last = trial.samples.back();
    const std::string memory =
        fmt::format("about {:.0f} MB", forecast.megabytes);
    if (!forecast.known) {
      line("time", unknown_text(trial));
      line("memory", memory + ", or more");
      return text;
    }
    line("time", time_text(input, forecast));
    line("", parts_text(forecast));
    line("", last.time >= end_of(input) * (1. - 1e-9)
                 ? std::string("all steps were tried")
                 : fmt::format("as the first {} step{}, to t = {}, which took "
                               "{}; later ones may cost more or less",
                               last.steps, last.steps == 1 ? "" : "s",
                               engineering(last.time, "s"),
                               Progress::duration(trial.cpu)));
    if (!trial.failure.empty())
      line("", "then a step fails: " + trial.failure);
    constexpr double clearly = 1.5;
    if (forecast.busy > clearly)
      line("",
           fmt::format("on a core of its own; now others use it as well, and "
                       "it would be {}",
                       Progress::duration(forecast.busy * forecast.seconds)));
    if (forecast.picturing > 0.5 * forecast.seconds)
      line("", "change: fewer pictures, which take most of the time, by a "
               "longer `fields every`");
    line("memory", memory);
    return text;
  }
} // namespace nsfd
