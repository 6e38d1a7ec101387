#pragma once

namespace nsfd
{
  struct MaterialInput;

  /**
   * Fields next to the tip of a crack that runs at the speed v through an
   * isotropic elastic material (Freund, Dynamic Fracture Mechanics, 1990,
   * sections 4.3 and 5.3): everything that depends on v alone.
   */
  class RunningCrack
  {
  public:
    /** The wave speeds are those of plane stress if @p plane_stress. */
    RunningCrack(const MaterialInput &material, bool plane_stress);
    /** Plane strain for Poisson's ratio @p poisson. */
    RunningCrack(double young, double poisson, double density);

    double pressure_speed() const { return pressure_; } ///< c_d, m/s
    double shear_speed() const { return shear_; }       ///< c_s, m/s

    /** c_R: the root of D(v) = 4 a_d a_s - (1 + a_s^2)^2 below c_s. */
    double rayleigh_speed() const { return rayleigh_; }

    /** E' = E/(1 - nu^2) in plane strain, E in plane stress; Pa. */
    double stiffness() const { return stiffness_; }

    /**
     * A_I(v) and A_II(v) of G = (A_I K_I^2 + A_II K_II^2)/E'; 1 at v = 0, they
     * grow without bound towards c_R. NaN at and above it.
     */
    double opening_function(double v) const;
    double sliding_function(double v) const;

    /** |K_I| in Pa sqrt(m) that spends @p G J/m^2 at the speed @p v. */
    double opening_intensity(double G, double v) const;

  private:
    RunningCrack(double young, double poisson, double density,
                 bool plane_stress);
    double function(double v, bool sliding) const;

    double pressure_, shear_, rayleigh_, stiffness_;
    double poisson_; ///< nu, or nu/(1 + nu) in plane stress
  };
} // namespace nsfd
