#include "step_control.h"

#include "nsfd/core/archive.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    // Lengths of cells far from the origin, hence Courant numbers, are known to
    // round-off of the coordinates only: 2e-9 at 1e7 lengths of a cell.
    constexpr double round_off = 1e-8;

    constexpr unsigned int least_patience = 4, most_patience = 64;
  } // namespace

  StepControl::StepControl(const double end, const double base,
                           const unsigned int maximum_bisections,
                           const double start)
      : end_(end), ceiling_(std::numeric_limits<double>::infinity()),
        n_base_(static_cast<unsigned long long>(
            std::fmax(1., std::ceil((end - start) / base * (1. - round_off))))),
        maximum_level_(maximum_bisections), start_(start)
  {
    base_ = (end - start) / double(n_base_);
  }

  StepControl StepControl::of_length(const double step, const double end,
                                     const double start)
  {
    StepControl control(end, step, 0, start);
    control.base_ = step;
    control.end_ = start + double(control.n_base_) * step;
    return control;
  }

  double StepControl::time() const
  {
    if (finished())
      return end_;
    return start_ +
           (double(base_count_) + std::ldexp(double(position_), -int(level_))) *
               base_;
  }

  double StepControl::next_time() const
  {
    StepControl after = *this;
    after.accept();
    return after.time();
  }

  double StepControl::step() const { return std::ldexp(base_, -int(level_)); }

  void StepControl::accept()
  {
    ++position_;
    ++successes_;
    if (on_trial_ && successes_ >= std::max(patience_, least_patience)) {
      patience_ /= 2;
      on_trial_ = false;
    }
    if (level_ > 0 && position_ % 2 == 0 && 2. * step() <= ceiling_ &&
        successes_ >= patience_) {
      position_ /= 2;
      --level_;
      successes_ = 0;
      on_trial_ = true;
    }
    if (position_ == 1ull << level_) {
      ++base_count_;
      position_ = 0;
    }
  }

  bool StepControl::bisect()
  {
    if (level_ == maximum_level_)
      return false;
    ++level_;
    position_ *= 2;
    ++n_bisections_;
    if (on_trial_)
      patience_ =
          std::min(std::max(2 * patience_, least_patience), most_patience);
    on_trial_ = false;
    successes_ = 0;
    return true;
  }

  void StepControl::serialize(Archive &archive)
  {
    const Archive::Part part(archive, "step_control");
    archive.numbers("step_levels", start_, end_, base_, n_base_, base_count_,
                    position_, level_, maximum_level_, n_bisections_, ceiling_);
    archive.numbers("step_patience", patience_, successes_, on_trial_);
  }

  void StepControl::limit(const double limit)
  {
    while (step() > limit && level_ < maximum_level_) {
      ++level_;
      position_ *= 2;
      on_trial_ = false;
    }
  }
} // namespace nsfd
