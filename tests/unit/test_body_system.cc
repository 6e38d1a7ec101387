#include "nonsmooth/solvers/body_system.h"
#include "nonsmooth/solvers/soft_space.h"

#include "make_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

// All bodies joined by stiffnesses, symmetric or not, small or huge: factors
// and iterations against what defines the solution; the motions of a node that
// stretch no stiff spring, counted by hand.

using namespace nsfd;
using nsfd::test::Scene;

namespace test_body_system
{
  /**
   * Four bodies of one node each that meet at a vertex:
   *
   *     2 | 3      faces 0-1 and 2-3 have the normal x,
   *     --+--      faces 0-2 and 1-3 the normal y;
   *     0 | 1      unit mass, one point per face.
   */
  struct Vertex {
    std::vector<std::size_t> first_dof{0, 2, 4, 6, 8};
    std::vector<FaceRows> faces;
    SparseRows K;
    std::vector<double> mass;

    /** @p normal, @p tangential stiffness of faces 0-1, 2-3, 0-2, 1-3. */
    Vertex(const std::vector<double> &normal,
           const std::vector<double> &tangential)
    {
      const int bodies[4][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}};
      std::vector<double> dense(64, 0.);
      mass.assign(64, 0.);
      for (int i = 0; i < 8; ++i)
        dense[i * 8 + i] = mass[i * 8 + i] = 1.;
      for (std::size_t f = 0; f < 4; ++f) {
        FaceRows face;
        face.first = f;
        face.count = 1;
        for (const int b : bodies[f])
          for (int c = 0; c < 2; ++c)
            face.dofs.push_back(2 * b + c);
        const bool upright = f < 2;
        // unknowns: ux, uy of the first body, ux, uy of the second
        face.rows = upright ? std::vector<double>{-1, 0, 1, 0, 0, -1, 0, 1}
                            : std::vector<double>{0, -1, 0, 1, -1, 0, 1, 0};
        for (int k = 0; k < 2; ++k)
          for (int a = 0; a < 4; ++a)
            for (int b = 0; b < 4; ++b)
              dense[face.dofs[a] * 8 + face.dofs[b]] +=
                  (k == 0 ? normal[f] : tangential[f]) * face.rows[k * 4 + a] *
                  face.rows[k * 4 + b];
        faces.push_back(face);
      }
      K.start = {0};
      for (int i = 0; i < 8; ++i) {
        for (int j = 0; j < 8; ++j) {
          K.column.push_back(j);
          K.value.push_back(dense[i * 8 + j]);
        }
        K.start.push_back(int(K.column.size()));
      }
    }

