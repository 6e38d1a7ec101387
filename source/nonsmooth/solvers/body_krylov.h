#pragma once

#include "linear_algebra/sparse_lu.h"
#include "soft_space.h"

#include <vector>

namespace nsfd
{
  /**
   * Bodies joined by stiffnesses S_i at their points, solved by GMRES. Given
   * momenta b and changes d of impulses: velocities x and impulses P with
   *
   *     M_hat x = b + H^T P,      P = d - S H x,
   *
   * S dim x dim per point, neither symmetric nor bounded: that of a contact
   * that sticks is 1e7 times what its bodies oppose, and d belongs to it. With
   * c = 20 times what they oppose, G = (I + S/c)^{-1} and S_c = S G, which is
   * at most c, the same equations are
   *
   *     (M_hat + H^T S_c H) x + H^T Q = b + H^T G d,
   *     (S_c/c) S_c H x - G Q = (S_c/c) G d,      P = G d - S_c H x - Q,
   *
   * Q = 0 where S < c. Nothing in them grows with S, and the second row
   * eliminated by the first is nearly -I (an augmented Lagrangian). The first
   * is preconditioned by the soft space, then by the bodies one by one with the
   * springs around them. On one rank.
   */
  class BodyKrylov
  {
  public:
    using Vector = std::vector<double>;

    BodyKrylov(unsigned int dim, const std::vector<std::size_t> &first_dof,
               const std::vector<FaceRows> &faces);

    /**
     * S_c of all points, to be assembled into K by the caller. @p resistance is
     * that of the bodies at a point, dim per point, the first one counts.
     */
    const Vector &cap(const Vector &S, const Vector &resistance);

    /**
     * @p K with the S_c of cap(), alive and unchanged until the next call, and
     * the values of M_hat on its pattern. Rows of @p K are columns of the
     * matrix. False if the coarse matrix or a body is singular.
     */
    bool prepare(const SparseRows &K, const Vector &bodies);

    static constexpr unsigned int most_iterations = 200;

    /**
     * Until the residual is @p tolerance of the right-hand side, or
     * most_iterations; returns their number.
     */
    unsigned int solve(const Vector &b, const Vector &d, double tolerance,
                       Vector &x, Vector &P);

    const SoftSpace &soft_space() const { return soft_; }

  private:
    void relative_velocity(const double *x, Vector &U) const;
    void add_momentum(const Vector &P, double *r) const;
    void apply(const double *x, double *y);
    void precondition(const double *r, double *z);
    void multiply(const double *x, double *y) const;
    void add_bodies(const double *r, double *z) const;
    bool invert_bodies();

    const unsigned int dim_;
    const std::vector<std::size_t> &first_dof_;
    const std::vector<FaceRows> &faces_;
    const SparseRows *K_ = nullptr;
    SoftSpace soft_;
    SparseLU coarse_;
    Vector capped_, gain_, cap_;     // S_c, G, c; of all points
    std::vector<std::size_t> stiff_; // points with Q
    Vector blocks_; // inverse, column-major, of the bodies in order
    Vector U_, impulse_, coarse_r_, coarse_z_, work_;
  };
} // namespace nsfd
