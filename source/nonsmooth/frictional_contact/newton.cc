#include "alart_curnier.h"
#include "session.h"

namespace nsfd::stored
{
  namespace
  {
    /** Semismooth Newton on the map of Alart and Curnier for the velocities
     * u + weight (r - centre). */
    template <int d>
    class Newton
    {
    public:
      explicit Newton(Session<d> &session)
          : s_(session), p_(session.problem), n_(session.r.size()),
            A_(std::size_t(d * d) * p_.n), B_(A_), F_(n_), step_(n_), r_(n_),
            u_(n_), change_(n_), rho_(p_.n)
      {
        for (int i = 0; i < p_.n; ++i) {
          double trace = 0.;
          for (int c = 0; c < d; ++c)
            trace += p_.diagonal_block(i)[(d + 1) * c];
          rho_[i] = trace > 0. ? d / trace : 1.;
        }
      }

      /** Other weights of the velocities in the map: by each entry of @p
       * factors of the usual ones. Another way to the same solutions. */
      void weigh(const std::vector<double> &factors)
      {
        for (std::size_t i = 0; i < factors.size(); ++i)
          rho_[i] *= factors[i];
      }

      /** The proximal term; a weight of zero takes it away. */
      void push(const double weight, const std::vector<double> &centre)
      {
        weight_ = weight;
        centre_ = centre;
      }

      /** |F|^2 at the current impulses, with its derivative. */
      double linearise() { return map(s_.r, s_.u, true); }

      /** One step with line search on |F|^2 = @p value. After eight cuts the
       * last one is taken: the map has kinks that stop every descent.
       * @return false if nothing finite was found */
      bool advance(const double value, const double regularisation)
      {
        for (std::size_t j = 0; j < A_.size(); ++j)
          A_[j] += (weight_ + regularisation) * B_[j];
        s_.factor(A_, B_);
        for (std::size_t j = 0; j < n_; ++j)
          step_[j] = -F_[j];
        s_.solve(step_);
        p_.multiply(step_.data(), change_.data());
        s_.count_products(1);
        double next = 0., length = 1.;
        for (int cut = 0; cut < 8; ++cut, length *= 0.5) {
          for (std::size_t j = 0; j < n_; ++j) {
            r_[j] = s_.r[j] + length * step_[j];
            u_[j] = s_.u[j] + length * change_[j];
          }
          next = map(r_, u_, false);
          if (next < (1. - 0.1 * length) * value)
            break;
        }
        if (!std::isfinite(next))
          return false;
        std::swap(s_.r, r_);
        s_.judge();
        ++s_.iterations;
        return true;
      }

    private:
      double map(const std::vector<double> &r, const std::vector<double> &u,
                 const bool derive)
      {
        double sum = 0.;
        s_.charge(0.);
        for (int i = 0; i < p_.n; ++i) {
          double w[d];
          for (int c = 0; c < d; ++c)
            w[c] = u[d * i + c];
          if (weight_ > 0.)
            for (int c = 0; c < d; ++c)
              w[c] += weight_ * (r[d * i + c] - centre_[d * i + c]);
          sum += alart_curnier<d>(&r[d * i], w, p_.mu[i], rho_[i], &F_[d * i],
                                  derive ? &A_[d * d * i] : nullptr,
                                  derive ? &B_[d * d * i] : nullptr);
        }
        return sum;
      }

      Session<d> &s_;
      const BlockProblem<d> &p_;
      std::size_t n_;
      std::vector<double> A_, B_, F_, step_, r_, u_, change_, rho_, centre_;
      double weight_ = 0.;
    };
  } // namespace

  template <int d>
  bool newton(Session<d> &s, const NewtonSettings &settings)
  {
    Newton<d> method(s);
    method.weigh(settings.weights);
    Best<d> best(s);
    unsigned int idle = 0;
    const double largest = settings.largest_growth * s.error;
    for (unsigned int k = 0; k < settings.limit && !s.solved(); ++k) {
      if (!method.advance(method.linearise(), settings.regularisation))
        break;
      idle = best.keep(0.9) ? 0 : idle + 1;
      if (idle > settings.idle || s.error > largest)
        break;
    }
    best.restore();
    return s.solved();
  }

  template <int d>
  bool proximal(Session<d> &s, const unsigned int limit,
                const std::vector<double> &weights)
  {
    Newton<d> method(s);
    method.weigh(weights);
    Best<d> best(s);
    double weight = 1e-2;
    for (unsigned int k = 0; k < limit && !s.solved(); ++k) {
      const double before = s.error;
      method.push(weight, s.r);
      double value = method.linearise();
      const double enough = 1e-4 * value;
      bool finite = true;
      for (unsigned int step = 0;
           step < 12 && finite && value > enough && !s.solved(); ++step) {
        finite = method.advance(value, 0.);
        value = method.linearise();
      }
      best.keep();
      if (!finite || !std::isfinite(s.error))
        best.restore();
      weight = s.error < before ? std::max(0.1 * weight, 1e-9)
                                : std::min(10. * weight, 1.);
    }
    best.restore();
    return s.solved();
  }

  template bool newton<2>(Session<2> &, const NewtonSettings &);
  template bool newton<3>(Session<3> &, const NewtonSettings &);
  template bool proximal<2>(Session<2> &, unsigned int,
                            const std::vector<double> &);
  template bool proximal<3>(Session<3> &, unsigned int,
                            const std::vector<double> &);
} // namespace nsfd::stored
