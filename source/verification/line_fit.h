#pragma once

#include "nsfd/core/archive.h"

#include <optional>

namespace nsfd::cases
{
  /** Least squares of a quantity over time: the speed of a crack. */
  class LineFit
  {
  public:
    void add(const double t, const double a)
    {
      n_ += 1.;
      t_ += t;
      a_ += a;
      tt_ += t * t;
      ta_ += t * a;
    }

    /** Nothing from fewer than two times. */
    std::optional<double> slope() const
    {
      const double variance = n_ * tt_ - t_ * t_;
      if (!(variance > 0.))
        return {};
      return (n_ * ta_ - t_ * a_) / variance;
    }

    void serialize(Archive &archive)
    {
      archive.numbers("line_fit", n_, t_, a_, tt_, ta_);
    }

  private:
    double n_ = 0., t_ = 0., a_ = 0., tt_ = 0., ta_ = 0.;
  };
} // namespace nsfd::cases
