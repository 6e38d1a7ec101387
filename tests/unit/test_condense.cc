// Contacts of a step on their own: what solves the step solves them.
#include "breaking_plate.h"
#include "make_scene.h"

#include "nonsmooth/solvers/condense.h"
#include "nonsmooth/solvers/contact_solvers.h"
#include "nsfd/scene/scene_input.h"

#include <gtest/gtest.h>

namespace test_condense
{
  using namespace nsfd;
  using nsfd::test::Scene;

  /** Broken cells in three dimensions on a floor, some of them moving. */
  const std::string heap = R"(# heap - broken cells on a floor.
set dimension = 3
subsection Mesh
  set type         = brick
  set lower corner = 0, 0, 0
  set upper corner = 2, 2, 2
  set cells        = 2, 2, 2
end
subsection Material: block
  set Young modulus      = 100
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = if(x < 1, 0.1, 0)
end
subsection Interface: broken
  set law         = contact
  set friction    = 0.5
  set restitution = 0.3
end
subsection Obstacle: floor
  set where    = bottom
  set point    = 0, 0, 0
  set normal   = 0, 1, 0
  set friction = 0.3
end
subsection Loads
  set gravity = 0, -1, 0.1
end
subsection Time
  set end  = 1
  set step = 1 courant
end
)";

  /** The contacts of the last step of @p scene. */
  template <int dim>
  ContactProblem last_contacts(const Scene<dim> &scene)
  {
    LawEvaluation<dim> evaluation(scene.stepper->problem(), *scene.delassus, 0.,
                                  1e-12);
    evaluation.update(scene.state.impulse);
    return condense_contacts<dim>(scene.stepper->problem(), *scene.delassus,
                                  evaluation);
  }

  template <int dim>
  void expect_same_contacts(const std::string &text,
                            const std::vector<std::string> &overrides,
                            const unsigned int steps)
  {
    std::vector<std::string> all = overrides;
    all.push_back("Solver/tolerance=1e-12");
    Scene<dim> scene(text, all);
    std::size_t pressed = 0;
    for (unsigned int k = 0; k < steps; ++k) {
      scene.advance_bisecting();
      const ContactProblem contacts = last_contacts<dim>(scene);
      if (contacts.n_contacts() == 0)
        continue;
      for (std::size_t j = 0; j < contacts.n_rows(); j += dim)
        pressed += contacts.solution[j] > 0.;
      // 1e-12 of the step in its own norm; the measure weighs r and u as they
      // are, here within a factor of 1e3 of one another
      EXPECT_LT(natural_map_error(contacts, contacts.solution), 1e-8)
          << "step " << k;
      std::vector<double> r;
      EXPECT_TRUE(solve_contact_problem(contacts, "auto", {}, r).converged)
          << "step " << k;
    }
    EXPECT_GT(pressed, 0u);
  }

  TEST(Condense, BrokenCellsOnAFloor) { expect_same_contacts<3>(heap, {}, 5); }

  // one half broken, the other half softens next to its contacts
  TEST(Condense, BreakingPlate)
  {
    for (const char *rule : {"end point", "exact"})
      expect_same_contacts<2>(test::breaking_plate,
                              {std::string("Time/cohesion rule=") + rule,
                               "Interface: all/broken=x > 1"},
                              30);
  }

  TEST(Condense, NothingWithoutContact)
  {
    Scene<2> scene(test::breaking_plate,
                   {"Interface: all/strength scatter=0",
                    "Material: plate/initial velocity x=0"});
    scene.advance();
    const ContactProblem contacts = last_contacts<2>(scene);
    EXPECT_EQ(contacts.n_contacts(), 0u);
    EXPECT_TRUE(contacts.value.empty());
  }
} // namespace test_condense
