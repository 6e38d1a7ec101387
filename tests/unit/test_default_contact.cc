#include "input/read_scene.h"

#include <gtest/gtest.h>

#include <string>

// What touches in large motions where no Contact block says so.

namespace nsfd::test_default_contact
{
  namespace
  {
    std::string wall(const std::string &interfaces,
                     const std::string &contact = "")
    {
      return R"(set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 4, 1
  set cells        = 4, 1
end
subsection Material: stone
  set model   = rigid
  set density = 1
end
)" + interfaces +
             contact + R"(subsection Time
  set end  = 1
  set step = 0.1
end
)";
    }

    std::string block(const std::string &name, const std::string &entries)
    {
      return "subsection Interface: " + name + "\n" + entries + "end\n";
    }

    std::unique_ptr<SceneInput> read(const std::string &text)
    {
      InputErrors errors;
      auto scene = read_scene_text(text, "test.prm", {}, errors);
      EXPECT_NE(scene, nullptr) << errors.report();
      return scene;
    }

    const std::string left = "  set where = x < 1.5\n",
                      dry = "  set law = contact\n  set friction = 0.6\n  set "
                            "restitution = 0.2\n",
                      joined = "  set law = joined\n";
  } // namespace

  TEST(DefaultContact, AllSurfacesTouchAsTheFacesDo)
  {
    const auto scene =
        read(wall(block("one", left + dry) + block("other", dry)));
    ASSERT_EQ(scene->contacts.size(), 1u);
    const ContactInput &contact = scene->contacts.front();
    EXPECT_TRUE(contact.materials[0].empty());
    EXPECT_EQ(contact.friction, 0.6);
    EXPECT_EQ(contact.restitution, 0.2);
    EXPECT_TRUE(contact.is_default);
  }

  // faces that never open have no friction that could be meant
  TEST(DefaultContact, OnlyFacesThatMayOpenCount)
  {
    EXPECT_EQ(read(wall(block("one", left + joined) + block("other", dry)))
                  ->contacts.size(),
              1u);
    EXPECT_TRUE(read(wall(block("all", joined)))->contacts.empty());
  }

  TEST(DefaultContact, ABlockDecides)
  {
    const std::string own =
        "subsection Contact: own\n  set friction = 0.1\nend\n";
    const auto scene = read(wall(block("all", dry), own));
    ASSERT_EQ(scene->contacts.size(), 1u);
    EXPECT_EQ(scene->contacts.front().friction, 0.1);
    EXPECT_FALSE(scene->contacts.front().is_default);

    const std::string none =
        "subsection Contact: own\n  set between = none\nend\n";
    EXPECT_TRUE(read(wall(block("all", dry), none))->contacts.empty());
  }

  TEST(DefaultContact, DifferentFacesAskForABlock)
  {
    InputErrors errors;
    EXPECT_EQ(read_scene_text(wall(block("one", left + dry) +
                                   block("other", "  set law = contact\n")),
                              "test.prm", {}, errors),
              nullptr);
    EXPECT_EQ(errors.n_errors(), 1u);
    const std::string report = errors.report();
    EXPECT_NE(report.find("`other` has another one than `one`"),
              std::string::npos)
        << report;
    EXPECT_NE(report.find("subsection Contact: all"), std::string::npos);
  }
} // namespace nsfd::test_default_contact
