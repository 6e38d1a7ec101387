#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Young's modulus of a body that elastic interfaces C_N, C_T make softer,
   * under a uniform tension sigma along an axis of its mesh (quasi-static:
   * theta = 1, long steps).
   *
   * Exact value. On lattices in which the faces at every inner edge come in
   * opposite pairs the uniform stress is the solution: tractions balance, and
   * the jumps t_N/C_N + t_T/C_T around each edge add up to zero. With the unit
   * normal n of a face and x the direction of the load, t_N = sigma n_x^2 and
   * t_T^2 = sigma^2 (n_x^2 - n_x^4), so that the energy of all faces gives
   *
   *   1/E_eff = 1/E' + (1/V) sum over faces of
   *                    area (n_x^4 / C_N + (n_x^2 - n_x^4) / C_T).
   *
   * For boxes with sides a (along x) and b: the m - 1 faces across x give
   * (1 - 1/m) / (a C_N), and a plane through opposite edges parallel to the
   * third direction gives (b^3 / (a C_N) + a b / C_T) / (a^2 + b^2)^(3/2) per
   * box. E' = E, or E / (1 - nu^2) in plane strain.
   *
   * Measured value. In equilibrium the loads have done the work
   * sigma A (mean elongation) / 2, which is the elastic energy U of cells and
   * faces: 1/E_eff = (mean elongation) / (sigma L) = 2 U / (sigma^2 V).
   */
  class EffectiveModulus final : public VerificationCase
  {
  public:
    explicit EffectiveModulus(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const LoadedSide side = loaded_side(input);
      axis_ = side.normal.axis;
      tension_ = side.tension(input.time.end);
      volume_ = extent(input, axis_) * cross_section(input, axis_);
      plane_ = input.dimension == 2;
      demand(tension_ != 0., "the tension at the end of the run is 0");
      demand(input.materials.size() == 1 && !input.materials[0].rigid,
             "the body needs one elastic material");
      demand(input.interfaces.front().law_name == "elastic" &&
                 input.interfaces.front().where.kind == Where::Kind::all,
             "the first Interface block must be elastic, with where = all");

      const MaterialInput &material = input.materials[0];
      const bool plane_strain = plane_ && !input.plane_stress;
      const double nu = material.poisson;
      bulk_ = (plane_strain ? 1. - nu * nu : 1.) / material.young;
      const InterfaceInput &faces = elastic_interface(input);
      exact_ = bulk_ + compliance_of_faces(input, faces);
      const double pi = faces.normal_stiffness / faces.tangential_stiffness;
      density_ =
          5. / (1. + 4. / 3. * pi) * faces.normal_stiffness / material.young;
      if (input.mesh.type == "crossed triangles" && plane_)
        density_ *= extent(input, axis_) / n_cells(input, axis_) /
                    (2. * (1. + std::sqrt(2.)));
      else
        density_ = 0.;
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const EnergyLines &energy = view.row->energy;
      measured_ = 2. * (energy.elastic + energy.cohesive) /
                  (tension_ * tension_ * volume_);
      kinetic_ = energy.elastic > 0. ? energy.kinetic / energy.elastic : 0.;
      // xx, yy, zz, ...; what holds a plane body in z is no error
      stress_ = 0.;
      for (const CellState &cell : *view.cells)
        for (unsigned int c = 0; c < 6; ++c)
          if (!(plane_ && c == 2))
            stress_ = std::max(stress_, std::abs(cell.stress[c] / tension_ -
                                                 (c == axis_ ? 1. : 0.)));
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["modulus"] = relative_error(measured_, exact_);
      errors["stress"] = stress_;
      errors["kinetic"] = kinetic_;
      errors["compliance"] = measured_; // 1/E_eff in 1/Pa
      errors["modulus_ratio"] = bulk_ / measured_;
      errors["exact_modulus_ratio"] = bulk_ / exact_;
      if (density_ > 0.) {
        errors["xi"] = density_;
        errors["bound_79"] = density_ / (1. + density_);
      }
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", measured_, kinetic_, stress_);
    }

  private:
    unsigned int axis_ = 0;
    bool plane_ = true;
    double tension_ = 0., volume_ = 0., exact_ = 0., bulk_ = 0.;
    double density_ = 0.; ///< xi as printed in (79), crossed triangles
    double measured_ = 0., kinetic_ = 0., stress_ = 0.;

    /** What the faces add to 1/E, by the lattice of the mesh. */
    double compliance_of_faces(const SceneInput &input,
                               const InterfaceInput &faces) const
    {
      const double C_N = faces.normal_stiffness,
                   C_T = faces.tangential_stiffness;
      const auto side = [&](const unsigned int d) {
        return extent(input, d) / n_cells(input, d);
      };
      const double a = side(axis_), m = n_cells(input, axis_);
      double sum = (1. - 1. / m) / (a * C_N);

      // planes through opposite edges of a box, across the plane (x, d)
      const auto diagonal = [&](const unsigned int d) {
        const double b = side(d);
        return (b * b * b / (a * C_N) + a * b / C_T) /
               std::pow(a * a + b * b, 1.5);
      };
      const std::string &type = input.mesh.type;
      demand(type == "rectangle" || type == "brick" ||
                 type == "crossed triangles" || type == "diagonal triangles" ||
                 type == "tetrahedra",
             "no exact modulus is known for the mesh `" + type + "`");
      if (type == "crossed triangles")
        sum += 2. * diagonal(1 - axis_);
      if (type == "diagonal triangles")
        sum += diagonal(1 - axis_);
      if (type == "tetrahedra")
        sum += diagonal((axis_ + 1) % 3) + diagonal((axis_ + 2) % 3);
      return sum;
    }
  };

  NSFD_REGISTER(VerificationRegistry, EffectiveModulus, "effective modulus",
                "Uniform tension of a body with elastic faces: 1/E_eff of the "
                "lattice");
} // namespace nsfd
