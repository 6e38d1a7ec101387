#include "joined/merged_groups.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nsfd::test_merged_groups
{
  namespace
  {
    constexpr int dim = 3;
    using Vector = MergedGroups<dim>::Vector;

    /** Five groups: 0 to 3 hang together in a ring with a chord, 4 is free. */
    struct Ring {
      NodeProblem<dim> node;
      std::vector<std::uint8_t> holds;
      MergedGroups<dim> merged;
      std::vector<Vector> moving;  ///< merged
      std::vector<Vector> impulse; ///< of the points that hold
      bool possible;

      /** @p given: components whose motion is prescribed, by group. */
      explicit Ring(const std::vector<unsigned int> &given = {0, 0, 0, 0, 0})
      {
        for (std::size_t g = 0; g < 5; ++g) {
          node.inverse_mass.emplace_back();
          node.velocity.emplace_back();
          for (unsigned int c = 0; c < dim; ++c) {
            const bool moves = (given[g] & (1u << c)) == 0;
            node.inverse_mass[g][c] = moves ? 1. / (1. + double(g)) : 0.;
            node.velocity[g][c] =
                moves ? std::sin(1. + 3. * double(g) + c) : 0.5;
          }
        }
        const std::array<int, 2> links[] = {{{0, 1}}, {{1, 2}}, {{3, 2}},
                                            {{3, 0}}, {{0, 2}}, {{2, 4}}};
        for (const auto &link : links) {
          node.points.push_back({node.points.size(), link});
          holds.push_back(link[1] != 4);
        }
        merged.reinit(node, holds);
        moving.resize(merged.size());
        possible = merged.merge(node.velocity, moving.data());
        std::vector<Vector> change(5);
        for (int g = 0; g < 5; ++g)
          for (unsigned int c = 0; c < dim; ++c)
            change[g][c] = merged.mass(g, c) *
                           (moving[merged.of(g)][c] - node.velocity[g][c]);
        for (std::size_t e = 0; e < 5; ++e)
          impulse.push_back(merged.carried(e, change.data()));
      }

      /** Of the momentum of group @p g, less what the points give it. */
      double missing(const int g, const unsigned int c) const
      {
        double sum =
            merged.mass(g, c) * (moving[merged.of(g)][c] - node.velocity[g][c]);
        for (std::size_t e = 0; e < impulse.size(); ++e)
          for (unsigned int s = 0; s < 2; ++s)
            if (node.points[e].groups[s] == g)
              sum -= s == 0 ? -impulse[e][c] : impulse[e][c];
        return sum;
      }
      /** P / w of point @p e. */
      double strain(const std::size_t e, const unsigned int c) const
      {
        const auto [a, b] = node.points[e].groups;
        return impulse[e][c] * (2. + a + b) / ((1. + a) * (1. + b));
      }
    };

    TEST(MergedGroups, MoveWithTheirMeanAndKeepMomentum)
    {
      const Ring ring;
      ASSERT_EQ(ring.merged.size(), 2u);
      for (unsigned int c = 0; c < dim; ++c) {
        double momentum = 0.;
        for (int g = 0; g < 4; ++g) {
          EXPECT_EQ(ring.merged.of(g), 0);
          momentum += (1. + g) * ring.node.velocity[g][c];
          EXPECT_NEAR(ring.missing(g, c), 0., 1e-14); // of speeds of 1
        }
        EXPECT_NEAR(ring.moving[0][c], momentum / 10., 1e-15);
        EXPECT_EQ(ring.moving[1][c], ring.node.velocity[4][c]);
        EXPECT_NEAR(ring.merged.inverse_mass()[0][c], 0.1, 1e-16);
      }
      EXPECT_FALSE(ring.merged.is_held(4));
    }

    // P = w (phi_2 - phi_1) of one number per group: nothing goes round.
    TEST(MergedGroups, ShareWhatTheyHoldInCycles)
    {
      const Ring ring;
      for (unsigned int c = 0; c < dim; ++c) {
        EXPECT_NEAR(ring.strain(0, c) + ring.strain(1, c), ring.strain(4, c),
                    1e-14);
        EXPECT_NEAR(ring.strain(3, c) + ring.strain(4, c), ring.strain(2, c),
                    1e-14);
      }
    }

    // One prescribed motion leads all, two have to agree.
    TEST(MergedGroups, FollowPrescribedMotions)
    {
      const Ring one({0, 2, 0, 0, 0});
      ASSERT_TRUE(one.possible);
      EXPECT_EQ(one.moving[0][1], 0.5);
      EXPECT_EQ(one.merged.inverse_mass()[0][1], 0.);
      EXPECT_NEAR(one.merged.inverse_mass()[0][0], 0.1, 1e-16);
      for (const int g : {0, 2, 3})
        for (unsigned int c = 0; c < dim; ++c)
          EXPECT_NEAR(one.missing(g, c), 0., 1e-14);
      EXPECT_NEAR(one.missing(1, 0), 0., 1e-14); // it reacts in y alone
      EXPECT_GT(std::abs(one.missing(1, 1)), 0.1);

      Ring two({0, 2, 0, 2, 0});
      EXPECT_TRUE(two.possible);
      two.node.velocity[3][1] = 0.6;
      EXPECT_FALSE(two.merged.merge(two.node.velocity, two.moving.data()));
    }
  } // namespace
} // namespace nsfd::test_merged_groups
