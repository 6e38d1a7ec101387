#pragma once

#include "contact_cone.h"

namespace nsfd::stored
{
  /** Alart-Curnier map of one contact with its derivative: F, and A, B with
   * F(r + dr) = F + A dr + B du to first order. Scaled by rho. */
  template <int d>
  double alart_curnier(const double *r, const double *u, const double mu,
                       const double rho, double *F, double *A, double *B)
  {
    if (A) {
      std::fill(A, A + d * d, 0.);
      std::fill(B, B + d * d, 0.);
    }
    const double y_n = r[0] - rho * u[0];
    if (y_n <= 0.) { // open
      double sum = 0.;
      for (int c = 0; c < d; ++c) {
        F[c] = r[c];
        sum += F[c] * F[c];
        if (A)
          A[(d + 1) * c] = 1.;
      }
      return sum;
    }
    F[0] = rho * u[0];
    if (A)
      B[0] = rho;
    double y[d - 1], norm = 0.;
    for (int i = 0; i < d - 1; ++i) {
      y[i] = r[1 + i] - rho * u[1 + i];
      norm += y[i] * y[i];
    }
    norm = std::sqrt(norm);
    double sum = F[0] * F[0];
    const double bound = mu * y_n;
    if (norm <= bound) { // stick
      for (int c = 1; c < d; ++c) {
        F[c] = rho * u[c];
        sum += F[c] * F[c];
        if (A)
          B[(d + 1) * c] = rho;
      }
      return sum;
    }
    const double g = bound / norm;
    for (int i = 0; i < d - 1; ++i) { // slide
      const int c = 1 + i;
      F[c] = r[c] - g * y[i];
      sum += F[c] * F[c];
      if (!A)
        continue;
      A[d * c] = -mu * y[i] / norm;
      B[d * c] = mu * rho * y[i] / norm;
      A[(d + 1) * c] = 1.;
      for (int j = 0; j < d - 1; ++j) {
        const double G = g * ((i == j ? 1. : 0.) - y[i] * y[j] / (norm * norm));
        A[d * c + 1 + j] -= G;
        B[d * c + 1 + j] += rho * G;
      }
    }
    return sum;
  }
} // namespace nsfd::stored
