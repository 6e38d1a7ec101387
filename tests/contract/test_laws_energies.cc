#include "every_law.h"

#include "nsfd/cohesive_laws/law_point.h"

namespace every_law::test_laws_energies
{
  using Jump = std::array<double, 3>;

  JumpSize size_of(const Jump &u) { return JumpSize::of<3>(u.data()); }

  Jump along(const Jump &u, const Jump &way, const double share)
  {
    return {
        {u[0] + share * way[0], u[1] + share * way[1], u[2] + share * way[2]}};
  }

  /** R_coh at the jump @p u of a point with this history. */
  Jump traction(const LawPoint &point, const Jump &u, const Reach &history,
                const bool plateau = false)
  {
    Secant b = point.secant(history);
    if (point.law().adds_openings()) { // each direction by itself
      const double T = point.traction(history.opening),
                   slip = std::hypot(u[1], u[2]);
      b = {u[0] > 0. ? T / u[0] : 0.,
           slip > 0. ? T * std::sqrt(point.law().shear_weight()) / slip : 0.};
    } else if (plateau) {
      const double size =
          point.traction(history.opening) / point.reach(size_of(u)).opening;
      b = {size, size * point.law().stiffness_ratio()};
    }
    return {{b.normal * std::max(0., u[0]), b.tangential * u[1],
             b.tangential * u[2]}};
  }

