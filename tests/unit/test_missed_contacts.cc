// Continuous detection: what a step passes over, of surfaces that are made by
// hand.
#include "separating_axes.h"
#include "surface_scene.h"

#include "contact_detection/missed_contacts.h"

#include <gtest/gtest.h>

namespace test_missed_contacts
{
  using namespace nsfd;
  using namespace surface_scene;
  using surface_scene::Scene;

  template <int dim>
  using Missed = std::optional<MissedContact<dim>>;

  template <int dim>
  Missed<dim> look(const Scene<dim> &scene,
                   const std::vector<std::vector<double>> &later,
                   const double thickness = 1e3)
  {
    StepPath path = {scene.x.data()};
    for (const auto &x : later)
      path.push_back(x.data());
    return first_missed<dim>(
        scene.surfaces, path, std::vector<double>(10, thickness),
        [](unsigned int) { return true; }, apart);
  }

  /** The vertices of a scene from @p first on, moved. */
  template <int dim>
  std::vector<double> moved(const Scene<dim> &scene, const unsigned int first,
                            const Place<dim> &by)
  {
    std::vector<double> x = scene.x;
    for (std::size_t i = first * dim; i < x.size(); ++i)
      x[i] += by[i % dim];
    return x;
  }

  /** A plate from 0 to 0.1, ten wide, and a box of size 1 that is 0.5 off. */
  template <int dim>
  Scene<dim> box_and_plate(const double aside = 0.)
  {
    Scene<dim> scene;
    Place<dim> low{}, high{}, box_low{}, box_high{};
    low.fill(-5.);
    high.fill(5.);
    low[0] = 0.;
    high[0] = 0.1;
    box_low.fill(-0.5 + aside);
    box_high.fill(0.5 + aside);
    box_low[0] = -1.5;
    box_high[0] = -0.5;
    add_box(scene, 0, low, high);
    add_box(scene, 1, box_low, box_high);
    scene.all_points();
    scene.all_edges();
    return scene;
  }
  template <int dim>
  constexpr unsigned int box_begins = dim == 2 ? 4 : 8;

  template <int dim>
  void expect_box_stopped()
  {
    const Scene<dim> scene = box_and_plate<dim>();
    Place<dim> way{};
    for (const double length : {0.62, 0.8, 1.5, 2.2, 40.}) {
      SCOPED_TRACE(length);
      way[0] = length;
      const auto missed =
          look<dim>(scene, {moved<dim>(scene, box_begins<dim>, way)}, 0.1);
      ASSERT_TRUE(missed);
      // in at 0.5; half as deep as a quarter of the plate is thick
      EXPECT_NEAR(missed->share * length, 0.5 + 0.0125, 1e-9);
      EXPECT_NEAR(missed->place[0], 0., 1e-12);
      EXPECT_EQ(missed->body_1, 0u);
      EXPECT_EQ(missed->body_2, 1u);
    }
    // does not come so far, or only as deep as the search finds it
    for (const double length : {0.2, 0.499, 0.51, 0.524}) {
      way[0] = length;
      EXPECT_FALSE(
          look<dim>(scene, {moved<dim>(scene, box_begins<dim>, way)}, 0.1))
          << length;
    }
    // parallel to it, and away from it
    way = {};
    way[1] = 30.;
    EXPECT_FALSE(
        look<dim>(scene, {moved<dim>(scene, box_begins<dim>, way)}, 0.1));
    way = {};
    way[0] = -30.;
    EXPECT_FALSE(
        look<dim>(scene, {moved<dim>(scene, box_begins<dim>, way)}, 0.1));
  }

  TEST(MissedContacts, BoxThroughAPlate)
  {
    expect_box_stopped<2>();
    expect_box_stopped<3>();
  }

