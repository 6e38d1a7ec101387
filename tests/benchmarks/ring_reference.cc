#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

/**
 * The expanding ring of prm/verification/ring.prm once more, without any part
 * of nsfd: bars of two lumped masses, central differences, the linear law with
 * unloading to the origin, inelastic contact, periodic. It answers one
 * question: are the sizes of fragments those of the model, where they are not
 * those of the published fits? In units of c, R, E and t_0; G = 1, so that s_0
 * = 1.
 */
namespace
{
  struct Result {
    double size = 0.;     ///< mean, over s_0
    double per_face = 0.; ///< dissipated over G and broken faces
    unsigned int broken = 0;
  };

  double zhou(const double x)
  {
    return 4.5 / (1. + 0.77 * std::pow(x, 0.25) + 5.4 * std::pow(x, 0.75));
  }
  double levy(const double x) { return 3. / (1. + 4.5 * std::pow(x, 2. / 3.)); }

  /** Nodes of the bars and the faces at their left ends. */
  class Ring
  {
  public:
    Ring(const double rate, const double cell, const unsigned int n,
         const double scatter, const unsigned int seed)
        : n_(n), cell_(cell), turn_(rate * cell * n),
          time_((1. - scatter) / rate)
    {
      std::mt19937 generator(seed);
      std::uniform_real_distribution<double> noise(-scatter, scatter);
      for (unsigned int i = 0; i < n; ++i) {
        strength_.push_back(1. + noise(generator));
        for (unsigned int side = 0; side < 2; ++side) {
          v_[side].push_back(rate * cell * (i + side));
          u_[side].push_back(v_[side].back() * time_);
        }
      }
      force_.resize(n);
      largest_.resize(n);
      opens_.resize(n);
    }

    void run(const double duration)
    {
      const double step = 0.1 * cell_;
      for (const double end = time_ + duration; time_ < end; time_ += step) {
        for (unsigned int i = 0; i < n_; ++i)
          force_[i] = traction(i);
        for (unsigned int i = 0; i < n_; ++i) {
          const double share = step / (cell_ / 2.);
          v_[0][i] += share * (strain(i) - force_[i]);
          v_[1][i] += share * (force_[(i + 1) % n_] - strain(i));
        }
        for (unsigned int i = 0; i < n_; ++i)
          meet(i, step);
        for (unsigned int side = 0; side < 2; ++side)
          for (unsigned int i = 0; i < n_; ++i)
            u_[side][i] += step * v_[side][i];
      }
    }

    Result result() const
    {
      Result result;
      double dissipated = 0.;
      for (unsigned int i = 0; i < n_; ++i) {
        result.broken += largest_[i] >= critical;
        dissipated += strength_[i] * std::min(largest_[i] / critical, 1.);
      }
      result.size = cell_ * n_ / std::max(result.broken, 1u);
      result.per_face = dissipated / std::max(result.broken, 1u);
      return result;
    }

  private:
    static constexpr double critical = 2.; ///< G = R delta_c / 2

    unsigned int before(const unsigned int i) const
    {
      return i == 0 ? n_ - 1 : i - 1;
    }
    double strain(const unsigned int i) const
    {
      return (u_[1][i] - u_[0][i]) / cell_;
    }
    double opening(const unsigned int i) const
    {
      return u_[0][i] - u_[1][before(i)] + (i == 0 ? turn_ * time_ : 0.);
    }

    double traction(const unsigned int i)
    {
      const double tied = (strain(i) + strain(before(i))) / 2.;
      opens_[i] |= tied > strength_[i];
      if (!opens_[i])
        return tied;
      const double w = opening(i);
      largest_[i] = std::max(largest_[i], w);
      const double peak =
          std::max(0., strength_[i] * (1. - largest_[i] / critical));
      return largest_[i] > 0. ? peak * std::max(w, 0.) / largest_[i] : peak;
    }

    /** Tied faces move together, open ones do not pass through each other. */
    void meet(const unsigned int i, const double step)
    {
      double &left = v_[1][before(i)], &right = v_[0][i];
      const double apart = right - left + (i == 0 ? turn_ : 0.);
      const double rest = opens_[i] ? -opening(i) / step : 0.;
      if (opens_[i] && apart >= rest)
        return;
      right += (rest - apart) / 2.;
      left -= (rest - apart) / 2.;
    }

    const unsigned int n_;
    const double cell_, turn_; ///< turn: how fast the ring grows, per turn
    double time_;
    std::vector<double> u_[2], v_[2], strength_, force_, largest_;
    std::vector<char> opens_;
  };

  void print(const double x, const double scatter, const unsigned int per_size)
  {
    constexpr unsigned int n_seeds = 4, n_sizes = 40;
    double size = 0., per_face = 0., low = 1e300, high = 0.;
    for (unsigned int seed = 1; seed <= n_seeds; ++seed) {
      Ring ring(x, zhou(x) / per_size, n_sizes * per_size, scatter, seed);
      ring.run(12. / (zhou(x) * x));
      const Result result = ring.result();
      size += result.size / n_seeds;
      per_face += result.per_face / n_seeds;
      low = std::min(low, result.size);
      high = std::max(high, result.size);
    }
    fmt::print("| {:g} | {:g} | {} | {:.4f} ({:.4f} to {:.4f}) | {:.2f} | "
               "{:.2f} | {:.2f} |\n",
               x, scatter, per_size, size, low, high, size / zhou(x),
               size / levy(x), per_face);
  }
} // namespace

int main()
{
  fmt::print(
      "| x | scatter | cells per size | size / s_0, 4 seeds | over Zhou "
      "| over Levy | dissipated per face / G |\n|---|---|---|---|---|---|"
      "---|\n");
  for (const double x : {1., 10., 31.6, 100., 316.})
    for (const double scatter : {0.01, 1e-3, 1e-5})
      print(x, scatter, 14);
  for (const double x : {1., 10., 100.})
    print(x, 0.01, 56);
}
