#pragma once

#include "nsfd/core/space.h"
#include "nsfd/materials/hyperelastic.h"

namespace nsfd
{
  /** The symmetric matrix with these entries, and those of the symmetric part.
   */
  Mat3 matrix(const Voigt<3> &A);
  Voigt<3> entries(const Mat3 &A);

  /** Eigenvalues and vectors of a symmetric matrix, by Jacobi's rotations. */
  class Spectrum
  {
  public:
    explicit Spectrum(const Voigt<3> &A);

    const Vec3 &values() const { return values_; }
    const Mat3 &vectors() const { return vectors_; } ///< as columns
    bool positive() const
    {
      return values_[0] > 0. && values_[1] > 0. && values_[2] > 0.;
    }

    /** The matrix with the eigenvalues f(value). */
    template <typename Function>
    Voigt<3> function(const Function &f) const
    {
      return with_values({f(values_[0]), f(values_[1]), f(values_[2])});
    }
    /** ln(A) / 2. */
    Voigt<3> half_log() const;

  private:
    Voigt<3> with_values(const Vec3 &values) const;

    Vec3 values_;
    Mat3 vectors_;
  };

  /** d ln(C) / 2 along @p H. */
  Voigt<3> half_log_change(const Spectrum &C, const Voigt<3> &H);

  /**
   * The linear map P with P:(C1 - C0) / 2 = (ln C1 - ln C0) / 2, exactly and
   * also for equal C1 and C0: as
   *
   *   ln C1 - ln C0 = int (C0 + t)^{-1} (C1 - C0) (C1 + t)^{-1} dt,  t > 0,
   *
   * its entries between eigenvectors of C0 and of C1 are the divided
   * differences of ln. Both must be positive.
   */
  class LogSecant
  {
  public:
    LogSecant(const Spectrum &start, const Spectrum &end);

    /** The symmetric S with S:(C1 - C0) / 2 = T:(ln C1 - ln C0) / 2. */
    Voigt<3> pulled_back(const Voigt<3> &T) const;

    /** Of pulled_back(T) by C1: operator() is its change along @p H. */
    class EndDerivative
    {
    public:
      Voigt<3> operator()(const Voigt<3> &H) const;

    private:
      friend LogSecant;
      EndDerivative(const LogSecant &secant, const Voigt<3> &T);

      const LogSecant &secant_;
      double differences_[3][3][3]; ///< times T between the eigenvectors
    };
    /** Valid as long as this object. */
    EndDerivative derivative_at_end(const Voigt<3> &T) const
    {
      return {*this, T};
    }

  private:
    Voigt<3> from_bases(const Mat3 &W) const;

    Spectrum start_, end_;
    Mat3 differences_;
  };
} // namespace nsfd
