#include "nsfd/dynamics/dynamics.h"

#include <cmath>

namespace nsfd
{
  namespace
  {
    /**
     * Block Jacobi by face: the Cholesky factors of W_ff + D_f, components
     * that do not take part replaced by the identity.
     */
    template <int dim>
    class ElementwiseDynamics final : public Dynamics<dim>
    {
    public:
      using Dynamics<dim>::Dynamics;

      void prepare_preconditioner(const std::vector<double> &D) override
      {
        const auto &faces = this->points_.faces;
        factors_.resize(this->face_offset_.back());
        takes_part_.resize(D.size());
        for (std::size_t f = 0; f < faces.size(); ++f) {
          const unsigned int n = faces[f].count * dim;
          const std::size_t first = std::size_t(faces[f].first) * dim;
          const double *W = this->face_block(f);
          double *L = factors_.data() + this->face_offset_[f];
          for (unsigned int i = 0; i < n; ++i) {
            const bool active = D[first + i] >= 0.;
            takes_part_[first + i] = active;
            for (unsigned int j = 0; j <= i; ++j)
              L[i * n + j] =
                active && D[first + j] >= 0.
                  ? W[i * n + j] + (i == j ? D[first + i] : 0.)
                  : (i == j ? 1. : 0.);
          }
          factorise(L, n);
        }
      }

      void precondition(const double *r, double *z) const override
      {
        const auto &faces = this->points_.faces;
        for (std::size_t f = 0; f < faces.size(); ++f) {
          const unsigned int n = faces[f].count * dim;
          const std::size_t first = std::size_t(faces[f].first) * dim;
          const double *L = factors_.data() + this->face_offset_[f];
          double *x = z + first;
          for (unsigned int i = 0; i < n; ++i) {
            double value = takes_part_[first + i] ? r[first + i] : 0.;
            for (unsigned int k = 0; k < i; ++k)
              value -= L[i * n + k] * x[k];
            x[i] = value * L[i * n + i];
          }
          for (unsigned int i = n; i-- > 0;) {
            double value = x[i];
            for (unsigned int k = i + 1; k < n; ++k)
              value -= L[k * n + i] * x[k];
            x[i] = value * L[i * n + i];
          }
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

      std::vector<double> factors_;
      std::vector<char> takes_part_;
    };
  } // namespace

  template <int dim>
  std::unique_ptr<Dynamics<dim>>
  make_elementwise_dynamics(const Communicator &communicator,
                            const Bodies &bodies,
                            const InterfacePoints<dim> &points)
  {
    return std::make_unique<ElementwiseDynamics<dim>>(communicator, bodies,
                                                      points);
  }

  template std::unique_ptr<Dynamics<2>> make_elementwise_dynamics<2>(
    const Communicator &, const Bodies &, const InterfacePoints<2> &);
  template std::unique_ptr<Dynamics<3>> make_elementwise_dynamics<3>(
    const Communicator &, const Bodies &, const InterfacePoints<3> &);
} // namespace nsfd