    int motions()
    {
      SoftSpace space(2, first_dof, faces);
      EXPECT_EQ(space.n_nodes(), 1u);
      space.build(K, mass);
      return space.n_motions(0);
    }
  };

  TEST(SoftSpace, CountsTheMotionsOfAVertex)
  {
    const double s = 1e6; // against a mass of 1
    const auto motions = [](const std::vector<double> &normal,
                            const std::vector<double> &tangential) {
      return Vertex(normal, tangential).motions();
    };
    // 8 unknowns; a face that sticks takes two, one that slides its normal
    EXPECT_EQ(motions({0, 0, 0, 0}, {0, 0, 0, 0}), 8);
    EXPECT_EQ(motions({s, 0, 0, 0}, {s, 0, 0, 0}), 6);
    EXPECT_EQ(motions({s, 0, 0, 0}, {0, 0, 0, 0}), 7);
    EXPECT_EQ(motions({s, s, s, s}, {0, 0, 0, 0}), 4);
    // three that stick join all four bodies, whatever the last one does
    EXPECT_EQ(motions({s, s, s, 0}, {s, s, s, 0}), 2);
    EXPECT_EQ(motions({s, s, s, s}, {s, s, s, 0}), 2);
    // two halves that slide along y on two faces
    EXPECT_EQ(motions({s, s, s, s}, {0, 0, s, s}), 3);
    // springs softer than the bodies join nothing
    EXPECT_EQ(motions({0.1, 0.1, 0.1, 0.1}, {0.1, 0.1, 0.1, 0.1}), 8);
  }

  template <int dim>
  std::string block()
  {
    return std::string("set dimension = ") + (dim == 2 ? "2" : "3") + R"(
      subsection Mesh
        set type         = )" +
           (dim == 2 ? "rectangle" : "brick") + R"(
        set lower corner = )" +
           (dim == 2 ? "0, 0" : "0, 0, 0") + R"(
        set upper corner = )" +
           (dim == 2 ? "1, 1" : "1, 1, 1") + R"(
        set cells        = )" +
           (dim == 2 ? "4, 4" : "3, 3, 3") + R"(
        set distortion   = 0.1
      end
      subsection Material: bulk
        set model         = linear elastic
        set Young modulus = 1
        set Poisson ratio = 0.3
        set density       = 1
      end
      subsection Interface: faces
        set where    = all
        set law      = contact
        set friction = 0.5
      end
      subsection Time
        set end   = 100
        set theta = 1
        set step  = 2 courant
      end
    )";
  }

  /**
   * Stiffnesses as they occur at random points: stuck, sliding against
   * friction, open, a spring; @p stiff times what the bodies oppose.
   */
  template <int dim>
  std::vector<double> stiffnesses(const std::vector<double> &resistance,
                                  const double stiff, const bool symmetric)
  {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> share(0., 1.);
    std::vector<double> S(resistance.size() * dim, 0.);
    for (std::size_t i = 0; i < resistance.size() / dim; ++i) {
      const double pick = share(random), R = resistance[i * dim];
      double *s = &S[i * dim * dim];
      for (int c = 0; c < dim; ++c)
        if (pick < 0.3)
          s[c * dim + c] = stiff * R;
        else if (pick > 0.6)
          s[c * dim + c] = 10. * R;
        else if (pick < 0.45 && c == 0)
          s[0] = stiff * R;
      if (!symmetric && pick >= 0.3 && pick < 0.45)
        s[dim] = -0.5 * s[0];
    }
    return S;
  }

  /** Largest entry of M_hat x - b - H^T dP against that of M_hat x. */
  template <int dim>
  double imbalance(BodySystem<dim> &system,
                   const DelassusOperator<dim> &delassus,
                   const std::vector<double> &b, const std::vector<double> &x,
                   const std::vector<double> &dP)
  {
    std::vector<double> left, right(b.size());
    system.apply(x, left);
    delassus.generalised_impulse(dP.data(), right.data());
    double largest = 0., difference = 0.;
    for (std::size_t k = 0; k < b.size(); ++k) {
      largest = std::max(largest, std::abs(left[k]));
      difference = std::max(difference, std::abs(left[k] - right[k] - b[k]));
    }
    return difference / largest;
  }

  template <int dim>
  void compare()
  {
    Scene<dim> scene(block<dim>());
    const auto &delassus = *scene.delassus;
    BodySystem<dim> factor(delassus, scene.time_step, 1.),
        iteration(delassus, scene.time_step, 1., 0);
    std::vector<double> b(delassus.bodies().n_dofs()), x, y, dU, dV, dP, dQ;
    const auto &resistance = factor.impedance();
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1., 1.);
    for (double &value : b)
      value = resistance[0] * any(random);
    for (const bool symmetric : {false, true})
      for (const double stiff : {1e2, 1e7}) {
        const auto S = stiffnesses<dim>(resistance, stiff, symmetric);
        // what the velocities oppose: S times a velocity, as Newton's
        // method has it
        std::vector<double> change(delassus.points().n_points * dim, 0.),
            velocity(change.size());
        for (double &value : velocity)
          value = any(random);
        for (std::size_t j = 0; j < change.size(); ++j)
          for (int c = 0; c < dim; ++c)
            change[j] += S[j * dim + c] * velocity[j / dim * dim + c];
        ASSERT_TRUE(factor.factorise(S));
        ASSERT_TRUE(iteration.factorise(S));
        factor.respond(b, change, x, dU, dP);
        EXPECT_GT(iteration.respond(b, change, y, dV, dQ, 1e-12), 1u);
        // the definition, whatever S is
        EXPECT_LE(imbalance(iteration, delassus, b, y, dQ), 1e-10)
            << "dim " << dim << ", stiffness " << stiff;
        double largest = 0., difference = 0.;
        for (std::size_t k = 0; k < x.size(); ++k) {
          largest = std::max(largest, std::abs(x[k]));
          difference = std::max(difference, std::abs(x[k] - y[k]));
        }
        // round-off times the condition of K in the factor
        EXPECT_LE(difference, (stiff > 1e3 ? 1e-7 : 1e-10) * largest)
            << "dim " << dim << ", stiffness " << stiff;
      }
  }

  TEST(BodySystem, IterationsAgreeWithTheFactor)
  {
    compare<2>();
    compare<3>();
  }
} // namespace test_body_system
