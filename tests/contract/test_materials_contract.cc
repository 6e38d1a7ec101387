#include "../unit/make_law.h"

#include "nsfd/materials/material_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

// What every registered model of a material must satisfy.

namespace test_materials_contract
{
  using namespace nsfd;
  using nsfd::test::entries_of;

  MaterialInput read_material(const std::string &name,
                              const std::string &example)
  {
    std::string text = "subsection Material: test\n";
    for (const auto &[entry, value] : entries_of(example))
      text += "  set " + entry + " = " + value + "\n";
    InputErrors errors;
    ParameterFile file;
    file.read_text(text + "end\n", "test.prm", errors);
    SectionReader reader(file.open("Material: test"), errors);
    MaterialInput material;
    material.model_name = name;
    const std::shared_ptr<MaterialModel> model =
        MaterialRegistry::instance().create(name);
    material.model = model;
    material.kind = model->kind();
    material.rigid = material.kind == MaterialKind::rigid;
    model->read(reader,
                {3, false, material.kind == MaterialKind::finite_strain},
                material);
    file.report_stray(errors);
    EXPECT_FALSE(errors.has_errors()) << errors.report();
    return material;
  }

  /** lambda + 2 mu. */
  double wave_modulus(const MaterialInput &material)
  {
    const double E = material.young, nu = material.poisson;
    return E * (1. - nu) / ((1. + nu) * (1. - 2. * nu));
  }

  /** 1 on the diagonal times @p stretch, else 0. */
  template <int dim>
  Voigt<dim> diagonal(const double stretch)
  {
    Voigt<dim> C{};
    for (unsigned int c = 0; c < dim; ++c)
      C[c] = stretch;
    return C;
  }

  // No stress at rest, and the stiffness of small strain next to it: with
  // C_11 = 1 + 2 e the stress S_11 is (lambda + 2 mu) e.
  template <int dim>
  void energies_begin_linearly(const MaterialInput &material)
  {
    const auto law = material.model->hyperelastic<dim>(material, false);
    const double modulus = wave_modulus(material);
    EXPECT_NEAR(law->modulus(), modulus, 1e-14 * modulus);
    Voigt<dim> S;
    ASSERT_TRUE(law->stress(diagonal<dim>(1.), S));
    for (const double s : S)
      EXPECT_NEAR(s, 0., 1e-14 * modulus);
    Voigt<dim> C = diagonal<dim>(1.);
    const double e = 1e-6; // the next term is of its square
    C[0] += 2. * e;
    ASSERT_TRUE(law->stress(C, S));
    EXPECT_NEAR(S[0] / e, modulus, 1e-5 * modulus);
    EXPECT_NEAR(law->energy(C), modulus * e * e / 2., 1e-5 * modulus * e * e);
  }

  // An elastic step from rest: its mean stress is half of that at its end.
  template <int dim>
  void history_begins_linearly(const MaterialInput &material)
  {
    const auto law =
        material.model->history_dependent<dim>(material, false, false);
    const double modulus = wave_modulus(material), e = 1e-6;
    EXPECT_NEAR(law->modulus(), modulus, 1e-14 * modulus);
    std::vector<double> start(law->n_history()), end(start);
    law->begin(start.data());
    typename HistoryMaterial<dim>::Way way;
    way.C0 = way.C1 = Voigt<dim>{}; // 2 eps in small strain
    way.C1[0] = 2. * e;
    way.history = start.data();
    way.time_step = 1.;
    typename HistoryMaterial<dim>::Step step;
    ASSERT_TRUE(law->step(way, false, step, end.data()));
    EXPECT_NEAR(step.S[0], modulus * e / 2., 1e-12 * modulus * e);
    EXPECT_EQ(step.plastic, 0.);
    EXPECT_EQ(end, start);
  }

  TEST(MaterialsContract, ExamplesMakeWhatTheirKindNeeds)
  {
    for (const auto &[name, entry] : MaterialRegistry::instance().entries()) {
      EXPECT_FALSE(entry.examples.empty()) << name;
      for (const std::string &example : entry.examples) {
        SCOPED_TRACE(name + ": " + example);
        const MaterialInput material = read_material(name, example);
        EXPECT_GT(material.density, 0.);
        switch (material.kind) {
        case MaterialKind::finite_strain:
          energies_begin_linearly<2>(material);
          energies_begin_linearly<3>(material);
          break;
        case MaterialKind::history_dependent:
          history_begins_linearly<2>(material);
          history_begins_linearly<3>(material);
          break;
        case MaterialKind::small_strain:
          EXPECT_TRUE(!material.is_isotropic() || material.young > 0.);
          break;
        case MaterialKind::rigid:
          EXPECT_EQ(material.young, 0.);
          break;
        }
      }
    }
  }

  TEST(MaterialsContract, EntriesOfOtherModelsAreRefused)
  {
    std::string text = "subsection Material: test\n"
                       "  set density = 1\n"
                       "  set yield stress = 1\n"
                       "  set axis = 1, 0, 0\n"
                       "end\n";
    InputErrors errors;
    ParameterFile file;
    file.read_text(text, "test.prm", errors);
    SectionReader reader(file.open("Material: test"), errors);
    MaterialInput material;
    MaterialRegistry::instance().create("rigid")->read(reader, {}, material);
    const std::string report = errors.report();
    EXPECT_NE(report.find("the material does not flow"), std::string::npos);
    EXPECT_NE(report.find("it needs model = transversely isotropic"),
              std::string::npos);
  }
} // namespace test_materials_contract
