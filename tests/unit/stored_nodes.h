#pragma once

#include "make_law.h"
#include "node_problems.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <iterator>

// Problems of nodes from runs, see tests/problems.

namespace node_test
{
  using Json = nlohmann::json;

  inline Interaction stored_interaction(const Json &data)
  {
    Interaction result;
    const auto text = [&](const char *name) {
      std::ostringstream digits;
      digits.precision(17);
      digits << data[name].get<double>();
      return digits.str();
    };
    result.law =
        test::make_law("camacho-ortiz", {{"strength", text("strength")},
                                         {"toughness", text("toughness")}});
    result.friction = data["friction"];
    result.friction_exponent = data["friction exponent"];
    result.stiffness_ratio = result.shear_weight = data["shear weight"];
    return result;
  }

  template <int dim>
  std::vector<Vec<dim>> vectors_of(const Json &data)
  {
    std::vector<Vec<dim>> result(data.size() / dim);
    for (std::size_t i = 0; i < data.size(); ++i)
      result[i / dim][i % dim] = data[i];
    return result;
  }

  template <int dim>
  NodeData<dim> stored_node(const Json &data)
  {
    NodeData<dim> result;
    auto &p = result.problem;
    const std::size_t n = data["kind"].size();
    resize(p, n);
    p.n_owned = n;
    p.time_step = data["time step"];
    p.theta = data["theta"];
    p.rule = CohesionRule::exact;
    result.h = p.time_step * p.theta;
    for (const Json &interaction : data["interactions"])
      p.interactions.push_back(stored_interaction(interaction));
    for (std::size_t i = 0; i < n; ++i) {
      p.kind[i] = PointKind(data["kind"][i].get<int>());
      p.contact[i] = 1;
      p.interaction[i] = data["interaction"][i];
      const Json &groups = data["groups"];
      result.node.points.push_back({i, {{groups[2 * i], groups[2 * i + 1]}}});
    }
    const auto read = [&](const char *name, std::vector<double> &values) {
      values = data[name].get<std::vector<double>>();
    };
    read("weight", p.weight);
    read("factor", p.strength_factor);
    read("factor", p.opening_factor);
    read("largest opening", p.opening_max);
    read("target", p.target);
    read("jump before", p.jump_old);
    read("jump", p.jump_free);
    read("sliding offset", p.sliding_offset);
    read("impulse", result.impulses);
    read("frame", result.frames);
    result.node.inverse_mass = vectors_of<dim>(data["inverse mass"]);
    result.node.velocity = vectors_of<dim>(data["velocity"]);
    result.solutions.resize(n);
    return result;
  }

  inline Json read_stored_nodes(const std::string &file)
  {
    std::ifstream in(file, std::ios::binary);
    return Json::from_cbor(std::vector<char>(std::istreambuf_iterator<char>(in),
                                             std::istreambuf_iterator<char>()));
  }
} // namespace node_test
