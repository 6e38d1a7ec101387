#include "nsfd/materials/history_material.h"

#include "matrix_log.h"
#include "strain.h"

#include "j2_flow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace nsfd
{
  using namespace space;

  namespace
  {
    using Strain = J2Flow::Strain;

    template <int dim>
    constexpr unsigned int n_entries = dim *(dim + 1) / 2;

    /** Place in space of entry @p i. */
    template <int dim>
    constexpr unsigned int in_space(const unsigned int i)
    {
      return dim == 2 && i == 2 ? 3u : i;
    }

    template <int dim>
    Strain in_space(const Voigt<dim> &A, const double factor,
                    const double across)
    {
      Strain result{};
      if (dim == 2)
        result[2] = across;
      for (unsigned int i = 0; i < n_entries<dim>; ++i)
        result[in_space<dim>(i)] = factor * A[i];
      return result;
    }

    template <int dim>
    Voigt<dim> of_space(const Strain &A)
    {
      Voigt<dim> result;
      for (unsigned int i = 0; i < n_entries<dim>; ++i)
        result[i] = A[in_space<dim>(i)];
      return result;
    }

    Strain sum(const Strain &A, const double s, const Strain &B)
    {
      Strain result;
      for (unsigned int i = 0; i < A.size(); ++i)
        result[i] = A[i] + s * B[i];
      return result;
    }

    /** alpha, then p. */
    J2Flow::InternalVariables read_variables(const double *history)
    {
      J2Flow::InternalVariables variables;
      std::copy_n(history, 6, variables.alpha.begin());
      variables.equivalent = history[6];
      return variables;
    }

    void write_variables(const J2Flow::InternalVariables &old,
                         const J2Flow::Step &step, double *history)
    {
      const Strain alpha = sum(old.alpha, 1., step.plastic_strain);
      std::copy_n(alpha.begin(), 6, history);
      history[6] = old.equivalent + step.flow;
    }

    template <int dim>
    class J2Material : public HistoryMaterial<dim>
    {
    public:
      explicit J2Material(const J2Flow &flow) : flow_(flow) {}

      VoigtBlock<dim> tangent_at_rest(const double theta) const override
      {
        const J2Flow::Tangent whole = flow_.elastic_tangent(theta / 2.);
        VoigtBlock<dim> result;
        for (unsigned int i = 0; i < n_entries<dim>; ++i)
          for (unsigned int j = 0; j < n_entries<dim>; ++j)
            result[i * n_entries<dim> + j] =
                whole[in_space<dim>(i) * 6 + in_space<dim>(j)];
        return result;
      }

      double modulus() const override { return flow_.modulus(); }

    protected:
      static void put_losses(const J2Flow::Step &from,
                             typename HistoryMaterial<dim>::Step &to)
      {
        to.plastic = from.plastic;
        to.viscous = from.viscous;
        to.numerical = from.numerical;
        to.added = from.added;
      }

      const J2Flow flow_;
    };

    /** C is 2 eps. */
    template <int dim>
    class SmallJ2 final : public J2Material<dim>
    {
    public:
      using J2Material<dim>::J2Material;
      using typename HistoryMaterial<dim>::Way;
      using typename HistoryMaterial<dim>::Step;

      unsigned int n_history() const override { return 7; }
      void begin(double *history) const override
      {
        std::fill_n(history, n_history(), 0.);
      }

      double energy(const Voigt<dim> &C, const double *history) const override
      {
        const auto variables = read_variables(history);
        return this->flow_.energy(
            sum(in_space<dim>(C, 0.5, 0.), -1., variables.alpha), variables);
      }

      bool step(const Way &way, const bool with_tangent, Step &result,
                double *history) const override
      {
        const auto variables = read_variables(way.history);
        J2Flow::Step step;
        if (!this->flow_.step(
                sum(in_space<dim>(way.C0, 0.5, 0.), -1., variables.alpha),
                sum(in_space<dim>(way.C1, 0.5, 0.), -1., variables.alpha),
                variables, way.time_step, way.theta, with_tangent, step))
          return false;
        this->put_losses(step, result);
        result.S = of_space<dim>(step.stress);
        if (with_tangent)
          for (unsigned int i = 0; i < n_entries<dim>; ++i)
            for (unsigned int j = 0; j < n_entries<dim>; ++j)
              result.tangent[i * n_entries<dim> + j] =
                  step.tangent[in_space<dim>(i) * 6 + in_space<dim>(j)] / 2.;
        if (history)
          write_variables(variables, step, history);
        return true;
      }

      bool state(const Voigt<dim> &C, const double *history, Voigt<dim> &S,
                 double &energy) const override
      {
        const auto variables = read_variables(history);
        const Strain elastic =
            sum(in_space<dim>(C, 0.5, 0.), -1., variables.alpha);
        S = of_space<dim>(this->flow_.stress(elastic));
        energy = this->flow_.energy(elastic, variables);
        return std::isfinite(energy);
      }

      std::array<double, 6> stress(const double *gradient,
                                   const double *history) const override
      {
        Voigt<dim> C;
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = a; b < dim; ++b)
            C[voigt_place<dim>(a, b)] =
                gradient[a * dim + b] + gradient[b * dim + a];
        return this->flow_.stress(
            sum(in_space<dim>(C, 0.5, 0.), -1., read_variables(history).alpha));
      }

      double equivalent_strain(const double *history) const override
      {
        return history[6];
      }
    };

    /** C is F^T F; F_p^{-1} = G comes first of what is kept. */
    template <int dim>
    class FiniteJ2 final : public J2Material<dim>
    {
    public:
      using J2Material<dim>::J2Material;
      using typename HistoryMaterial<dim>::Way;
      using typename HistoryMaterial<dim>::Step;

      unsigned int n_history() const override { return 16; }
      void begin(double *history) const override
      {
        std::fill_n(history, n_history(), 0.);
        history[0] = history[4] = history[8] = 1.;
      }

      double energy(const Voigt<dim> &C, const double *history) const override
      {
        const Spectrum e = elastic(C, read_matrix(history));
        if (!e.positive())
          return std::numeric_limits<double>::infinity();
        return this->flow_.energy(e.half_log(), read_variables(history + 9));
      }

      bool step(const Way &way, const bool with_tangent, Step &result,
                double *history) const override
      {
        const Mat3 G = read_matrix(way.history);
        const auto variables = read_variables(way.history + 9);
        const Spectrum start = elastic(way.C0, G), end = elastic(way.C1, G);
        if (!start.positive() || !end.positive())
          return false;
        J2Flow::Step step;
        if (!this->flow_.step(start.half_log(), end.half_log(), variables,
                              way.time_step, way.theta, with_tangent, step))
          return false;
        this->put_losses(step, result);
        const LogSecant secant(start, end);
        result.S = of_space<dim>(forward(G, secant.pulled_back(step.stress)));
        if (with_tangent) {
          const auto turn = secant.derivative_at_end(step.stress);
          for (unsigned int j = 0; j < n_entries<dim>; ++j) {
            Strain H{};
            H[in_space<dim>(j)] = 1. / voigt_weight<dim>(j);
            H = back(G, H);
            const Strain dE = half_log_change(end, H);
            Strain dT{};
            for (unsigned int k = 0; k < 6; ++k)
              for (unsigned int l = 0; l < 6; ++l)
                dT[k] += step.tangent[k * 6 + l] * voigt_weight<3>(l) * dE[l];
            const Voigt<dim> dS = of_space<dim>(
                forward(G, sum(secant.pulled_back(dT), 1., turn(H))));
            for (unsigned int i = 0; i < n_entries<dim>; ++i)
              result.tangent[i * n_entries<dim> + j] = dS[i];
          }
        }
        if (history) {
          write_matrix(step.flow > 0. ? flown(G, end, step) : G, history);
          write_variables(variables, step, history + 9);
        }
        return true;
      }

      bool state(const Voigt<dim> &C, const double *history, Voigt<dim> &S,
                 double &energy) const override
      {
        const Mat3 G = read_matrix(history);
        const Spectrum e = elastic(C, G);
        if (!e.positive())
          return false;
        const Strain E = e.half_log();
        S = of_space<dim>(
            forward(G, LogSecant(e, e).pulled_back(this->flow_.stress(E))));
        energy = this->flow_.energy(E, read_variables(history + 9));
        return std::isfinite(energy);
      }

      std::array<double, 6> stress(const double *gradient,
                                   const double *history) const override
      {
        double F[dim * dim];
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            F[a * dim + b] = gradient[a * dim + b] + (a == b ? 1. : 0.);
        const Mat3 G = read_matrix(history);
        const Spectrum e = elastic(symmetric_product<dim>(F, F), G);
        const double J = jacobian<dim>(F);
        if (!e.positive() || !(J > 0.))
          return {};
        const Strain S = forward(
            G, LogSecant(e, e).pulled_back(this->flow_.stress(e.half_log())));
        Mat3 full{};
        full[2][2] = 1.;
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            full[a][b] = F[a * dim + b];
        return sum({}, 1. / J, forward(full, S));
      }

      double equivalent_strain(const double *history) const override
      {
        return history[15];
      }

    private:
      static Mat3 read_matrix(const double *history)
      {
        Mat3 A;
        for (unsigned int i = 0; i < 3; ++i)
          std::copy_n(history + 3 * i, 3, A[i].begin());
        return A;
      }

      static void write_matrix(const Mat3 &A, double *history)
      {
        for (unsigned int i = 0; i < 3; ++i)
          std::copy_n(A[i].begin(), 3, history + 3 * i);
      }

      /** G^T A G. */
      static Strain back(const Mat3 &G, const Strain &A)
      {
        return entries(transposed(G) * (matrix(A) * G));
      }

      /** G A G^T. */
      static Strain forward(const Mat3 &G, const Strain &A)
      {
        return entries(G * (matrix(A) * transposed(G)));
      }

      /** Of F_e^T F_e = G^T C G. */
      static Spectrum elastic(const Voigt<dim> &C, const Mat3 &G)
      {
        return Spectrum(back(G, in_space<dim>(C, 1., 1.)));
      }

      /** G Z with Z F_e^T F_e Z = exp(2 E) and Z symmetric. */
      static Mat3 flown(const Mat3 &G, const Spectrum &trial,
                        const J2Flow::Step &step)
      {
        const Strain wanted =
            Spectrum(sum(trial.half_log(), -1., step.plastic_strain))
                .function([](const double e) { return std::exp(2. * e); });
        const Strain root =
            trial.function([](const double c) { return std::sqrt(c); });
        const Strain inverse =
            trial.function([](const double c) { return 1. / std::sqrt(c); });
        const Strain middle =
            Spectrum(forward(matrix(root), wanted))
                .function([](const double c) { return std::sqrt(c); });
        const Mat3 result = G * matrix(forward(matrix(inverse), middle));
        const double det = dot(result[0], space::cross(result[1], result[2]));
        return (1. / std::cbrt(det)) * result; // it is one to round-off
      }
    };
  } // namespace

  template <int dim>
  std::unique_ptr<const HistoryMaterial<dim>>
  make_history_material(const double young, const double poisson,
                        const PlasticInput &plastic, const bool finite,
                        const bool plane_stress)
  {
    const J2Flow flow(young, poisson, plane_stress, plastic);
    if (!finite)
      return std::make_unique<SmallJ2<dim>>(flow);
    if (plane_stress)
      throw std::invalid_argument("no flow of finite strain in plane stress");
    return std::make_unique<FiniteJ2<dim>>(flow);
  }

  template std::unique_ptr<const HistoryMaterial<2>>
  make_history_material<2>(double, double, const PlasticInput &, bool, bool);
  template std::unique_ptr<const HistoryMaterial<3>>
  make_history_material<3>(double, double, const PlasticInput &, bool, bool);
} // namespace nsfd