  double product(const Jump &a, const Jump &b)
  {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  /** A law with factors, jumps and times at random. */
  class RandomPoint
  {
  public:
    const CohesiveLaw &law;
    LawPoint point;
    double toughness;   ///< times the factor of the point
    double strength;    ///< likewise
    double end;         ///< openings by which most of the energy is spent
    double slip_length; ///< the same of the slip

    RandomPoint(const CohesiveLaw &its_law, std::mt19937 &random,
                const bool plateau = false)
        : RandomPoint(its_law, random,
                      std::uniform_real_distribution<>{.6, 1.4}, plateau)
    {
    }

    double number(const double lower, const double upper)
    {
      return std::uniform_real_distribution<double>(lower, upper)(random_);
    }

    /** Of a size up to some ends of the law, compressed one time in five. */
    Jump jump(const double size)
    {
      return {{end * size * number(-0.25, 1.),
               slip_length * size * number(-1., 1.),
               slip_length * size * number(-1., 1.)}};
    }

  private:
    std::mt19937 &random_;

    template <typename Factor>
    RandomPoint(const CohesiveLaw &its_law, std::mt19937 &random, Factor factor,
                const bool plateau)
        : RandomPoint(its_law, random, factor(random), factor(random), plateau)
    {
    }
    RandomPoint(const CohesiveLaw &its_law, std::mt19937 &random,
                const double a, const double g, const bool plateau)
        : law(its_law), point(law, a, a / g, plateau),
          toughness(g * law.toughness()), strength(a * law.strength()),
          end(std::min(end_of_softening(law),
                       5. * law.toughness() / law.strength()) *
              g / a),
          slip_length(end / std::sqrt(law.shear_weight())), random_(random)
    {
    }
  };

  /** Law by law, and each extrinsic one also with a plateau. */
  void expect_with_plateaus(
      const std::function<void(const CohesiveLaw &, bool)> &check)
  {
    expect_for_all_laws([&](const CohesiveLaw &law) {
      check(law, false);
      if (law.extrinsic()) {
        SCOPED_TRACE("unloading = plateau");
        check(law, true);
      }
    });
  }

  bool jumps(const CohesiveLaw &law)
  {
    return std::isinf(law.steepest_softening());
  }

  // Within the history the potential is quadratic (a cone on a plateau), so
  // that a centred difference is exact but for round-off (h^2 on a plateau).
  void potential_gives_the_traction(const CohesiveLaw &law, const bool plateau)
  {
    std::mt19937 random(3);
    for (unsigned int k = 0; k < 200; ++k) {
      RandomPoint its(law, random, plateau);
      const LawPoint &point = its.point;
      Jump u = its.jump(1.);
      u[0] = std::abs(u[0]) + 0.01 * its.end;
      const LawState opened = point.moved({}, size_of(u));
      u = along({}, u, its.number(0.2, 0.9));
      const Jump expected = traction(point, u, opened.history, plateau);
      const double h =
          1e-4 * (std::abs(u[0]) + std::abs(u[1]) / its.slip_length * its.end);
      for (unsigned int c = 0; c < 3; ++c) {
        Jump left = u, right = u;
        left[c] -= h;
        right[c] += h;
        const double slope = (point.stored({size_of(right), opened.history}) -
                              point.stored({size_of(left), opened.history})) /
                             (2. * h);
        ASSERT_NEAR(slope, expected[c],
                    (plateau || law.adds_openings() ? 1e-6 : 1e-9) *
                        its.strength * (1. + law.stiffness_ratio()))
            << "component " << c;
      }
      // what a step within the history does is elastic
      EXPECT_EQ(
          point.dissipated(opened, point.moved(opened, size_of(u))).total(),
          0.);
    }
  }

  // On the envelope what is stored and dissipated grows with the power of the
  // traction: forward differences, extrapolated to second order.
  void envelope_gives_the_traction(const CohesiveLaw &law, const bool plateau)
  {
    std::mt19937 random(4);
    unsigned int checked = 0;
    for (unsigned int k = 0; k < 300; ++k) {
      RandomPoint its(law, random, plateau);
      const LawPoint &point = its.point;
      Jump u = its.jump(0.7), way = its.jump(1.);
      u[0] = std::abs(u[0]) + 0.01 * its.end;
      for (unsigned int c = 0; c < 3; ++c)
        way[c] = std::copysign(way[c], u[c]);
      const LawState start = point.moved({}, size_of(u));
      const double d = start.history.opening * point.opening_factor();
      const double h = 1e-5;
      // T'' of a tail next to 0, or of a curve next to its end, is large
      if (kink_between(law, 0.98 * d, 1.02 * d + 1e-3 * end_of_softening(law)))
        continue;
      const auto power = [&](const double share) {
        const LawState next = point.moved(start, size_of(along(u, way, share)));
        return (point.stored(next) + point.dissipated(start, next).total() -
                point.stored(start)) /
               share;
      };
      const double expected =
          product(traction(point, u, start.history, plateau), way);
      const double scale = its.strength * its.end;
      ASSERT_NEAR(2. * power(h / 2.) - power(h), expected, 1e-6 * scale)
          << "at " << d;
      ++checked;
    }
    EXPECT_GT(checked, 100u);
  }

  /**
   * The traction in small steps against what is stored and dissipated, also
   * in small steps: along a straight way, monotone from 0, and along legs that
   * open, close and turn. At rest where damage takes time.
   */
  void energies_are_the_work(const CohesiveLaw &law, const bool plateau)
  {
    std::mt19937 random(5);
    for (unsigned int path = 0; path < 12; ++path) {
      RandomPoint its(law, random, plateau);
      const LawPoint &point = its.point;
      LawState state;
      Jump u{};
      double work = 0., dissipated = 0., booked = 0.;
      const unsigned int n_legs = path % 3 == 0 ? 1 : 5, n = 4000;
      for (unsigned int leg = 0; leg < n_legs; ++leg) {
        Jump way = its.jump(1.);
        if (leg % 2 == 1) // back, past the origin now and then
          way = along({}, u, -its.number(0.2, 1.2));
        for (unsigned int step = 0; step < n; ++step) {
          const Jump middle = along(u, way, 0.5 / n);
          const LawState half = point.moved(state, size_of(middle));
          work +=
              product(traction(point, middle, half.history, plateau), way) / n;
          u = along(u, way, 1. / n);
          const LawState next = point.moved(state, size_of(u));
          const Dissipation lost = point.dissipated(state, next);
          ASSERT_GE(lost.damage, 0.);
          ASSERT_GE(lost.viscous, 0.);
          dissipated += lost.total();
          booked += point.stored(next) - point.stored(state) + lost.total();
          state = next;
        }
        // the rule of the middle: h^2 on smooth curves, h at a jump or kink
        ASSERT_NEAR(work, point.stored(state) + dissipated,
                    (jumps(law) || law.adds_openings() ? 2e-3 : 2e-5) *
                        its.toughness)
            << "path " << path << ", leg " << leg;
      }
      EXPECT_NEAR(booked, point.stored(state) + dissipated,
                  1e-10 * its.toughness);
    }
  }

  // The discrete gradient takes it in one step of any length, damage that
  // takes time included.
  void mean_secants_take_the_work(const CohesiveLaw &law, const bool plateau)
  {
    std::mt19937 random(6);
    for (unsigned int path = 0; path < 1000; ++path) {
      RandomPoint its(law, random, plateau);
      const LawPoint &point = its.point;
      LawState state;
      for (unsigned int step = 0; step < 6; ++step) {
        const Jump u = its.jump(3. * std::pow(10., -3. * its.number(0., 1.)));
        const double time = std::pow(10., its.number(-4., 1.));
        const LawState next = point.moved(state, size_of(u), time);
        const Dissipation lost = point.dissipated(state, next);
        ASSERT_GE(lost.damage, 0.);
        ASSERT_GE(lost.viscous, 0.);
        const Secant b =
            point.mean_secant({point.reach(state.jump), state.history},
                              {point.reach(next.jump), next.history});
        const auto square = [](const double x) { return x * x; };
        const double opening =
            square(next.jump.opening) - square(state.jump.opening);
        const double slip = next.jump.slip_square - state.jump.slip_square;
        const LawPoint::Reached from{point.reach(state.jump), state.history};
        const double to = point.reach(next.jump).opening;
        const double work =
            law.adds_openings()
                ? point.mean_traction(from, to) * (to - from.now.opening)
                : (b.normal * opening + b.tangential * slip) / 2.;
        ASSERT_NEAR(work,
                    point.stored(next) - point.stored(state) + lost.total(),
                    1e-11 * (its.toughness + std::abs(b.normal * opening) +
                             std::abs(b.tangential * slip)))
            << "path " << path << ", step " << step;
        state = next;
      }
    }
  }

  // Whatever came before, with a potential; in pure opening without one.
  void separation_dissipates_the_toughness(const CohesiveLaw &law,
                                           const bool plateau)
  {
    std::mt19937 random(7);
    for (unsigned int path = 0; path < 1000; ++path) {
      RandomPoint its(law, random, plateau);
      const LawPoint &point = its.point;
      LawState state;
      double dissipated = 0.;
      const auto move = [&](const Jump &u) {
        const LawState next = point.moved(state, size_of(u));
        dissipated += point.dissipated(state, next).total();
        state = next;
      };
      for (unsigned int step = 0; step < path % 6; ++step) {
        Jump u = its.jump(2. * std::pow(10., -3. * its.number(0., 1.)));
        if (!law.has_potential())
          u[1] = u[2] = 0.;
        move(u);
      }
      move({{1e9 * its.end, 0., 0.}});
      ASSERT_NEAR(dissipated + point.stored(state), its.toughness,
                  1e-10 * its.toughness)
          << "path " << path;
      if (std::isfinite(law.final_opening())) {
        EXPECT_EQ(point.stored(state), 0.);
      }
    }
    if (law.mixed() == nullptr)
      return;
    // in shear alone: the toughness in shear
    const LawPoint point(law);
    const double far = 1e9 * end_of_softening(law);
    const LawState sheared = point.moved({}, size_of({{0., far, -far}}));
    const double shear = law.mixed()->tangential_energy(0., 2. * far, 0.);
    EXPECT_NEAR(point.dissipated({}, sheared).total(), shear, 1e-11 * shear);
  }

  TEST(LawsContract, PotentialGivesTheTraction)
  {
    expect_with_plateaus(potential_gives_the_traction);
  }

  TEST(LawsContract, EnvelopeGivesTheTraction)
  {
    expect_with_plateaus(envelope_gives_the_traction);
  }

  TEST(LawsContract, EnergiesAreTheWork)
  {
    expect_with_plateaus(energies_are_the_work);
  }

  TEST(LawsContract, MeanSecantsTakeTheWork)
  {
    expect_with_plateaus(mean_secants_take_the_work);
  }

  TEST(LawsContract, SeparationDissipatesTheToughness)
  {
    expect_with_plateaus(separation_dissipates_the_toughness);
  }
} // namespace every_law::test_laws_energies
