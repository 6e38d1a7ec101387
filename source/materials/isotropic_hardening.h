#pragma once

namespace nsfd
{
  struct PlasticInput; // see scene/scene_input.h

  /**
   * R(p), by which the yield stress grows with the flow p in the measure of von
   * Mises: R = H p + Q (1 - exp(-b p)), or the power law of exponent N,
   *
   *   p = yield/E (s^(1/N) - s),  s = 1 + R/yield,
   *
   * with which the strain of uniaxial stress is yield/E s^(1/N) beyond yield
   * (Tvergaard and Hutchinson 1992). Pa.
   */
  class IsotropicHardening
  {
  public:
    IsotropicHardening(double young, const PlasticInput &plastic);

    struct Value {
      double R, slope; ///< dR/dp
    };
    Value at(double p) const;
    /** The mean of R over the way from @p p to p + @p dp. */
    double mean(double p, double dp) const;
    /** The integral of R from 0 to @p p, J per volume. */
    double energy(double p) const;

  private:
    double excess(double p) const; ///< R/yield of the power law
    double mean_excess(double t0, double t1) const;

    double yield_, yield_strain_, linear_, saturation_, decay_;
    double inverse_ = 0.; ///< 1/N; 0: no power law
  };
} // namespace nsfd