  // much thinner than what a corner may overlap unseen
  TEST(MissedContacts, BoxThroughAFoil)
  {
    Scene<2> scene;
    add_box(scene, 0, {0., -5.}, {1e-3, 5.});
    add_box(scene, 1, {-1.5, -0.5}, {-0.5, 0.5});
    scene.all_points();
    for (const double way : {0.51, 2., 50.}) {
      const auto missed = look<2>(scene, {moved<2>(scene, 4, {way, 0.})}, 1e-3);
      ASSERT_TRUE(missed) << way;
      EXPECT_NEAR(missed->share * way, 0.5 + 1.25e-4, 1e-9);
    }
  }

  TEST(MissedContacts, OnlyTheMotionPastEachOtherCounts)
  {
    Scene<2> scene = box_and_plate<2>();
    const auto together = moved<2>(scene, 0, {100., 3.});
    EXPECT_FALSE(look<2>(scene, {together}, 0.1));
    Scene<2> both = scene;
    both.x = together;
    EXPECT_TRUE(look<2>(scene, {moved<2>(both, 4, {0.8, 0.})}, 0.1));
  }

  TEST(MissedContacts, BodiesThatDoNotTouch)
  {
    const Scene<2> scene = box_and_plate<2>();
    const std::vector<double> end = moved<2>(scene, 4, {2., 0.});
    const std::vector<double> thickness(2, 0.1);
    const StepPath path = {scene.x.data(), end.data()};
    const auto all = [](unsigned int) { return true; };
    EXPECT_TRUE(first_missed<2>(scene.surfaces, path, thickness, all, apart));
    EXPECT_FALSE(
        first_missed<2>(scene.surfaces, path, thickness, all,
                        [](unsigned int, unsigned int) { return true; }));
    // each rank for its own bodies
    EXPECT_TRUE(first_missed<2>(
        scene.surfaces, path, thickness,
        [](const unsigned int b) { return b == 1; }, apart));
  }

  TEST(MissedContacts, FlushBoxesSlide)
  {
    // beside each other, one moves past the other one and beyond its end
    for (const double gap : {0., 1e-12, -1e-12}) {
      Scene<2> scene;
      add_box(scene, 0, {0., 0.}, {1., 1.});
      add_box(scene, 1, {1. + gap, 1.2}, {2. + gap, 2.2});
      scene.all_points();
      EXPECT_FALSE(look<2>(scene, {moved<2>(scene, 4, {0., -5.})})) << gap;
      EXPECT_FALSE(look<2>(scene, {moved<2>(scene, 4, {0., -1.7})})) << gap;
    }
    // on each other
    Scene<3> scene;
    add_box(scene, 0, {0., 0., 0.}, {1., 1., 1.});
    add_box(scene, 1, {0.3, 0.2, 1.}, {1.3, 1.2, 2.});
    scene.all_points();
    scene.all_edges();
    for (const double way : {0.4, 3., -3.})
      EXPECT_FALSE(look<3>(scene, {moved<3>(scene, 8, {way, 0.1, 0.})})) << way;
  }

  TEST(MissedContacts, GrazedCorners)
  {
    // the left corner of a square on its tip goes along the diagonal past the
    // upper right corner of the box, below it by `deep`
    for (const double deep : {0.3, 0.05, 0.003, -0.05}) {
      Scene<2> scene;
      add_box(scene, 0, {0., 0.}, {1., 1.});
      const double r = std::sqrt(0.5), c = 1. - deep * r;
      add_polygon(scene, 1,
                  {{c - 2., c + 2.},
                   {c - 2. + r, c + 2. - r},
                   {c - 2. + 2. * r, c + 2.},
                   {c - 2. + r, c + 2. + r}});
      scene.all_points();
      const auto missed = look<2>(scene, {moved<2>(scene, 4, {4., -4.})});
      EXPECT_EQ(bool(missed), deep > 0.01) << deep;
    }
  }

