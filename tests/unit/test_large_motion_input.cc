#include "large_motion_scenes.h"
#include "nsfd/cohesive_laws/cohesive_law.h"

#include "simulation/motion_report.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace nsfd::large_motion_scenes::test_large_motion_input
{
  TEST(LargeMotionInput, SmallMotionIsTheDefault)
  {
    const auto scene = read_good(small);
    ASSERT_NE(scene, nullptr);
    EXPECT_FALSE(scene->large_motion);
    EXPECT_EQ(scene->materials[0].model_name, "rigid");
    EXPECT_EQ(scene->materials[1].model_name, "linear elastic");
    EXPECT_EQ(scene->obstacles[0].shape_name, "plane");
    EXPECT_FALSE(scene->obstacles[0].moves());
    EXPECT_TRUE(motion_report(*scene).empty());
    EXPECT_FALSE(read_good(small, {"motion=small"})->large_motion);
  }

  TEST(LargeMotionInput, Materials)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    EXPECT_TRUE(scene->large_motion);
    ASSERT_EQ(scene->materials.size(), 3u);
    EXPECT_EQ(scene->materials[0].model_name, "rigid");
    EXPECT_EQ(scene->materials[1].model_name, "neo-hookean");
    EXPECT_EQ(scene->materials[2].model_name, "saint-venant kirchhoff");
    EXPECT_TRUE(scene->materials[0].rigid);
    EXPECT_FALSE(scene->materials[1].rigid || scene->materials[2].rigid);
    EXPECT_EQ(scene->materials[1].young, 1e6);
    EXPECT_EQ(scene->materials[2].poisson, 0.3);
    EXPECT_TRUE(read_good(plane)->plane_stress);
    const auto strain =
        read_good(replaced(plane, "model = saint-venant kirchhoff",
                           "model = neo-hookean"),
                  {"plane=strain"});
    ASSERT_NE(strain, nullptr);
    EXPECT_EQ(strain->materials[1].model_name, "neo-hookean");
  }

  // Without a model, that which bodies of any motion can have.
  TEST(LargeMotionInput, ModelFollowsFromTheMotion)
  {
    const std::string none =
        replaced(plane, "  set model = saint-venant kirchhoff\n", "");
    EXPECT_EQ(read_good(none)->materials[1].model_name,
              "saint-venant kirchhoff");
    EXPECT_EQ(read_good(none, {"plane=strain"})->materials[1].model_name,
              "neo-hookean");
  }

  TEST(LargeMotionInput, RigidBodies)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    const RigidInput &stone = scene->materials[0].rigid_bodies;
    EXPECT_TRUE(stone.connected && stone.ball);
    EXPECT_DOUBLE_EQ(stone.mass.value(), 3e-6);
    ASSERT_TRUE(stone.inertia.has_value());
    EXPECT_DOUBLE_EQ((*stone.inertia)[0], 1e-9);
    EXPECT_DOUBLE_EQ((*stone.inertia)[1], 2e-9);
    EXPECT_DOUBLE_EQ((*stone.inertia)[2], 3e-9);

    const auto cells = read_good(plane);
    ASSERT_NE(cells, nullptr);
    const RigidInput &rock = cells->materials[0].rigid_bodies;
    EXPECT_FALSE(rock.connected || rock.ball);
    EXPECT_FALSE(rock.mass.has_value() || rock.inertia.has_value());

    const auto weighed =
        read_good(plane, {"Material: rock/mass=3 kg/m",
                          "Material: rock/principal inertia=5 kg*m^2/m",
                          "Material: rock/bodies=connected",
                          "Material: rock/surface=mesh"});
    ASSERT_NE(weighed, nullptr);
    const RigidInput &heavy = weighed->materials[0].rigid_bodies;
    EXPECT_TRUE(heavy.connected);
    EXPECT_FALSE(heavy.ball);
    EXPECT_EQ(heavy.mass.value(), 3.);
    EXPECT_EQ(heavy.inertia.value(), (std::array<double, 3>{0., 0., 5.}));
  }

  TEST(LargeMotionInput, InertiaOfAFlatBodyIsTakenAtAnySize)
  {
    // one moment is the sum of the others, up to the last digits
    for (const std::string scale : {"1e-40", "1", "1e40"})
      for (const std::string moments :
           {"{0} * 0.1, {0} * 0.2, {0} * 0.3",
            "{0} * 0.3, {0} * 0.1, {0} * 0.2", "{0} / 3, {0}, {0} * 2 / 3"}) {
        std::string value = moments;
        for (std::size_t at; (at = value.find("{0}")) != std::string::npos;)
          value.replace(at, 3, scale);
        EXPECT_NE(
            read_good(space, {"Material: stone/principal inertia=" + value}),
            nullptr)
            << value;
      }
  }

  TEST(LargeMotionInput, Obstacles)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    ASSERT_EQ(scene->obstacles.size(), 3u);
    const ObstacleInput &floor = scene->obstacles[0];
    EXPECT_EQ(floor.shape_name, "plane");
    EXPECT_DOUBLE_EQ(floor.normal[1], 0.6);
    EXPECT_DOUBLE_EQ(floor.normal[2], 0.8);
    EXPECT_EQ(floor.point[2], -1e-3);
    EXPECT_FALSE(floor.moves() || floor.hollow);

    const ObstacleInput &drum = scene->obstacles[1];
    EXPECT_EQ(drum.shape_name, "cylinder");
    EXPECT_EQ(drum.normal, (std::array<double, 3>{0., 0., 1.}));
    EXPECT_EQ(drum.point, (std::array<double, 3>{0., 0., 1e-3}));
    EXPECT_EQ(drum.radius, 1e-2);
    EXPECT_TRUE(drum.hollow);
    EXPECT_FALSE(drum.moves());

    const ObstacleInput &hammer = scene->obstacles[2];
    EXPECT_EQ(hammer.shape_name, "sphere");
    EXPECT_EQ(hammer.point, (std::array<double, 3>{9e-3, 1e-3, 2e-3}));
    EXPECT_EQ(hammer.radius, 2e-3);
    EXPECT_FALSE(hammer.hollow);
    EXPECT_TRUE(hammer.moves());
    EXPECT_DOUBLE_EQ((*hammer.velocity[0])(0., 0., 0., 0.), -3.);
    EXPECT_FALSE(hammer.velocity[1].has_value());
    EXPECT_EQ((*hammer.velocity[2])(0., 0., 0., 0.), 1.);
    EXPECT_EQ(hammer.restitution, 0.5);
  }

  TEST(LargeMotionInput, ObstaclesInThePlane)
  {
    const auto scene = read_good(
        plane, {"Obstacle: hill/velocity y=1 m/s", "Obstacle: hill/hollow=true",
                "Obstacle: wall/point=0, 0", "Obstacle: wall/normal=1, 0",
                "Obstacle: wall/velocity x=2 m/s"});
    ASSERT_NE(scene, nullptr);
    ASSERT_EQ(scene->obstacles.size(), 2u);
    EXPECT_EQ(scene->obstacles[0].shape_name, "sphere");
    EXPECT_EQ(scene->obstacles[0].radius, 4e3);
    EXPECT_TRUE(scene->obstacles[0].hollow);
    EXPECT_EQ((*scene->obstacles[0].velocity[1])(0., 0., 0.), 1.);
    EXPECT_EQ(scene->obstacles[1].shape_name, "plane");
    EXPECT_TRUE(scene->obstacles[1].moves());
  }

  TEST(LargeMotionInput, Contacts)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    ASSERT_EQ(scene->contacts.size(), 2u);
    const ContactInput &first = scene->contacts[0];
    EXPECT_EQ(first.name, "stone on rubber");
    EXPECT_EQ(first.materials, (std::array<std::string, 2>{"stone", "rubber"}));
    EXPECT_EQ(first.friction, 0.7);
    EXPECT_EQ(first.restitution, 0.);
    EXPECT_DOUBLE_EQ(first.sliding.wear, 1e-12);
    EXPECT_EQ(first.sliding.dilatancy, 0.);
    const ContactInput &others = scene->contacts[1];
    EXPECT_EQ(others.materials, (std::array<std::string, 2>{}));
    EXPECT_EQ(others.friction, 0.);
    EXPECT_EQ(others.restitution, 0.25);
    EXPECT_FALSE(others.sliding.lifts());
  }

  TEST(LargeMotionInput, AContactMayNameOneMaterialTwice)
  {
    const auto scene =
        read_good(replaced(space, pair, "set between = stone, stone"));
    ASSERT_NE(scene, nullptr);
    EXPECT_EQ(scene->contacts[0].materials,
              (std::array<std::string, 2>{"stone", "stone"}));
  }

  TEST(LargeMotionInput, AContactThatGetsOnlyTheLastPairIsTaken)
  {
    // three pairs of two materials: with the third one named, `all` is left
    // with nothing
    const std::string named =
        replaced(plane, "subsection Time",
                 "subsection Contact: a\n  set between = [rock, rock]\nend\n"
                 "subsection Contact: b\n  set between = [ice, rock]\nend\n"
                 "subsection Contact: c\n  set between = all\nend\n"
                 "subsection Time");
    const auto scene = read_good(named);
    ASSERT_NE(scene, nullptr);
    EXPECT_EQ(scene->contacts.size(), 3u);
    InputErrors errors;
    read_scene_text(replaced(named, "subsection Contact: c",
                             "subsection Contact: d\n"
                             "  set between = [ice, ice]\nend\n"
                             "subsection Contact: c"),
                    "bad.prm", {}, errors);
    EXPECT_EQ(errors.n_errors(), 1u) << errors.report();
    EXPECT_NE(errors.report().find("section `Contact: c` never holds"),
              std::string::npos)
        << errors.report();
  }

  TEST(LargeMotionInput, RestitutionOfContactsWarnsOfTheta)
  {
    InputErrors errors;
    EXPECT_NE(read_scene_text(
                  space, "warn.prm",
                  {"Time/theta=0.9", "Contact: others/restitution=1"}, errors),
              nullptr);
    EXPECT_NE(errors.report().find("1/(1 + e) = 0.5"), std::string::npos)
        << errors.report();
  }

  TEST(LargeMotionInput, Pins)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    ASSERT_EQ(scene->pins.size(), 1u);
    EXPECT_EQ(scene->pins[0].name, "hinge");
    EXPECT_EQ(scene->pins[0].material, "stone");
    EXPECT_EQ(scene->pins[0].at, (std::array<double, 3>{1e-3, 2e-3, 3e-3}));
    const auto flat = read_good(
        plane, {"Pin: nail/material=rock", "Pin: nail/at=1 km, 2 km"});
    ASSERT_NE(flat, nullptr);
    EXPECT_EQ(flat->pins[0].at, (std::array<double, 3>{1e3, 2e3, 0.}));
  }

  TEST(LargeMotionInput, ExtrinsicLawsEverywhereStartRigid)
  {
    const auto large = read_good(space);
    ASSERT_NE(large, nullptr);
    ASSERT_TRUE(large->interfaces[0].law->extrinsic());
    EXPECT_EQ(large->interfaces[0].where.kind, Where::Kind::all);
    EXPECT_EQ(large->interfaces[0].intact, IntactFaces::rigid);
    EXPECT_FALSE(large->has_bonded_faces());
    EXPECT_NE(read_good(space, {"Interface: seam/intact faces=rigid"}),
              nullptr);
    const auto still =
        read_good(replaced(small, "set law = rigid",
                           "set law = camacho-ortiz\n  set strength = 1\n"
                           "  set toughness = 1"));
    ASSERT_NE(still, nullptr);
    EXPECT_EQ(still->interfaces[0].intact, IntactFaces::bonded);
  }

  TEST(LargeMotionInput, InterfacesKeepWhatTheyHave)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    const InterfaceInput &seam = scene->interfaces[0];
    EXPECT_EQ(seam.sliding.dilatancy, 0.1);
    EXPECT_EQ(seam.opening_viscosity, 1.);
    EXPECT_TRUE(seam.crack_pressure.has_value());
  }

  TEST(LargeMotionInput, TheTextOfAPressureSaysThatItIsDead)
  {
    EXPECT_NE(read_good(space)->echo.find("a dead load"), std::string::npos);
    EXPECT_EQ(read_good(small, {"Boundary: right/pressure=1"})
                  ->echo.find("a dead load"),
              std::string::npos);
  }

  TEST(LargeMotionInput, EchoReadsBackTheSame)
  {
    for (const std::string *text : {&space, &plane, &small}) {
      const auto first = read_good(*text);
      ASSERT_NE(first, nullptr);
      const auto second = read_good(first->echo);
      ASSERT_NE(second, nullptr);
      EXPECT_EQ(second->echo, first->echo);
      EXPECT_EQ(second->large_motion, first->large_motion);
      EXPECT_EQ(second->contacts.size(), first->contacts.size());
      EXPECT_EQ(second->pins.size(), first->pins.size());
    }
  }

  TEST(LargeMotionInput, ListNamesEveryModel)
  {
    std::vector<std::string> names;
    for (const NamedPart &part : named_parts())
      if (part.kind == "material model")
        names.push_back(part.name);
    EXPECT_EQ(names, (std::vector<std::string>{
                         "linear elastic", "transversely isotropic", "cubic",
                         "rigid", "orthotropic", "saint-venant kirchhoff",
                         "neo-hookean", "j2 plastic", "viscoplastic"}));
  }

  TEST(LargeMotionInput, PartsAreNamed)
  {
    const auto scene = read_good(space);
    ASSERT_NE(scene, nullptr);
    std::string text;
    for (const auto &[keyword, sentence] : motion_report(*scene))
      text += keyword + " - " + sentence + "\n";
    EXPECT_EQ(text,
              "rigid bodies - stone: cells that touch are one, its surface a "
              "ball, mass 3e-06, inertia 1e-09, 2e-09, 3e-09\n"
              "finite strain - rubber: neo-hookean\n"
              "finite strain - steel: saint-venant kirchhoff\n"
              "contact search - stone on rubber: stone and rubber, friction "
              "0.7, restitution 0, wear coefficient 1e-12\n"
              "contact search - others: all surfaces, friction 0, restitution "
              "0.25\n"
              "pin - hinge: of stone\n");
    const auto alone = read_good(plane, {"Material: rock/mass=3 kg/m"});
    ASSERT_NE(alone, nullptr);
    EXPECT_EQ(motion_report(*alone)[0].text, "rock: each cell is one, mass 3");
    EXPECT_EQ(motion_report(*alone).back().text,
              "no Contact block: surfaces pass through each other");
    const auto &obstacles = scene->obstacles;
    EXPECT_EQ(describe_obstacle(obstacles[0], 3), "plane");
    EXPECT_EQ(describe_obstacle(obstacles[1], 3), "hollow cylinder");
    EXPECT_EQ(describe_obstacle(obstacles[2], 3), "moving sphere");
    EXPECT_EQ(describe_obstacle(obstacles[2], 2), "moving disc");
  }

  TEST(LargeMotionInput, FormulasKnowWhetherTheyDependOnThePlace)
  {
    const auto scene = read_good(small, {"Boundary: left/velocity x=t * 2",
                                         "Boundary: left/velocity y=y + t",
                                         "Boundary: right/velocity x=3"});
    ASSERT_NE(scene, nullptr);
    EXPECT_FALSE(scene->boundaries[0].velocity[0]->depends_on_position());
    EXPECT_TRUE(scene->boundaries[0].velocity[1]->depends_on_position());
    EXPECT_FALSE(scene->boundaries[1].velocity[0]->depends_on_position());
    EXPECT_FALSE(Expression(3.).depends_on_position());
  }
} // namespace nsfd::large_motion_scenes::test_large_motion_input
