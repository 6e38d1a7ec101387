#include "make_scene.h"

#include "delassus/joined_bodies.h"
#include "discretization/fixed_faces.h"
#include "discretization/node_coordinates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

// Inner nodes that are eliminated before, against a factor of all: whatever
// opens, whatever the springs of points and supports, the same answers.

namespace nsfd::test_substructures
{
  namespace
  {
    using Vector = std::vector<double>;

    const std::string plate = R"(set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 12, 9
  set cells        = 12, 9
  set distortion   = 0.2
end
)";
    const std::string block = R"(set dimension = 3
subsection Mesh
  set type         = brick
  set upper corner = 16, 2, 2
  set cells        = 16, 2, 2
end
)";
    const std::string rest = R"(
subsection Material: solid
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density       = 1
end
subsection Interface: plane
  set where     = abs(x - 4) < 0.25
  set law       = camacho-ortiz
  set strength  = 1
  set toughness = 1
end
subsection Interface: elsewhere
  set law = joined
end
subsection Boundary: left
  set where          = x < 0.01
  set displacement x = 0
  set displacement y = 0
end
subsection Time
  set end    = 1000
  set step   = 20 courant
  set scheme = moreau-jean
end
)";

    /** The same bodies twice, of which one knows what stays as it is. */
    template <int dim>
    class Twins
    {
    public:
      explicit Twins(const std::string &text)
          : scene_(text), faces_(scene_.discretization->points().faces.size())
      {
        FixedFaces none{std::vector<char>(faces_, 0),
                        std::vector<char>(faces_, 0)};
        one_ = make(fixed_faces(*scene_.discretization));
        other_ = make(none);
      }

      /** Of the points of the plane, those beyond @p share of its height are
          open. */
      void open(const double share)
      {
        const auto &points = scene_.discretization->points();
        std::vector<std::uint8_t> bonded(points.n_points, 0);
        acts_.clear();
        double top = 0.;
        for (const auto &face : points.faces)
          top = std::max(top, face.centre[1]);
        for (std::size_t i = 0; i < bonded.size(); ++i) {
          bonded[i] = scene_.state.kind[i] == PointKind::bonded;
          const auto &face = points.faces[points.face_of[i]];
          if (std::abs(face.centre[0] - 4.) < 0.25 && !face.boundary &&
              face.centre[1] > (1. - share) * top)
            bonded[i] = 0;
          if (!bonded[i])
            acts_.push_back(i);
        }
        one_->set_bonds(bonded);
        other_->set_bonds(bonded);
      }

      void set_step(const double factor)
      {
        for (auto *bodies : {one_.get(), other_.get()})
          bodies->reinit(factor * scene_.time_step,
                         scene_.input->time.bulk_theta());
      }

      /** @p skew: T is not symmetric. The largest difference over the largest
          answer. */
      double difference(const bool skew, const unsigned int seed,
                        const double of_supports)
      {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> number(-1., 1.);
        const std::size_t n = scene_.state.kind.size();
        Vector T(n * dim * dim, 0.), c(n * dim, 0.), none(n * dim, 0.);
        const auto &origins = scene_.discretization->origins();
        for (const std::size_t i : acts_)
          for (unsigned int k = 0; k < dim; ++k) {
            const bool support = origins[i].kind == PointOrigin::Kind::motion;
            T[(i * dim + k) * dim + k] =
                support ? of_supports : 3. + number(random);
            for (unsigned int l = 0; !support && l < k; ++l) {
              const double t = number(random);
              T[(i * dim + k) * dim + l] = t;
              T[(i * dim + l) * dim + k] = skew ? -0.5 * t : t;
            }
            c[i * dim + k] = number(random);
          }
        std::array<Vector, 2> dU, dP;
        for (unsigned int w = 0; w < 2; ++w) {
          auto &bodies = w == 0 ? *one_ : *other_;
          auto &motion = dynamic_cast<VelocitySolver &>(bodies).motion();
          motion.start({}, {}, none);
          EXPECT_TRUE(
              motion.solve(T, !skew, c, {1e-14, 1e-14, c}, dP[w], dU[w]));
          motion.cancel();
        }
        double largest = 0., difference = 0.;
        for (std::size_t k = 0; k < n * dim; ++k) {
          largest = std::max(largest, std::abs(dU[1][k]));
          difference = std::max(difference, std::abs(dU[0][k] - dU[1][k]));
        }
        EXPECT_GT(largest, 1e-3);
        return difference / largest;
      }

      /** Of W P. */
      double difference_of_products()
      {
        const std::size_t n = scene_.state.kind.size() * dim;
        Vector P(n, 0.), U(n), V(n);
        for (const std::size_t i : acts_)
          P[i * dim] = 1. + 0.1 * double(i % 7);
        one_->apply_delassus(P.data(), U.data());
        other_->apply_delassus(P.data(), V.data());
        double largest = 0., difference = 0.;
        for (std::size_t k = 0; k < n; ++k) {
          largest = std::max(largest, std::abs(V[k]));
          difference = std::max(difference, std::abs(U[k] - V[k]));
        }
        EXPECT_GT(largest, 1e-3);
        return difference / largest;
      }

      bool condenses() const { return condenses(*one_); }
      bool other_condenses() const { return condenses(*other_); }

    private:
      std::unique_ptr<JoinedDelassus<dim>> make(const FixedFaces &faces)
      {
        return make_joined_delassus<dim>(
            scene_.communicator, scene_.discretization->bodies(),
            scene_.discretization->points(), "direct",
            node_coordinates(*scene_.discretization), faces);
      }
      static bool condenses(const JoinedDelassus<dim> &bodies)
      {
        return dynamic_cast<const JoinedBodies<dim> &>(bodies).means() ==
               JoinedBodies<dim>::Means::substructures;
      }

      test::Scene<dim> scene_;
      const std::size_t faces_;
      std::unique_ptr<JoinedDelassus<dim>> one_, other_;
      std::vector<std::size_t> acts_;
    };

    template <int dim>
    void expect_alike(const std::string &mesh)
    {
      Twins<dim> twins(mesh + rest);
      unsigned int seed = 0;
      for (const double length : {1., 0.5})
        for (const double share : {0.3, 0.7, 1.1, 0.5}) {
          twins.open(share);
          twins.set_step(length);
          EXPECT_TRUE(twins.condenses());
          EXPECT_FALSE(twins.other_condenses());
          EXPECT_LT(twins.difference_of_products(), 1e-10);
          for (const double of_supports : {1e4, 1e4, 1e2})
            for (const bool skew : {false, true})
              EXPECT_LT(twins.difference(skew, ++seed, of_supports), 1e-8)
                  << share << ' ' << skew;
        }
    }

    TEST(Substructures, AnswerAsAFactorOfAllDoes) { expect_alike<2>(plate); }

    TEST(Substructures, AnswerInSpaceToo) { expect_alike<3>(block); }
  } // namespace
} // namespace nsfd::test_substructures
