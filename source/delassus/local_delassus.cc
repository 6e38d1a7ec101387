#include "delassus_operator.h"
#include "simd_system.h"

#include "core/cost.h"
#include "inner_solver.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /**
     * Block Jacobi by face: the inverses of W_ff + D_f on the components that
     * take part, zero on the others.
     */
    template <int dim>
    class FaceBlocks : public DelassusOperator<dim>
    {
    public:
      FaceBlocks(const Communicator &communicator, const Bodies &bodies,
                 const InterfacePoints<dim> &points)
          : DelassusOperator<dim>(communicator, bodies, points)
      {
        this->keeps_face_blocks_ = true;
      }

      void prepare_preconditioner(const std::vector<double> &D) override
      {
        const Charge charge(Cost::preconditioner);
        const auto &faces = this->points_.faces;
        factors_.resize(this->face_offset_.back());
        for (std::size_t f = 0; f < faces.size(); ++f) {
          const unsigned int n = faces[f].count * dim;
          const std::size_t first = std::size_t(faces[f].first) * dim;
          const double *W = this->face_block(f);
          double *L = factors_.data() + this->face_offset_[f];
          for (unsigned int i = 0; i < n; ++i) {
            const bool active = D[first + i] >= 0.;
            for (unsigned int j = 0; j <= i; ++j)
              L[i * n + j] = active && D[first + j] >= 0.
                                 ? W[i * n + j] + (i == j ? D[first + i] : 0.)
                                 : (i == j ? 1. : 0.);
          }
          factorise(L, n);
          invert(L, n);
          for (unsigned int i = 0; i < n; ++i)
            if (D[first + i] < 0.)
              for (unsigned int j = 0; j < n; ++j)
                L[i * n + j] = L[j * n + i] = 0.;
        }
      }

      void precondition(const double *r, double *z) const override
      {
        const Charge charge(Cost::precondition);
        const auto &faces = this->points_.faces;
        for (std::size_t f = 0; f < faces.size(); ++f) {
          const unsigned int n = faces[f].count * dim;
          const std::size_t first = std::size_t(faces[f].first) * dim;
          const double *A = factors_.data() + this->face_offset_[f];
          // two Gauss points in two dimensions are by far the most frequent
          if (n == 4)
            multiply<4>(A, r + first, z + first);
          else
            multiply(A, n, r + first, z + first);
        }
      }

    private:
      /**
       * Cholesky in place with the inverse pivots on the diagonal. W may be
       * singular on a face (rigid modes, more points than traces): a pivot
       * that vanishes against its diagonal entry leaves its component out.
       */
      static void factorise(double *L, const unsigned int n)
      {
        for (unsigned int j = 0; j < n; ++j) {
          const double original = L[j * n + j];
          double pivot = original;
          for (unsigned int k = 0; k < j; ++k)
            pivot -= L[j * n + k] * L[j * n + k];
          const double inverse =
              pivot > 1e-10 * original ? 1. / std::sqrt(pivot) : 0.;
          L[j * n + j] = inverse;
          for (unsigned int i = j + 1; i < n; ++i) {
            double value = L[i * n + j];
            for (unsigned int k = 0; k < j; ++k)
              value -= L[i * n + k] * L[j * n + k];
            L[i * n + j] = value * inverse;
          }
        }
      }

      /** (L L^T)^{-1} in place of L, whose diagonal holds inverse pivots. */
      void invert(double *L, const unsigned int n)
      {
        inverse_.assign(std::size_t(n) * n, 0.);
        for (unsigned int c = 0; c < n; ++c) {
          double *x = inverse_.data() + std::size_t(c) * n;
          for (unsigned int i = c; i < n; ++i) {
            double value = i == c ? 1. : 0.;
            for (unsigned int k = c; k < i; ++k)
              value -= L[i * n + k] * x[k];
            x[i] = value * L[i * n + i];
          }
        }
        // columns of L^{-1} are rows of inverse_: A^{-1} = L^{-T} L^{-1}
        std::fill(L, L + std::size_t(n) * n, 0.);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j <= i; ++j) {
            double value = 0.;
            for (unsigned int k = i; k < n; ++k)
              value += inverse_[i * n + k] * inverse_[j * n + k];
            L[i * n + j] = L[j * n + i] = value;
          }
      }

      template <unsigned int n>
      static void multiply(const double *A, const double *r, double *z)
      {
        for (unsigned int i = 0; i < n; ++i) {
          double value = 0.;
          for (unsigned int j = 0; j < n; ++j)
            value += A[i * n + j] * r[j];
          z[i] = value;
        }
      }

      static void multiply(const double *A, const unsigned int n,
                           const double *r, double *z)
      {
        std::fill(z, z + n, 0.);
        for (unsigned int j = 0; j < n; ++j)
          for (unsigned int i = 0; i < n; ++i)
            z[i] += A[j * n + i] * r[j];
      }

      std::vector<double> factors_, inverse_;
    };

    /** With Newton systems in single precision, in batches of bodies. */
    template <int dim>
    class BatchedDelassus : public FaceBlocks<dim>, public InnerSolver
    {
    public:
      using FaceBlocks<dim>::FaceBlocks;

      unsigned int solve_inner(const InnerSystem &system,
                               const std::vector<double> &r,
                               std::vector<double> &x) override
      {
        if (!batched_)
          set_batched();
        const auto before = batched_->applications();
        const unsigned int iterations =
            system.jacobian ? batched_->gmres(system, r, x)
                            : batched_->conjugate_gradients(system, r, x);
        this->counters_.delassus += batched_->applications() - before;
        return iterations;
      }

    protected:
      void set_batched()
      {
        if (!batched_)
          batched_ = std::make_unique<SimdSystem<dim>>(
              this->communicator_, this->bodies_, this->points_);
        batched_->reinit(*this);
      }

      std::unique_ptr<SimdSystem<dim>> batched_;
    };

    template <int dim>
    class LocalDelassus final : public BatchedDelassus<dim>
    {
    public:
      using BatchedDelassus<dim>::BatchedDelassus;

      void reinit(const double time_step, const double theta) override
      {
        const bool changes =
            time_step != this->time_step_ || theta != this->theta_;
        DelassusOperator<dim>::reinit(time_step, theta);
        if (!changes)
          return;
        const Charge charge(Cost::blocks);
        this->set_batched();
      }
    };

    /** Every step has bodies and points of its own. */
    template <int dim>
    class MovingDelassus final : public BatchedDelassus<dim>
    {
    public:
      using BatchedDelassus<dim>::BatchedDelassus;

      void reinit(const double time_step, const double theta) override
      {
        DelassusOperator<dim>::reinit(time_step, theta);
        this->batched_.reset();
      }
    };
  } // namespace

  template <int dim>
  std::unique_ptr<DelassusOperator<dim>>
  make_moving_delassus(const Communicator &communicator, const Bodies &bodies,
                       const InterfacePoints<dim> &points)
  {
    return std::make_unique<MovingDelassus<dim>>(communicator, bodies, points);
  }

  template <int dim>
  std::unique_ptr<DelassusOperator<dim>>
  make_local_delassus(const Communicator &communicator, const Bodies &bodies,
                      const InterfacePoints<dim> &points)
  {
    return std::make_unique<LocalDelassus<dim>>(communicator, bodies, points);
  }

  template std::unique_ptr<DelassusOperator<2>>
  make_moving_delassus<2>(const Communicator &, const Bodies &,
                          const InterfacePoints<2> &);
  template std::unique_ptr<DelassusOperator<3>>
  make_moving_delassus<3>(const Communicator &, const Bodies &,
                          const InterfacePoints<3> &);
  template std::unique_ptr<DelassusOperator<2>>
  make_local_delassus<2>(const Communicator &, const Bodies &,
                         const InterfacePoints<2> &);
  template std::unique_ptr<DelassusOperator<3>>
  make_local_delassus<3>(const Communicator &, const Bodies &,
                         const InterfacePoints<3> &);
} // namespace nsfd