  TEST(MissedContacts, EdgesAcrossEdges)
  {
    // two roofs that cross at right angles; no corner comes near the other one
    const double r = std::sqrt(0.5);
    Scene<3> scene;
    add_box(scene, 0, {-3., -0.5, -0.5}, {3., 0.5, 0.5});
    for (std::size_t i = 0; i < scene.x.size(); i += 3) {
      const double y = scene.x[i + 1], z = scene.x[i + 2];
      scene.x[i + 1] = r * (y - z);
      scene.x[i + 2] = r * (y + z);
    }
    add_box(scene, 1, {-0.5, -3., -0.5}, {0.5, 3., 0.5});
    for (std::size_t i = 24; i < scene.x.size(); i += 3) {
      const double x = scene.x[i], z = scene.x[i + 2];
      scene.x[i] = r * (x - z);
      scene.x[i + 2] = r * (x + z) + 2.;
    }
    scene.all_points();
    scene.all_edges();
    const double gap = 2. - 2. * r; // of the edges
    for (const double way : {1.2, 2.5, 5., 20.}) {
      SCOPED_TRACE(way);
      const auto missed = look<3>(scene, {moved<3>(scene, 8, {0., 0., -way})});
      ASSERT_TRUE(missed);
      EXPECT_NEAR(missed->share * way, gap + 0.0625 * std::sqrt(6.), 1e-9);
      EXPECT_NEAR(missed->place[2], r, 1e-9);
    }
    for (const double way : {0.3, gap + 0.2, -20.})
      EXPECT_FALSE(look<3>(scene, {moved<3>(scene, 8, {0., 0., -way})})) << way;
    // beside it
    scene.x = moved<3>(scene, 8, {9., 0., 0.});
    EXPECT_FALSE(look<3>(scene, {moved<3>(scene, 8, {0., 0., -5.})}));
  }

  template <int dim>
  void expect_balls_meet()
  {
    Scene<dim> scene;
    Place<dim> at{}, way{};
    scene.ball(0, at, 0.5);
    at[0] = -3.;
    at[1] = 0.3;
    scene.ball(1, at, 0.25);
    for (const double length : {3.2, 4., 7., 100.}) {
      SCOPED_TRACE(length);
      way[0] = length;
      const auto missed = look<dim>(scene, {moved<dim>(scene, 1, way)});
      ASSERT_TRUE(missed);
      // |(-3 + s, 0.3)| = 0.75, then an eighth of the smaller ball
      const double meets = 3. - std::sqrt(0.75 * 0.75 - 0.3 * 0.3);
      EXPECT_NEAR(missed->share * length, meets + 0.125 * 0.25, 1e-9);
    }
    // short of it, just in, another way
    for (const double length : {2., 2.35, -50.}) {
      way[0] = length;
      EXPECT_FALSE(look<dim>(scene, {moved<dim>(scene, 1, way)})) << length;
    }
    // past it
    way[0] = 10.;
    way[1] = 2.;
    EXPECT_FALSE(look<dim>(scene, {moved<dim>(scene, 1, way)}));
  }

  TEST(MissedContacts, Balls)
  {
    expect_balls_meet<2>();
    expect_balls_meet<3>();
  }

  TEST(MissedContacts, BallsAndFacets)
  {
    Scene<2> scene;
    add_box(scene, 0, {0., -5.}, {0.1, 5.});
    scene.ball(1, {-2., 0.}, 0.5);
    scene.all_points();
    for (const double way : {1.7, 2., 2.9, 40.}) {
      const auto missed =
          look<2>(scene, {moved<2>(scene, 4, {way, 0.2 * way})}, 0.1);
      ASSERT_TRUE(missed) << way;
      EXPECT_NEAR(missed->share,
                  1.5 / way + 0.0125 / (way * std::hypot(1., 0.2)), 1e-9);
    }
    // rolls on it, leaves it, stays away
    scene.x[8] = -0.5;
    for (const auto &by : {Place<2>{0., 4.}, {-20., 0.}, {0., 30.}})
      EXPECT_FALSE(look<2>(scene, {moved<2>(scene, 4, by)}, 0.1));
  }

