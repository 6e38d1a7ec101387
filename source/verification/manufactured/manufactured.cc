#include "nsfd/verification/case_input.h"

#include "nsfd/parameters/section_reader.h"

#include <optional>

namespace nsfd
{
  using namespace cases;

  namespace
  {
    using Vector = std::array<double, 3>;
    using Order = std::array<unsigned int, 3>; ///< of derivatives by x, y, z

    Order plus(Order order, const unsigned int axis)
    {
      ++order[axis];
      return order;
    }

    /** sin(k t + phase) along every axis, times each other. */
    struct Product {
      Vector wave, phase;

      double at(const Vector &x, const Order &order) const
      {
        const double quarter = std::acos(0.);
        double value = 1.;
        for (unsigned int d = 0; d < 3; ++d)
          value *= std::pow(wave[d], order[d]) *
                   std::sin(wave[d] * x[d] + phase[d] + quarter * order[d]);
        return value;
      }
    };
  } // namespace

  /**
   * A smooth motion chosen freely in a box, and the body force that makes it
   * one: u = A T(t) G(X), T = 2 + cos(omega t), X the position in the box over
   * its length along x,
   *
   *   G = (sin(1.3 X + 0.4) cos(0.9 Y + 0.2) cos(0.8 Z - 0.1),
   *        cos(0.7 X - 0.3) sin(1.1 Y + 0.5) cos(0.6 Z + 0.3),
   *        cos(0.5 X + 0.2) cos(0.8 Y - 0.2) sin(1.2 Z + 0.4)),
   *
   * without the factors in Z in two dimensions. With two materials there are
   * elastic faces C_N, C_T at X = 1/2, where the part of the second material
   * jumps by what they need: u = A T (G + d) beyond, with D = sigma n / C there
   * and
   *
   *   d_x = D_x - (X - 1/2) (lambda / (lambda + 2 mu)) (dD_y/dY + dD_z/dZ),
   *   d_y = D_y - (X - 1/2) dD_x/dY,   d_z = D_z - (X - 1/2) dD_x/dZ,
   *
   * which leaves the traction continuous. Initial fields, body forces and the
   * motion of boundaries with `motion = exact` follow from it.
   */
  class Manufactured final : public VerificationCase
  {
  public:
    explicit Manufactured(SectionReader &reader)
    {
      if (reader.optional("amplitude", "m; default: 1e-3 of the box along x"))
        amplitude_ =
            reader.number("amplitude", "", units::length, Range::positive(),
                          "m; default: 1e-3 of the box along x");
      if (reader.optional("angular frequency",
                          "1/s; default: 2 c_p over the box along x"))
        frequency_ = reader.number("angular frequency", "", {0, 0, -1},
                                   Range::positive(),
                                   "1/s; default: 2 c_p over the box along x");
    }

    bool has_motion() const override { return true; }

