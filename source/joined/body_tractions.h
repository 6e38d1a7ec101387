#pragma once

#include "discretization/bodies.h"

#include <array>
#include <vector>

namespace nsfd
{
  template <int dim>
  class Discretization;

  /** Tractions on the outward normals of all bodies, Pa, and where those of
      the points are. */
  template <int dim>
  class BodyTractions
  {
  public:
    /** Those of @p block; bodies whose class has none carry nothing. */
    BodyTractions(const Discretization<dim> &discretization,
                  Block BodyClass::*block);

    bool acts_in(const std::size_t body) const
    {
      return first_[body + 1] > first_[body];
    }
    double *of_body(const std::size_t body) { return &values_[first_[body]]; }

    /** On the normal from body 1 to body 2 of a point: the mean of both. */
    std::array<double, dim> mean(const std::size_t point) const
    {
      std::array<double, dim> t;
      for (unsigned int c = 0; c < dim; ++c)
        t[c] = (values_[place_[point][0] + c] - values_[place_[point][1] + c]) /
               2.;
      return t;
    }

  private:
    std::vector<double> values_; ///< the last ones, 0, are of bodies without
    std::vector<std::size_t> first_;                ///< per body, and the end
    std::vector<std::array<std::size_t, 2>> place_; ///< by point, of body 1, 2
  };
} // namespace nsfd
