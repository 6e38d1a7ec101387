#include "nsfd/verification/case_input.h"

#include "materials/anisotropy.h"
#include "nsfd/core/archive.h"
#include "nsfd/parameters/section_reader.h"

#include <deal.II/base/symmetric_tensor.h>

#include <memory>

namespace nsfd
{
  using namespace cases;

  /**
   * A standing plane wave in a box, between fixed ends across x:
   *
   *   u = A p sin(k s) exp(-d t) (cos(w t) + d/w sin(w t)),   k = n pi / L,
   *
   * s from the left end, with a polarisation p in the plane of x and y that
   * solves Gamma p = rho c^2 p of Christoffel's matrix of the direction x
   * (Auld, Acoustic fields and waves in solids, 1973, chapter 7), and for a
   * viscous body
   *
   *   w_0 = c k,   d = k^2 Gamma_v / (2 rho),   w^2 = w_0^2 - d^2,
   *
   * Gamma_v = zeta + 4/3 eta of a longitudinal wave and eta of a transverse
   * one. The body is at rest at first. The sides take the exact motion.
   * In a cubic or orthotropic body Christoffel's matrix is that of the
   * direction x in the axes of the crystal, and p may leave the plane in space.
   * The speed that the run has is w_m/k from the last time at which the mode
   * was zero.
   */
  class PlaneWave final : public VerificationCase
  {
  public:
    explicit PlaneWave(SectionReader &reader)
        : is_fast_(reader.choice("wave", "fast", {"fast", "slow"},
                                 "the fastest or the slowest of the waves; of "
                                 "isotropic and transversely isotropic bodies, "
                                 "of those in the plane of x and y") == "fast"),
          n_waves_(reader.integer("half waves", "2", 1, 1000,
                                  "number of them along x"))
    {
    }

    bool has_motion() const override { return true; }

    void provide(SceneInput &scene) const override
    {
      // the scene's functions own a copy that knows the scene
      const auto self = std::make_shared<PlaneWave>(*this);
      self->initialise(scene);
      for (MaterialInput &material : scene.materials)
        for (unsigned int c = 0; c < scene.dimension; ++c) {
          demand(material.initial_displacement[c].is_zero() &&
                     material.initial_velocity[c].is_zero(),
                 "the case sets the initial fields: remove those of material "
                 "`" +
                     material.name + "`");
          material.initial_displacement[c] = Expression(
              [self, c](const double x, const double y, const double z,
                        double) {
                return self->displacement({x, y, z}, 0.)[c];
              },
              "exact", false);
        }
      set_exact_motion(scene, self);
    }

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      demand(input.materials.size() == 1, "there must be one material");
      const MaterialInput &material = input.materials.front();
      demand(!material.rigid && !material.graded,
             "the material must be elastic and the same everywhere");
      const double length = extent(input, 0), pi = std::acos(-1.);
      dimension_ = input.dimension;
      start_ = input.mesh.lower[0];
      amplitude_ = 1e-3 * length;
      wave_number_ = n_waves_ * pi / length;
      const double modulus = set_wave(material, plane_stress(input));
      natural_ = wave_number_ * std::sqrt(modulus / material.density);
      decay_ = wave_number_ * wave_number_ * viscous_modulus(material) /
               (2. * material.density);
      demand(decay_ < natural_, "the wave must not be overdamped");
      frequency_ = std::sqrt(natural_ * natural_ - decay_ * decay_);
    }

    bool has_fields() const override { return true; }

    Vector displacement(const Vector &x, const double t) const override
    {
      return shape(x, std::exp(-decay_ * t) * in_time(t));
    }

    Vector velocity(const Vector &x, const double t) const override
    {
      return shape(x, -std::exp(-decay_ * t) * natural_ * natural_ /
                          frequency_ * std::sin(frequency_ * t));
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      double mode = 0.; // of the displacements
      for (const CellState &cell : *view.cells)
        for (unsigned int c = 0; c < 3; ++c)
          mode += cell.volume * polarisation_[c] * cell.displacement[c] *
                  std::sin(wave_number_ * (cell.centre[0] - start_));
      if (view.row->step > 0 && mode * mode_ < 0.) {
        last_zero_ = time_ + (view.time - time_) * mode_ / (mode_ - mode);
        ++n_zeros_;
      }
      mode_ = mode;
      time_ = view.time;
      energy_ = mechanical_energy(*view.row);
      if (view.row->step == 0)
        initial_energy_ = energy_;
    }

    /** What is left of the energy, that of an oscillator of one mass. */
    void finish(std::map<std::string, double> &errors) const override
    {
      const double rate = natural_ / frequency_ * std::sin(frequency_ * time_);
      const double left = std::exp(-2. * decay_ * time_) *
                          (in_time(time_) * in_time(time_) + rate * rate);
      errors["energy"] = relative_error(energy_ / initial_energy_, left);
      errors["exact_energy_left"] = left;
      errors["exact_speed"] = natural_ / wave_number_;
      if (n_zeros_ > 0 && decay_ == 0.) // at odd quarters of the period
        errors["speed"] = relative_error(
            (n_zeros_ - 0.5) * std::acos(-1.) / last_zero_, natural_);
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", time_, energy_, initial_energy_);
      archive.numbers("zeros", mode_, last_zero_, n_zeros_);
    }

  private:
    bool is_fast_;
    unsigned int n_waves_, dimension_ = 2;
    double start_ = 0., amplitude_ = 0., wave_number_ = 0., natural_ = 0.,
           decay_ = 0., frequency_ = 0.;
    std::array<double, 3> polarisation_{{1., 0., 0.}};
    double time_ = 0., energy_ = 0., initial_energy_ = 0.;
    double mode_ = 0., last_zero_ = 0., n_zeros_ = 0.;