    void provide(SceneInput &scene) const override
    {
      // the scene's functions own a copy that knows the scene
      const auto self = std::make_shared<Manufactured>(*this);
      self->initialise(scene);
      for (unsigned int m = 0; m < scene.materials.size(); ++m) {
        MaterialInput &material = scene.materials[m];
        for (unsigned int c = 0; c < scene.dimension; ++c) {
          demand(material.initial_displacement[c].is_zero() &&
                     material.initial_velocity[c].is_zero() &&
                     material.body_force[c].is_zero(),
                 "the case sets initial fields and body forces: remove those "
                 "of material `" +
                     material.name + "`");
          const auto part = [&](auto member, const bool depends_on_time) {
            return Expression(
                [self, m, c, member](const double x, const double y,
                                     const double z, const double t) {
                  return ((*self).*member)(m, {x, y, z}, t)[c];
                },
                "exact", depends_on_time);
          };
          material.initial_displacement[c] =
              part(&Manufactured::displacement_in, false);
          material.initial_velocity[c] =
              part(&Manufactured::velocity_in, false);
          material.body_force[c] = part(&Manufactured::body_force, true);
        }
      }
      set_exact_motion(scene, self);
    }

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      demand(input.materials.size() <= 2,
             "one material, or two with elastic faces between them");
      const MaterialInput &first = input.materials.front();
      for (const MaterialInput &material : input.materials)
        demand(!material.rigid && material.young == first.young &&
                   material.poisson == first.poisson &&
                   material.density == first.density,
               "the materials must be elastic and alike");
      const double E = first.young, nu = first.poisson;
      mu_ = E / (2. * (1. + nu));
      lambda_ = E * nu / ((1. + nu) * (1. - 2. * nu));
      if (input.dimension == 2 && input.plane_stress) {
        stress_zz_ = 0.;
        lambda_ = E * nu / (1. - nu * nu);
      } else
        stress_zz_ = nu;
      density_ = first.density;
      dim_ = input.dimension;
      lower_ = {};
      for (unsigned int d = 0; d < dim_; ++d)
        lower_[d] = input.mesh.lower[d];
      length_ = extent(input, 0);
      if (!amplitude_)
        amplitude_ = 1e-3 * length_;
      if (!frequency_)
        frequency_ = 2. * std::sqrt((lambda_ + 2. * mu_) / density_) / length_;
      jumps_ = input.materials.size() == 2;
      if (jumps_) {
        const InterfaceInput &interface = elastic_interface(input);
        // C over the stress of a unit motion
        normal_ = interface.normal_stiffness * length_;
        tangential_ = interface.tangential_stiffness * length_;
      }
    }

    bool has_fields() const override { return true; }
    bool has_stress() const override { return true; }

    Vector displacement(const Vector &x, const double t) const override
    {
      return displacement_in(side(x), x, t);
    }

    bool has_jump() const override { return true; }

    Vector jump(const Vector &x, const Vector &n, const double t) const override
    {
      Vector jump{};
      if (!jumps_ || std::abs(scaled(x)[0] - 0.5) > 1e-9)
        return jump;
      const Vector first = displacement_in(0, x, t),
                   second = displacement_in(1, x, t);
      for (unsigned int c = 0; c < dim_; ++c)
        jump[c] = n[0] > 0. ? second[c] - first[c] : first[c] - second[c];
      return jump;
    }

    /** As a part of the material with this index, at points of both. */
    Vector displacement_in(const unsigned int material, const Vector &x,
                           const double t) const
    {
      Vector u{};
      for (unsigned int c = 0; c < dim_; ++c)
        u[c] = *amplitude_ * factor(t) * shape(material, c, scaled(x), {});
      return u;
    }

    Vector velocity(const Vector &x, const double t) const override
    {
      return velocity_in(side(x), x, t);
    }

    std::array<double, 6> stress(const Vector &x, const double t) const override
    {
      const Vector X = scaled(x);
      const unsigned int m = side(x);
      double gradient[3][3] = {}, trace = 0.;
      for (unsigned int c = 0; c < dim_; ++c) {
        for (unsigned int d = 0; d < dim_; ++d)
          gradient[c][d] =
              *amplitude_ / length_ * factor(t) * shape(m, c, X, plus({}, d));
        trace += gradient[c][c];
      }
      const auto shear = [&](const unsigned int c, const unsigned int d) {
        return mu_ * (gradient[c][d] + gradient[d][c]);
      };
      std::array<double, 6> s{};
      for (unsigned int c = 0; c < dim_; ++c)
        s[c] = lambda_ * trace + 2. * mu_ * gradient[c][c];
      if (dim_ == 2)
        s[2] = stress_zz_ * (s[0] + s[1]);
      s[3] = shear(0, 1);
      s[4] = shear(0, 2);
      s[5] = shear(1, 2);
      return s;
    }

  private:
    std::optional<double> amplitude_, frequency_;
    unsigned int dim_ = 2;
    bool jumps_ = false;
    double lambda_ = 0., mu_ = 0., density_ = 0., length_ = 1., stress_zz_ = 0.,
           normal_ = 1., tangential_ = 1.;
    Vector lower_{};

