#pragma once

#include <cstddef>
#include <vector>

/**
 * The loops of a Newton system in single precision, over bodies and faces side
 * by side. Every lane sees the same operations in the same order, whatever
 * shares its vector: results do not depend on how bodies and faces are grouped.
 */
namespace nsfd::simd
{
  /** Bodies, or faces, that one vector holds. */
  constexpr unsigned int width = 16;

  /**
   * Bodies with the same pattern of the traces H, in batches of `width`. Values
   * are those of one class for all (`shared`) or one per lane. W = A where that
   * is cheaper, else W = H A H^T.
   */
  struct BodyGroup {
    unsigned int rows = 0, dofs = 0; ///< of H
    bool dense = false, shared = false;
    std::size_t first = 0; ///< of its vectors: rows x width per batch
    std::size_t n_batches = 0;
    std::size_t n_shared = 0; ///< batches with bodies at points of other ranks
    /// entries of H by column and by row
    std::vector<unsigned int> column_first, column_row, row_first, row_column;
    std::vector<float> by_column, by_row, matrix;
  };

  /**
   * Faces with the same number of points, in batches of `width`. Local
   * components, scaled to a diagonal of W of one; n = count dim per face.
   */
  struct FaceGroup {
    unsigned int dim = 0, count = 0;
    std::size_t first = 0; ///< of its vectors: n x width per batch
    std::size_t n_batches = 0;
    std::vector<unsigned int> faces; ///< per lane; or none
    std::vector<int> place;   ///< per batch, point, side, lane: the x-component
    std::vector<float> frame; ///< per batch, point, row, column, lane: scaled
    std::vector<float> owned; ///< per batch, lane: 1 where sums count it
    std::vector<float> D;     ///< per batch, component, lane; 0: no part
    std::vector<float> inverse; ///< packed, of W_ff + D
    // of the unsymmetric system, per batch, component, lane
    std::vector<float> weight;   ///< (D + R) before the preconditioner
    std::vector<float> idle;     ///< 1 where there is no part
    std::vector<float> jacobian; ///< per batch, point, row, column, lane
    std::vector<float> ratio;    ///< (1 - shift) R

    unsigned int n() const { return count * dim; }
    unsigned int packed() const { return n() * (n() + 1) / 2; }
  };

  /**
   * A sum of terms that are rounded to multiples of a power of two first, so
   * that it is exact and does not depend on the order; that power is 2^-36 of
   * @p scale, which the sum may exceed 2^15 times.
   */
  class ExactSum
  {
  public:
    explicit ExactSum(double scale);
    double high; ///< what rounds a term when it is added and taken away
    double value = 0.;
  };

  /** Y = W X over the batches from @p begin to @p end of a group. */
  void multiply_bodies(const BodyGroup &group, std::size_t begin,
                       std::size_t end, const float *X, float *Y);

  /** The signed impulses of the points p to the slots of their bodies. */
  void scatter(const FaceGroup &group, const float *p, float *X);

  /** w = W p + D p from the velocities at the slots; adds p.w to @p sum. */
  void gather(const FaceGroup &group, const float *Y, const float *p, float *w,
              ExactSum &sum);

  /** w = p - J (W p - ratio p) from the velocities at the slots. */
  void gather_coupled(const FaceGroup &group, const float *Y, const float *p,
                      float *w);

  /** x += alpha p, r -= alpha w, z = inverse r; adds r.z to @p sum. */
  void advance(const FaceGroup &group, float alpha, const float *p,
               const float *w, float *x, float *r, float *z, ExactSum &sum);

  /** out = inverse (weight in) + idle in. */
  void precondition(const FaceGroup &group, const float *in, float *out);

  /** Products a.b per face, in the order of the lanes; zero where not owned. */
  void face_products(const FaceGroup &group, const float *a, const float *b,
                     double *terms);

  /** sums[j] += V[j].w over the owned faces, for @p count vectors. */
  void dots(const FaceGroup &group, const float *const *V, unsigned int count,
            const float *w, ExactSum *sums);

  /** p = z + beta p. */
  void combine(std::size_t n, float beta, const float *z, float *p);

  /** w -= sum of h[j] V[j]. */
  void subtract(std::size_t n, const float *const *V, const float *h,
                unsigned int count, float *w);

  /**
   * The packed inverses of W_ff + D for the lanes of one batch, in double
   * precision: @p W packed, @p D and @p part (1 or 0) per component, all by
   * lane. A pivot that vanishes against its diagonal leaves its component out.
   */
  void invert(unsigned int n, const double *W, const double *D,
              const double *part, double *work, float *inverse);
} // namespace nsfd::simd
