#include "session.h"

namespace nsfd::stored
{
  template <int d>
  Sweeps<d>::Sweeps(Session<d> &session) : s_(session)
  {
    const BlockProblem<d> &p = s_.problem;
    contacts_.reserve(p.n);
    for (int i = 0; i < p.n; ++i)
      contacts_.emplace_back(p.diagonal_block(i), p.mu[i]);
  }

  template <int d>
  void Sweeps<d>::run(const unsigned int count)
  {
    const BlockProblem<d> &p = s_.problem;
    double *const r = s_.r.data();
    const int *const order = order_.empty() ? nullptr : order_.data();
    for (unsigned int sweep = 0; sweep < count; ++sweep)
      for (int place = 0; place < p.n; ++place) {
        const int i = order ? order[place] : place;
        double b[d];
        std::copy(&p.q[d * i], &p.q[d * i] + d, b);
        const double *w = &p.block[std::size_t(d * d) * p.start[i]];
        for (int k = p.start[i]; k < p.start[i + 1]; ++k, w += d * d) {
          if (k == p.diagonal[i])
            continue;
          const double *const x = r + d * p.column[k];
          for (int c = 0; c < d; ++c)
            for (int e = 0; e < d; ++e)
              b[c] += w[d * c + e] * x[e];
        }
        contacts_[i].solve(b, r + d * i);
      }
    s_.iterations += count;
    s_.count_products(count);
  }

  template <int d>
  bool gauss_seidel(Session<d> &s, const unsigned int limit)
  {
    Sweeps<d> sweeps(s);
    // a judgement costs as much as a sweep
    for (unsigned int k = 0; k < limit && !s.solved();) {
      const unsigned int count = k < 16 ? 1 : std::min(4u, limit - k);
      sweeps.run(count);
      s.judge();
      k += count;
    }
    return s.solved();
  }

  template class Sweeps<2>;
  template class Sweeps<3>;
  template bool gauss_seidel<2>(Session<2> &, unsigned int);
  template bool gauss_seidel<3>(Session<3> &, unsigned int);
} // namespace nsfd::stored