  TEST(MissedContacts, ATurnIsFollowed)
  {
    // a rod turns by half a revolution about its end; a box is in its way that
    // the chords of its corners do not come near
    Scene<2> scene;
    add_box(scene, 0, {-0.2, 2.5}, {0.2, 2.9});
    add_box(scene, 1, {0., -0.1}, {3., 0.1});
    scene.all_points();
    std::vector<std::vector<double>> path;
    const unsigned int n = 8;
    for (unsigned int k = 1; k <= n; ++k) {
      auto x = turned<2>(scene.x, 3.141592653589793 * k / n);
      std::copy_n(scene.x.begin(), 8, x.begin());
      path.push_back(x);
    }
    const auto missed = look<2>(scene, path);
    ASSERT_TRUE(missed);
    // the tip meets the right side of the box after 85 degrees or so
    EXPECT_GT(missed->share, 0.45);
    EXPECT_LT(missed->share, 0.5);
    EXPECT_FALSE(look<2>(scene, {path.back()}));
  }

  // --- random boxes in the plane, looked at by separating axes

  test::Separation apart_by(const std::vector<double> &x)
  {
    test::Convex body[2];
    for (unsigned int b = 0; b < 2; ++b)
      for (unsigned int i = 0; i < 4; ++i) {
        const double *p = &x[8 * b + 2 * i], *q = &x[8 * b + 2 * ((i + 1) % 4)];
        body[b].corners.push_back({p[0], p[1], 0.});
        body[b].normals.push_back({q[1] - p[1], p[0] - q[0], 0.});
      }
    return test::separation(body[0], body[1]);
  }

  TEST(MissedContacts, RandomBoxesAreNeitherMissedNorMadeUp)
  {
    std::mt19937 random(7);
    const auto draw = [&](const double low, const double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    unsigned int n_missed = 0, n_apart = 0;
    for (unsigned int k = 0; k < 4000; ++k) {
      SCOPED_TRACE(k);
      Scene<2> scene;
      double least = 1e3;
      std::vector<double> start, end;
      for (unsigned int b = 0; b < 2; ++b) {
        const double w = draw(0.3, 1.), h = draw(0.3, 1.), angle = draw(0., 6.),
                     turn = draw(-0.4, 0.4);
        least = std::min({least, w, h});
        Scene<2> one;
        add_box(one, 0, {-w, -h}, {w, h});
        const double from[2] = {b * draw(-4., 4.), b * draw(-4., 4.)},
                     to[2] = {b * draw(-6., 6.), b * draw(-6., 6.)};
        auto x = turned<2>(one.x, angle), y = turned<2>(one.x, angle + turn);
        for (unsigned int i = 0; i < 8; ++i) {
          start.push_back(x[i] + from[i % 2]);
          end.push_back(y[i] + to[i % 2]);
        }
        add_box(scene, b, {0., 0.}, {1., 1.});
      }
      scene.all_points();
      scene.x = start;
      // a turned box between two of its places is a smaller box
      const auto at = [&](const double s) {
        std::vector<double> x(start);
        for (std::size_t i = 0; i < x.size(); ++i)
          x[i] += s * (end[i] - start[i]);
        return apart_by(x).distance;
      };
      constexpr unsigned int n = 300;
      double smallest = 1e3;
      for (unsigned int i = 0; i <= n; ++i)
        smallest = std::min(smallest, at(double(i) / n));
      if (at(0.) < 0.)
        continue;
      const auto missed = look<2>(scene, {end}, 2. * least);
      if (smallest > 0.) {
        ++n_apart;
        EXPECT_FALSE(missed);
      }
      if (smallest < -0.2 * least && at(1.) > 0.) {
        ++n_missed;
        EXPECT_TRUE(missed);
      }
      // such a step ends no deeper than the search sees, and inside, or as near
      // as a vertex is ahead of the place in its body from which it is seen
      if (missed) {
        EXPECT_LT(at(missed->share), 0.02 * 2.);
        EXPECT_GT(at(missed->share), -0.25 * 2. * least);
      }
    }
    EXPECT_GT(n_missed, 300u);
    EXPECT_GT(n_apart, 300u);
  }
} // namespace test_missed_contacts