    unsigned int side(const Vector &x) const
    {
      return jumps_ && scaled(x)[0] >= 0.5 ? 1 : 0;
    }

    Vector scaled(const Vector &x) const
    {
      Vector X{};
      for (unsigned int d = 0; d < dim_; ++d)
        X[d] = (x[d] - lower_[d]) / length_;
      return X;
    }

    double factor(const double t) const
    {
      return 2. + std::cos(*frequency_ * t);
    }

    Vector velocity_in(const unsigned int material, const Vector &x,
                       const double t) const
    {
      Vector v{};
      for (unsigned int c = 0; c < dim_; ++c)
        v[c] = -*amplitude_ * *frequency_ * std::sin(*frequency_ * t) *
               shape(material, c, scaled(x), {});
      return v;
    }

    /** rho u'' - div sigma. */
    Vector body_force(const unsigned int material, const Vector &x,
                      const double t) const
    {
      const Vector X = scaled(x);
      const double omega = *frequency_;
      Vector b{};
      for (unsigned int c = 0; c < dim_; ++c) {
        double divergence = 0.;
        for (unsigned int d = 0; d < dim_; ++d)
          divergence +=
              mu_ * shape(material, c, X, plus(plus({}, d), d)) +
              (lambda_ + mu_) * shape(material, d, X, plus(plus({}, d), c));
        b[c] = *amplitude_ * (-density_ * omega * omega * std::cos(omega * t) *
                                  shape(material, c, X, {}) -
                              factor(t) * divergence / (length_ * length_));
      }
      return b;
    }

    /** Derivative of component @p c of G. */
    double smooth(const unsigned int c, const Vector &X,
                  const Order &order) const
    {
      static const double q = std::acos(0.); // cos(a) = sin(a + q)
      static const Product products[3] = {
          {{1.3, 0.9, 0.8}, {0.4, 0.2 + q, -0.1 + q}},
          {{0.7, 1.1, 0.6}, {-0.3 + q, 0.5, 0.3 + q}},
          {{0.5, 0.8, 1.2}, {0.2 + q, -0.2 + q, 0.4}}};
      if (dim_ == 3)
        return products[c].at(X, order);
      Product flat = products[c]; // no factor in Z
      flat.wave[2] = 0.;
      flat.phase[2] = q;
      return flat.at(X, order);
    }

    /** Derivative along the interface of the jump D at X = 1/2. */
    double gap(const unsigned int c, const Vector &X, const Order &order) const
    {
      Vector at = X;
      at[0] = 0.5;
      const Order along = {0, order[1], order[2]};
      if (c > 0)
        return mu_ / tangential_ *
               (smooth(c, at, plus(along, 0)) + smooth(0, at, plus(along, c)));
      double traction = 2. * mu_ * smooth(0, at, plus(along, 0));
      for (unsigned int d = 0; d < dim_; ++d)
        traction += lambda_ * smooth(d, at, plus(along, d));
      return traction / normal_;
    }

    /** Derivative of component @p c of G, or of G + d in the second part. */
    double shape(const unsigned int material, const unsigned int c,
                 const Vector &X, const Order &order) const
    {
      const double value = smooth(c, X, order);
      if (material == 0 || !jumps_ || order[0] > 1)
        return value;
      double slope = 0.; // of d along X
      if (c > 0)
        slope = -gap(0, X, plus(order, c));
      else
        for (unsigned int d = 1; d < dim_; ++d)
          slope -= lambda_ / (lambda_ + 2. * mu_) * gap(d, X, plus(order, d));
      if (order[0] == 1)
        return value + slope;
      return value + gap(c, X, order) + (X[0] - 0.5) * slope;
    }
  };

  NSFD_REGISTER(
      VerificationRegistry, Manufactured, "manufactured",
      "A smooth motion in a box with the body force that it needs, "
      "with or without elastic faces across it: fields, stress, jump");
} // namespace nsfd
