#include "nsfd/postprocess/observable_input.h"

#include "parameters/input_errors.h"

#include <fmt/format.h>

#include <sstream>

namespace nsfd::observables
{
  namespace
  {
    std::string kind_name(const NamedSurface::Kind kind)
    {
      switch (kind) {
      case NamedSurface::Kind::boundary:
        return "Boundary";
      case NamedSurface::Kind::obstacle:
        return "Obstacle";
      case NamedSurface::Kind::contact:
        return "Contact";
      default:
        return "Interface";
      }
    }

    std::vector<NamedSurface> surfaces_of(const SceneInput &scene)
    {
      std::vector<NamedSurface> all;
      const auto add = [&](const auto &blocks, const NamedSurface::Kind kind) {
        for (unsigned int b = 0; b < blocks.size(); ++b)
          all.push_back({kind, b, blocks[b].name});
      };
      add(scene.boundaries, NamedSurface::Kind::boundary);
      add(scene.obstacles, NamedSurface::Kind::obstacle);
      for (unsigned int b = 0; b < scene.interfaces.size(); ++b)
        if (scene.interfaces[b].obstacle < 0)
          all.push_back(
              {NamedSurface::Kind::interface, b, scene.interfaces[b].name});
      add(scene.contacts, NamedSurface::Kind::contact);
      return all;
    }
  } // namespace

  std::string full_name(const NamedSurface &surface)
  {
    return kind_name(surface.kind) + ": " + surface.name;
  }

  NamedSurface read_surface(SectionReader &reader, const SceneInput &scene,
                            const std::string &text)
  {
    const std::string name = reader.word("on", "", text);
    if (name.empty()) {
      reader.error("on", "`on` must be given",
                   "write the name of a Boundary, Obstacle, Interface or "
                   "Contact block");
      return {};
    }
    std::vector<NamedSurface> found;
    std::vector<std::string> names;
    for (const NamedSurface &surface : surfaces_of(scene)) {
      names.push_back(surface.name);
      if (surface.name == name || full_name(surface) == name)
        found.push_back(surface);
    }
    if (found.size() == 1)
      return found[0];
    if (found.empty())
      reader.error("on",
                   fmt::format("on = {} is the name of no Boundary, Obstacle, "
                               "Interface or Contact block",
                               name),
                   did_you_mean(name, names));
    else
      reader.error("on",
                   fmt::format("on = {} is the name of several blocks", name),
                   fmt::format("write `{}` or `{}`", full_name(found[0]),
                               full_name(found[1])));
    return {};
  }

  Vector read_direction(SectionReader &reader, const SceneInput &scene)
  {
    const auto given =
        reader.numbers("direction", scene.dimension == 2 ? "1, 0" : "1, 0, 0",
                       units::none, Range::any(), scene.dimension,
                       "in which the crack grows, of any length");
    double largest = 0., square = 0.;
    for (const double n : given)
      largest = std::max(largest, std::abs(n));
    if (largest == 0.) {
      reader.error("direction", "direction = 0 has no direction",
                   "write for example: 1, 0");
      return {{1., 0., 0.}};
    }
    for (const double n : given)
      square += (n / largest) * (n / largest);
    Vector direction = in_space(given);
    for (double &n : direction)
      n /= largest * std::sqrt(square);
    return direction;
  }

  std::optional<RunningCrack> only_material(const SceneInput &scene)
  {
    const MaterialInput *first = nullptr;
    for (const MaterialInput &material : scene.materials) {
      if (material.rigid)
        continue;
      if (first && (first->young != material.young ||
                    first->poisson != material.poisson ||
                    first->density != material.density))
        return {};
      first = &material;
    }
    if (!first || !(first->young > 0.) || !(first->density > 0.))
      return {};
    return RunningCrack(*first, scene.dimension == 2 && scene.plane_stress);
  }

  std::vector<char> read_crack_faces(SectionReader &reader,
                                     const SceneInput &scene,
                                     const bool must_grow)
  {
    std::vector<char> chosen(scene.interfaces.size(), 0);
    std::vector<std::string> names;
    for (std::size_t b = 0; b < chosen.size(); ++b)
      if (scene.interfaces[b].law)
        names.push_back(scene.interfaces[b].name);
    const std::string text = reader.word(
        "faces", "all", "all that may break, or names of Interface blocks");
    if (names.empty() && must_grow)
      reader.error("faces", "no Interface block has a law that breaks",
                   "give one of them a cohesive law");
    std::istringstream words(text);
    for (std::string word; std::getline(words, word, ',');) {
      word.erase(0, word.find_first_not_of(" \t"));
      word.erase(word.find_last_not_of(" \t") + 1);
      bool found = false;
      for (std::size_t b = 0; b < chosen.size(); ++b) {
        const InterfaceInput &block = scene.interfaces[b];
        if (block.law && (text == "all" || block.name == word))
          chosen[b] = found = true;
      }
      if (!found && !names.empty())
        reader.error("faces",
                     fmt::format("faces = {} is the name of no Interface "
                                 "block with a law that breaks",
                                 word),
                     did_you_mean(word, names));
    }
    return chosen;
  }
} // namespace nsfd::observables