    static bool plane_stress(const SceneInput &input)
    {
      return input.dimension == 2 && input.plane_stress;
    }

    double in_time(const double t) const
    {
      return std::cos(frequency_ * t) +
             decay_ / frequency_ * std::sin(frequency_ * t);
    }

    Vector shape(const Vector &x, const double factor) const
    {
      const double value =
          amplitude_ * factor * std::sin(wave_number_ * (x[0] - start_));
      return {polarisation_[0] * value, polarisation_[1] * value,
              polarisation_[2] * value};
    }

    /** rho c^2, and the polarisation. */
    double set_wave(const MaterialInput &material, const bool plane_stress)
    {
      if (material.transverse)
        return set_transverse(*material.transverse, plane_stress);
      if (material.anisotropic) {
        demand(!plane_stress, "take plane strain");
        return set_crystal(*material.anisotropic);
      }
      demand(material.model_name == "linear elastic",
             "the material must be elastic");
      const double E = material.young, nu = material.poisson;
      polarisation_ = {{is_fast_ ? 1. : 0., is_fast_ ? 0. : 1., 0.}};
      if (!is_fast_)
        return E / (2. * (1. + nu));
      return plane_stress ? E / (1. - nu * nu)
                          : E * (1. - nu) / ((1. + nu) * (1. - 2. * nu));
    }

    /** Stiffness by inversion of the compliance the constants make. */
    double set_transverse(const TransverseInput &input, const bool plane_stress)
    {
      demand(input.axis[2] == 0., "the axis must be in the plane of x and y");
      const double S_aa = 1. / input.axial_young,
                   S_at = -input.axial_poisson / input.axial_young,
                   S_tt = 1. / input.transverse_young,
                   S_ts = -input.transverse_poisson / input.transverse_young,
                   G = input.axial_shear;
      // along the axis, and two directions across; in plane stress the second
      // one carries nothing
      const double determinant = plane_stress
                                     ? S_aa * S_tt - S_at * S_at
                                     : S_aa * (S_tt * S_tt - S_ts * S_ts) -
                                           2. * S_at * S_at * (S_tt - S_ts);
      const double C_aa = (plane_stress ? S_tt : S_tt * S_tt - S_ts * S_ts) /
                          determinant,
                   C_tt = (plane_stress ? S_aa : S_aa * S_tt - S_at * S_at) /
                          determinant,
                   C_at =
                       -S_at * (plane_stress ? 1. : S_tt - S_ts) / determinant;
      // x has the components c along the axis and s across it
      const double c = input.axis[0], s = -input.axis[1];
      const double a = C_aa * c * c + G * s * s, b = G * c * c + C_tt * s * s,
                   d = (C_at + G) * c * s;
      const double mean = (a + b) / 2., radius = std::hypot((a - b) / 2., d);
      const double value = is_fast_ ? mean + radius : mean - radius;
      // the better of the two rows of (Gamma - value) p = 0
      double p = d, q = value - a;
      if (std::hypot(value - b, d) > std::hypot(p, q)) {
        p = value - b;
        q = d;
      }
      const double size = std::hypot(p, q);
      p /= size;
      q /= size;
      polarisation_ = {{p * c + q * s, -p * s + q * c, 0.}};
      return value;
    }

    /** Gamma_ac = C_abcd n_b n_d in the axes of the crystal, n along x. */
    double set_crystal(const AnisotropicInput &input)
    {
      demand(!input.orientation.varies(), "all cells must be turned alike");
      const auto axes =
          crystal_axes(orientation_at(input.orientation, {{0., 0., 0.}}, 0));
      double crystal[3][3] = {};
      for (unsigned int a = 0; a < 3; ++a)
        for (unsigned int b = 0; b < 3; ++b)
          for (unsigned int c = 0; c < 3; ++c)
            for (unsigned int d = 0; d < 3; ++d)
              crystal[a][c] +=
                  input.stiffness[stress_place(a, b)][stress_place(c, d)] *
                  axes[b][0] * axes[d][0];
      dealii::SymmetricTensor<2, 3> scene;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = i; j < 3; ++j)
          for (unsigned int a = 0; a < 3; ++a)
            for (unsigned int c = 0; c < 3; ++c)
              scene[i][j] += axes[a][i] * crystal[a][c] * axes[c][j];
      if (dimension_ == 2) // the others carry no motion
        for (unsigned int i = 0; i < 3; ++i)
          scene[i][2] = 0.;
      const auto pairs = dealii::eigenvectors(scene);
      const auto &pair = pairs[is_fast_ ? 0 : dimension_ - 1];
      for (unsigned int c = 0; c < 3; ++c)
        polarisation_[c] = pair.second[c];
      return pair.first;
    }

    double viscous_modulus(const MaterialInput &material) const
    {
      if (!material.is_viscous())
        return 0.;
      const double p = polarisation_[0],
                   q = std::hypot(polarisation_[1], polarisation_[2]);
      demand(std::abs(p * q) < 1e-12,
             "a viscous wave must be longitudinal or transverse");
      return material.shear_viscosity * (4. / 3. * p * p + q * q) +
             material.bulk_viscosity * p * p;
    }
  };

  NSFD_REGISTER(VerificationRegistry, PlaneWave, "plane wave",
                "Standing plane wave along x, in any direction of an "
                "anisotropic body, damped by viscosity: fields, energy that is "
                "left, speed");
} // namespace nsfd
